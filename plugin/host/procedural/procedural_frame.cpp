#include "plugin/host/procedural/procedural_frame.h"

#include <tbb/info.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/base/constants.h"
#include "core/plan/grid_layout.h"
#include "core/plan/memory.h"
#include "core/scene/text.h"
#include "core/surface/footprint_levels.h"
#include "core/surface/view.h"
#include "core/waves/whitecaps.h"
#include "plugin/machine/memory.h"

namespace pelagic::procedural {
namespace {

constexpr std::size_t kRayCache_bytes = std::size_t{256} << 20;

constexpr ProductSet kProducts =
    products(Product::Position, Product::Displacement, Product::Normal, Product::Velocity,
             Product::SlopeVariance, Product::Coverage, Product::Breaking, Product::FoamAge);

// What a frame of a sea holds at most where its host doesn't say how fine it is to be.
constexpr std::size_t kUnasked_bytes = std::size_t{256} << 20;

struct Planned {
    Plan plan;
    double finest_cell_m,
        finest_pixel_m;  // as asked for, or as the shot's camera needs and kUnasked_bytes hold
};
Planned plan_of(const Scene& scene, const SeaOptions& options) {
    auto prepared = prepare(scene);
    const bool is_asked = options.finest_cell_m > 0.0 || options.finest_pixel_m > 0.0;
    // One alone stands for both: pixels as the shot's camera sees them beside a host's cells would be what takes most.
    double cell_m = options.finest_cell_m > 0.0 ? options.finest_cell_m : options.finest_pixel_m;
    double pixel_m = options.finest_pixel_m > 0.0 ? options.finest_pixel_m : options.finest_cell_m;
    if (!is_asked) {
        ProjectedGridOptions grid = projected_grid_options(*prepared);
        grid.cell_px = kCell_px;
        std::vector<View> views;
        for (const int frame : representative_frames(scene, 16))
            views.push_back(view_at(scene.camera, frame));
        const ProjectedGridNeeds needs = projected_grid_needs(views, grid);
        cell_m = needs.finest_cell_m;
        pixel_m = needs.finest_pixel_m;
    }
    const std::size_t most_bytes =
        options.max_memory_bytes > 0 ? std::min(kUnasked_bytes, options.max_memory_bytes) : kUnasked_bytes;
    for (;; cell_m *= 2.0, pixel_m *= 2.0) {
        const double finest_pixel_m = std::min(cell_m, pixel_m);
        const Query query = view_query(*prepared, {.products = kProducts,
                                                   .finest_cell_m = cell_m,
                                                   .finest_pixel_m = finest_pixel_m,
                                                   .points = Chunk<float>::kPoints});
        Plan plan = make_plan(prepared, {query}, {.double_precision = false});
        constexpr double kCoarsest_m = 1.0;  // a sea of trains takes the same at any
        if (is_asked || plan.frame_bytes() <= most_bytes || cell_m > kCoarsest_m)
            return {std::move(plan), cell_m, finest_pixel_m};
    }
}

// Of n samples, side by side so that the compiler takes vectors.
float largest(const float* samples, std::size_t n) {
    constexpr std::size_t kSide = 16;
    std::array<float, kSide> most{};
    std::size_t i = 0;
    for (; i + kSide <= n; i += kSide)
        for (std::size_t j = 0; j < kSide; ++j) {
            const float size = std::abs(samples[i + j]);
            most[j] = size > most[j] ? size : most[j];
        }
    for (; i < n; ++i) most[0] = std::max(most[0], std::abs(samples[i]));
    return *std::max_element(most.begin(), most.end());
}

constexpr std::array kVelocities{Field::VelocityX, Field::VelocityY, Field::VelocityZ};

// The most that a field's sum can be, everywhere: splines stay within their coefficients, and the blending weights at
// a point add up to 2 at most (core/plan/random_tiling.h).
double most_of(const Frame<float>& frame, Field field) {
    const Plan& plan = frame.sea().plan();
    double most = 0.0;
    for (std::size_t c = 0; c < plan.cascades.size(); ++c) {
        double of_cascade = 0.0;
        for (std::size_t g = 0; g < plan.cascades[c].grids.size(); ++g) {
            const int n = plan.cascades[c].grids[g].resolution;
            const float* samples = frame.samples(static_cast<int>(c), static_cast<int>(g), field);
            if (!samples) continue;
            for (int y = 0; y < n; ++y)
                of_cascade = std::max(
                    of_cascade,
                    static_cast<double>(largest(samples + static_cast<std::size_t>(y) * line_stride<float>(n),
                                                static_cast<std::size_t>(n))));
        }
        most += (plan.cascades[c].has_random_tiling ? 2.0 : 1.0) * of_cascade;
    }
    if (plan.trains) {
        const Trains<float>& trains = frame.sea().trains();
        const auto add = [&](const std::vector<float>& amplitudes) {
            for (const float amplitude : amplitudes) most += std::abs(static_cast<double>(amplitude));
        };
        if (const Coast<float>* coast = frame.sea().coast().get()) {
            for (std::size_t i = 0; i < trains.count(); ++i) {
                const double gain = coast->most_gain[std::min(i, coast->feeling)],
                             sideways = i < coast->feeling ? coast->most_sideways[i]
                                                           : gain * kTwoPi / trains.wavelength_m[i];
                const double of_height =
                    field == Field::VelocityZ ? gain : static_cast<double>(coast->sideways_m[i]) * sideways;
                most += static_cast<double>(coast->omega[i]) * trains.height_m[i] * of_height;
            }
        } else {
            add(trains.amplitude[index(field)]);
        }
        for (const std::size_t axis : {0, 1, 2})
            if (field == kVelocities[axis]) add(trains.growth[axis]);
    }
    if (plan.masks) most *= plan.masks->largest();
    constexpr double kRounding = 1e-4;  // of hundreds of sums in single precision
    return (1.0 + kRounding) * most;
}

// A cell through which all trains pass whole [m], far below what the filter asks for (core/plan/filter.h); without
// trains any will do.
double whole_cell_m(const Sea<float>& sea) {
    constexpr double kOfShortest = 1.0 / 64.0;
    const std::vector<double>& lengths_m = sea.trains().wavelength_m;
    return lengths_m.empty() ? 1.0 : kOfShortest * lengths_m.back();
}

}  // namespace

ShotSea::ShotSea(Scene from, const SeaOptions& options, const BuildWatch& watch)
    : scene(std::move(from)),
      ray_cache_bytes(options.ray_cache_bytes > 0 ? options.ray_cache_bytes : kRayCache_bytes),
      arena(options.threads > 0 ? std::make_unique<tbb::task_arena>(
                                      std::min(options.threads, tbb::info::default_concurrency()))
                                : std::make_unique<tbb::task_arena>()) {
    arena->execute([&] {
        Planned planned = plan_of(scene, options);
        MemoryNeed need;
        // A host's own number is for the frame alone.
        if (options.max_memory_bytes == 0) machine::add_program(need);
        add_sea(need, planned.plan, arena->max_concurrency());
        require_memory(need, machine::memory_limit_or(options.max_memory_bytes), "a frame of this sea");
        sea = std::make_shared<const SeaOverTime<float>>(std::move(planned.plan), watch);
        if (sea->plan().foam) without_past = sea->first()->whitecaps({});
        // As the plan's levels have it; a sea of trains has none.
        const auto finest_of = [&](double first_m, double planned_m) {
            return first_m > 0.0 ? first_m : std::max(planned_m, whole_cell_m(*sea->first()));
        };
        finest_cell_m = finest_of(query().cell_m.front(), planned.finest_cell_m);
        finest_pixel_m = finest_of(query().pixel_m.front(), planned.finest_pixel_m);
    });
}

ShotFrame::ShotFrame(std::shared_ptr<const ShotSea> of, double open_s, double close_s)
    : of_(std::move(of)), state_(of_->sea) {
    set(open_s, close_s);
}

void ShotFrame::set(double open_s, double close_s) {
    const auto accepts = [](double t_s) { return std::abs(t_s) <= Frame<float>::kLatest_s; };
    if (!accepts(open_s) || !accepts(close_s) || !(open_s <= close_s) ||
        !(close_s - open_s <= kLongestShutter_s))
        throw std::invalid_argument("a shutter from " + number_text(open_s) + " s to " +
                                    number_text(close_s) + " s: accepted: times within " +
                                    number_text(Frame<float>::kLatest_s) + " s, in order, and open for " +
                                    number_text(kLongestShutter_s) + " s of the sea at most");
    is_set_ = false;
    of_->arena->execute([&] {
        stop_if(&of_->is_cancelled);
        state_.set(0.5 * (open_s + close_s), &of_->is_cancelled);
        const ProductSet now = kProducts & ~lasting_products();
        query_.emplace(state_.frame(), 0, now);
        if (of_->without_past) {
            const bool changes = of_->sea->plan().from->weather != nullptr;
            whitecaps_without_past_ = changes ? state_.sea().whitecaps({}) : of_->without_past;
            without_past_.emplace(state_.frame(), 0, now, glm::dvec2(0.0), &*whitecaps_without_past_);
        }
        half_open_s_ = 0.5 * (close_s - open_s);
        fastest_mps_ = glm::dvec3(0.0);
        tiles_.reset();
        everywhere_.reset();
        cells_.reset();
        if (half_open_s_ == 0.0) return;
        tbb::parallel_for(0, 3, [&](int axis) {
            fastest_mps_[axis] = most_of(state_.frame(), kVelocities[static_cast<std::size_t>(axis)]);
        });
    });
    is_set_ = true;
}

void ShotFrame::check_times(const float* time_s, std::size_t count, const char* name) const {
    if (!time_s) return;
    // A host may scale a share of the shutter by its length in single precision. Rounding then takes times beyond the
    // end: half an epsilon each for the length, the share, their product and a sum. Late ends are themselves rounded.
    const double open_for_s = 2.0 * half_open_s_,
                 rounding_s =
                     2.0 * std::numeric_limits<float>::epsilon() * open_for_s +
                     2.0 * std::numeric_limits<double>::epsilon() * std::abs(state_.frame().time_s());
    for (std::size_t i = 0; i < count; ++i)
        if (!(time_s[i] >= -rounding_s && time_s[i] <= open_for_s + rounding_s))
            throw std::invalid_argument(
                std::string(name) + "[" + std::to_string(i) + "] is " + number_text(double{time_s[i]}) +
                " s, when the shutter isn't open; accepted: 0 to " + number_text(open_for_s) + " s");
}

// Level by level: a bound that holds for all footprints of a wide range would be loose for each.
template <class Bound>
DisplacementBounds ShotFrame::over_levels(FootprintRange cells, const Bound& bound) const {
    double level_m = level_below_m(std::max(cells.finest_m, of_->finest_cell_m));
    DisplacementBounds all = bound(bounds_.from_level(level_m));
    // Where a footprint resolves no waves, nothing moves, and larger ones change nothing.
    const auto moves = [](const DisplacementBounds& b) { return b.z.hi > b.z.lo; };
    for (bool goes_on = moves(all); goes_on && 2.0 * level_m < cells.coarsest_m;) {
        const DisplacementBounds here = bound(bounds_.from_level(level_m *= 2.0));
        goes_on = moves(here);
        for (const auto axis : {&DisplacementBounds::z, &DisplacementBounds::dx, &DisplacementBounds::dy}) {
            (all.*axis).lo = std::min((all.*axis).lo, (here.*axis).lo);
            (all.*axis).hi = std::max((all.*axis).hi, (here.*axis).hi);
        }
    }
    return all;
}

std::pair<glm::dvec3, glm::dvec3> ShotFrame::bounds(const RestRegion& region, FootprintRange cells) const {
    constexpr int kBlocks = 4096;
    if (!(cells.finest_m >= 0.0) || !(cells.coarsest_m >= cells.finest_m))
        throw std::invalid_argument("region.finest_cell_m, coarsest_cell_m: accepted: 0 or more, in order");
    // So large a region has every wave in it.
    constexpr double kAnywhere_m = 65536.0;
    const glm::dvec2 side_m = region.max_m - region.min_m;
    if (std::min(side_m.x, side_m.y) >= kAnywhere_m && cells.finest_m <= of_->finest_cell_m) {
        const SurfaceBounds all = everywhere();
        const glm::dvec3 most_m(glm::dvec2(all.reach_m), all.height_m);
        return {glm::dvec3(region.min_m, 0.0) - most_m, glm::dvec3(region.max_m, 0.0) + most_m};
    }
    const DisplacementBounds moved =
        over_levels(cells, [&](const FrameBounds<float>& of) { return of.region(region, kBlocks); });
    const glm::dvec3 by_m = half_open_s_ * fastest_mps_;
    return {glm::dvec3(region.min_m, 0.0) + glm::dvec3(moved.dx.lo, moved.dy.lo, moved.z.lo) - by_m,
            glm::dvec3(region.max_m, 0.0) + glm::dvec3(moved.dx.hi, moved.dy.hi, moved.z.hi) + by_m};
}

SurfaceBounds ShotFrame::everywhere() const {
    const std::lock_guard<std::mutex> lock(lock_);
    const auto most = [&](Field field, double velocity_mps) {
        return most_of(state_.frame(), field) + half_open_s_ * velocity_mps;
    };
    if (!everywhere_)
        everywhere_ = {
            .height_m = most(Field::Height, fastest_mps_.z),
            .reach_m = std::hypot(most(Field::Dx, fastest_mps_.x), most(Field::Dy, fastest_mps_.y))};
    return *everywhere_;
}

const SurfaceTiles& ShotFrame::tiles() const {
    const std::lock_guard<std::mutex> lock(lock_);
    const auto& masks = of_->sea->plan().masks;
    if (!tiles_)
        tiles_ = std::make_unique<const SurfaceTiles>(*query_, of_->finest_cell_m, half_open_s_,
                                                      of_->ray_cache_bytes, masks ? &*masks : nullptr);
    return *tiles_;
}

std::optional<double> ShotFrame::remembered_cell_px(const View& view, double error_px, bool on_earth) const {
    const std::lock_guard<std::mutex> lock(lock_);
    const bool is_it =
        cells_ && cells_->view == view && cells_->error_px == error_px && cells_->on_earth == on_earth;
    return is_it ? std::optional(cells_->cell_px) : std::nullopt;
}

void ShotFrame::remember_cell_px(const View& view, double error_px, bool on_earth, double cell_px) const {
    const std::lock_guard<std::mutex> lock(lock_);
    cells_ = {view, error_px, on_earth, cell_px};
}

struct ShotFrame::Counted {
    Points<float> points;
    std::vector<float> cell_m, pixel_m;  // that they point into
};

ShotFrame::Counted ShotFrame::counted(const Points<float>& points) const {
    Counted to{points, {}, {}};
    // Tiles hold them within their levels; wave trains have none.
    if (of_->query().cell_m.front() > 0.0) return to;
    const auto count = [&](Strided<const float> asked, double finest_m, std::vector<float>& own) {
        const auto least_m = static_cast<float>(finest_m);
        own.assign(asked ? points.count : 1, least_m);
        if (!asked) return Strided<const float>{own.data(), 0};
        for (std::size_t i = 0; i < points.count; ++i) own[i] = std::max(asked[i], least_m);
        return Strided<const float>{own.data()};
    };
    to.points.cell_m = count(points.cell_m, of_->finest_cell_m, to.cell_m);
    to.points.pixel_m = count(points.pixel_m, of_->finest_pixel_m, to.pixel_m);
    return to;
}

void ShotFrame::ask(const Points<float>& asked, const Results<float>& results, CoverageOf coverage,
                    bool alone) const {
    const Counted held = counted(asked);
    const Points<float>& points = held.points;
    if (coverage == CoverageOf::FirstVersion && without_past_) {
        Results<float> now = results;
        now.set(Product::Breaking, results.numbers(Product::Coverage));
        now.set(Product::Coverage, Strided<float>{});
        return alone ? without_past_->evaluate_alone(points, now) : without_past_->evaluate(points, now);
    }
    const auto all = [&] { state_.evaluate(*query_, points, results, of_->watch(), alone); };
    // The past is gone through by this thread alone as well.
    if (alone && (results.given() & lasting_products()).any() && state_.has_past(0))
        tbb::task_arena(1).execute(all);
    else
        all();
}

void ShotFrame::evaluate(const TimedPoints& timed, Results<float> results, CoverageOf coverage) const {
    const std::size_t count = timed.points.count;
    const bool moves = timed.time_s && half_open_s_ > 0.0 && results.holds(Product::Position);
    std::vector<glm::vec3> velocity;
    if (moves && !results.holds(Product::Velocity)) {
        velocity.resize(count);
        results.set(Product::Velocity, {velocity.data()});
    }
    ask(timed.points, results, coverage, true);
    if (!moves) return;
    const auto position = results.vectors(Product::Position), fast = results.vectors(Product::Velocity);
    const auto half_s = static_cast<float>(half_open_s_);
    for (std::size_t i = 0; i < count; ++i)
        position[i] += std::clamp(timed.time_s[i] - half_s, -half_s, half_s) * fast[i];
}

void ShotFrame::evaluate_by_all(const Points<float>& points, const Results<float>& results,
                                CoverageOf coverage) const {
    ask(points, results, coverage, false);
}

void ShotFrame::water_at(std::span<const glm::dvec2> places_m, float footprint_m,
                         std::span<WaterState> water) const {
    // Each answer is of its place alone. So many take some milliseconds, where the sea has folded a hundred times that.
    constexpr std::size_t kAskedEach = 256;
    const bool has_levels = of_->query().cell_m.front() > 0.0;
    if (!has_levels) footprint_m = std::max(footprint_m, static_cast<float>(of_->finest_cell_m));
    for (std::size_t first = 0; first < places_m.size(); first += kAskedEach) {
        stop_if(&of_->is_cancelled);
        const std::size_t count = std::min(kAskedEach, places_m.size() - first);
        pelagic::water_at(bounds_, *query_, places_m.subspan(first, count), footprint_m,
                          water.subspan(first, count), true);
    }
}

void ShotFrame::prepare(const Points<float>& points) const {
    stop_if(&of_->is_cancelled);
    const Counted held = counted(points);
    of_->arena->execute([&] { state_.prepare(0, held.points, of_->watch()); });
}

ProjectedGridOptions grid_options(const ShotFrame& frame, double cell_px) {
    ProjectedGridOptions options = projected_grid_options(*frame.shot().sea->plan().from);
    options.cell_px = cell_px;
    options.bounds = frame.everywhere();
    options.has_levels = frame.shot().query().cell_m.size() > 1;
    return options;
}

}  // namespace pelagic::procedural
