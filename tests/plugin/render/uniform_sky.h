// A sky without features, for pictures whose light can be told beforehand.
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "core/base/constants.h"
#include "core/lighting/sky.h"

namespace pelagic {

inline constexpr float kSkyRadiance = 5.0f;

// The same radiance from everywhere, the lower hemisphere included, and no sun.
inline Sky uniform_sky() {
    Sky sky;
    sky.map = SkyMap(4, std::vector<glm::vec3>(16, glm::vec3(kSkyRadiance)));
    sky.sky_irradiance = glm::vec3(kSkyRadiance * static_cast<float>(kPi));
    return sky;
}

}  // namespace pelagic
