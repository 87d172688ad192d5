// What a frame of a plan costs, from what it computes: never from a clock, so that every machine of a farm plans alike.
//
// The milliseconds are those of a machine of two cores with AVX-512, fitted to bakes of the examples (tests/bench,
// bench_cost_model, which prints the numbers below anew and how far they are off).
#pragma once

#include <array>
#include <cstddef>

#include "core/plan/plan.h"

namespace pelagic {

// In millions, but for the first.
enum class Work {
    Frame,       // 1
    Transforms,  // N log₂ N of each line of each transform
    Modes,       // that fill the grids, for each field
    Reads,       // of a grid's node at a point, for each field
    Trains,      // that a point adds up
    Answers,     // numbers that points have in the end
    Foam,        // the past of a cell's corner, in one interval
};
inline constexpr std::size_t kWorkCount = 7;
using WorkDone = std::array<double, kWorkCount>;

WorkDone work_of(const Plan& plan);
double cost_ms(const WorkDone& work, bool double_precision);

// Of a frame: the sea, all outputs' points, and of the foam's past what a frame of a run adds to the one before, or all of it where
// the shot has one frame. Without what is encoded, written, and lit.
double frame_ms(const Plan& plan);

}  // namespace pelagic
