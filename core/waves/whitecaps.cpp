#include "core/waves/whitecaps.h"

#include <limits>

namespace pelagic {

namespace {

double coverage_at(const Scene& scene, double wind_mps) {
    constexpr double kFastestSeen_mps = 23.09;
    const Effects& effects = scene.effects;
    const auto cube = [](double x) { return std::max(x * x * x, 0.0); };
    const double law = [&] {
        switch (effects.whitecap_law) {
            case WhitecapLaw::Monahan1980:
                return 2.95e-6 * std::pow(wind_mps, 3.52);
            case WhitecapLaw::Monahan1986:
                return 1.95e-5 * std::pow(wind_mps, 2.55) * std::exp(0.0861 * effects.sea_minus_air_c);
            case WhitecapLaw::Callaghan2008: {
                const double seen_mps = std::min(wind_mps, kFastestSeen_mps);
                // The two cross at 10.2 m/s; the smaller one holds.
                return std::min(3.18e-5 * cube(seen_mps - 3.70), 4.82e-6 * cube(seen_mps + 1.98));
            }
        }
        return 0.0;
    }();
    return std::min(effects.whitecap_amount * law, kMostCoverage);
}

}  // namespace

double law_coverage(const Scene& scene, double winds) {
    return coverage_at(scene, winds * std::max(scene.sea.wind_speed_mps, 0.0));
}

double law_exponent(const Scene& scene) {
    constexpr double kStep = 1.01, kMost = 4.0;
    const double wind_mps = scene.sea.wind_speed_mps;
    const double less = coverage_at(scene, wind_mps / kStep), more = coverage_at(scene, wind_mps * kStep);
    return less > 0.0 ? std::min(std::log(more / less) / (2.0 * std::log(kStep)), kMost) : kMost;
}

double whole_coverage(const JacobianMoments<double>& j, double threshold, bool third_moment, double left) {
    const double active = coverage(j, threshold, third_moment);
    if (!(left > 0.0)) return active;
    // Cells that resolve the breaking see 1.7 % less of it than J's three moments say: the law lies between.
    constexpr double kSeen = 0.99;
    const double residual = left_coverage(breaking_deviate(j, threshold, third_moment), left);
    return active + residual_foam(kSeen * residual, active);
}

double calibrated_threshold(const SpectralMoments& breaking, double law_coverage, double choppiness,
                            bool third_moment, const FoamLife& life) {
    const auto j = jacobian_moments<double>(
        0.0, 0.0, 0.0, 0.0, {breaking.xxxx, breaking.xxxy, breaking.xxyy, breaking.xyyy, breaking.yyyy});
    constexpr double kNoFoam = 1e-9;  // a square millimetre in a thousand square metres
    if (law_coverage < kNoFoam || !(j.variance > 0.0)) return -std::numeric_limits<double>::infinity();
    constexpr double kLeastPressed = 0.1;
    double low = 0.0, high = 1.0 - kLeastPressed * std::min(choppiness, 1.0);
    for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (low + high);
        const double left = life.lasting_s > 0.0
                                ? life.left_per_s(breaking_deviate(j, middle, third_moment)) * life.lasting_s
                                : 0.0;
        (whole_coverage(j, middle, third_moment, left) < law_coverage ? low : high) = middle;
    }
    return high;
}

}  // namespace pelagic
