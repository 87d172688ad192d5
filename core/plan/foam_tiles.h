// How much of the foam's past a plan holds.
#pragma once

#include <array>

#include "core/plan/plan.h"

namespace pelagic {

// Tiles by level, for which the history of a plan with persistent foam has room: of all its queries. A plan without
// outputs is one for pictures and views, which prepare what they read.
std::array<double, FoamPlan::kLevels> foam_tiles(const Plan& plan);

}  // namespace pelagic
