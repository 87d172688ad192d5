// Tone mapping for C++, and a light's exposure.
#pragma once

#include <glm/vec3.hpp>

#include "core/lighting/sky.h"

namespace pelagic {

// The sRGB display value, 0 … 1, of a radiance. radiance · exposure = 0.18 is middle grey (tone.glsl).
glm::vec3 display_colour(glm::vec3 radiance, float exposure);

// The exposure for a light, > 0 and finite. It depends on the light and not on the picture, so that a camera
// that turns keeps its brightness. A brighter light always gives a brighter picture.
float exposure_for(const Sky& sky);

// That exposure, brighter by `stops`: a factor of 2 for each.
float exposure_for(const Sky& sky, double stops);

}  // namespace pelagic
