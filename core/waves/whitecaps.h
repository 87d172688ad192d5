// Whitecap coverage from the moments of the Jacobian (Dupuy and Bruneton 2012), with a third moment.
//
// J = (1 + Dxx)(1 + Dyy) − Dxy². A footprint splits D into the waves that it shows and a Gaussian remainder s
// = (sxx, syy, sxy) with covariance V. Given the shown ones, J = J_shown + g·s + sᵀAs with
//   g = (1 + Dyy, 1 + Dxx, −2 Dxy),   sᵀAs = sxx syy − sxy²,
// whose cumulants are known in closed form:
//   κ1 = J_shown + tr(AV),   κ2 = gᵀVg + 2 tr(AVAV),   κ3 = 6 gᵀVAVg + 8 tr(AVAVAV).
// tr(AV) = ⟨sxx syy⟩ − ⟨sxy²⟩ is 0 for every spectrum: both are ∬ Ψ kx²ky²/k². So the mean of J is the shown
// J, and a grid that shows fewer waves has the same expected coverage: what it doesn't show is in κ2 and κ3.
// The paper's own sum of squares (its Eq. 8) subtracts μ² once instead of each pattern's mean, which makes σ²
// negative; none of that here.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/base/constants.h"
#include "core/spectrum/spectral_moments.h"

namespace pelagic {

// Mean, variance and third cumulant of J in a footprint [-].
template <class T>
struct JacobianMoments {
    T mean = T(1), variance = T(0), third = T(0);
};

// Covariance of (sxx, syy, sxy): the fourth moments of the waves that a footprint hides, times choppiness².
template <class T>
struct HiddenStrain {
    T xxxx = T(0), xxxy = T(0), xxyy = T(0), xyyy = T(0), yyyy = T(0);
};

// J's cumulants given the shown derivatives of the displacement. Variance ≥ 0; exactly 0 where nothing is
// hidden.
template <class T>
JacobianMoments<T> jacobian_moments(T dxx, T dyy, T dxy, const HiddenStrain<T>& v) {
    const T gx = T(1) + dyy, gy = T(1) + dxx, gs = T(-2) * dxy;
    // Vg, AV and then the traces; A has ½ off the diagonal (xx, yy) and −1 at (xy, xy).
    const T vg_x = v.xxxx * gx + v.xxyy * gy + v.xxxy * gs;
    const T vg_y = v.xxyy * gx + v.yyyy * gy + v.xyyy * gs;
    const T vg_s = v.xxxy * gx + v.xyyy * gy + v.xxyy * gs;
    const T h = T(0.5);
    const T m[3][3] = {{h * v.xxyy, h * v.yyyy, h * v.xyyy},
                       {h * v.xxxx, h * v.xxyy, h * v.xxxy},
                       {-v.xxxy, -v.xyyy, -v.xxyy}};
    T trace2 = T(0), trace3 = T(0);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            trace2 += m[i][j] * m[j][i];
            for (int k = 0; k < 3; ++k) trace3 += m[i][j] * m[j][k] * m[k][i];
        }
    JacobianMoments<T> result;
    result.mean = gx * gy - dxy * dxy;
    result.variance = std::max(gx * vg_x + gy * vg_y + gs * vg_s + T(2) * trace2, T(0));
    result.third = T(6) * (vg_x * vg_y - vg_s * vg_s) + T(8) * trace3;
    return result;
}

// Mean, variance and third cumulant of a weighted set of parts from theirs and from the spread of their
// means: how a mip level is made (law of total cumulance). Powers are taken about the first part's mean, so
// that a calm sea doesn't cancel.
template <class T>
class MomentSum {
  public:
    // weight > 0, in any unit.
    void add(const JacobianMoments<T>& part, T weight = T(1)) {
        if (!(weight_ > T(0))) origin_ = part.mean;
        const T d = part.mean - origin_;
        weight_ += weight;
        first_ += weight * d;
        second_ += weight * (d * d + part.variance);
        third_ += weight * (d * d * d + T(3) * d * part.variance + part.third);
    }
    // Of nothing: J = 1 everywhere.
    JacobianMoments<T> moments() const {
        if (!(weight_ > T(0))) return {};
        const T m1 = first_ / weight_, m2 = second_ / weight_, m3 = third_ / weight_;
        return {origin_ + m1, std::max(m2 - m1 * m1, T(0)), m3 - T(3) * m1 * m2 + T(2) * m1 * m1 * m1};
    }

