// From radiance by direction to the sky's map and its irradiance: what daylight and pictures share.
#pragma once

#include <functional>
#include <glm/vec3.hpp>

#include "core/lighting/sky_map.h"

namespace pelagic {

// Mean reflectance of the flat sea under diffuse light (fresnel.glsl).
float diffuse_fresnel();

// The upper hemisphere of a sky, for bake_sky_map().
struct SkyDome {
    // Radiance from a unit direction with z ≥ 0, finite and not negative. Called from several threads.
    std::function<glm::vec3(glm::vec3 direction)> radiance;
    // How many samples a side a texel needs whose middle lies there and which spans `angle` [rad] of sky, at
    // least 1: the mean over the texel is the mean over their middles.
    std::function<int(glm::vec3 direction, float angle)> samples;
};

struct BakedSky {
    SkyMap map;
    glm::vec3 irradiance{0.0f};  // of the dome, on a horizontal plane: ∫ L cosθ dω over the same samples
};

// Each texel is the mean over its square of u. Below the horizon radiance is diffuse_fresnel() ·
// irradiance/π: what looks down there sees more of the sea, which reflects the sky (Bruneton et al. 2010,
// §6). Texels that the horizon crosses are mixed by their areas on either side. size: as SkyMap's.
BakedSky bake_sky_map(int size, const SkyDome& dome);

}  // namespace pelagic
