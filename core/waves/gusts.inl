// The pattern of gusts (core/plan/gusts.h) and what it does, for vectors and for GLSL: see core/base/number.h. The includer has
// sine_of_cycles() and cosine_of_cycles() as well.

// How far the waves before shift a wave: cycles for each unit of their sum.
inline constexpr double kGustShift = 0.238732414637843;

// Sums over the waves so far, the longest first: the pattern that a footprint resolves, the shift of the next wave,
// and the resolved variance.
template <class T>
struct GustSum {
    T resolved, shift, kept;
};

// cycles: of this wave at the point; weight: of it in the footprint.
template <class T>
inline GustSum<T> with_gust(GustSum<T> sum, T amplitude, T cycles, T weight) {
    T shifted = cycles + T(kGustShift) * sum.shift;
    T resolved = weight * amplitude;
    return GustSum<T>(sum.resolved + resolved * cosine_of_cycles(shifted),
                      sum.shift + amplitude * sine_of_cycles(shifted),
                      sum.kept + T(0.5) * resolved * resolved);
}

// The square of a footprint's length along a direction: its width, and its long axis [m] or nothing.
template <class T>
inline T length2_along(T width, T axis_x, T axis_y, T unit_x, T unit_y) {
    T length2 = axis_x * axis_x + axis_y * axis_y;
    T beyond = maximum(length2 - width * width, T(0)) / maximum(length2, T(1e-12));
    T along = axis_x * unit_x + axis_y * unit_y;
    return width * width + beyond * along * along;
}

// How far foam in a front has gone from where no pattern is seen to where all is, by the share of the variance that is kept: the level's
// own variance rises faster than that. Mean foam of fronts stays within some percent.
template <class T>
inline T patchy_share(T kept) {
    return kept * (T(2) - kept);
}

// The level of gusts, −1 … 1. Its mean over area is 0, however much of the pattern a footprint resolves.
template <class T>
inline T gust_level(T resolved) {
    return resolved / square_root(T(1) + resolved * resolved);
}
