// Pierson, Neumann & James 1955: cos² of the angle to the wind, nothing against it, at every frequency.
#pragma once

#include "core/spectrum/angular.h"

namespace pelagic {

struct CosineSpreading {
    CosineSquared at(double) const { return {}; }
};

}  // namespace pelagic
