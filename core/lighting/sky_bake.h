// From radiance by direction to the sky's map and irradiance, for daylight and pictures alike.
#pragma once

#include <functional>
#include <glm/vec3.hpp>

#include "core/lighting/sky_map.h"

namespace pelagic {

// Reflectance of the flat sea under diffuse light (fresnel.glsl).
float diffuse_fresnel();

// Radiance from a unit direction with z ≥ 0, finite and not negative. Called from several threads.
using SkyRadiance = std::function<glm::vec3(glm::vec3 direction)>;

// The upper hemisphere of a sky, for bake_sky_map().
struct SkyDome {
    SkyRadiance radiance;
    // Samples per side, ≥ 1, of a texel centred there that spans `angle` [rad] of sky. Samples stand at the
    // centres of equal squares.
    std::function<int(glm::vec3 direction, float angle)> samples;
    // A dome that is too large to hold is sampled in rings round the zenith, this high [rad]. Before each ring
    // prepare() hears between which angles from the zenith its directions lie.
    double ring = 10.0;  // all of it at once
    std::function<void(double from_zenith, double to_zenith)> prepare = [](double, double) {};
};

struct BakedSky {
    SkyMap map;
    glm::vec3 irradiance{0.0f};  // of the dome, on a horizontal plane: ∫ L cosθ dω over the same samples
};

// Each texel is the mean over its square of u. Radiance below the horizon is diffuse_fresnel() ·
// irradiance/π: rays that go down meet more sea, which reflects the sky (Bruneton et al. 2010, §6). Texels on
// the horizon mix both by area. size: as for SkyMap.
BakedSky bake_sky_map(int size, const SkyDome& dome);
// The same of a sky that varies little over two texels but for the horizon: radiance() is asked once a texel of the sky, and past the horizon. The map's finest
// level passes through it there, and means are of that spline.
BakedSky bake_smooth_sky_map(int size, const SkyRadiance& radiance);

}  // namespace pelagic
