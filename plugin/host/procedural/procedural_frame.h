// The sea of a shot and its frames, as the C interface hands them out (pelagic/procedural.h says what each call does).
#pragma once

#include <tbb/task_arena.h>

#include <atomic>
#include <cstddef>
#include <glm/vec3.hpp>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <utility>

#include "core/effects/sea_at_time.h"
#include "core/evaluate/water.h"
#include "core/plan/plan.h"
#include "core/surface/projected_grid.h"
#include "core/surface/view.h"
#include "core/waves/frame.h"
#include "plugin/host/procedural/surface_tiles.h"

namespace pelagic::procedural {

// The side of a mesh's cells on the screen by default.
inline constexpr double kCell_px = 2.0;

// Points move in straight lines while the shutter is open. Within a longer one they would go further than waves do, and a ray would
// have to look for them everywhere: 0.8 s for the first rays of a second, and 15 s of two.
inline constexpr double kLongestShutter_s = 1.0;

// What a sea is asked for.
struct SeaOptions {
    double finest_cell_m = 0.0, finest_pixel_m = 0.0;  // 0: as the shot's camera needs it
    int threads = 0;                                   // at most; 0: all
    std::size_t ray_cache_bytes = 0;                   // that a frame keeps for rays; 0: 256 MiB
    std::size_t max_memory_bytes = 0;                  // that a frame may hold; 0: what the system gives
};

// Immutable. The plan has one query, number 0.
struct ShotSea {
    ShotSea(Scene from, const SeaOptions& options, const BuildWatch& watch);

    Scene scene;
    std::size_t ray_cache_bytes;
    double finest_cell_m = 0.0,
           finest_pixel_m = 0.0;  // finer footprints, of points and rays, count as these; > 0
    mutable std::atomic<bool> is_cancelled{false};  // by any thread, while others use the sea
    BuildWatch watch() const { return {.cancel = &is_cancelled}; }
    std::unique_ptr<tbb::task_arena> arena;  // where everything that uses several threads runs
    std::shared_ptr<const SeaOverTime<float>> sea;
    std::optional<Whitecaps>
        without_past;  // as if no foam were persistent; none where none is. Of the first key of a sea that changes
    const Query& query() const { return sea->plan().queries.front().query; }
};

// Points as evaluate() takes them, and when each is asked for.
struct TimedPoints {
    Points<float> points;
    const float* time_s = nullptr;  // from the shutter's opening on; null: its middle
};

// What a host takes coverage for: all foam, or, as structures of the first version had it, what breaks now as if no foam
// were persistent.
enum class CoverageOf { AllFoam, FirstVersion };

class ShotFrame {
  public:
    ShotFrame(std::shared_ptr<const ShotSea> of, double open_s, double close_s);

    // Not while others use the frame. Throws std::invalid_argument for times that aren't accepted. As all that follow but bounds,
    // BuildCancelled where the sea is.
    void set(double open_s, double close_s);
    bool is_set() const {
        return is_set_;
    }  // false after a set() that was cancelled or failed: all else is undefined then

    const ShotSea& shot() const { return *of_; }

    // Of all points of the region, displaced, while the shutter is open: least and greatest corner in the world [m].
    std::pair<glm::dvec3, glm::dvec3> bounds(const RestRegion& region, FootprintRange cells) const;
    // Half the height and the reach of all points everywhere.
    SurfaceBounds everywhere() const;

    double half_open_s() const { return half_open_s_; }  // half of the time for which the shutter is open
    // Of a batch, from the shutter's opening on; null: none. Throws std::invalid_argument, which calls them `name`, for one outside.
    void check_times(const float* time_s, std::size_t count, const char* name) const;
    // The surface for rays. Made when first asked for, so that frames without rays cost nothing.
    const SurfaceTiles& tiles() const;

    // The cells of the last mesh that was asked for by its error, if it was this one.
    std::optional<double> remembered_cell_px(const View& view, double error_px, bool on_earth) const;
    void remember_cell_px(const View& view, double error_px, bool on_earth, double cell_px) const;

    // By the calling thread alone. Times count from the shutter's opening; those that rounding puts outside count as
    // its ends.
    void evaluate(const TimedPoints& points, Results<float> results,
                  CoverageOf coverage = CoverageOf::AllFoam) const;
    // The same in the middle of the shutter, by all threads of the calling arena.
    void evaluate_by_all(const Points<float>& points, const Results<float>& results,
                         CoverageOf coverage = CoverageOf::AllFoam) const;
    // Above places of the world in the middle of the shutter, by the calling thread alone; 0: the finest footprints.
    void water_at(std::span<const glm::dvec2> places_m, float footprint_m, std::span<WaterState> water) const;
    // Goes through the past of the foam at these points, by several threads.
    void prepare(const Points<float>& points) const;

  private:
    template <class Bound>
    DisplacementBounds over_levels(FootprintRange cells, const Bound& bound) const;

    // With footprints as they count.
    struct Counted;
    Counted counted(const Points<float>& points) const;
    void ask(const Points<float>& points, const Results<float>& results, CoverageOf coverage,
             bool alone) const;

    std::shared_ptr<const ShotSea> of_;
    SeaAtTime<float> state_;
    BoundsByLevel<float> bounds_{state_.frame(), 0};
    std::optional<Whitecaps> whitecaps_without_past_;
    std::optional<PreparedQuery<float>> query_, without_past_;
    bool is_set_ = false;
    double half_open_s_ = 0.0;
    glm::dvec3 fastest_mps_{0.0};  // no point moves faster along the axes
    mutable std::mutex lock_;      // of members that are made when asked for
    mutable std::unique_ptr<const SurfaceTiles> tiles_;
    mutable std::optional<SurfaceBounds> everywhere_;
    struct Cells {
        View view;
        double error_px;
        bool on_earth;
        double cell_px;
    };
    mutable std::optional<Cells> cells_;
};

// All of the sea that may be in view from there while the shutter is open.
ProjectedGridOptions grid_options(const ShotFrame& frame, double cell_px);

}  // namespace pelagic::procedural
