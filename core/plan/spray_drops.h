// The large drops of the spray as particles (SprayLaw::drops): where and when parcels of them start, and which sea says so.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>

#include "core/plan/plan.h"

namespace pelagic {

// Parcels start from cells of the sea at rest, in intervals of absolute time.
struct SprayDropsPlan {
    static constexpr double kFinestCell_m = 1.0;
    static constexpr double kMostCells =
        256.0;  // along a side of what is asked for: further on they are wider
    static constexpr double kMostCellsInAll = 512.0;  // likewise along what they may come from
    static constexpr double kMostParcels_per_s = 3.0;
    static constexpr int kMostParcels =
        24;  // of a cell in an interval; where more breaks, each stands for more drops
    static constexpr double kLongestLife_s = 2.5;

    double cell_m = kFinestCell_m;
    double parcels_per_s = kMostParcels_per_s;  // of a cell, on average over the sea
    double interval_s = 0.25;
    std::int64_t intervals_a_loop = 0;  // 0: no loop

    // Intervals in which what is in the air may have started.
    int intervals() const;
    // How far the wind, and waves, may carry a parcel from its cell, downwind and to any side [m].
    double downwind_m = 0.0, around_m = 0.0;
};

// Of a square with this side [m].
SprayDropsPlan plan_spray_drops(const PreparedScene& from, double size_m);

// The sea that those cells see. Trains are the plan's: which there are depends on all that is asked of the sea.
Plan plan_of_spray_drops(const Plan& plan, const SprayDropsPlan& drops);

// What all that holds, over a square [bytes]: that sea, a frame of it, and the parcels of all intervals, in expectation.
std::size_t spray_drops_bytes(const Plan& plan, const SprayDropsPlan& drops, double size_m);

}  // namespace pelagic
