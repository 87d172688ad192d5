// How much of the foam's past a plan holds.
#pragma once

#include <array>

#include "core/plan/plan.h"

namespace pelagic {

// Tiles by level, as the history of a plan with living foam holds them at most: of all its queries, at two times, or of a plan
// without outputs, for pictures and views, which prepare what they read, at one.
std::array<double, FoamPlan::kLevels> foam_tiles(const Plan& plan);

}  // namespace pelagic
