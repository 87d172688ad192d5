// What a footprint leaves unresolved of a trochoid train, for plain numbers, for vectors of them and for GLSL: see
// core/base/number.h.

// The unresolved part of a trochoid train's variances of height, slope and displacement gradient where its weight is
// w: 1 − w² without cancellation.
template <class T>
inline T unresolved_part(T w) {
    return (T(1) - w) * (T(1) + w);
}
