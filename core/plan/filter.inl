// The footprint filter's blend, for plain numbers, for vectors of them and for GLSL: see core/base/number.h.

// 3x² − 2x³ for x ∈ [0, 1]: from 0 to 1, level at both ends (Bruneton, Neyret, Holzschuch 2010, §4.1).
template <class T>
inline T smooth_rise(T x) {
    return x * x * (T(3) - T(2) * x);
}
