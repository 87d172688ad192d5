// What a frame of a bake and a picture cost: what they compute, counted from the plan, times what that takes on a machine.
//
// The recorded times are those of a machine of two cores with AVX-512, fitted to bakes and pictures of the examples (tests/bench,
// bench_cost_model, which prints them anew and how far they are off).
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "core/plan/plan.h"
#include "plugin/render/render.h"

namespace pelagic {

// In millions, but for the first.
enum class Work {
    Frame,          // 1
    Transforms,     // N log₂ N of each line of each transform
    Modes,          // that fill the grids, for each field
    Reads,          // of a grid's node at a point, for each field
    Trains,         // that a point adds up
    Answers,        // numbers that points have in the end
    Foam,           // the past of a cell's corner, in one interval
    SeaByLookups,   // samples of a picture that show the sea, with one or nine lookups of the sky
    SeaByIntegral,  // with the integral
    Sky,            // samples that show it
    SprayTexels,    // of the map of the spray, anew at each moment
    SpraySamples,   // that look into it
    FloorTexels,    // of the sun's light on the floor, anew at each moment
};
inline constexpr std::size_t kWorkCount = 13;
// Of the sea in single precision: double counts as more.
using WorkDone = std::array<double, kWorkCount>;

// [ms] of each Work.
using Rates = std::array<double, kWorkCount>;
const Rates& recorded_rates();

// Of a frame of a bake: the sea, all outputs' points, and of the foam's past what a frame of a run adds to the one before, or all
// of it where the shot has one frame. Without what is encoded and written.
WorkDone work_of(const Plan& plan);

// Of a picture of a run by this plan (picture_plan() of of_samples(), whatever its lookups of the sky), the frame that shows the
// most water. With a shutter the sea is computed once more for each sample of a pixel, but its foam's past is gone through
// once. Without what is encoded and written.
WorkDone picture_work(const Plan& plan, std::span<const int> frames, const RenderOptions& options);

double cost_ms(const WorkDone& work, const Rates& rates = recorded_rates());

}  // namespace pelagic
