// The plan: what a scene's outputs need, as pure data, before a byte is allocated.
//
// A closure over tables (outputs.h, effects.h, products.h): outputs → products → fields → inverse transforms. Nothing else in
// the code decides whether an effect is computed: Sea, Frame and evaluate() read the plan and do what stands
// there. It knows no FFTW and allocates no buffers, so that explain() answers at once for an 8192² sea.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/plan/breaking.h"
#include "core/plan/choppiness.h"
#include "core/plan/filter.h"
#include "core/plan/foam.h"
#include "core/plan/gusts.h"
#include "core/plan/masks.h"
#include "core/plan/outputs.h"
#include "core/plan/prepared_scene.h"
#include "core/plan/products.h"
#include "core/plan/query.h"
#include "core/plan/second_order.h"
#include "core/plan/trains.h"
#include "core/plan/vessels.h"
#include "core/surface/projected_grid.h"
#include "pelagic/scene.h"

namespace pelagic {

// How a point finds its value in a grid of samples.
enum class Sampling {
    Nodes,   // the points are the grid's nodes: a plain read, exact
    Spline,  // B-spline whose coefficients come straight from the spectrum (core/waves/spline.h)
};

// One cascade seen through one footprint: an N × N periodic grid and the transforms that fill it.
struct Grid {
    int level = 0;       // the first of those that read it: what they filter is the same
    int resolution = 0;  // N
    Sampling sampling = Sampling::Spline;
    int radius = 0;   // modes with mx² + my² < radius² pass, 2 radius ≤ N + 1
    FieldSet fields;  // each is one real N × N transform
    // The rows that are transformed, from one on and round: all, but for a vessel's tile that only a lattice's points read.
    int first_row = 0, rows = 0;

    FieldSet along_x{};  // those of kAlongX that have no columns of their own

    // One-dimensional complex transforms of N points that a frame takes: of a field a column for each mx below
    // radius, and two real rows at a time.
    long lines() const {
        const auto of = [](const FieldSet& some) { return static_cast<long>(some.count()); };
        return of(fields & ~along_x) * radius + of(fields) * ((rows + 1) / 2);
    }
};

struct CascadePlan {
    double size_m = 0.0;
    int resolution = 0;
    // The band [rad/m]: lower ≤ |k| < upper, from the sizes alone. The finest cascade's upper edge is
    // infinite: it ends with its last mode, below mode_radius.
    double k_lower = 0.0, k_upper = 0.0;
    // Modes with mx² + my² < mode_radius² are counted in what is resolved.
    int mode_radius = 0;
    std::vector<Grid> grids;  // only those through which something passes
    // Index into grids, −1: nothing of this cascade passes. Levels that let all of its modes through whole
    // share one.
    std::vector<int> grid_of_level;
    // Modes with mx² + my² < radius² pass a level at all; 0: none.
    std::vector<int> radius_of_level;
    std::string why_empty;  // set when there are no grids

    // λ of its modes, as Breaking has it. 0: none of horizontal_fields().
    double choppiness = 1.0;
    // Whether it has random tiling (core/plan/random_tiling.h), except for queries of a cascade's own tile.
    bool has_random_tiling = false;

    std::optional<SecondOrderPlan> second_order{};  // of the one cascade that has it

    // Of the waves that heroes, and what floats by its mass, must know whatever is asked for: these are the same in every plan. 0 without.
    int known_radius = 0;

    // Of a vessel's waves, which are none of the spectrum's, and lie within the tile round its middle alone: behind all cascades of the sea.
    std::optional<VesselPlan> vessel{};

    bool moves() const;  // whether somebody asks for velocities
    // Modes within it have amplitudes: the largest of its grids', of its second order and known_radius; 0 without any.
    int amplitude_radius() const;
};

// A footprint that some query uses; queries with the same footprint and sampling share it.
struct Level {
    double footprint_m = 0.0;
    std::optional<Lattice> lattice;
    std::optional<int> only_cascade;
    bool is_of_light = false;  // of a picture's pixels: Knobs::light_oversampling
};

// Quality, resolved into knobs (core/plan/quality.h).
struct Knobs {
    int spline_taps = 6;
    double oversampling = 2.0, light_oversampling = 2.0;
    bool third_moment = true;  // coverage from three moments of J, or from two (Dupuy and Bruneton)
    bool double_precision = false;
    double longest_ellipse = 8.0;  // of footprints: over its width, 1 … kLongestEllipse (core/plan/taps.h)
    double foam_steps_a_period =
        4.0;  // of the lattice of times of persistent foam, in periods of its shortest waves

