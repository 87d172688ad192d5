// What a point's summed fields say about the surface there, for plain numbers, for vectors of them and for
// GLSL: see core/base/number.h.

template <class T>
struct SurfaceNormal {
    T x, y, z;
};

// T_x × T_y of T_x = (1 + Dxx, Dyx, ηx), T_y = (Dxy, 1 + Dyy, ηy), of length 1: its z has the sign of J, and
// it is finite however J vanishes. Both tangents parallel: no normal exists; up is as good as any.
// dxy = ∂Dx/∂y, dyx = ∂Dy/∂x: equal for a sum of waves, but not where tiles blend (core/plan/random_tiling.h).
template <class T>
inline SurfaceNormal<T> surface_normal(T slope_x, T slope_y, T dxx, T dyy, T dxy, T dyx) {
    const T x = dyx * slope_y - slope_x * (T(1) + dyy), y = slope_x * dxy - slope_y * (T(1) + dxx);
    const T z = (T(1) + dxx) * (T(1) + dyy) - dxy * dyx;
    const T length = square_root(x * x + y * y + z * z);
    const T by = T(1) / select(length > T(0), length, T(1));
    return SurfaceNormal<T>(select(length > T(0), x * by, T(0)), select(length > T(0), y * by, T(0)),
                            select(length > T(0), z * by, T(1)));
}

// Variances of slopes [-], world axes.
template <class T>
struct SlopeVariances {
    T xx, yy, xy;
};

// Below this |J| unresolved slopes are steepened no further: a crest that folds would make them infinite.
inline constexpr double kLeastJacobian = 0.1;

// Unresolved waves ride on the resolved ones. These move a point at rest x to P(x), M = ∂P/∂x = 1 + ∇D, so that a
// slope ∇ₓη at rest is M⁻ᵀ ∇ₓη on the sea, and variances Σ at rest are M⁻ᵀ Σ M⁻¹: larger where a crest is compressed,
// smaller where a trough is stretched.
template <class T>
inline SlopeVariances<T> carried_slopes(SlopeVariances<T> rest, T dxx, T dyy, T dxy, T dyx) {
    const T jacobian = (T(1) + dxx) * (T(1) + dyy) - dxy * dyx;
    const T by = T(1) / maximum(magnitude(jacobian), T(kLeastJacobian));
    // M⁻ᵀ = (a, −b; −c, d).
    const T a = (T(1) + dyy) * by, b = dyx * by, c = dxy * by, d = (T(1) + dxx) * by;
    const T xx = a * a * rest.xx - T(2) * a * b * rest.xy + b * b * rest.yy,
            yy = c * c * rest.xx - T(2) * c * d * rest.xy + d * d * rest.yy,
            xy = (a * d + b * c) * rest.xy - a * c * rest.xx - b * d * rest.yy;
    // Where a crest is compressed from one side these are small differences of large terms: rounding leaves them possible.
    const T bound = square_root(maximum(xx, T(0)) * maximum(yy, T(0)));
    return SlopeVariances<T>(maximum(xx, T(0)), maximum(yy, T(0)), minimum(maximum(xy, -bound), bound));
}
