#include "core/plan/plan.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>
#include <stdexcept>
#include <utility>

#include "core/base/constants.h"
#include "core/plan/effects.h"
#include "core/plan/extent.h"
#include "core/plan/foam_tiles.h"
#include "core/plan/grid_layout.h"
#include "core/plan/hulls.h"
#include "core/plan/mode_lattice.h"
#include "core/plan/products.h"
#include "core/plan/quality.h"
#include "core/plan/random_tiling.h"
#include "core/plan/taps.h"
#include "core/plan/weather.h"
#include "core/scene/cascade_bands.h"
#include "core/scene/hull.h"
#include "core/scene/object_pose.h"
#include "core/spectrum/dispersion.h"
#include "core/surface/earth.h"
#include "core/surface/footprint_levels.h"

namespace pelagic {
namespace {

Knobs knobs_of(QualityLevel level) {
    const QualityRow& row = quality_of(level);
    return {.spline_taps = row.spline_taps,
            .oversampling = row.oversampling,
            .light_oversampling = row.light_oversampling,
            .third_moment = true,
            .double_precision = row.double_precision};
}

// The smallest even number ≥ n without a prime factor above 7: FFTW has fast code for those.
int transform_size(int n) {
    for (int size = std::max(n + n % 2, 2);; size += 2) {
        int rest = size;
        for (int prime : {2, 3, 5, 7})
            while (rest % prime == 0) rest /= prime;
        if (rest == 1) return size;
    }
}

// Nodes per Nyquist sample of a grid whose shortest wave this footprint fades. A spline of n taps adds to a wave with ν waves a
// node its image with (ν/(1 − ν))^n of its amplitude, since its transform is sinc^n: the fewest nodes with which no wave that is
// left has a larger one than the shortest, unfaded, has with `oversampling`.
double faded_oversampling(const FootprintFilter& filter, double footprint_m, double shortest_m, int taps,
                          double oversampling) {
    if (!(footprint_m > 0.0)) return oversampling;
    const auto image = [&](double nodes_a_wave) { return std::pow(1.0 / (nodes_a_wave - 1.0), taps); };
    const double most = image(2.0 * oversampling);
    constexpr int kWaves = 64;  // of a smooth curve, up to the first that isn't faded
    const double longest_m = std::max(filter.n_max * footprint_m, shortest_m);
    const auto is_enough = [&](double nodes) {
        for (int i = 0; i <= kWaves; ++i) {
            const double wave_m = std::lerp(shortest_m, longest_m, i / double{kWaves});
            if (filter.weight(kTwoPi / wave_m, footprint_m) * image(2.0 * nodes * wave_m / shortest_m) > most)
                return false;
        }
        return true;
    };
    constexpr double kStep = 0.02;  // nodes a sample: finer than the sizes that transforms come in
    double nodes = oversampling;
    while (nodes - kStep > 1.0 && is_enough(nodes - kStep)) nodes -= kStep;
    return nodes;
}

// The nodes of an L-periodic grid that the lattice's points fall on: its resolution, or nothing.
std::optional<int> node_resolution(const Lattice& lattice, double size_m) {
    const auto whole = [](double x) {
        return std::abs(x - std::round(x)) < 1e-9 * std::max(1.0, std::abs(x));
    };
    const double n = size_m / lattice.spacing_m;
    if (n < 2.0 || n > 32768.0 || !whole(n) || !whole(lattice.first_m / lattice.spacing_m)) return {};
    return static_cast<int>(std::round(n));
}

bool has_energy(const DirectionalSpectrum& spectrum, double k_lower, double k_upper) {
    constexpr double kLongest = 1e-6;  // rad/m: no wave is longer than 6000 km
    constexpr int kSteps = 256;  // each below 10 % in k, narrower than the narrowest system, a swell's 14 %
    const double from = std::max(k_lower, kLongest);
    for (int i = 0; i <= kSteps; ++i)
        if (spectrum.omnidirectional(from * std::pow(k_upper / from, i / double{kSteps})) > 0.0) return true;
    return false;
}

int level_index(Plan& plan, const Level& level) {
    const auto same = [&](const Level& other) {
        return level.footprint_m == other.footprint_m && level.lattice == other.lattice &&
               level.only_cascade == other.only_cascade && level.is_of_light == other.is_of_light;
    };
    const auto found = std::find_if(plan.levels.begin(), plan.levels.end(), same);
    if (found != plan.levels.end()) return static_cast<int>(found - plan.levels.begin());
    plan.levels.push_back(level);
    return static_cast<int>(plan.levels.size()) - 1;
}

// Whether all of the lattice's points read the tile of cell (0, 0), without an offset or blending.
bool shows_one_tile(const Lattice& lattice, double size_m) {
    return std::max(-lattice.first_m, lattice.last_m) < kPlainHalf * size_m;
}

// Fields of a query's points, but for those of the waves that break. Foam of what breaks on a coast's floor lies on crests.
FieldSet fields_of_points(const Plan& plan, const Query& query) {
    FieldSet needed = fields_of(query.products & ~breaking_products());
    if (plan.masks && plan.masks->surf && !query.only_cascade && (query.products & breaking_products()).any())
        needed |= fields(Field::Height);
    return needed & ~plan.dropped;
}

// Fields that this cascade's grids of this level must hold for all queries together.
FieldSet fields_at(const Plan& plan, const CascadePlan& cascade, int level, bool blends) {
    FieldSet wanted;
    const FieldSet zero = cascade.choppiness > 0.0 ? FieldSet() : horizontal_fields();
    const auto derivatives = [&](const FieldSet& fields) {
        return blends || plan.masks || cascade.vessel ? fields | (gradient_fields(fields) & ~plan.dropped)
                                                      : fields;
    };
    for (const PlannedQuery& planned : plan.queries) {
        const auto uses = [&](const std::vector<int>& levels) {
            return std::find(levels.begin(), levels.end(), level) != levels.end();
        };
        const FieldSet needed = fields_of_points(plan, planned.query);
        if (uses(planned.cell_levels)) wanted |= needed & cell_fields();
        if (uses(planned.pixel_levels)) wanted |= derivatives(needed & ~cell_fields());
        if (uses(planned.breaking_levels)) wanted |= derivatives(displacement_gradient_fields());
        if (uses(planned.calm_cells)) wanted |= needed & cell_fields();
        if (uses(planned.calm_pixels)) wanted |= derivatives(needed & ~cell_fields());
    }
    return wanted & ~zero;
}

// Whether some query wants to know what this level's pixels leave unresolved.
bool hides(const Plan& plan, int level) {
    const auto has = [level](const std::vector<int>& levels) {
        return std::find(levels.begin(), levels.end(), level) != levels.end();
    };
    return std::any_of(plan.queries.begin(), plan.queries.end(), [&](const PlannedQuery& planned) {
        return has(planned.breaking_levels) ||
               ((planned.query.products & unresolved_products()).any() && has(planned.pixel_levels));
    });
}

// A grid that this level may read as it is: both let every mode through whole, and their points meet the same nodes.
std::optional<int> same_grid(const Plan& plan, const CascadePlan& cascade, const Level& at, int radius) {
    const double shortest_m = cascade.size_m / radius;
    const auto whole = [&](double footprint_m) { return plan.filter.n_max * footprint_m <= shortest_m; };
    if (!whole(at.footprint_m)) return {};
    for (std::size_t g = 0; g < cascade.grids.size(); ++g) {
        const Level& other = plan.levels[cascade.grids[g].level];
        if (other.lattice == at.lattice && whole(other.footprint_m) &&
            other.only_cascade == at.only_cascade && other.is_of_light == at.is_of_light)
            return static_cast<int>(g);
    }
    return {};
}

// Only those that points of its level's lattice read. Whoever hides slopes has means over all rows.
void leave_rows_out(const Plan& plan, const CascadePlan& cascade, Grid& grid) {
    constexpr int kTogether = 8;  // as Frame transforms and scatters them
    const std::optional<Lattice>& lattice = plan.levels[grid.level].lattice;
    if (!lattice || grid.resolution % kTogether != 0) return;
    const double per_m = grid.resolution / cascade.size_m, size_m = lattice->last_m - lattice->first_m;
    if (!(size_m < cascade.size_m)) return;
    const double below =
                     std::floor((lattice->first_m * per_m - plan.knobs.spline_taps) / kTogether) * kTogether,
                 end = lattice->last_m * per_m + plan.knobs.spline_taps;
    const int rows = static_cast<int>(std::ceil((end - below) / kTogether)) * kTogether;
    if (rows >= grid.resolution) return;
    grid.first_row = static_cast<int>(below - std::floor(below / grid.resolution) * grid.resolution);
    grid.rows = rows;
}

void add_grids(Plan& plan, int cascade_index) {
    CascadePlan& cascade = plan.cascades[cascade_index];
    // A vessel's shortest waves are next to nothing.
    const double of_vessels =
        std::max(0.625 * plan.knobs.oversampling, std::min(plan.knobs.oversampling, 1.25));
    constexpr double kRounding = 1.0 - 1e-12;  // a mode that ends the filter exactly is not below its end
    for (int level = 0; level < static_cast<int>(plan.levels.size()); ++level) {
        const Level& at = plan.levels[level];
        if (at.only_cascade && *at.only_cascade != cascade_index) continue;
        const bool is_blended = cascade.has_random_tiling && !at.only_cascade;
        const bool blends = is_blended && !(at.lattice && shows_one_tile(*at.lattice, cascade.size_m));
        const FieldSet wanted = fields_at(plan, cascade, level, blends);
        // A tile shows the modes that its own nodes can hold; the cascade may have more, for a nearby camera.
        const double resolution =
            at.only_cascade && at.lattice
                ? std::min<double>(cascade.resolution, std::round(cascade.size_m / at.lattice->spacing_m))
                : cascade.resolution;
        const double cutoff = std::min(
            {plan.filter.cutoff(at.footprint_m), cascade.k_upper, kPi * resolution / cascade.size_m});
        // The band holds every cell that reaches into it, so its last modes lie beyond its edge. A footprint's
        // cutoff is a limit on the modes themselves, and the mode on it has weight 0: a mesh on every second
        // node of a tile shows half of the tile's modes and no more.
        const double filter_modes =
            std::ceil(plan.filter.cutoff(at.footprint_m) * cascade.size_m / kTwoPi * kRounding);
        const int radius = static_cast<int>(
            std::min({0.5 * resolution, filter_modes, modes_within(cascade.size_m, cascade.k_upper) + 1.0}));
        if (cutoff <= cascade.k_lower || radius < 2) continue;
        cascade.radius_of_level[level] = radius;
        // The unresolved part is the spectrum less what these modes hold, whether they are also asked for fields or
        // not.
        if (hides(plan, level)) cascade.mode_radius = std::max(cascade.mode_radius, radius);
        if (wanted.none()) continue;
        cascade.mode_radius = std::max(cascade.mode_radius, radius);
        if (const auto same = same_grid(plan, cascade, at, radius)) {
            cascade.grids[*same].fields |= wanted;
            cascade.grid_of_level[level] = *same;
            continue;
        }

        Grid grid;
        grid.level = level;
        grid.fields = wanted;
        grid.radius = radius;
        const double oversampling =
            at.is_of_light   ? faded_oversampling(plan.filter, at.footprint_m, cascade.size_m / radius,
                                                  plan.knobs.spline_taps, plan.knobs.light_oversampling)
            : cascade.vessel ? of_vessels
                             : plan.knobs.oversampling;
        grid.resolution = transform_size(static_cast<int>(std::ceil(oversampling * (2.0 * radius - 1.0))));
        auto nodes = at.lattice ? node_resolution(*at.lattice, cascade.size_m) : std::nullopt;
        // So fine that the tile's offsets are whole nodes.
        if (nodes && blends) *nodes = std::lcm(*nodes, static_cast<int>(kTileSteps));
        if (nodes && *nodes >= 2 * radius - 1 &&
            (at.only_cascade || (*nodes <= 2 * grid.resolution && *nodes == transform_size(*nodes)))) {
            // Up to four times the samples of the spline's grid are cheaper than the spline, and without its
            // error.
            grid.resolution = *nodes;
            grid.sampling = Sampling::Nodes;
        }
        grid.rows = grid.resolution;
        cascade.grid_of_level[level] = static_cast<int>(cascade.grids.size());
        cascade.grids.push_back(std::move(grid));
    }
    // Of the sea's own cascades that would save as much, but change their bits.
    if (cascade.vessel)
        for (Grid& grid : cascade.grids) {
            for (const AlongX& along : kAlongX)
                grid.along_x[index(along.derivative)] =
                    grid.fields[index(along.derivative)] && grid.fields[index(along.of)];
            if (!plan.hides_slopes(cascade_index)) leave_rows_out(plan, cascade, grid);
        }
    if (cascade.grids.empty() && cascade.why_empty.empty())
        cascade.why_empty = "all its waves are too short for the footprints asked for: kept as variance";
}

// The cascade that holds most of the waves has the second order of what it holds: of wavenumbers from the sizes alone, whatever
// footprints let through.
void add_second_order(Plan& plan) {
    const SecondOrder& pairs = plan.from->second_order;
    int most = 0;
    std::optional<SecondOrderBand> band;
    CascadePlan* holder = nullptr;
    for (CascadePlan& cascade : plan.cascades) {
        const int largest_radius =
            std::min(cascade.resolution / 2, modes_within(cascade.size_m, cascade.k_upper) + 1);
        const SecondOrderBand own(pairs, cascade.k_lower, cascade.k_upper, cascade.size_m, largest_radius);
        if (own.bins() <= most) continue;
        most = own.bins();
        band = own;
        holder = &cascade;
    }
    if (!holder || !(holder->choppiness > 0.0)) return;
    FieldSet shown;
    for (const Grid& grid : holder->grids) shown |= grid.fields;
    if ((shown & vertical_fields()).none()) return;
    SecondOrderPlan own =
        band->plan(pairs, plan.second_order_gain * holder->choppiness, shown[index(Field::VelocityZ)],
                   plan.from->spectrum.dispersion().depth_m);
    own.resolution = transform_size(2 * own.radius + own.reach);
    holder->second_order = own;
    holder->mode_radius = std::max(holder->mode_radius, own.reach);
}

}  // namespace

std::vector<CascadeSize> resolve_cascades(const PreparedScene& prepared, double finest_footprint_m,
                                          const FootprintFilter& filter) {
    const Scene& scene = prepared.scene;
    if (!scene.waves.cascades.empty() || scene.waves.model == WaveModel::Trochoid)
        return scene.waves.cascades;
    // Ten of the longest peak waves fit into the first tile (their m0 then varies by some 7 % from seed to
    // seed); each further one is smaller by the golden ratio cubed, about as far from a common period as
    // numbers go.
    constexpr double kPeakWaves = 10.0;
    constexpr double kRatio = 4.23606797749979;
    constexpr int kCascades = 4, kLargestResolution = 2048, kUnfilteredResolution = 512;
    const double peak = prepared.spectrum.longest_peak_wavenumber();
    std::vector<CascadeSize> cascades(kCascades);
    std::vector<double> sizes;
    for (int i = 0; i < kCascades; ++i) sizes.push_back(kPeakWaves * kTwoPi / peak / std::pow(kRatio, i));
    // All cells have the same tile: what its waves happen to have in common over short distances stays in the
    // picture. With sixteen peak waves that is little, for a third more of all transforms.
    constexpr double kCopiedPeakWaves = 16.0;
    if (scene.waves.tiling == Tiling::Random) sizes.front() *= kCopiedPeakWaves / kPeakWaves;
    const auto edges = lower_edges(sizes);
    for (int i = 0; i < kCascades; ++i) {
        cascades[i].size_m = sizes[i];
        int resolution = kUnfilteredResolution;
        if (i + 1 < kCascades) {
            resolution = sufficient_resolution(sizes[i], edges[i + 1]);
        } else if (finest_footprint_m > 0.0) {
            // The finest cascade goes as far as somebody looks. Modes don't depend on it: more only adds
            // detail.
            const double modes = filter.cutoff(finest_footprint_m) * sizes[i] / kTwoPi;
            resolution =
                static_cast<int>(std::clamp(2.0 * (std::ceil(modes) + 1.0), 16.0, 1.0 * kLargestResolution));
        }
        cascades[i].resolution = transform_size(resolution);
    }
    return cascades;
}

Query view_query(const PreparedScene& prepared, const ViewQueryOptions& options) {
    Query query;
    query.name = "view";
    query.is_view = true;
    query.is_picture = options.products.none();
    query.products = options.products;
    if (query.is_picture) {
        query.products =
            products(Product::Position, Product::Normal, Product::SlopeVariance, Product::Coverage);
        query = with_effects(prepared.scene, std::move(query));
    }
    query.points = options.points;
    const FootprintFilter& filter = options.filter;
    const double finest_m = options.finest_pixel_m > 0.0 ? first_level_m(options.finest_pixel_m) : 0.0;
    const auto cascades = resolve_cascades(prepared, finest_m, filter);
    // Trains use each point's own footprints, whatever the levels.
    query.cell_m = query.pixel_m = {0.0};
    if (cascades.empty()) return query;
    // Where the finest cascade's shortest wave is still whole: finer footprints change nothing. A camera's levels
    // begin at the nearest one: waves within √2 of the shortest, which that leaves unresolved, aren't worth a second
    // grid of that size.
    const CascadeSize& finest = cascades.back();
    const double shortest_m = finest.size_m / (0.5 * finest.resolution);
    const double whole_m =
        finest_m > 0.0 ? first_level_m(shortest_m / filter.n_max) : level_below_m(shortest_m / filter.n_max);
    const double none_m = cascades.front().size_m / filter.n_min;
    if (finest_m > 0.0) query.pixel_m.clear();
    for (double level_m = std::max(finest_m, whole_m);; level_m *= 2.0) {
        query.pixel_m.push_back(level_m);
        if (level_m >= none_m) break;
    }
    const double finest_cell_m = std::max(options.finest_cell_m, options.finest_pixel_m);
    const auto coarser = std::upper_bound(query.pixel_m.begin() + 1, query.pixel_m.end(),
                                          finest_cell_m > 0.0 ? first_level_m(finest_cell_m) : 0.0);
    query.cell_m.assign(coarser - 1, query.pixel_m.end());
    return query;
}

ProjectedGridOptions projected_grid_options(const PreparedScene& prepared) {
    return projected_grid_options(prepared.scene, prepared.extent);
}

namespace {

void check_footprints(const Query& query) {
    const auto rising = [](const std::vector<double>& footprints) {
        return !footprints.empty() && footprints.front() >= 0.0 && std::isfinite(footprints.back()) &&
               std::adjacent_find(footprints.begin(), footprints.end(),
                                  [](double a, double b) { return !(a < b); }) == footprints.end();
    };
    if (!rising(query.cell_m) || !rising(query.pixel_m))
        throw std::invalid_argument(
            "query \"" + query.name +
            "\": footprints must be at least one, finite, from 0 up and strictly rising");
}

// The query with its levels, at the end of the plan's.
int add_query(Plan& plan, const Query& query) {
    check_footprints(query);
    PlannedQuery planned{query, {}, {}, {}};
    // Levels of their own even where a cell's has the same footprint: which do depends on the camera's place, and a picture's
    // bits must not depend on what other pictures are planned with it.
    const bool is_of_light = query.is_picture && plan.knobs.light_oversampling < plan.knobs.oversampling;
    const auto level_of = [&](double footprint_m, bool of_light) {
        return level_index(plan, {footprint_m, query.lattice, query.only_cascade, of_light});
    };
    for (double footprint_m : query.cell_m) planned.cell_levels.push_back(level_of(footprint_m, false));
    for (double footprint_m : query.pixel_m)
        planned.pixel_levels.push_back(level_of(footprint_m, is_of_light));
    if ((query.products & breaking_products()).any())
        for (double footprint_m : query.pixel_m)
            planned.breaking_levels.push_back(level_of(plan.breaking.footprint_of(footprint_m), is_of_light));
    const bool shows_ripples = fields_of(query.products & ~breaking_products()).any();
    if (plan.masks && plan.masks->calms_ripples && !query.only_cascade && shows_ripples) {
        if (query.cell_m.front() < kSlick_m) planned.calm_cells = {level_of(kSlick_m, false)};
        if (query.pixel_m.front() < kSlick_m) planned.calm_pixels = {level_of(kSlick_m, is_of_light)};
    }
    plan.queries.push_back(std::move(planned));
    return static_cast<int>(plan.queries.size()) - 1;
}

}  // namespace

Plan make_plan(std::shared_ptr<const PreparedScene> from, const std::vector<Query>& queries,
               const PlanOptions& options) {
    Plan plan;
    plan.from = std::move(from);
    const PreparedScene& prepared = *plan.from;
    const Scene& scene = prepared.scene;
    plan.knobs = options.knobs.value_or(knobs_of(scene.quality.level));
    plan.filter = options.filter;
    plan.knobs.double_precision = options.double_precision.value_or(plan.knobs.double_precision);
    plan.breaking = breaking_of(scene, plan.filter);
    // Before the queries: a slick is one of their levels. Depths that nobody has read are refused.
    plan.masks = scene.waves.coast && !scene.waves.coast_depths ? plan_masks(scene, prepared.spectrum)
                                                                : prepared.masks;
    // In pictures the edge of what breaks is as wide as a breaker's roller is thick, and the foam's pattern tears it: to a pixel it would be cut.
    // Two thirds of the height are by eye; a mean over footprints stays.
    constexpr double kRollerOverHeight = 2.0 / 3.0;
    if (std::ranges::any_of(queries, [](const Query& query) { return query.is_picture; }))
        plan.breaking.footprint_m =
            plan.breaking.footprint_of(kRollerOverHeight * highest_breaker_m(prepared));
    for (const Query& query : queries) add_query(plan, query);
    for (const EffectRow& row : effect_table())
        if (!row.is_on(scene))
            plan.dropped |= row.fields;
        else if (row.plan)
            row.plan(plan);

    double finest_m = std::numeric_limits<double>::infinity(), trains_finest_m = finest_m;
    for (const PlannedQuery& planned : plan.queries) {
        const Query& query = planned.query;
        if (query.only_cascade) continue;
        const double own_m = std::min(query.cell_m.front(), query.pixel_m.front());
        finest_m = std::min(finest_m, own_m);
        if (!query.is_view) trains_finest_m = std::min(trains_finest_m, own_m);
    }
    const double finest_footprint_m = std::isfinite(finest_m) ? finest_m : 0.0;
    plan.trains = resolve_trains(prepared, trains_finest_m);
    if (plan.trains && prepared.weather) plan.trains->shot = plan.from;
    const auto sizes = resolve_cascades(prepared, finest_footprint_m, plan.filter);
    std::vector<double> sizes_m;
    for (const CascadeSize& cascade : sizes) sizes_m.push_back(cascade.size_m);
    const auto edges = lower_edges(sizes_m);
    const DirectionalSpectrum& spectrum = prepared.spectrum;
    for (std::size_t i = 0; i < sizes.size(); ++i) {
        CascadePlan cascade;
        cascade.size_m = sizes[i].size_m;
        cascade.resolution = sizes[i].resolution;
        cascade.choppiness = plan.breaking.choppiness.at(edges[i]);
        cascade.has_random_tiling = scene.waves.tiling == Tiling::Random;
        cascade.k_lower = plan.trains ? std::max(edges[i], kTwoPi / plan.trains->shortest_m) : edges[i];
        cascade.k_upper = i + 1 < sizes.size() ? edges[i + 1] : std::numeric_limits<double>::infinity();
        cascade.grid_of_level.assign(plan.levels.size(), -1);
        cascade.radius_of_level.assign(plan.levels.size(), 0);
        plan.cascades.push_back(std::move(cascade));
        const double last = std::min(plan.cascades[i].k_upper, kPi * sizes[i].resolution / sizes[i].size_m);
        if (last > plan.cascades[i].k_lower && has_energy(spectrum, plan.cascades[i].k_lower, last))
            add_grids(plan, static_cast<int>(i));
        else
            plan.cascades[i].why_empty =
                plan.trains && plan.trains->count > 0 && !(last > plan.cascades[i].k_lower)
                    ? "its waves are those of the trains"
                    : "the spectrum has no energy in its band";
    }
    if (plan.second_order_gain > 0.0) add_second_order(plan);
    double known_to = 0.0;  // [rad/m]
    if (plan.trains && plan.trains->hero_trains > 0) known_to = plan.trains->hero_ends.height;
    for (const SceneObject& object : scene.objects)
        if (object.mesh && answers_by_mass(object))
            known_to = std::max(known_to, plan.filter.cutoff(floating_cell_m(object)));
    for (CascadePlan& cascade : plan.cascades) {
        if (!(known_to > cascade.k_lower)) continue;
        const double end = std::min(known_to, cascade.k_upper) * cascade.size_m / kTwoPi;
        cascade.known_radius =
            std::min(static_cast<int>(std::min(std::ceil(end), 1e6)) + 1, cascade.resolution / 2);
        cascade.mode_radius = std::max(cascade.mode_radius, cascade.known_radius);
    }
    for (VesselPlan& vessel : plan_vessels(scene)) {
        CascadePlan cascade;
        cascade.size_m = vessel.size_m;
        cascade.resolution = 2 * vessel.radius;
        cascade.choppiness = plan.breaking.choppiness.at(kGravity / std::pow(vessel.speed_mps, 2));
        cascade.k_upper = std::numeric_limits<double>::infinity();
        cascade.grid_of_level.assign(plan.levels.size(), -1);
        cascade.radius_of_level.assign(plan.levels.size(), 0);
        cascade.vessel = std::move(vessel);
        plan.cascades.push_back(std::move(cascade));
        add_grids(plan, static_cast<int>(plan.cascades.size()) - 1);
    }
    return plan;
}

Plan make_plan(const Scene& scene, const std::vector<Query>& queries, const PlanOptions& options) {
    return make_plan(prepare(scene), queries, options);
}

Plan plan_of_foam_level(const Plan& plan, double cell_m) {
    Query query;
    query.name = "foam";
    query.products = products(Product::JacobianMoments);
    if (plan.from->scene.waves.coast) query.products |= products(Product::Displacement);
    query.cell_m = query.pixel_m = {cell_m};
    query.is_view = true;
    // Six taps on 0.7 as many nodes read as well as four: the final level's foam is 0.4 % off (RMS) with either, six taking three
    // quarters of the time (tests/bench/README.md). No fewer than drafts have anyway.
    constexpr double kNodes = 0.7, kFewest = 1.25;
    Knobs knobs = plan.knobs;
    knobs.spline_taps = 6;
    knobs.oversampling = std::max(kNodes * knobs.oversampling, kFewest);
    Plan own = make_plan(plan.from, {query}, {.knobs = knobs});
    own.trains = plan.trains;  // which there are depends on all that is asked of the sea
    own.gusts.reset();         // the whole sea's own
    own.cascades.resize(own.sea_cascades());
    return own;
}

Plan plan_bake(std::shared_ptr<const PreparedScene> prepared, std::span<const int> frames, const Plan* like) {
    const std::shared_ptr<const RestSurface> surface =
        like ? like->surface : make_surface(prepared->scene, prepared->extent);
    std::optional<SurfaceNeeds> needs;
    if (like) needs = like->surface_needs;
    const OutputContext context{.prepared = *prepared, .surface = *surface, .frames = frames, .needs = needs};
    std::vector<OutputRequest> requests;
    for (const OutputRow& row : output_table()) row.add(row, context, requests);
    std::vector<Query> queries;
    std::vector<PlannedOutput> outputs;
    for (OutputRequest& request : requests) {
        const Query query = with_effects(prepared->scene, std::move(request.query));
        PlannedOutput output{.row = request.row,
                             .map = request.map,
                             .cascade = request.cascade,
                             .volume = request.volume,
                             .query = static_cast<int>(queries.size()),
                             .has_surface = request.needs.has_value(),
                             .key_parts = request.row->key_parts};
        if (output.has_surface) {
            needs = request.needs;
            output.key_parts |= surface->key_parts();
        }
        for (const VolumeRow& row : volume_table())
            if (output.volume == row.volume) output.key_parts |= row.key_parts;
        for (const EffectRow& row : effect_table())
            if (row.shapes && row.shapes(query)) output.key_parts |= row.key_parts;
        outputs.push_back(std::move(output));
        queries.push_back(query);
    }
    if (!hulls_of(prepared->scene).empty()) {
        bool is_any = false, have_places = true;
        for (PlannedOutput& output : outputs) {
            output.meets_hulls = may_meet_hulls(output);
            is_any = is_any || output.meets_hulls;
            // A map's texels are at rest. Volumes and drops ask at places, and have no foam.
            const ProductSet& products = queries[static_cast<std::size_t>(output.query)].products;
            const bool is_mesh_with_foam =
                output.row->kind == OutputKind::Mesh && products[index(Product::Coverage)];
            if (output.meets_hulls &&
                (output.map || (is_mesh_with_foam && !products[index(Product::Velocity)])))
                have_places = false;
        }
        if (is_any)
            if (std::optional<Query> hulls = hulls_query(prepared->scene, have_places))
                queries.push_back(std::move(*hulls));
    }
    Plan plan = make_plan(std::move(prepared), queries);
    plan.outputs = std::move(outputs);
    plan.surface = surface;
    plan.surface_needs = needs;
    return plan;
}

Plan plan_bake(const Scene& scene) {
    constexpr int kFrames = 64;
    return plan_bake(prepare(scene), representative_frames(scene, kFrames));
}

std::vector<int> summed_levels(const Plan& plan, const PlannedQuery& planned) {
    const FieldSet needed = fields_of_points(plan, planned.query);
    std::vector<int> levels;
    const auto add = [&](const std::vector<int>& more, const FieldSet& of) {
        if ((needed & of).any()) levels.insert(levels.end(), more.begin(), more.end());
    };
    add(planned.cell_levels, cell_fields());
    add(planned.pixel_levels, ~cell_fields());
    levels.insert(levels.end(), planned.breaking_levels.begin(), planned.breaking_levels.end());
    add(planned.calm_cells, cell_fields());
    add(planned.calm_pixels, ~cell_fields());
    return levels;
}

bool CascadePlan::moves() const {
    return std::any_of(grids.begin(), grids.end(),
                       [](const Grid& grid) { return (grid.fields & velocity_fields()).any(); });
}

bool Plan::hides_slopes(int cascade) const {
    std::set<int> shown;
    for (const PlannedQuery& planned : queries)
        if ((planned.query.products & unresolved_products()).any())
            for (const int level : planned.pixel_levels) shown.insert(cascades[cascade].grid_of_level[level]);
    return shown.size() > 1;
}

std::size_t Plan::sea_cascades() const {
    return static_cast<std::size_t>(
        std::ranges::count_if(cascades, [](const CascadePlan& cascade) { return !cascade.vessel; }));
}

std::size_t Plan::vessel_bytes() const {
    std::size_t bytes = 0;
    for (const CascadePlan& cascade : cascades)
        if (cascade.vessel) bytes += cascade.vessel->bytes(cascade.amplitude_radius());
    return bytes;
}

int CascadePlan::amplitude_radius() const {
    int radius = std::max(known_radius, second_order ? second_order->reach : 0);
    for (const Grid& grid : grids) radius = std::max(radius, grid.radius);
    return radius;
}

bool Plan::has_gradients() const {
    return choppiness.moves() || std::any_of(queries.begin(), queries.end(), [](const PlannedQuery& planned) {
               return !planned.breaking_levels.empty();
           });
}

int Plan::transforms_per_frame() const {
    std::size_t count = 0;
    for (const CascadePlan& cascade : cascades)
        for (const Grid& grid : cascade.grids) count += grid.fields.count();
    return static_cast<int>(count);
}

long Plan::lines_per_frame() const {
    long count = 0;
    for (const CascadePlan& cascade : cascades) {
        for (const Grid& grid : cascade.grids) count += grid.lines();
        if (cascade.second_order) count += cascade.second_order->lines();
    }
    return count;
}

// The seas of its keys, and that of a frame, which is made while the one before is there. Where waves change it has modes of its own, with
// their rates; else all share theirs, but for trains and tables.
static std::size_t weather_bytes(const Plan& plan) {
    std::set<std::size_t> seas;
    for (const Weather::Key& key : plan.from->weather->keys) seas.insert(key.waves);
    Plan one = plan;
    one.from = plan.from->weather->keys.front().sea;
    const std::size_t keys = plan.from->weather->keys.size(),
                      scalar = plan.knobs.double_precision ? sizeof(double) : sizeof(float);
    const bool is_over_depth = depth_at(*plan.from, 0.0).has_value();
    std::size_t modes = 0, rates = 0, turns = 0;
    for (const CascadePlan& cascade : plan.cascades) {
        const std::size_t count = lattice_modes(cascade.amplitude_radius());
        modes += count * sea_bytes_per_mode(plan.knobs.double_precision, plan.has_gradients());
        // Of the amplitudes, and of the displacement over a depth that changes.
        if (cascade.moves()) rates += count * (is_over_depth && plan.has_gradients() ? 5 : 4) * scalar;
        if (is_over_depth) turns += count * (keys + 1) * sizeof(double);  // of each key and of a frame
    }
    const std::size_t others = one.sea_bytes() - modes;
    if (seas.size() == 1 && !is_over_depth) return modes + (keys + 2) * others;
    return (seas.size() + 2) * modes + (keys + 2) * others + turns + 2 * rates;
}

std::size_t Plan::sea_bytes() const {
    if (from->weather) return weather_bytes(*this);
    std::size_t bytes = trains ? trains->sea_bytes(knobs.double_precision) : 0;
    for (const CascadePlan& cascade : cascades)
        bytes += lattice_modes(cascade.amplitude_radius()) *
                 sea_bytes_per_mode(knobs.double_precision, has_gradients());
    for (const PlannedQuery& planned : queries)
        if (has_ellipse_table(*this, planned.query))
            bytes += EllipseTable::nodes(planned.query.pixel_m.size()) * EllipseTable::kBytesANode;
    return bytes;
}

std::size_t Plan::frame_bytes() const {
    std::size_t bytes = 0;
    for (const CascadePlan& cascade : cascades)
        for (const Grid& grid : cascade.grids)
            bytes += grid.fields.count() * grid_bytes(grid.resolution, knobs.double_precision);
    return bytes;
}

std::size_t Plan::second_order_bytes() const {
    std::size_t bytes = 0;
    for (const CascadePlan& cascade : cascades)
        if (cascade.second_order) bytes += cascade.second_order->bytes(knobs.double_precision);
    return bytes;
}

std::array<double, FoamPlan::kLevels> foam_tiles(const Plan& plan) {
    std::vector<Query> asked;
    for (const PlannedQuery& planned : plan.queries) asked.push_back(planned.query);
    return foam_tiles(*plan.foam, plan.from->scene, asked, plan.outputs.empty());
}

std::size_t Plan::foam_history_bytes() const {
    const Scene& scene = from->scene;
    if (!foam || !(scene.sea.wind_speed_mps > 0.0 && scene.effects.whitecap_amount > 0.0)) return 0;
    const std::array<double, FoamPlan::kLevels> tiles = foam_tiles(*this);
    std::size_t bytes = 0;
    for (int level = 0; level < FoamPlan::kLevels; ++level) {
        const double count = tiles[static_cast<std::size_t>(level)];
        if (!(count > 0.0)) continue;
        const Plan own = plan_of_foam_level(*this, foam->cell_of(level));
        // All levels share the sea's coast.
        const std::size_t coast = own.trains ? own.trains->coast_bytes(own.knobs.double_precision) : 0;
        bytes += static_cast<std::size_t>(std::ceil(count)) * foam->tile_bytes() + own.sea_bytes() - coast +
                 own.frame_bytes();
    }
    return bytes;
}

std::size_t Plan::effect_bytes() const {
    std::size_t bytes = 0;
    for (const EffectRow& row : effect_table())
        if (row.state.bytes) bytes += row.state.bytes(*this);
    return bytes;
}

std::size_t Plan::output_bytes() const {
    std::size_t bytes = 0;
    for (const ProductRow& row : kProductTable) {
        std::size_t most = 0;
        for (const PlannedQuery& planned : queries) {
            if (!planned.query.products[index(row.product)]) continue;
            bytes += planned.query.points * row.components * sizeof(float);
            most = std::max(most, planned.query.points);
        }
        if (knobs.double_precision) bytes += most * row.components * sizeof(double);
    }
    std::vector<std::pair<std::size_t, double>> squares;
    for (const PlannedQuery& planned : queries) {
        const std::pair square(planned.query.points,
                               planned.query.lattice ? planned.query.lattice->spacing_m : 0.0);
        if (std::find(squares.begin(), squares.end(), square) != squares.end()) continue;
        squares.push_back(square);
        bytes += square.first * 2 * (knobs.double_precision ? sizeof(double) : sizeof(float));
    }
    return bytes;
}

}  // namespace pelagic
