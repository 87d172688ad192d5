#include "core/lighting/background.h"

#include <glm/glm.hpp>

namespace pelagic {
namespace behind {

using namespace glm;
// clang-format off
#include "core/lighting/special.glsl"
#include "core/lighting/background.glsl"
// clang-format on

}  // namespace behind

Background background(const Sky& sky, glm::vec3 direction, float pixel_angle) {
    const float share = behind::sun_disc(direction, sky.sun_direction, sky.sun_angular_radius, pixel_angle);
    const glm::vec2 place =
        behind::background_place(sky_map_place(direction), static_cast<float>(sky.map.size()));
    return {sky.map.radiance(place, 0.0f), sky.sun_radiance * share};
}

float pixel_angle(float pixel_tangent, float cos_off_axis) {
    return behind::pixel_angle(pixel_tangent, cos_off_axis);
}

}  // namespace pelagic
