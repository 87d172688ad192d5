// All levels of a sky map in one picture, for hosts whose textures have no mip levels.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
#include <vector>

#include "core/lighting/sky_map.h"

namespace pelagic {

// Level 0 of a map of N × N begins at (0, 0), level k at (N, N − 2 (N >> k)): sky_atlas.glsl reads it so.
struct SkyAtlas {
    glm::ivec2 size{0};               // 3/2 N × N
    std::vector<glm::vec4> texels{};  // x fastest; alpha is 1
};
SkyAtlas sky_atlas(const SkyMap& map);

}  // namespace pelagic