    bool operator==(const Knobs&) const = default;
};

struct PlannedQuery {
    Query query;
    std::vector<int> cell_levels, pixel_levels;  // into Plan::levels, parallel to the footprints
    // Parallel to pixel_levels: the levels of the breaking waves' displacement gradient. The same levels, except for
    // pixels finer than Breaking::footprint_m. Empty where nobody asks.
    std::vector<int> breaking_levels;
    // The level of what a slick leaves of finer cells and pixels (kSlick_m). Empty where there are none, or no slick.
    std::vector<int> calm_cells{}, calm_pixels{};
};

struct Plan {
    std::shared_ptr<const PreparedScene> from;  // what was planned
    Knobs knobs;
    FootprintFilter filter;
    Choppiness choppiness = 0.0;
    Breaking breaking;
    std::vector<PlannedQuery> queries;
    std::vector<Level> levels;
    std::vector<CascadePlan> cascades;
    // The second wave model, where cascades begin where its waves end, and heroes.
    std::optional<TrainsPlan> trains;
    double lean_rad = 0.0;  // by which the horizontal displacement runs ahead
    double second_order_gain = 0.0;
    std::optional<FoamPlan> foam;        // with persistent foam, where a query asks for any of it
    std::optional<GustsPlan> gusts;      // where the wind varies over the surface
    std::optional<MasksPlan> masks;      // where waves are calmer or rougher from place to place
    FieldSet dropped;                    // fields that are zero in this scene, whoever asks: never computed
    std::vector<PlannedOutput> outputs;  // of a bake; each has a query
    std::shared_ptr<const RestSurface> surface;  // of a bake: where the mesh's points are
    std::optional<SurfaceNeeds> surface_needs;   // and what they ask for, where there is a mesh

    // Whether modes have horizontal displacements, or a displacement gradient that decides about breaking.
    bool has_gradients() const;
    bool hides_slopes(int cascade)
        const;  // whether somebody asks for those that pixels hide, and some show less than others
    std::size_t sea_cascades() const;  // those before vessels'
    std::size_t vessel_bytes() const;  // of each Frame
    int transforms_per_frame() const;  // real two-dimensional ones: one for each field of each grid
    long lines_per_frame() const;      // the one-dimensional complex ones that they are made of
    std::size_t sea_bytes() const;     // held once, shared
    std::size_t frame_bytes() const;   // held by each Frame, beside what a thread works on: some 70 N numbers
                                       // of its largest grid
    // Points at rest, shared by queries over the same square, and one frame's results: each query's own, in
    // single precision as files hold them; in double, besides, an array a product as long as its longest.
    std::size_t output_bytes() const;
    std::size_t second_order_bytes() const;  // of each Frame
    // The bytes of the history of persistent foam (core/effects/foam_history.h), in expectation where a picture's
    // frame or a mesh for a camera decides which tiles are read.
    std::size_t foam_history_bytes() const;
    std::size_t effect_bytes() const;  // of all effects that hold anything from frame to frame: the history's
};

struct ViewQueryOptions {
    // None: what a picture's light needs, that is positions, normals, what pixels hide of the slopes, and what the
    // scene's effects add, coverage for one.
    ProductSet products{};
    // No point's footprints will be finer [m] (ProjectedGridNeeds); 0: nothing may be filtered.
    double finest_cell_m = 0.0, finest_pixel_m = 0.0;
    std::size_t points = 0;
    FootprintFilter filter{};
};

// A query for points at all distances from a camera: levels of footprints, each twice as large as the one before.
// They are powers of two in metres, whatever the scene (core/surface/footprint_levels.h), from the nearest to the finest
// footprint (one of 0 before them, if nothing may be filtered) up to where no cascade has a wave to resolve. A
// point's answer depends on the two levels beside its own footprints, and never on how fine other points are. The
// cells' levels are among those of the pixels, so that they share what they can.
// Named "view".
Query view_query(const PreparedScene&, const ViewQueryOptions& options = {});

// The projected grid of the shot's camera, for pictures.
ProjectedGridOptions projected_grid_options(const PreparedScene&);

// The plan of these queries, with the parts that the scene's effects plan themselves. Without `knobs` or `double_precision` as the
// quality level has them. Throws std::invalid_argument when a query is malformed.
struct PlanOptions {
    std::optional<Knobs> knobs{};
    FootprintFilter filter{};  // to measure what another one would cost
    std::optional<bool> double_precision{};
};
Plan make_plan(std::shared_ptr<const PreparedScene>, const std::vector<Query>&, const PlanOptions& = {});
Plan make_plan(const Scene&, const std::vector<Query>&, const PlanOptions& = {});

// Of a plan with persistent foam: the sea seen through the cells of one level of its history.
Plan plan_of_foam_level(const Plan&, double cell_m);

// The plan of a bake of these frames: its outputs, in the order of the table, each with its query. The frames decide
// how fine the levels for the camera's own surfaces are, and nothing about any frame's bits. `like`: a plan of the same frames
// and of a surface that is the same, and isn't laid out again.
Plan plan_bake(std::shared_ptr<const PreparedScene>, std::span<const int> frames, const Plan* like = nullptr);
// Of representative frames (core/surface/rest_surface.h), for estimates of a bake.
Plan plan_bake(const Scene&);

// The cascades in force, largest first: the scene's own, or "auto" resolved for the finest footprint asked
// for; none for a sea of trains alone.
std::vector<CascadeSize> resolve_cascades(const PreparedScene&, double finest_footprint_m,
                                          const FootprintFilter& filter = {});

// The levels, of Plan::levels, from which the query's values are summed: none where they only count what is
// unresolved.
std::vector<int> summed_levels(const Plan&, const PlannedQuery&);

// A page of text: each output, product, field, transform with its size, bytes held, and why.
std::string explain(const Plan&);

}  // namespace pelagic
