// What a pixel covers of a tilted sea, for plain numbers and for GLSL: see core/base/number.h.

// The long axis of a footprint, as of Points.
template <class T>
struct PixelAxis {
    T x_m, y_m;
};

// Of a pixel that is across_m wide where it meets a surface with normal n and slopes g = −n_xy/n_z, v being the way to the
// eye; n and v are unit vectors. A horizontal way s on the surface rises by g · s, and is seen as long as what of it is
// perpendicular to v: sᵀ A s ≤ (across_m/2)², A = 1 + g gᵀ − u uᵀ, u = v_xy + v_z g. Its determinant is the square of
// the seen area over the horizontal one, (n · v/n_z)². The larger eigenvalue is 1 or more: across_m stands for the short
// axis. Surfaces seen edge-on count as seen at a slant of a thousandth.
template <class T>
inline PixelAxis<T> pixel_axis(T across_m, T nx, T ny, T nz, T vx, T vy, T vz) {
    const T by = T(1) / maximum(nz, T(0.01));
    const T gx = T(0) - nx * by;
    const T gy = T(0) - ny * by;
    const T ux = vx + vz * gx;
    const T uy = vy + vz * gy;
    const T xy = gx * gy - ux * uy;
    const T half_x = T(0.5) * (gx * gx - ux * ux - gy * gy + uy * uy);
    const T middle = T(1) + T(0.5) * (gx * gx - ux * ux + gy * gy - uy * uy);
    const T apart = square_root(half_x * half_x + xy * xy);
    const T most = middle + apart;
    const T seen = vz - gx * vx - gy * vy;
    const T least = maximum(seen * seen / most, T(1e-6) * most);
    // The eigenvector of the least, in the form that doesn't cancel.
    const T ax = select(half_x > T(0), T(0) - xy, apart - half_x);
    const T ay = select(half_x > T(0), half_x + apart, T(0) - xy);
    const T length = square_root(least * (ax * ax + ay * ay));
    const T along_m = select(length > T(0), across_m / length, T(0));
    return PixelAxis<T>(along_m * ax, along_m * ay);
}
