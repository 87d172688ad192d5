// What a pixel's footprint leaves unresolved of the waves' variances, for plain numbers, for vectors of them and for
// GLSL: see core/base/number.h.

// A moment at a point between two levels, which reads (1 − t) of one level's fields and t of the next one's: ((1 − t)
// w_a + t w_b)² expanded. here, next: the moment that each level resolves, or leaves unresolved; both: with the
// product of their weights. The three factors add up to 1, so that unresolved moments blend alike.
template <class T>
inline T blended_moment(T here, T both, T next, T t) {
    return (T(1) - t) * (T(1) - t) * here + (T(2) * t * (T(1) - t) * both + t * t * next);
}

// Second moments of slopes and of displacement gradients (times choppiness²) [-]: UnresolvedMoments by name.
template <class T>
struct PixelMoments {
    T xx, xy, yy, xxxx, xxxy, xxyy, xyyy, yyyy;
};

template <class T>
inline T possible_covariance(T value, T bound) {
    return minimum(maximum(value, -bound), bound);
}

// Repairs the rounding of moments that are differences of sums: variances are never negative, covariances within
// their bounds.
template <class T>
inline PixelMoments<T> possible_moments(PixelMoments<T> m) {
    const T xx = maximum(m.xx, T(0)), yy = maximum(m.yy, T(0));
    const T xxxx = maximum(m.xxxx, T(0)), yyyy = maximum(m.yyyy, T(0));
    const T xxyy = minimum(maximum(m.xxyy, T(0)), square_root(xxxx * yyyy));
    return PixelMoments<T>(xx, possible_covariance(m.xy, square_root(xx * yy)), yy, xxxx,
                           possible_covariance(m.xxxy, square_root(xxxx * xxyy)), xxyy,
                           possible_covariance(m.xyyy, square_root(yyyy * xxyy)), yyyy);
}