  private:
    T weight_ = T(0), origin_ = T(0), first_ = T(0), second_ = T(0), third_ = T(0);
};

namespace whitecaps_detail {

// Beyond these |skewness| Wilson and Hilferty's cube leaves its range; a J that lopsided is calm almost
// everywhere.
inline constexpr double kLargestSkewness = 2.0;
inline constexpr double kNoSkewness = 1e-4;  // below, the correction is smaller than single precision

// The standard normal deviate as improbable as the deviate z of a Pearson III (shifted gamma) variable of
// mean 0, variance 1 and the given skewness: Wilson and Hilferty 1931. Rising in z, and the identity for
// skewness → 0.
template <class T>
T to_normal(T z, T skewness) {
    const T s = std::clamp(skewness, T(-kLargestSkewness), T(kLargestSkewness));
    if (std::abs(s) < T(kNoSkewness)) return z;
    return (T(6) / s) * (std::cbrt(T(1) + T(0.5) * s * z) - T(1)) + s / T(6);
}

template <class T>
T from_normal(T y, T skewness) {
    const T s = std::clamp(skewness, T(-kLargestSkewness), T(kLargestSkewness));
    if (std::abs(s) < T(kNoSkewness)) return y;
    const T root = T(1) + (s / T(6)) * (y - s / T(6));
    return (T(2) / s) * (root * root * root - T(1));
}

// Standard normal quantile by Newton's method on erfc; p in (0, 1).
inline double normal_quantile(double p) {
    double y = 0.0;
    for (int i = 0; i < 100; ++i) {
        const double excess = 0.5 * std::erfc(-y / std::sqrt(2.0)) - p;
        const double density = std::exp(-0.5 * y * y) / std::sqrt(kTwoPi);
        const double step = std::clamp(excess / std::max(density, 1e-300), -0.5, 0.5);
        y -= step;
        if (std::abs(step) < 1e-14) break;
    }
    return y;
}

}  // namespace whitecaps_detail

// The part of a footprint with J < threshold, 0 … 1. Two moments: ½(1 + erf((ε − μ)/(√2 σ))) (Dupuy and
// Bruneton 2012, Eq. 6). The third makes J's distribution a shifted gamma: with a skewness of 0.24, the
// Gaussian is off by +85 % at a coverage of 0.005. Variance 0: the step, without a division.
template <class T>
T coverage(const JacobianMoments<T>& j, T threshold, bool third_moment) {
    if (!(j.variance > T(0))) return j.mean < threshold ? T(1) : T(0);
    const T sigma = std::sqrt(j.variance);
    T z = (threshold - j.mean) / sigma;
    if (third_moment) z = whitecaps_detail::to_normal(z, j.third / j.variance / sigma);
    return std::clamp(T(0.5) * std::erfc(-z / T(std::sqrt(2.0))), T(0), T(1));
}

// Monahan and O'Muircheartaigh 1980: W = 2.95e-6 U10^3.52, U10 in m/s. Held below 1 (reached at 37 m/s).
inline double observed_coverage(double wind_speed_mps) {
    return std::min(2.95e-6 * std::pow(std::max(wind_speed_mps, 0.0), 3.52), 0.99);
}

// The threshold ε at which the whole sea, every wave of the spectrum counted, has the coverage that is
// observed at this wind. −∞ (never any foam) without wind or where nothing converges.
// `third_moment`: as coverage() will be asked.
inline double calibrated_threshold(const SpectralMoments& all_waves, double wind_speed_mps,
                                   bool third_moment) {
    const auto j = jacobian_moments<double>(
        0.0, 0.0, 0.0, {all_waves.xxxx, all_waves.xxxy, all_waves.xxyy, all_waves.xyyy, all_waves.yyyy});
    const double w = observed_coverage(wind_speed_mps);
    constexpr double kNoFoam = 1e-9;  // a square millimetre in a thousand square metres
    if (w < kNoFoam || !(j.variance > 0.0)) return -std::numeric_limits<double>::infinity();
    const double sigma = std::sqrt(j.variance);
    const double skewness = third_moment ? j.third / j.variance / sigma : 0.0;
    return j.mean + sigma * whitecaps_detail::from_normal(whitecaps_detail::normal_quantile(w), skewness);
}

}  // namespace pelagic
