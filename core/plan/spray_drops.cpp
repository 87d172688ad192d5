#include "core/plan/spray_drops.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/plan/hulls.h"
#include "core/plan/spray.h"

namespace pelagic {

int SprayDropsPlan::intervals() const {
    return static_cast<int>(std::ceil(kLongestLife_s / interval_s)) + 1;
}

SprayDropsPlan plan_spray_drops(const PreparedScene& from, double size_m) {
    SprayDropsPlan drops;
    if (const double loop_s = from.scene.shot.sea_loop_s(); loop_s > 0.0) {
        const double intervals = std::max(std::round(loop_s / drops.interval_s), 1.0);
        drops.interval_s = loop_s / intervals;
        drops.intervals_a_loop = static_cast<std::int64_t>(intervals);
    }
    // Gusts of the air that carries them are faster, and the water that they start from moves.
    constexpr double kFaster = 1.3, kWater_mps = 5.0;
    drops.downwind_m = kFaster * from.scene.sea.wind_speed_mps * SprayDropsPlan::kLongestLife_s;
    drops.around_m = from.extent.reach_m + kWater_mps * SprayDropsPlan::kLongestLife_s;
    // Where the wind tears few drops off there are few parcels, and not many that hide nothing.
    constexpr double kMany = 0.004;  // the thickness from which on each parcel has more drops instead
    const double thickness = spray_law(from.scene, from.extent.significant_height_m).drops.optical_thickness;
    drops.parcels_per_s = SprayDropsPlan::kMostParcels_per_s * std::clamp(thickness / kMany, 0.01, 1.0);
    // Round a small square in a hurricane there is far more sea that drops may come from.
    const double all_m = size_m + 2.0 * drops.around_m + drops.downwind_m;
    drops.cell_m = std::max({SprayDropsPlan::kFinestCell_m, size_m / SprayDropsPlan::kMostCells,
                             all_m / SprayDropsPlan::kMostCellsInAll});
    return drops;
}

Plan plan_of_spray_drops(const Plan& plan, const SprayDropsPlan& drops) {
    Query query;
    query.name = "drops of spray";
    query.products =
        products(Product::Displacement, Product::Velocity, Product::JacobianMoments, Product::Breaking);
    query.cell_m = query.pixel_m = {drops.cell_m};
    query.is_view = true;
    // No picture: drops tear off where a mesh's sea breaks, so that a stage's are its picture's.
    std::vector<Query> queries{query};
    if (knows_hulls(plan))
        if (auto hulls = hulls_query(plan.from->scene, true)) queries.push_back(std::move(*hulls));
    Plan own = make_plan(plan.from, queries, {.double_precision = plan.knobs.double_precision});
    own.knobs.spline_taps = 4;  // as for foam's past: a hundredth of a breaking is enough
    own.trains = plan.trains;
    return own;
}

std::size_t spray_drops_bytes(const Plan& plan, const SprayDropsPlan& drops, double size_m) {
    const Plan own = plan_of_spray_drops(plan, drops);
    const double wide = size_m + 2.0 * drops.around_m, area_m2 = wide * (wide + 1.5 * drops.downwind_m);
    const double cells = area_m2 / (drops.cell_m * drops.cell_m);
    // Of a cell: its place, and what is asked there. Of a parcel: as it starts, and as it is shown.
    constexpr double kCellBytes = 8.0 * sizeof(double), kParcelBytes = 26.0 * sizeof(double);
    const std::size_t coast =  // that is the sea's
        own.trains ? own.trains->coast_bytes(own.knobs.double_precision) : 0;
    return own.sea_bytes() - coast + own.frame_bytes() +
           static_cast<std::size_t>(cells * (kCellBytes + kParcelBytes * drops.parcels_per_s *
                                                              drops.interval_s * drops.intervals()));
}

}  // namespace pelagic
