// The pictures that a scene's masks name (waves.masks[].picture): data of the scene, read from OpenEXR files.
#pragma once

#include <filesystem>
#include <vector>

#include "core/scene/problem.h"
#include "pelagic/scene.h"

namespace pelagic {

// Reads them from a folder into waves.mask_pictures, which keeps no others; masks then have the paths of their files for names.
// What is wrong with each. A file that was read before, is as it was then, and is still some scene's isn't read again.
std::vector<Problem> read_mask_pictures(Waves& waves, const std::filesystem::path& folder);

}  // namespace pelagic
