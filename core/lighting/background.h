// The background: what a picture shows where there is no sea.
#pragma once

#include <glm/vec3.hpp>

#include "core/lighting/sky.h"

namespace pelagic {

struct Background {
    glm::vec3 sky{0.0f},
        sun{0.0f};  // radiance of the map's finest level, without the ground, and of the sun's disc
};

// The sun's disc as the shaders take it: towards its middle, and the radiance at its lowest place above
// the horizon, at its highest, and half-way between them.
struct SunDisc {
    glm::vec3 centre{0.0f, 0.0f, 1.0f}, low{0.0f}, middle{0.0f}, high{0.0f};
};
SunDisc sun_disc(const Sky& sky);

// Along a unit direction: without the sun.
glm::vec3 background_sky(const Sky& sky, glm::vec3 direction);
// With it, for a pixel whose side subtends `pixel_angle` [rad].
Background background(const Sky& sky, glm::vec3 direction, float pixel_angle);

// For a pixel with tangent `pixel_tangent` at the picture's centre, at this cosine from the axis.
float pixel_angle(float pixel_tangent, float cos_off_axis);

}  // namespace pelagic
