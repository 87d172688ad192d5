// What a picture shows where there is no sea.
#pragma once

#include <glm/vec3.hpp>

#include "core/lighting/sky.h"

namespace pelagic {

struct Background {
    glm::vec3 sky{0.0f}, sun{0.0f};  // radiance of the map at its finest, and of the disc before it
};

// Along a unit direction, for a pixel whose side subtends `pixel_angle` [rad] (background.glsl).
Background background(const Sky& sky, glm::vec3 direction, float pixel_angle);

// Of a pixel that covers `pixel_tangent` in the middle of the picture, this far from its axis.
float pixel_angle(float pixel_tangent, float cos_off_axis);

}  // namespace pelagic
