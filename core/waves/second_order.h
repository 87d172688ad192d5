// What pairs of waves add to a cascade's modes at one time (core/plan/second_order.h).
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "core/base/buffer.h"
#include "core/plan/second_order.h"
#include "core/waves/sea.h"
#include "core/waves/transform.h"

namespace pelagic {

// Of a column of modes, from my = −H up. Null rates: nobody asks for velocities.
template <class T>
struct PairModes {
    int half_height = 0;
    const T *height_re = nullptr, *height_im = nullptr;  // [m]
    const T *rate_re = nullptr, *rate_im = nullptr;      // [m/s]
};

template <class T>
class SecondOrderWaves {
  public:
    // Of a cascade whose plan has a second order; `transform` is of its resolution.
    SecondOrderWaves(std::shared_ptr<const Sea<T>> sea, int cascade, LineTransform<T> transform);

    // The same bits on any number of threads. Returns how many lines it transformed: SecondOrderPlan::lines().
    long set(double time_within_loop_s);

    // Another sea of the same plan, for the times to come.
    void take(std::shared_ptr<const Sea<T>> sea) { sea_ = std::move(sea); }

    int cascade() const { return cascade_; }
    int radius() const { return plan().radius; }
    int reach() const { return plan().reach; }
    PairModes<T> column(int mx) const;  // 0 ≤ mx < reach()

  private:
    struct Plane {
        Buffer<T> re, im;
    };
    struct Modes {
        std::vector<T> re, im;  // by mode of the lattice
    };

    const SecondOrderPlan& plan() const { return *sea_->plan().cascades[cascade_].second_order; }
    std::size_t columns() const { return 2 * static_cast<std::size_t>(radius()) - 1; }
    void sum_columns(int first_mx, int end_mx, double time_s);
    void pair_rows(int first_y, int end_y);
    void take_columns(int first_mx, int end_mx);

    std::shared_ptr<const Sea<T>> sea_;
    int cascade_;
    LineTransform<T> transform_;
    // F, F_x, F_y and G, and their rates behind them: N rows of columns −R < mx < R.
    std::vector<Plane> sums_;
    // z₂ and ∂z₂/∂t: N rows of columns 0 ≤ mx < reach, and what comes of them.
    std::vector<Plane> results_;
    std::vector<Modes> modes_;
    std::vector<std::size_t> first_;  // of each column's modes
};

}  // namespace pelagic
