// The formulas of whitecaps, written once for scalars, SIMD vectors and GLSL (core/base/number.h). Their
// derivation is in core/waves/whitecaps.h.

// Mean, variance and third cumulant of J within a footprint [-].
template <class T>
struct JacobianMoments {
    T mean, variance, third;
};

// Covariance of (sxx, syy, sxy): fourth moments of the unresolved waves, times choppiness².
template <class T>
struct UnresolvedGradients {
    T xxxx, xxxy, xxyy, xyyy, yyyy;
};

// tr(AVAV) and tr(AVAVAV): the terms of J's cumulants that depend on V alone.
template <class T>
struct GradientTraces {
    T second, third;
};

template <class T>
inline GradientTraces<T> gradient_traces(UnresolvedGradients<T> v) {
    // AV by rows. A is ½ at (xx, yy) and (yy, xx), −1 at (xy, xy), 0 elsewhere.
    const T h = T(0.5);
    T m[9];
    m[0] = h * v.xxyy;
    m[1] = h * v.yyyy;
    m[2] = h * v.xyyy;
    m[3] = h * v.xxxx;
    m[4] = h * v.xxyy;
    m[5] = h * v.xxxy;
    m[6] = -v.xxxy;
    m[7] = -v.xyyy;
    m[8] = -v.xxyy;
    T second = T(0), third = T(0);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            second += m[3 * i + j] * m[3 * j + i];
            for (int k = 0; k < 3; ++k) third += m[3 * i + j] * m[3 * j + k] * m[3 * k + i];
        }
    return GradientTraces<T>(second, third);
}

// J's cumulants, given the resolved derivatives of the displacement, dxy = ∂Dx/∂y and dyx = ∂Dy/∂x. The variance is ≥
// 0, and exactly 0 where all waves are resolved.
template <class T>
inline JacobianMoments<T> jacobian_moments(T dxx, T dyy, T dxy, T dyx, UnresolvedGradients<T> v,
                                           GradientTraces<T> traces) {
    const T gx = T(1) + dyy, gy = T(1) + dxx, gs = -(dxy + dyx);
    const T vg_x = v.xxxx * gx + v.xxyy * gy + v.xxxy * gs;
    const T vg_y = v.xxyy * gx + v.yyyy * gy + v.xyyy * gs;
    const T vg_s = v.xxxy * gx + v.xyyy * gy + v.xxyy * gs;
    return JacobianMoments<T>(gx * gy - dxy * dyx,
                              maximum(gx * vg_x + gy * vg_y + gs * vg_s + T(2) * traces.second, T(0)),
                              T(6) * (vg_x * vg_y - vg_s * vg_s) + T(8) * traces.third);
}
template <class T>
inline JacobianMoments<T> jacobian_moments(T dxx, T dyy, T dxy, T dyx, UnresolvedGradients<T> v) {
    return jacobian_moments(dxx, dyy, dxy, dyx, v, gradient_traces(v));
}

namespace whitecaps_detail {

// Wilson and Hilferty's cube root holds up to this |skewness|. A J more skewed than that belongs to an almost
// calm sea.
inline constexpr double kLargestSkewness = 2.0;
inline constexpr double kNoSkewness = 1e-4;  // the correction is below single precision

// A standard normal deviate y, and the cube root (1 + s z/2)^⅓ of the deviate z that it stands for, which converts
// densities.
template <class T>
struct NormalDeviate {
    T y, root;
};

// Maps the deviate z of a Pearson III (shifted gamma) variable of mean 0, variance 1 and the given skewness
// to the standard normal deviate of equal probability: Wilson and Hilferty 1931. Increasing in z; the
// identity for skewness → 0. The root is (1 + s z/2)^⅓.
template <class T>
inline NormalDeviate<T> to_normal(T z, T skewness) {
    const T clamped = minimum(maximum(skewness, T(-kLargestSkewness)), T(kLargestSkewness));
    const T s = select(magnitude(clamped) < T(kNoSkewness), T(1), clamped);
    const T root = cube_root(T(1) + T(0.5) * s * z);
    const T y = (T(6) / s) * (root - T(1)) + s * T(1.0 / 6.0);
    return NormalDeviate<T>(select(magnitude(clamped) < T(kNoSkewness), z, y),
                            select(magnitude(clamped) < T(kNoSkewness), T(1), root));
}

}  // namespace whitecaps_detail

// Beyond this many standard deviations the coverage is 0 or 1 (ε = −∞: no foam).
inline constexpr double kFarthestDeviate = 30.0;

