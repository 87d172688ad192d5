// The state of the sea at one time. Whoever uses a Frame owns it and reuses it: its buffers are allocated
// once.
#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <array>
#include <memory>
#include <vector>

#include "core/base/buffer.h"
#include "core/plan/grid_layout.h"
#include "core/waves/kernels.h"
#include "core/waves/realisation.h"
#include "core/waves/sea.h"
#include "core/waves/transform.h"

namespace pelagic {

// Frame f's content depends on the sea and on t alone, not on what was computed before or on the number of
// threads.
template <class T>
class Frame {
  public:
    explicit Frame(std::shared_ptr<const Sea<T>>);

    // t [s] within ± kLatest_s; throws std::invalid_argument otherwise. Runs the plan's transforms, several
    // side by side.
    void set(double t_s);

    static constexpr double kLatest_s = 1e12;  // a phase in cycles then still has four digits after the point
    bool is_set() const { return is_set_; }
    // Calls of set() since the frame was made: who keeps what it held knows by it that this has changed.
    long times_set() const { return times_set_; }

    const Sea<T>& sea() const { return *sea_; }
    double time_s() const { return time_s_; }
    double time_within_loop_s() const { return time_within_loop_s_; }  // core/waves/loop.h

    // The samples f(jx, jy) of a field of a cascade's grid, at jy · line_stride<T>(N) + jx, jx < N +
    // kRowSkirt (core/plan/grid_layout.h), jy < N, at x = jx L/N and y = jy L/N. Null where the grid doesn't
    // hold it.
    const T* samples(int cascade, int grid, Field field) const {
        const Buffer<T>& plane = grids_[cascade][grid].planes[index(field)];
        return plane.empty() ? nullptr : plane.data();
    }
    // How many of a field's transforms, and of the lines that they are made of, were run since the frame was
    // made: set() calls × plan().transforms_per_frame(), × plan().lines_per_frame().
    long executed_transforms() const { return executed_transforms_; }
    long executed_lines() const { return executed_lines_; }
    // What the fields' samples take: plan().frame_bytes().
    std::size_t held_bytes() const;

    // Sums over the modes at this time, filtered as `query` filters its finest positions and normals.
    Realisation realisation(int query) const;

  private:
    struct GridState {
        LineTransform<T> transform;
        Buffer<T>
            prefilter;  // by my from 1 − radius to radius − 1; empty where the grid is read at its nodes
        std::array<Buffer<T>, kFieldCount> planes;
    };
    // A few of a cascade's columns: what is done at once, so that the spectrum never leaves the cache.
    struct Block {
        int cascade, first_mx, columns;
    };
    // A few of a field's rows.
    struct Rows {
        int cascade, grid;
        Field field;
        int first, count;
    };
    struct Scratch {                                                              // of one thread
        Buffer<T> height_re, height_im, rate_re, rate_im, through, chop_through;  // by mode of a block
        Buffer<T> line, lines;  // one line before its transform, a block's afterwards
    };

    Scratch& scratch() const;  // this thread's
    void advance(const Block&, Scratch&) const;
    // Both return how many lines they have transformed.
    long transform_columns(const Block&);
    long transform_rows(const Rows&);

    std::shared_ptr<const Sea<T>> sea_;
    Kernels<T> kernels_;
    std::vector<std::vector<GridState>> grids_;  // by cascade
    std::vector<Block> blocks_;                  // the largest first, so that small ones fill the gaps
    std::vector<Rows> rows_;
    std::size_t block_modes_ = 0, line_values_ = 0;  // the most that a scratch must hold
    mutable tbb::enumerable_thread_specific<Scratch> scratches_;
    double time_s_ = 0.0, time_within_loop_s_ = 0.0;
    long executed_transforms_ = 0, executed_lines_ = 0, times_set_ = 0;
    bool is_set_ = false;
};

}  // namespace pelagic
