#include "core/plan/cost_model.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/constants.h"
#include "core/plan/foam.h"
#include "core/plan/mode_lattice.h"
#include "core/plan/products.h"

namespace pelagic {
namespace {

// [ms] of each Work in single precision.
constexpr WorkDone kMs{0.05, 0.306, 3.84, 0.0212, 0.347, 2.19, 18.0};
constexpr double kDouble =
    1.8;  // as much in double precision (`pelagic accuracy --rows precision`: 1.4 … 1.84)

double& at(WorkDone& work, Work what) {
    return work[static_cast<std::size_t>(what)];
}

void add_grids(const CascadePlan& cascade, WorkDone& work) {
    for (const Grid& grid : cascade.grids) {
        const double n = grid.resolution, fields = static_cast<double>(grid.fields.count());
        at(work, Work::Transforms) += 1e-6 * fields * grid.lines_per_field() * n * std::log2(n);
        at(work, Work::Modes) += 1e-6 * fields * static_cast<double>(lattice_modes(grid.radius));
    }
}

// The grids that a point reads, each once for all of its fields.
void add_points(const Plan& plan, const PlannedQuery& planned, WorkDone& work) {
    const double points = 1e-6 * static_cast<double>(planned.query.points);
    // A point between two levels reads both.
    const double levels_read = planned.query.pixel_m.size() > 1 ? 2.0 : 1.0;
    for (const CascadePlan& cascade : plan.cascades) {
        if (planned.query.only_cascade && &cascade != &plan.cascades[*planned.query.only_cascade]) continue;
        double reads = 0.0, grids = 0.0;
        for (const int level : summed_levels(plan, planned)) {
            const int g = cascade.grid_of_level[static_cast<std::size_t>(level)];
            if (g < 0) continue;
            const Grid& grid = cascade.grids[static_cast<std::size_t>(g)];
            const int taps = grid.sampling == Sampling::Nodes ? 1 : plan.knobs.spline_taps;
            reads += static_cast<double>(grid.fields.count()) * taps * taps;
            grids += 1.0;
        }
        if (grids > 0.0) at(work, Work::Reads) += points * reads * std::min(1.0, levels_read / grids);
    }
    if (plan.trains && !planned.query.only_cascade) {
        int shown = 0;
        for (const double length_m : plan.trains->wavelengths_m)
            shown += plan.filter.weight(kTwoPi / length_m, planned.query.pixel_m.front()) > 0.0;
        at(work, Work::Trains) += points * shown;
    }
    double values = 0.0;
    for (const ProductRow& row : kProductTable)
        if (planned.query.products[index(row.product)]) values += static_cast<double>(row.components);
    at(work, Work::Answers) += points * values;
}

// A frame of a run goes on from the one before; one that stands alone goes through all of the past.
double intervals_of_frame(const Plan& plan) {
    const double all = plan.foam->intervals();
    const Shot& shot = plan.from->scene.shot;
    if (shot.first_frame == shot.last_frame) return all;
    return std::min(all, std::max(1.0, shot.time_scale / shot.fps / plan.foam->step_s));
}

void add_foam(const Plan& plan, WorkDone& work) {
    const double intervals = intervals_of_frame(plan);
    const bool are_pictures = plan.outputs.empty();
    std::vector<Query> asked;
    for (const PlannedQuery& planned : plan.queries) {
        asked.push_back(planned.query);
        // A picture's foam was timed by the tiles all round its camera: of points that aren't known.
        if (are_pictures) asked.back().points = 0;
    }
    const auto tiles = foam_tiles(*plan.foam, plan.from->scene, asked, are_pictures);
    for (int level = 0; level < FoamPlan::kLevels; ++level) {
        const double count = tiles[static_cast<std::size_t>(level)];
        at(work, Work::Foam) += 1e-6 * intervals * count * static_cast<double>(FoamPlan::kTileNodes);
    }
}

}  // namespace

WorkDone work_of(const Plan& plan) {
    WorkDone work{};
    at(work, Work::Frame) = 1.0;
    for (const CascadePlan& cascade : plan.cascades) add_grids(cascade, work);
    if (plan.foam && plan.from->scene.sea.wind_speed_mps > 0.0) add_foam(plan, work);
    for (const PlannedQuery& planned : plan.queries) add_points(plan, planned, work);
    return work;
}

double cost_ms(const WorkDone& work, bool double_precision) {
    double ms = 0.0;
    for (std::size_t i = 0; i < kWorkCount; ++i) ms += kMs[i] * work[i];
    return double_precision ? kDouble * ms : ms;
}

double frame_ms(const Plan& plan) {
    return cost_ms(work_of(plan), plan.knobs.double_precision);
}

}  // namespace pelagic
