// Tone mapping for C++, and the exposure that goes with a light.
#pragma once

#include <glm/vec3.hpp>

#include "core/lighting/sky.h"

namespace pelagic {

// What a screen shows of a radiance: sRGB, 0 … 1. radiance · exposure = 0.18 is middle grey (tone.glsl).
glm::vec3 display_colour(glm::vec3 radiance, float exposure);

// The exposure for a light, > 0 and finite: of the light alone and not of the picture, so that a shot whose
// camera turns keeps its brightness. A brighter light is always shown brighter.
float exposure_for(const Sky& sky);

// The exposure for `stops` more than that: twice for each.
float exposure_for(const Sky& sky, double stops);

}  // namespace pelagic
