// What a point's summed fields say about the surface there, for plain numbers, for vectors of them and for
// GLSL: see core/base/number.h.

template <class T>
struct SurfaceNormal {
    T x, y, z;
};

// T_x × T_y of T_x = (1 + Dxx, Dxy, ηx), T_y = (Dxy, 1 + Dyy, ηy), of length 1: its z has the sign of J, and
// it is finite however J vanishes. Both tangents parallel: no normal exists; up is as good as any.
template <class T>
inline SurfaceNormal<T> surface_normal(T slope_x, T slope_y, T dxx, T dyy, T dxy) {
    const T x = dxy * slope_y - slope_x * (T(1) + dyy), y = slope_x * dxy - slope_y * (T(1) + dxx);
    const T z = (T(1) + dxx) * (T(1) + dyy) - dxy * dxy;
    const T length = square_root(x * x + y * y + z * z);
    const T by = T(1) / select(length > T(0), length, T(1));
    return SurfaceNormal<T>(select(length > T(0), x * by, T(0)), select(length > T(0), y * by, T(0)),
                            select(length > T(0), z * by, T(1)));
}
