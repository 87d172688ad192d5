// The state of the sea at one time. Whoever uses a Frame owns it and reuses it: its buffers are allocated
// once.
#pragma once

#include <atomic>
#include <memory>
#include <vector>

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

    const Sea<T>& sea() const { return *sea_; }
    double time_s() const { return time_s_; }

    // The samples of transform `transform` of grid `grid` of cascade `cascade`: N × N complex values, x
    // fastest, the first field in the real part and the second in the imaginary part.
    const std::complex<T>* samples(int cascade, int grid, int transform) const {
        return states_[cascade].grids[grid].buffers[transform].data();
    }
    // How many transforms were run since the frame was made: equals set() calls ×
    // plan().transforms_per_frame().
    long executed_transforms() const { return executed_transforms_; }

    // Sums over the modes at this time, filtered as `query` filters its finest positions and normals.
    Realisation realisation(int query) const;

  private:
    struct GridState {
        std::vector<T> prefilter;  // by |m|; empty where the grid is read at its nodes
        std::vector<T> weight;     // by mode: what the footprint lets through
        InverseTransform<T> transform;
        std::vector<TransformBuffer<T>> buffers;
    };
    struct State {
        std::vector<std::complex<T>> height;  // h(k,t)
        std::vector<std::complex<T>> rate;    // ∂h/∂t; empty where nobody asks for velocities
        std::vector<GridState> grids;
    };
    void advance(int cascade);
    // Counts the transform that it has run.
    void fill(int cascade, int grid, int transform, std::atomic<long>& executed);

    std::shared_ptr<const Sea<T>> sea_;
    std::vector<State> states_;
    double time_s_ = 0.0, reduced_time_s_ = 0.0;
    long executed_transforms_ = 0;
    bool is_set_ = false;
};

}  // namespace pelagic
