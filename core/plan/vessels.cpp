#include "core/plan/vessels.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "core/base/constants.h"
#include "core/plan/mode_lattice.h"
#include "core/scene/course.h"
#include "core/spectrum/dispersion.h"

namespace pelagic {
namespace {

constexpr double kLeastLengths = 4.0;  // of a hull in its tile

}  // namespace

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
    constexpr std::size_t kTables = 15 + sizeof(double) / sizeof(float);  // core/waves/vessel_waves.h
    return (kBlocks * 4 + kTables) * lattice_modes(radius) * sizeof(float);
}

// Its waves are as long as the tile's shortest.
double slowest_mps(const Vessel& vessel) {
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
        if (!(plan.speed_mps > slowest_mps(vessel)) || !(plan.waves > 0.0)) continue;
        const double transverse_m = kTwoPi * plan.speed_mps * plan.speed_mps / kGravity;
        plan.size_m = std::max(kWaves * std::min(transverse_m, kLengths * plan.length_m),
                               kLeastLengths * plan.length_m);
        // Energy is left behind at half the vessel's speed or more.
        constexpr double kSides = 1.5;
        plan.block_s = kSides * plan.size_m / plan.speed_mps / VesselPlan::kBlocks;
        plans.push_back(std::move(plan));
    }
    return plans;
}

}  // namespace pelagic
