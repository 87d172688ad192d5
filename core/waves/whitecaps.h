// Whitecap coverage from the moments of the Jacobian (Dupuy and Bruneton 2012), with a third moment.
//
// J = (1 + Dxx)(1 + Dyy) − Dxy². A footprint splits D into the waves that it resolves and a Gaussian remainder
// s = (sxx, syy, sxy) with covariance V. Given the resolved waves, J = J_resolved + g·s + sᵀAs with
//   g = (1 + Dyy, 1 + Dxx, −2 Dxy),   sᵀAs = sxx syy − sxy²,
// whose cumulants are known in closed form:
//   κ1 = J_resolved + tr(AV),   κ2 = gᵀVg + 2 tr(AVAV),   κ3 = 6 gᵀVAVg + 8 tr(AVAVAV).
// tr(AV) = ⟨sxx syy⟩ − ⟨sxy²⟩ is 0 for every spectrum: both terms are ∬ Ψ kx²ky²/k². So the mean of J is
// J_resolved, and a grid that resolves fewer waves has the same expected coverage: the others enter κ2 and κ3.
// (The paper's Eq. 8 subtracts μ² once instead of each pattern's squared mean, which can make σ² negative. It
// isn't used here.)
#pragma once

#include <algorithm>
#include <cmath>

#include "core/base/constants.h"
#include "core/base/number.h"
#include "core/spectrum/spectral_moments.h"
#include "pelagic/scene.h"

namespace pelagic {

#include "core/waves/whitecaps.inl"

// Mean, variance and third cumulant of a weighted mixture, from those of its parts (law of total cumulance).
// Builds mip levels. Powers are taken about the first part's mean, to avoid cancellation on a calm sea.
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
    // Without any part: J = 1 everywhere.
    JacobianMoments<T> moments() const {
        if (!(weight_ > T(0))) return {T(1), T(0), T(0)};
        const T m1 = first_ / weight_, m2 = second_ / weight_, m3 = third_ / weight_;
        return {origin_ + m1, std::max(m2 - m1 * m1, T(0)), m3 - T(3) * m1 * m2 + T(2) * m1 * m1 * m1};
    }

  private:
    T weight_ = T(0), origin_ = T(0), first_ = T(0), second_ = T(0), third_ = T(0);
};

// The laws were measured up to some 23 m/s, and none holds for a sea that is white all over.
inline constexpr double kMostCoverage = 0.6;

// The share of the sea that is foam, by the scene's law and amount. 0 without wind, never above kMostCoverage.
//   monahan-1980    Monahan and O'Muircheartaigh 1980: 2.95e-6 U10^3.52, U10 in m/s
//   monahan-1986    Monahan and O'Muircheartaigh 1986: 1.95e-5 U10^2.55 exp(0.0861 ΔT), ΔT the sea's temperature less the
//                   air's (Darles et al. 2007, Eq. 3, prints 1.59e-5)
//   callaghan-2008  Callaghan et al. 2008: 3.18e-5 (U10 − 3.70)³, from 10.2 m/s on 4.82e-6 (U10 + 1.98)³, seen up to
//                   23.09 m/s. From there on it stays: Holthuijsen et al. 2012 found no more foam on crests beyond 24 m/s.
// `winds`: in so many times the scene's wind.
double law_coverage(const Scene& scene, double winds = 1.0);
// The exponent of the wind in the law, at the scene's wind: 3.52, 2.55; 0 where the coverage stays constant. Near the
// wind at which foam begins callaghan-2008 is steeper than any power; 4 at most.
double law_exponent(const Scene& scene);

// How fast foam comes and goes, for its statistics.
struct FoamLife {
    double rate_per_s = 0.0;  // √(Var(dJ/dt)/Var(J)), of the waves that break
    double lasting_s = 0.0;   // ∫ over the foam's age of the share that is left

    // What one breaking leaves, on average: half of what broke is residual foam just after.
    static constexpr double kLeft = 0.5;

    // The coverage that breaking leaves per second that it lasts: kLeft/d, d being the mean time that J stays below
    // the threshold at a point of the water. By Rice 1944: the share of time over the rate of crossings, both of the
    // Gaussian whose deviate at the threshold is y.
    double left_per_s(double y) const {
        const double share = 0.5 * std::erfc(-y / std::sqrt(2.0));
        const double crossings_per_s = rate_per_s / kTwoPi * std::exp(-0.5 * y * y);
        return share > 0.0 ? kLeft * crossings_per_s / share : 0.0;
    }
};

// The standard normal deviate whose probability is the share of points at rest with J < threshold.
inline double breaking_deviate(const JacobianMoments<double>& j, double threshold, bool third_moment) {
    const double sigma = std::sqrt(j.variance);
    const double z = std::clamp((threshold - j.mean) / sigma, -kFarthestDeviate, kFarthestDeviate);
    return third_moment ? whitecaps_detail::to_normal(z, j.third / (j.variance * sigma)).y : z;
}

// The mean coverage that earlier breaking has left over the whole sea, before it is limited to 1. `left`: the
// coverage left per second of breaking, times how long it lasts.
inline double left_coverage(double deviate, double left) {
    return left * 0.5 * std::erfc(-deviate / std::sqrt(2.0));
}

// All foam of the sea at a threshold: what breaks now, and what is left on the rest.
double whole_coverage(const JacobianMoments<double>& j, double threshold, bool third_moment, double left);

// The coverage of the whole sea at any threshold.
struct FoamBalance {
    JacobianMoments<double> j{};
    double left = 0.0;  // as whole_coverage() takes it
    bool third_moment = true;
    double choppiness = 1.0;  // of the waves that break (Breaking)
    // Below 1: water that isn't compressed has no foam.
    double highest_threshold() const { return 1.0 - 0.01 * std::min(choppiness, 1.0); }
    double coverage_at(double threshold) const { return whole_coverage(j, threshold, third_moment, left); }
};

// The threshold ε, below 1, at which the waves that break have that coverage, or the nearest where the law is out of
// reach: a trochoid that is compressed to J = 0.9 has a steepness of 0.1, and none breaks below that (more choppiness
// than the trochoid's own compresses gentler waves as much, and they may break as well). So a sea without long enough
// waves has no foam, and water that is stretched never has. −∞ (no foam) without coverage or without such waves.
// choppiness: theirs (Breaking). `third_moment`: as coverage() will be called. With persistent foam, present breaking
// and what earlier breaking has left have that coverage together.
double calibrated_threshold(const SpectralMoments& breaking, double law_coverage, double choppiness,
                            bool third_moment, const FoamLife& life = {});

}  // namespace pelagic
