// Waves that no sea has: steeper than they can stand, or higher than their water is deep.
#pragma once

#include <vector>

#include "core/scene/problem.h"
#include "pelagic/scene.h"

namespace pelagic {

// The values of a valid SeaState (core/scene/validate.h) that ask for such waves, and the heights that are possible.
// It checks swells and sea.significant_height_m, which also needs waves that can have it; WaveSystem::sea itself
// limits what wind and fetch give. Limits are of significant heights: 0.142 λ tanh(k d) with the peak's λ (Miche
// 1944; a single wave there may be no higher), and 0.6 d.
std::vector<Problem> impossible_waves(const SeaState& sea);

// Of a scene whose sea has keys: of each of them.
std::vector<Problem> impossible_waves(const Scene& scene);

// All that is wrong with a scene: what validate() finds or, where that is nothing, impossible waves.
std::vector<Problem> problems_of(const Scene& scene);

}  // namespace pelagic
