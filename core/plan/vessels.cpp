#include "core/plan/vessels.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "core/base/constants.h"
#include "core/plan/mode_lattice.h"
#include "core/scene/course.h"
#include "core/spectrum/dispersion.h"

namespace pelagic {

template <class Linear, class Cubic>
glm::dvec2 VesselPath::on(double time_s, Linear linear, Cubic cubic) const {
    const auto after = std::upper_bound(keys.begin(), keys.end(), time_s,
                                        [](double t, const Key& key) { return t < key.time_s; });
    if (after == keys.begin()) return linear(keys.front(), keys.front().velocity_mps);
    if (after == keys.end()) return linear(keys.back(), keys.back().velocity_mps);
    const Key &a = *(after - 1), &b = *after;
    const double step_s = b.time_s - a.time_s;
    if (!is_smooth) return linear(a, (b.place_m - a.place_m) / step_s);
    return cubic(a, b, step_s, (time_s - a.time_s) / step_s);
}

glm::dvec2 VesselPath::at(double time_s) const {
    return on(
        time_s,
        [&](const Key& from, glm::dvec2 velocity) {
            return from.place_m + (time_s - from.time_s) * velocity;
        },
        [](const Key& a, const Key& b, double step_s, double t) {  // Hermite's
            const double u = 1.0 - t;
            return u * u * ((1.0 + 2.0 * t) * a.place_m + t * step_s * a.velocity_mps) +
                   t * t * ((3.0 - 2.0 * t) * b.place_m - u * step_s * b.velocity_mps);
        });
}

glm::dvec2 VesselPath::velocity_mps(double time_s) const {
    return on(
        time_s, [](const Key&, glm::dvec2 velocity) { return velocity; },
        [](const Key& a, const Key& b, double step_s, double t) {
            const double u = 1.0 - t;
            return 6.0 * t * u / step_s * (b.place_m - a.place_m) + u * (1.0 - 3.0 * t) * a.velocity_mps +
                   t * (3.0 * t - 2.0) * b.velocity_mps;
        });
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
    constexpr std::size_t kTables = 15 + sizeof(double) / sizeof(float);  // core/waves/vessel_waves.h
    return (kBlocks * 4 + kTables) * lattice_modes(radius) * sizeof(float);
}

namespace {

VesselPath path_of(const Scene& scene, const Vessel& vessel) {
    VesselPath path;
    path.is_smooth = vessel.interpolation == CameraInterpolation::Smooth;
    for (const CourseKey& key : course_of(vessel.path).value_or(std::vector<CourseKey>{}))
        path.keys.push_back({scene.shot.time_s(key.frame), {key.east_m, key.north_m}, {}});
    std::vector<VesselPath::Key>& keys = path.keys;
    const auto chord = [&](std::size_t i) {
        return (keys[i + 1].place_m - keys[i].place_m) / (keys[i + 1].time_s - keys[i].time_s);
    };
    for (std::size_t i = 0; keys.size() > 1 && i < keys.size(); ++i) {
        const glm::dvec2 before = chord(i > 0 ? i - 1 : 0), after = chord(std::min(i, keys.size() - 2));
        const double share = i > 0 && i + 1 < keys.size() ? (keys[i].time_s - keys[i - 1].time_s) /
                                                                (keys[i + 1].time_s - keys[i - 1].time_s)
                                                          : 0.5;
        keys[i].velocity_mps = (1.0 - share) * before + share * after;  // the parabola's through three keys
    }
    return path;
}

}  // namespace

std::vector<VesselPlan> plan_vessels(const Scene& scene) {
    std::vector<VesselPlan> plans;
    for (const Vessel& vessel : scene.waves.vessels) {
        VesselPlan plan{.path = path_of(scene, vessel),
                        .length_m = vessel.length_m,
                        .beam_m = vessel.beam_m,
                        .draught_m = vessel.draught_m,
                        .waves = vessel.waves,
                        .foam = vessel.foam};
        if (plan.path.keys.size() < 2) continue;
        constexpr int kParts = 16;
        for (std::size_t i = 0; i + 1 < plan.path.keys.size(); ++i)
            for (int part = 0; part <= kParts; ++part) {
                const double time_s =
                    std::lerp(plan.path.keys[i].time_s, plan.path.keys[i + 1].time_s, part / double{kParts});
                plan.speed_mps = std::max(plan.speed_mps, glm::length(plan.path.velocity_mps(time_s)));
            }
        // Forty of its waves: of those that it drags along, or, where these are long, of those that a hull of its length makes.
        constexpr double kWaves = 40.0, kLengths = 1.5, kLeastLengths = 4.0, kLeastCells = 2.0;
        const double transverse_m = kTwoPi * plan.speed_mps * plan.speed_mps / kGravity;
        plan.size_m = std::max(kWaves * std::min(transverse_m, kLengths * plan.length_m),
                               kLeastLengths * plan.length_m);
        if (!(transverse_m > kLeastCells * plan.size_m / (2.0 * VesselPlan::kRadius)) || !(plan.waves > 0.0))
            continue;
        // Energy is left behind at half the vessel's speed or more.
        constexpr double kSides = 1.5;
        plan.block_s = kSides * plan.size_m / plan.speed_mps / VesselPlan::kBlocks;
        plans.push_back(std::move(plan));
    }
    return plans;
}

}  // namespace pelagic
