// What a cascade's modes hold of a query's moments, through each of its footprints: sums over the lattice.
//
// A footprint lets the longest waves through whole and the shortest not at all; between the two lies one
// octave of wavelength. So a mode is added once, to the ring of wavevectors that it lies in, and once more
// for each footprint whose octave it lies in, with its weight. The rings are the same for every cascade and
// footprint: a pair of footprints has the same sum, to the bit, whatever else is asked for.
#pragma once

#include <vector>

#include "core/plan/filter.h"
#include "core/spectrum/spectral_moments.h"
#include "core/waves/mode_kernels.h"

namespace pelagic {

// Two footprints [m] whose weights are multiplied, and their sum. 0 lets everything pass. Only modes with mx² + my² <
// radius² are resolved.
struct FootprintPair {
    double a_m = 0.0, b_m = 0.0;
    int radius = 0;
    SpectralMoments* sum = nullptr;
};

class LevelSums {
  public:
    // Of modes (mx, my)·2π/size_m with mx² + my² < radius², the largest of the pairs' or more.
    LevelSums(double size_m, int radius, const FootprintFilter& filter, std::vector<FootprintPair> pairs);

    // The sums of some columns; zero at first.
    using Part = std::vector<MomentLanes>;
    Part part() const { return Part(rings_.size() + slots_.size(), MomentLanes{}); }

    // Adds column mx, height = half_height(radius, mx).
    void add(void (*moments)(const MomentArgs&), const ColumnSums& column, int mx, int height,
             Part& part) const;

    // Adds up the parts, in their order, into each pair's sum. Returns the sum over all modes without weights.
    SpectralMoments finish(const std::vector<Part>& parts) const;

  private:
    struct Slot {
        double a_m, b_m;
        int radius;
        std::size_t whole_rings;  // let through whole by both
        double from, end;         // the rest: from ≤ mx² + my² < end
    };
    double step_;
    FootprintFilter filter_;
    std::vector<double> rings_;  // mx² + my² of their outer ends, rising
    std::vector<Slot> slots_;
    std::vector<FootprintPair> pairs_;
    std::vector<std::size_t> slot_of_pair_;
};

}  // namespace pelagic
