#include "core/plan/foam.h"

#include <algorithm>
#include <cmath>

#include "core/base/constants.h"
#include "core/spectrum/dispersion.h"

namespace pelagic {

int FoamPlan::intervals() const {
    return static_cast<int>(std::ceil(window_s / step_s)) + 1;
}

std::size_t FoamPlan::tile_bytes() const {
    const auto kept = static_cast<std::size_t>(intervals() + kSpareIntervals);
    return kTileStride * (kept * sizeof(std::uint16_t) + 8 * sizeof(float));
}

FoamPlan::Weight FoamPlan::weight(double from_s, double to_s) const {
    const double a = std::max(from_s, 0.0), b = std::min(to_s, window_s);
    if (!(a < b)) return {};
    const double at_a = std::exp(-a / decay_s), at_b = std::exp(-b / decay_s);
    return {decay_s * (at_a - at_b), decay_s * ((a + decay_s) * at_a - (b + decay_s) * at_b)};
}

std::optional<FoamPlan> plan_foam(const Scene& scene, double finest_m) {
    const Effects& effects = scene.effects;
    if (!effects.whitecaps || !(effects.foam_decay_s > 0.0)) return {};
    constexpr double kFinestCell_m = 0.25;
    constexpr double kCell =
        1.4;  // of the finest that breaking resolves: a half as many cells, and none of the foam is lost
    constexpr double kWindow = 3.0;         // 5 % of the foam is older
    constexpr double kStepsOfPeriod = 4.0;  // of the shortest wave that a cell resolves
    FoamPlan foam;
    foam.decay_s = effects.foam_decay_s;
    foam.window_s = kWindow * foam.decay_s;
    foam.cell_m = std::max(kCell * finest_m, kFinestCell_m);
    foam.step_s = std::sqrt(kTwoPi * 2.0 * foam.cell_m / kGravity) / kStepsOfPeriod;
    const double towards = scene.sea.wind_direction_deg * kPi / 180.0;
    foam.drift_mps =
        effects.foam_drift * scene.sea.wind_speed_mps * glm::dvec2(std::cos(towards), std::sin(towards));
    if (const double loop_s = scene.shot.sea_loop_s(); loop_s > 0.0) {
        foam.step_s = loop_s / std::ceil(loop_s / foam.step_s);
        // In a loop foam drifts by whole cells, so that the last frame's lie where the first one's do.
        const double cell_mps = foam.cell_m / loop_s;
        foam.drift_mps = {cell_mps * std::round(foam.drift_mps.x / cell_mps),
                          cell_mps * std::round(foam.drift_mps.y / cell_mps)};
    }
    return foam;
}

float foam_footprint_m(float width_m, float length_m) {
    return length_m > width_m ? std::sqrt(width_m * length_m) : width_m;
}

FoamRung foam_rung(const FoamPlan& foam, float footprint_m) {
    const float cells = 2.0f * footprint_m / static_cast<float>(foam.cell_m);
    if (!(cells > 1.0f)) return {};
    const int level = std::ilogb(cells);
    if (level >= FoamPlan::kLevels) return {FoamPlan::kLevels, 0.0f};
    return {level, std::ldexp(cells, -level) - 1.0f};
}

namespace {

double tiles_over(double side_m, double cell_m) {
    const double side = std::ceil(side_m / (FoamPlan::kTileCells * cell_m)) + 1.0;
    return side * side;
}

// Those whose cells a camera's pixels need, whichever way it turns. A pixel is α s wide and α s²/h long at the slant distance
// s from an eye at the height h: its area is that of the square of a cell at s = (cell/α)^⅔ h^⅓, and further away coarser levels
// have it.
double tiles_in_view(const Camera& camera, double cell_m) {
    const auto pixel_of = [&](double fov_deg) {
        return 2.0 * std::tan(0.5 * fov_deg * kPi / 180.0) / camera.resolution.x;
    };
    const auto reach_m = [&](double height_m, double fov_deg) {
        const double slant_m = std::pow(cell_m / pixel_of(fov_deg), 2.0 / 3.0) * std::cbrt(height_m);
        return std::sqrt(std::max(slant_m * slant_m - height_m * height_m, 0.0));
    };
    double lowest_m = std::max(camera.position_m.z, 1.0), highest_m = lowest_m,
           narrowest_deg = camera.fov_deg;
    for (const CameraKey& key : camera.keys) {
        const double height_m = std::max(key.position_m.z, 1.0);
        lowest_m = std::min(lowest_m, height_m);
        highest_m = std::max(highest_m, height_m);
        narrowest_deg = std::min(narrowest_deg, key.fov_deg.value_or(camera.fov_deg));
    }
    // Between the keys a camera passes all heights. The reach grows with the height up to this one.
    const double farthest_height_m = cell_m / pixel_of(narrowest_deg) * std::pow(3.0, -0.75);
    const double farthest_m = reach_m(std::clamp(farthest_height_m, lowest_m, highest_m), narrowest_deg);
    if (!(farthest_m > 0.0)) return 0.0;
    const double radius = farthest_m / (FoamPlan::kTileCells * cell_m) + 1.0;
    return kPi * radius * radius;
}

}  // namespace

std::size_t foam_bytes(const FoamPlan& foam, const Scene& scene, const std::vector<Query>& queries) {
    double tiles = 0.0;
    for (const Query& query : queries) {
        if (!query.products[index(Product::Coverage)] || query.only_cascade)
            continue;  // tiles have no history
        if (query.lattice || !query.is_view) {
            const double points = static_cast<double>(query.points);
            const double spacing_m = query.lattice ? query.lattice->spacing_m : query.pixel_m.front();
            const FoamRung rung = foam_rung(foam, static_cast<float>(query.pixel_m.front()));
            for (int level = rung.level; level <= rung.level + (rung.t > 0.0f); ++level)
                if (level < FoamPlan::kLevels)
                    tiles += tiles_over(std::sqrt(points) * spacing_m, std::ldexp(foam.cell_m, level));
            continue;
        }
        for (int level = 0; level < FoamPlan::kLevels; ++level)
            tiles += tiles_in_view(scene.camera, std::ldexp(foam.cell_m, level));
    }
    return static_cast<std::size_t>(tiles) * foam.tile_bytes();
}

}  // namespace pelagic