// E[J; J < μ + σ z], σ² > 0. Of a Gaussian it is μ Φ(z) − σ φ(z); of a shifted gamma of skewness s, σ² (1 + s z/2) times
// the density of J in place of σ φ. With Wilson and Hilferty's normal deviate y both are μ Φ(y) − σ (1 + s z/2)^⅓ φ(y).
template <class T>
inline T mean_below(JacobianMoments<T> j, T sigma, T z, bool third_moment) {
    const T inside = minimum(maximum(z, T(-kFarthestDeviate)), T(kFarthestDeviate));
    T y = inside;
    T root = T(1);
    if (third_moment) {
        whitecaps_detail::NormalDeviate<T> normal =
            whitecaps_detail::to_normal(inside, j.third / (sigma * sigma) / sigma);
        y = normal.y;
        root = normal.root;
    }
    const T share = minimum(T(0.5) * complementary_error(y * T(-0.70710678118654752440)), T(1));
    return j.mean * share - sigma * root * (T(0.39894228040143267794) * exponential(T(-0.5) * y * y));
}

// The area of sea over that at rest: E[max(J, 0)]. What is folded over lies under it and is no sea to be seen.
template <class T>
inline T sea_area(JacobianMoments<T> j, bool third_moment) {
    const T sigma = square_root(select(j.variance > T(0), j.variance, T(1)));
    const T folded = mean_below(j, sigma, T(0) - j.mean / sigma, third_moment);
    return maximum(select(j.variance > T(0), j.mean - folded, j.mean), T(0));
}

// The share of a footprint's sea that has J < threshold, 0 … 1: E[max(J, 0); J < ε]/E[max(J, 0)], since a patch at rest of
// area A covers A·J of sea. (Dupuy and Bruneton 2012, Eq. 6, counts patches at rest.) From two moments J is Gaussian. The
// third makes its distribution a shifted gamma: at a skewness of 0.24 and a coverage of 0.005 the Gaussian is 85 % too
// large. Variance 0 gives a step, without a division; a footprint that is folded altogether is foam.
template <class T>
inline T coverage(JacobianMoments<T> j, T threshold, bool third_moment) {
    const T sigma = square_root(select(j.variance > T(0), j.variance, T(1)));
    const T deviate = (threshold - j.mean) / sigma;
    const T folded = mean_below(j, sigma, T(0) - j.mean / sigma, third_moment);
    const T sea = j.mean - folded;
    const T foam = mean_below(j, sigma, deviate, third_moment) - folded;
    const T least = T(1e-3) * sigma;  // less than that is rounding in single precision
    const T share = select(sea > least, minimum(maximum(foam / maximum(sea, least), T(0)), T(1)), T(1));
    const T within = select(threshold > T(0), select(deviate > T(kFarthestDeviate), T(1), share), T(0));
    return select(j.variance > T(0), within, select(j.mean < threshold, T(1), T(0)));
}

// Breaking waves lie on foam that they have left themselves (half of what one breaking leaves, on average), and where
// they compress the sea. A footprint that resolves the breaking has this by itself. In one that doesn't, each share
// of breaking covers this share of what earlier breaking has left, as measured at 14 m/s and decays of 0.5 … 4 s (0.3
// … 0.5).
inline constexpr double kUnderBreaking = 0.42;

// That share where what breaks is seen through a wider footprint than what it has left, as in pictures (Plan::breaking): the foam
// there shows half of it by itself, and the less so the nearer the two. With it all foam is as much as on meshes: at 14 and 24 m/s
// within 1 % at a decay of 4 s, 1.5 % at 0.5 s (without 1.3 and 5 %), in edition 3 2.3 % there. For the same footprint it is the whole share, to the bit.
template <class T>
inline T share_under_breaking(T footprint_m, T past_m, T breaking_m) {
    // In this order also of a pixel without end, or that is no number.
    T own_m = maximum(minimum(breaking_m, footprint_m), past_m);
    T ratio = (own_m + T(1e-6)) / (breaking_m + T(1e-6));
    T square = ratio * ratio;
    return T(kUnderBreaking) * (T(0.5) + T(0.5) * square * square);
}

// The share of a footprint that is residual foam: what earlier breaking has left (core/effects/foam_history.h) and
// present breaking doesn't cover.
template <class T>
inline T residual_foam(T left, T breaking, T under) {
    return minimum(maximum(left - under * breaking, T(0)), T(1)) * (T(1) - breaking);
}
template <class T>
inline T residual_foam(T left, T breaking) {
    return residual_foam(left, breaking, T(kUnderBreaking));
}
