// The simplest scene that still fails as another one does.
#pragma once

#include <functional>

#include "tests/random/random_scene.h"

namespace pelagic::test {

// Keys go back to their defaults, alone and in pairs, lists lose entries, and numbers are rounded, as long as it still
// fails, in at most so many runs.
RandomScene shrunk(RandomScene scene, const std::function<bool(const RandomScene&)>& still_fails,
                   int most_runs = 600);

}  // namespace pelagic::test
