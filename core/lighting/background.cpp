#include "core/lighting/background.h"

#include <cmath>
#include <glm/glm.hpp>

namespace pelagic {
namespace behind {

using namespace glm;
// clang-format off
#include "core/lighting/special.glsl"
#include "core/lighting/background.glsl"
// clang-format on

}  // namespace behind

SunDisc sun_disc(const Sky& sky) {
    SunDisc disc{.centre = sky.sun_direction,
                 .low = sky.limb_low * sky.sun_radiance,
                 .middle = sky.limb_middle * sky.sun_radiance,
                 .high = sky.limb_high * sky.sun_radiance};
    const glm::vec2 across(sky.sun_direction.x, sky.sun_direction.y);
    if (sky.sun_lower == 0.0f || glm::length(across) < 1e-3f) return disc;
    const float elevation = std::asin(glm::clamp(sky.sun_direction.z, -1.0f, 1.0f)) - sky.sun_lower;
    disc.centre = glm::vec3(glm::normalize(across) * std::cos(elevation), std::sin(elevation));
    return disc;
}

glm::vec3 background_sky(const Sky& sky, glm::vec3 direction) {
    return sky.map.open_radiance(behind::background_place(direction));
}

Background background(const Sky& sky, glm::vec3 direction, float pixel_angle) {
    Background seen{.sky = background_sky(sky, direction)};
    if (sky.sun_radiance == glm::vec3(0.0f)) return seen;
    const SunDisc disc = sun_disc(sky);
    const float share = behind::sun_disc(direction, disc.centre, sky.sun_angular_radius, pixel_angle);
    if (share > 0.0f)
        seen.sun = share * behind::disc_radiance(direction, disc.centre, sky.sun_angular_radius, disc.low,
                                                 disc.middle, disc.high);
    return seen;
}

float pixel_angle(float pixel_tangent, float cos_off_axis) {
    return behind::pixel_angle(pixel_tangent, cos_off_axis);
}

}  // namespace pelagic
