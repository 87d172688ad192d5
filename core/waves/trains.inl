// What a footprint hides of a trochoid train, for plain numbers, for vectors of them and for GLSL: see
// core/base/number.h.

// The part of a trochoid train's variances of height, slope and strain that is hidden where it is shown with weight w:
// 1 − w² without cancellation.
template <class T>
inline T hidden_part(T w) {
    return (T(1) - w) * (T(1) + w);
}
