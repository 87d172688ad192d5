#include "core/plan/vessels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>

#include "core/base/constants.h"
#include "core/plan/mode_lattice.h"
#include "core/scene/course.h"
#include "core/spectrum/dispersion.h"

namespace pelagic {
namespace {

constexpr double kLeastLengths = 4.0;  // of a hull in its tile

// 3 (sin u − u cos u)/u³, the transform of a parabola.
double parabola(double u) {
    return std::abs(u) < 0.05 ? 1.0 - u * u / 10.0 : 3.0 * (std::sin(u) - u * std::cos(u)) / (u * u * u);
}

constexpr int kBands = 8;  // of modes, by their size
// The square slopes of Kelvin's waves behind a steady course, summed across it, by the bands of their size. η = ∫ A e^{i(kx x + ky y)} dθ with
// Havelock's (1934) A and k = k₀/cos²θ; across the course ∫ η² dy = π ∫ |A|² dθ/(∂ky/∂θ), ∂ky/∂θ = k₀ (1 + sin²θ)/cos³θ, and slopes have
// k² more. To a factor that all speeds share.
std::array<double, kBands> square_slopes(const VesselPlan& plan, double speed_mps) {
    constexpr int kSteps = 400;
    std::array<double, kBands> bands{};
    const double k0 = kGravity / (speed_mps * speed_mps), end = kTwoPi * VesselPlan::kRadius / plan.size_m;
    if (!(k0 < end)) return bands;
    // By q of 1/cosθ = 1 + q²: even steps of it are fine where k is large.
    const double last = std::sqrt(std::sqrt(end / k0) - 1.0);
    for (int i = 0; i < kSteps; ++i) {
        const double q = last * (i + 0.5) / kSteps, secant = 1.0 + q * q, cosine = 1.0 / secant,
                     sine = std::sqrt(1.0 - cosine * cosine), k = k0 * secant * secant;
        const double angle = 2.0 * last / kSteps / (secant * std::sqrt(q * q + 2.0));
        const double hull = below_water_m(k, plan.draught_m) * parabola(0.5 * plan.length_m * k * cosine) *
                            parabola(0.5 * plan.beam_m * k * sine);
        const double slope = speed_mps * k * k * hull * k;
        // Rounding may put the last one at the end.
        const auto band = std::min(static_cast<int>(kBands * k / end), kBands - 1);
        bands[static_cast<std::size_t>(band)] +=
            angle * slope * slope * cosine * cosine * cosine / (1.0 + sine * sine);
    }
    return bands;
}

// The fewest modes that leave out no more than a thousandth of the square slopes at its greatest speed, at whatever speed it has on its way.
int radius_of(const VesselPlan& plan, double least_mps) {
    constexpr double kLost = 1e-3;
    constexpr int kSpeeds = 64, kFewest = kBands / 2;
    const double from_mps = std::max(plan.path.slowest_mps(), least_mps);
    double all = 0.0;
    std::array<double, kBands> most{};
    for (int i = 0; i < kSpeeds; ++i) {
        const double speed_mps = std::lerp(plan.speed_mps, from_mps, i / (kSpeeds - 1.0));
        const std::array<double, kBands> bands = square_slopes(plan, speed_mps);
        if (i == 0) all = std::reduce(bands.begin(), bands.end());
        double lost = 0.0;
        for (int band = kBands - 1; band >= 0; --band) {
            lost += bands[static_cast<std::size_t>(band)];
            most[static_cast<std::size_t>(band)] = std::max(most[static_cast<std::size_t>(band)], lost);
        }
        if (from_mps == plan.speed_mps) break;
    }
    int bands = kBands;
    while (bands > kFewest && most[static_cast<std::size_t>(bands) - 1] <= kLost * all) --bands;
    return bands * VesselPlan::kRadius / kBands;
}

}  // namespace

double below_water_m(double k, double draught_m) {
    const double q = k * draught_m;
    if (q < 0.05) return draught_m * (2.0 / 3.0 - q / 4.0 + q * q / 15.0);
    return draught_m * (1.0 / q - 2.0 / (q * q * q) + std::exp(-q) * (2.0 / (q * q) + 2.0 / (q * q * q)));
}

glm::dvec2 VesselPlan::middle_m(double time_s) const {
    constexpr double kBehind = 0.6;  // of the tile's side, twice as far as the vessel is before its middle
    return 0.5 * (path.at(time_s) + path.at(time_s - kBehind * size_m / speed_mps));
}

double VesselPlan::highest_m(double depth_m) const {
    constexpr double kMargin = 1.2;
    const double froude2 = std::min(speed_mps * speed_mps / (kGravity * depth_m), 0.9);
    return kMargin * waves * std::max(1.0, 2.0 * beam_m / length_m) / (1.0 - froude2) *
           std::min(draught_m, 2.0 * speed_mps * speed_mps * beam_m / (kGravity * length_m));
}

std::size_t VesselPlan::bytes(int radius) {
    constexpr std::size_t kTables =
        6 + 2 * kStepLengths + sizeof(double) / sizeof(float);  // core/waves/vessel_waves.h
    return (kBlocks * 4 + kTables) * lattice_modes(radius) * sizeof(float);
}

// Its waves are as long as the tile's shortest.
double least_wake_mps(const Vessel& vessel) {
    return std::sqrt(kGravity * kLeastLengths * vessel.length_m / VesselPlan::kRadius / kTwoPi);
}

std::vector<VesselPlan> plan_vessels(const Scene& scene) {
    std::vector<VesselPlan> plans;
    for (const Vessel& vessel : scene.waves.vessels) {
        VesselPlan plan{.path = path_of(scene.shot, vessel),
                        .length_m = vessel.length_m,
                        .beam_m = vessel.beam_m,
                        .draught_m = vessel.draught_m,
                        .waves = vessel.waves,
                        .foam = vessel.foam};
        if (plan.path.keys.size() < 2) continue;
        plan.speed_mps = plan.path.fastest_mps();
        // Forty of its waves: of those that it drags along, or, where these are long, of those that a hull of its length makes.
        constexpr double kWaves = 40.0, kLengths = 1.5;
        if (!(plan.speed_mps > least_wake_mps(vessel)) || !(plan.waves > 0.0)) continue;
        const double transverse_m = kTwoPi * plan.speed_mps * plan.speed_mps / kGravity;
        plan.size_m = std::max(kWaves * std::min(transverse_m, kLengths * plan.length_m),
                               kLeastLengths * plan.length_m);
        // Energy is left behind at half the vessel's speed or more.
        constexpr double kSides = 1.5;
        plan.radius = radius_of(plan, least_wake_mps(vessel));
        plan.block_s = kSides * plan.size_m / plan.speed_mps / VesselPlan::kBlocks;
        plans.push_back(std::move(plan));
    }
    return plans;
}

}  // namespace pelagic
