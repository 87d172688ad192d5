// Which waves a frame takes to second order, and with what (core/spectrum/second_order.h).
//
// The sums over pairs are no sums of waves; with kernels that are products they are products of sums. Of L^± in deep water
// Longuet-Higgins's have the factors 1 ± cos θ, and of the rest √(k_i k_j) is nearly all where most energy is (the height that
// pairs add has a correlation of 0.95 … 0.99 with the exact one; tests/bench/README.md). So
//   z₂ = ¼ [d (|F|² + |F_x|² + |F_y|²) + s Re(F² − F_x² − F_y²) + w Re(G²)],
// with F = Σ √k a e^{iψ}, F_x and F_y with k̂'s components besides, G with the root of shallow_wavenumber(), and d, s and w such
// that the skewness is that of the exact kernels and of all waves.
#pragma once

#include <cstddef>

#include "core/spectrum/second_order.h"

namespace pelagic {

// As it is computed: by complex transforms of a cascade's longest waves.
struct SecondOrderPlan {
    int radius = 0;  // modes with mx² + my² < radius² are paired
    int reach = 0;   // those with mx² + my² < reach² take what pairs add; radius or more
    int resolution =
        0;  // N of the transforms: 2 radius + reach at least, so that no product is mistaken for another
    double depth_m = 0.0;
    double difference = 0.0, sum = 0.0, shallow = 0.0;  // d/4, s/4, w/4, choppiness and gain included
    bool moves = false;                                 // whether somebody asks for vertical velocities
    double skewness = 0.0;                              // that these make, E[η³]/m0^{3/2}

    int sums() const { return (shallow > 0.0 ? 4 : 3) * (moves ? 2 : 1); }
    // What comes of them, and its rate: one by itself, so that nobody's heights depend on who asks for velocities.
    int results() const { return moves ? 2 : 1; }
    int transforms() const { return sums() + results(); }
    // One-dimensional transforms: along y of the columns that hold modes, along x of all rows, and for real results back.
    long lines() const {
        return static_cast<long>(sums()) * (2L * radius - 1 + resolution) +
               static_cast<long>(results()) * (reach + resolution);
    }
    std::size_t bytes(bool double_precision) const;  // of a frame, beside what a thread works on
};

// The bins that a cascade holds whose modes lie within the largest radius, and the radius within which they do; none: 0 bins.
class SecondOrderBand {
  public:
    SecondOrderBand(const SecondOrder& pairs, double k_lower, double k_upper, double size_m,
                    int largest_radius);

    int bins() const { return last_ - first_; }
    int radius() const { return radius_; }
    // Without its resolution.
    SecondOrderPlan plan(const SecondOrder& pairs, double gain, bool moves, double depth_m) const;

  private:
    int first_ = 0, last_ = 0, radius_ = 0, largest_radius_ = 0;
};

}  // namespace pelagic
