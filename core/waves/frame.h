// The state of the sea at one time. The caller owns a Frame and reuses it: its buffers are allocated once.
#pragma once

#include <array>
#include <atomic>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/base/buffer.h"
#include "core/plan/grid_layout.h"
#include "core/plan/wake_strip.h"
#include "core/scene/limits.h"
#include "core/waves/kernels.h"
#include "core/waves/realisation.h"
#include "core/waves/sea.h"
#include "core/waves/sea_over_time.h"
#include "core/waves/second_order.h"
#include "core/waves/transform.h"
#include "core/waves/vessel_waves.h"

namespace pelagic {

// The samples depend on the sea and on t alone: not on earlier calls of set(), not on the number of threads.
template <class T>
class Frame {
  public:
    explicit Frame(std::shared_ptr<const Sea<T>>);
    // sea() is then that of the frame's time, and each set() gives another where the sea changes.
    explicit Frame(std::shared_ptr<const SeaOverTime<T>>);
    ~Frame();
    Frame(Frame&&) noexcept;
    Frame& operator=(Frame&&) noexcept;

    // Runs the plan's transforms in parallel. t [s] within ± kLatest_s; throws std::invalid_argument otherwise.
    // Another thread may set `cancel`: set() then throws BuildCancelled, and the frame has no time.
    void set(double t_s, const std::atomic<bool>* cancel = nullptr);

    static constexpr double kLatest_s = limits::kTime_s.high;
    bool is_set() const { return is_set_; }
    // Calls of set() since the frame was made, by which those who keep its values notice that they have changed.
    long times_set() const { return times_set_; }

    const Sea<T>& sea() const { return *sea_; }
    const std::shared_ptr<const Sea<T>>& shared_sea() const { return sea_; }
    double time_s() const { return time_s_; }
    double time_within_loop_s() const { return time_within_loop_s_; }  // core/waves/loop.h

    // The samples f(jx, jy) of a field at x = jx L/N and y = jy L/N, stored at jy · line_stride<T>(N) + jx
    // for jy < N and jx < N + kRowSkirt (core/plan/grid_layout.h). Null where the grid doesn't hold the
    // field.
    const T* samples(int cascade, int grid, Field field) const {
        return grids_[cascade][grid].planes[index(field)].data();
    }
    // Where the tile of a vessel's cascade lies: beyond its half side there are none of its waves.
    glm::dvec2 tile_middle_m(int cascade) const { return vessels_[vessel_of(cascade)].middle_m(); }
    // Of a vessel's cascade, the slope variances (xx, xy, yy) round a place in the tile that grid `grid` doesn't show and its finest grid with
    // slopes does, between the means of kSlopeBlocks² blocks of the tile; −1: no grid, which shows none.
    static constexpr int kSlopeBlocks = 32;
    glm::dvec3 hidden_slopes(int cascade, int grid, glm::dvec2 place_m) const;
    // The turbulent wakes of vessels, at the frame's time.
    std::span<const WakeStrip> strips() const { return strips_; }
    // Gives a field's samples back, in whole pages, after their last use. The frame has no time from then on, and set() throws
    // std::logic_error.
    void release(int cascade, int grid, Field field);
    // Counts since construction: 2-D transforms, and the 1-D transforms that they consist of. After n calls
    // of set(): n × plan().transforms_per_frame() and n × plan().lines_per_frame().
    long executed_transforms() const { return executed_transforms_; }
    long executed_lines() const { return executed_lines_; }
    // Bytes of the fields' samples: plan().frame_bytes().
    std::size_t held_bytes() const;

    // Sums over the modes at this time that `query` may resolve, filtered as it filters its finest positions and
    // normals, or with these footprints, which must be no finer.
    Realisation realisation(int query) const;
    Realisation realisation(int query, const Footprints& footprints) const;

  private:
    struct GridState {
        LineTransform<T> transform;
        Buffer<T> prefilter;  // indexed by my + radius − 1; empty where the grid is read at its nodes only
        std::array<std::span<T>, kFieldCount> planes;  // of samples_; empty: none, or given back
    };
    // A few columns of a cascade, processed together so that their spectrum stays in the cache.
    struct Block {
        int cascade, first_mx, columns;
    };
    // A few rows of a field.
    struct Rows {
        int cascade, grid;
        Field field;
        int first, count;
    };
    struct Heights {
        Buffer<T> re, im, rate_re, rate_im;  // [m], [m/s]; no rates where nobody needs them
    };
    struct Scratch;    // of one thread
    struct Scratches;  // of all

    std::size_t vessel_of(int cascade) const {
        return static_cast<std::size_t>(cascade) - (grids_.size() - vessels_.size());
    }
    Scratch& scratch() const;  // of the calling thread
    void advance(const Block&, Scratch&) const;
    // Adds what pairs of waves add to the heights and their rates, beside those of the waves themselves.
    void add_second_order(const Block&, Scratch&) const;
    // Turns their phases by lean_rad() for the horizontal displacement.
    void lean(const Block&, Scratch&) const;
    double lean_rad() const;  // of the time
    // Adds what the amplitudes' own rates are of theirs, leaning where they do.
    void grow(const Block&, Scratch&) const;
    // Leaves the horizontal displacement the share of the planned one that the sea has, with its rate.
    void press(const Block&, Scratch&) const;
    // Both return the number of 1-D transforms.
    long transform_columns(const Block&);
    long transform_rows(const Rows&);
    // The means of a grid's squared slopes over blocks of a vessel's tile.
    std::vector<glm::vec3> squares_of(int cascade, int grid) const;
    // Lets a vessel's tile fade to its border: a grid, and a row of all of its fields.
    void fade(int cascade, int grid);
    void fade_row(int cascade, int grid, int row, const std::vector<TileFade>& along, const TileFade& y);

    std::shared_ptr<const Sea<T>> sea_;
    std::shared_ptr<const SeaOverTime<T>> shot_;  // null: the sea is one
    Kernels<T> kernels_;
    // Of all fields, one after another: in huge pages most of it costs a tenth of the time when it is written first, and planes by
    // themselves are too small for many of those.
    Buffer<T> samples_;
    std::vector<std::vector<GridState>> grids_;  // by cascade
    std::optional<SecondOrderWaves<T>> second_order_;
    std::vector<VesselWaves> vessels_;
    std::vector<std::vector<std::vector<glm::vec3>>>
        squares_;  // by vessel and grid; the first grid's are the finest's
    std::vector<WakeStrip> strips_;
    std::vector<Block> blocks_;  // largest first, so that the threads end together
    std::vector<Rows> rows_;
    std::size_t block_modes_ = 0, line_values_ = 0;  // sizes of a scratch's buffers
    std::unique_ptr<Scratches> scratches_;
    double time_s_ = 0.0, time_within_loop_s_ = 0.0;
    long executed_transforms_ = 0, executed_lines_ = 0, times_set_ = 0;
    bool is_set_ = false, is_whole_ = true;
};

}  // namespace pelagic
