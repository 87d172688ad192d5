// The picture of depths that waves.coast names by sea.depth_file.
#pragma once

#include <vector>

#include "core/scene/problem.h"
#include "pelagic/scene.h"

namespace pelagic {

// Reads it into waves.coast_depths where the scene has waves.coast and a picture, and leaves none otherwise.
// Returns what is wrong with a file, and has then read none.
std::vector<Problem> read_coast_depths(Scene& scene);

}  // namespace pelagic
