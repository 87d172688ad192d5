#include "plugin/budget/cost.h"

#include <algorithm>
#include <cmath>
#include <glm/vec2.hpp>
#include <set>
#include <vector>

#include "core/base/constants.h"
#include "core/plan/foam.h"
#include "core/plan/mode_lattice.h"
#include "core/plan/products.h"
#include "core/surface/view.h"
#include "plugin/render/floor_light.h"
#include "plugin/render/passes.h"
#include "plugin/render/spray_map.h"

namespace pelagic {
namespace {

// As much as in single precision costs the sea in double (`pelagic accuracy --rows precision`: 1.4 … 1.84).
constexpr double kDouble = 1.8;

double& at(WorkDone& work, Work what) {
    return work[static_cast<std::size_t>(what)];
}

void add_grids(const CascadePlan& cascade, WorkDone& work) {
    for (const Grid& grid : cascade.grids) {
        const double n = grid.resolution, fields = static_cast<double>(grid.fields.count());
        at(work, Work::Transforms) += 1e-6 * static_cast<double>(grid.lines()) * n * std::log2(n);
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
        int shown = plan.trains->hero_trains;
        for (const double length_m : plan.trains->wavelengths_m)
            shown += plan.filter.weight(kTwoPi / length_m, planned.query.pixel_m.front()) > 0.0;
        // Of those that feel the floor all are read at each point, whose hidden slopes differ, at some ten times the price.
        constexpr double kCoast = 10.0;
        at(work, Work::Trains) += points * (shown + kCoast * plan.trains->coast_trains);
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

double water_share(const Camera& camera, int frame, const PixelWindow& window) {
    constexpr int kLines = 64;
    const View view = view_at(camera, frame);
    int water = 0;
    for (int y = 0; y < kLines; ++y)
        for (int x = 0; x < kLines; ++x)
            water += view.direction(glm::dvec2(window.low) + (glm::dvec2(x, y) + 0.5) /
                                                                 static_cast<double>(kLines) *
                                                                 glm::dvec2(window.size()))
                         .z < 0.0;
    return static_cast<double>(water) / (kLines * kLines);
}

// Of a plan whose points are those of the camera's grid: with the samples that show the sea, and at so many moments. A point of the
// grid asks for its position alone, which about half of the fields answer. The foam's past is as long with a shutter as without,
// and adding it up again at each moment takes little beside (bench_cost_model has shutters).
WorkDone with_samples(WorkDone work, double points, double samples, double moments) {
    const double points_factor = 0.5 * moments + samples / points;
    for (std::size_t i = 0; i < kWorkCount; ++i) switch (static_cast<Work>(i)) {
            case Work::Frame:
            case Work::Transforms:
            case Work::Modes:
                work[i] *= moments;
                break;
            case Work::Reads:
            case Work::Trains:
            case Work::Answers:
                work[i] *= points_factor;
                break;
            default:  // the foam's past, and no light yet
                break;
        }
    return work;
}

}  // namespace

const Rates& recorded_rates() {
    static constexpr Rates kMs{0.05,   0.306,   3.84, 0.0212, 0.347, 2.19, 18.0,
                               2400.0, 31000.0, 50.0, 3000.0, 600.0, 250.0};
    return kMs;
}

WorkDone work_of(const Plan& plan) {
    WorkDone work{};
    at(work, Work::Frame) = 1.0;
    for (const CascadePlan& cascade : plan.cascades) add_grids(cascade, work);
    if (plan.foam && plan.from->scene.sea.wind_speed_mps > 0.0) add_foam(plan, work);
    for (const PlannedQuery& planned : plan.queries) add_points(plan, planned, work);
    if (plan.knobs.double_precision)
        for (double& each : work) each *= kDouble;
    return work;
}

WorkDone picture_work(const Plan& plan, std::span<const int> frames, const RenderOptions& options) {
    const Camera& camera = plan.from->scene.camera;
    const PicturePasses passes = passes_of(camera, frames.front(), options);
    const auto moments = static_cast<double>(passes.all.size());
    PixelWindow window = data_window(camera.resolution / options.samples, options);
    window = {window.low * options.samples, window.high * options.samples};
    double water = 0.0;
    for (const int frame : frames) water = std::max(water, water_share(camera, frame, window));
    const glm::dvec2 size(window.size());
    const double samples = 1e-6 * size.x * size.y;
    const double points = 1e-6 * static_cast<double>(plan.queries.front().query.points);
    WorkDone work = with_samples(work_of(plan), points, water * samples, moments);
    const bool is_integral = options.lighting.sky_quality == SkyQuality::Integral;
    at(work, is_integral ? Work::SeaByIntegral : Work::SeaByLookups) = water * samples;
    at(work, Work::Sky) = (1.0 - water) * samples;
    if (options.lighting.spray) {
        const SprayMapSize map =
            spray_map_size(camera.resolution.x / options.samples + 2 * options.overscan_px.x);
        at(work, Work::SprayTexels) = 1e-6 * map.columns * map.rows * moments;
        at(work, Work::SpraySamples) = samples;
    }
    if (options.lighting.water && options.lighting.sun) {
        std::set<double> times;  // a lens has several places at one
        for (const PicturePass& pass : passes.all) times.insert(pass.frame);
        at(work, Work::FloorTexels) =
            1e-6 * static_cast<double>(most_floor_light_needs(plan.from->scene, plan).texels * times.size());
    }
    return work;
}

double cost_ms(const WorkDone& work, const Rates& rates) {
    double ms = 0.0;
    for (std::size_t i = 0; i < kWorkCount; ++i) ms += rates[i] * work[i];
    return ms;
}

}  // namespace pelagic
