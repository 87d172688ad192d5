// How much spray a place has: the law's (core/plan/spray.h) times what breaks now there over what breaks now on average.
#pragma once

#include "core/waves/sea.h"

namespace pelagic {

// The share of the sea's area that breaks now, in expectation: the mean of evaluate()'s coverage, without what
// earlier breaking has left (core/effects/foam_history.h). 0 where no wave breaks. In the mean wind.
template <class T>
double mean_breaking(const Sea<T>& sea);

// The law's extinction at the surface over mean_breaking(): multiplied by evaluate()'s coverage it is a place's own
// [1/m]. 0 without spray, and where no wave breaks.
template <class T>
double spray_extinction_per_coverage(const Sea<T>& sea);

}  // namespace pelagic
