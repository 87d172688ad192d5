// What is wrong with a sea as a whole: choppiness moves crests together until they cross, troughs may lie under the bed.
#pragma once

#include <string>
#include <vector>

#include "core/plan/prepared_scene.h"

namespace pelagic {

// The share of the surface, by area at rest, whose Jacobian is below 0 with all waves of the spectrum; 0 … 1. From J's first
// three cumulants (core/waves/whitecaps.h).
double folded_share(const DirectionalSpectrum& spectrum, const Choppiness& choppiness);

// What an artist should know of a sea before it is built, a sentence each: a surface that folds over itself on more
// than 5 % of its area, and the choppiness that leaves that much; troughs deeper than the water; explicit tiles whose
// repetition is visible, or whose blending adds more than 5 % of slope; spray that is too thin to be seen; vessels too slow for a wake.
std::vector<std::string> sea_warnings(const PreparedScene& prepared);

}  // namespace pelagic
