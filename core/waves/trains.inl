// What a footprint hides of a trochoid train, for plain numbers, for vectors of them and for GLSL: see
// core/base/number.h.

// The part of a trochoid train's energy, and of its strain variance, that is hidden where it is shown with
// weight w: 1 − w² without cancellation.
template <class T>
inline T hidden_strain_part(T w) {
    return (T(1) - w) * (T(1) + w);
}

// The part of its slope variance, which falls faster with w: 1 − w² (1 + √(1 − q²))/(1 + √(1 − w²q²)),
// steepness2 = q² = (kH)² (Bruneton, Neyret, Holzschuch 2010, appendix A, as trains.h has it).
template <class T>
inline T hidden_slope_part(T w, T steepness2) {
    const T w2 = w * w;
    const T whole = T(1) + square_root(T(1) - steepness2);
    const T shown = T(1) + square_root(minus_product(T(1), w2, steepness2));
    return maximum(T(1) - w2 * whole / shown, T(0));
}
