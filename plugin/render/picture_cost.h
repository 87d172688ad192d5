// What a picture costs, from what it computes: never from a clock, so that every machine of a farm chooses alike.
//
// The milliseconds are those of core/plan/cost_model.h for the sea, and for its light fitted beside them (tests/bench,
// bench_cost_model).
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "core/plan/cost_model.h"
#include "core/scene/scene.h"
#include "plugin/render/render.h"

namespace pelagic {

// In millions.
enum class LightWork {
    SeaByLookups,   // samples that show the sea, with one or nine lookups of the sky
    SeaByIntegral,  // with the integral
    Sky,            // samples that show it
    SprayTexels,    // of the map of the spray, anew at each moment
    SpraySamples,   // that look into it
};
inline constexpr std::size_t kLightWorkCount = 5;
using LightWorkDone = std::array<double, kLightWorkCount>;

struct PictureWork {
    WorkDone sea{};
    LightWorkDone light{};
    bool double_precision = false;
};

// Of a picture of a run by this plan (picture_plan() of of_samples(), whatever its lookups of the sky), the frame that shows the
// most water. With a shutter the sea is computed once more for each sample of a pixel, but its foam's past is gone through
// once. Without what is encoded and written.
PictureWork picture_work(const Plan& plan, std::span<const int> frames, const RenderOptions& options);

double picture_ms(const PictureWork& work);

}  // namespace pelagic
