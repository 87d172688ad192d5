// The normal of waves on a surface that isn't flat at rest; after surface.inl, of which it is made.

// A surface S(u, v) with a sea on it that is displaced along the world's axes: P = S + D(S.x, S.y). With the tangents of a flat
// sea, T_x = e_x + ∂D/∂x and T_y = e_y + ∂D/∂y, those of P are A ∂S/∂u and A ∂S/∂v, A = (T_x, T_y, e_z) by columns. So their
// cross product is cof(A) N of N = ∂S/∂u × ∂S/∂v, cof(A) = (T_y × e_z, e_z × T_x, T_x × T_y), whatever the parameters are and
// where S is vertical, too. N = e_z: surface_normal(). N has any length, and the result is of length 1; where it vanishes, N
// stands for it.
template <class T>
inline SurfaceNormal<T> normal_on(SurfaceNormal<T> rest, T slope_x, T slope_y, T dxx, T dyy, T dxy, T dyx) {
    const T up_x = dyx * slope_y - slope_x * (T(1) + dyy), up_y = slope_x * dxy - slope_y * (T(1) + dxx);
    const T up_z = (T(1) + dxx) * (T(1) + dyy) - dxy * dyx;
    const T x = rest.x * (T(1) + dyy) - rest.y * dyx + rest.z * up_x;
    const T y = rest.y * (T(1) + dxx) - rest.x * dxy + rest.z * up_y;
    const T z = rest.z * up_z;
    const T length = square_root(x * x + y * y + z * z);
    const T by = T(1) / select(length > T(0), length, T(1));
    return SurfaceNormal<T>(select(length > T(0), x * by, rest.x), select(length > T(0), y * by, rest.y),
                            select(length > T(0), z * by, rest.z));
}
