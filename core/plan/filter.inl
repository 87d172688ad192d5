// The footprint filter's blend, for plain numbers, for vectors of them and for GLSL: see core/base/number.h.

// 3x² − 2x³ for x ∈ [0, 1]: from 0 to 1, level at both ends (Bruneton, Neyret, Holzschuch 2010, §3.2).
template <class T>
inline T smooth_rise(T x) {
    return x * x * minus_product(T(3), T(2), x);
}

// w(Nmin, Nmax, λ/L) = 3x̄² − 2x̄³, x̄ = clamp((λ/L − Nmin)/(Nmax − Nmin), 0, 1): the weight of a wave that is
// `samples` = λ/L of its footprints long. per_range = 1/(Nmax − Nmin).
template <class T>
inline T footprint_weight(T samples, T n_min, T per_range) {
    return smooth_rise(minimum(maximum((samples - n_min) * per_range, T(0)), T(1)));
}
