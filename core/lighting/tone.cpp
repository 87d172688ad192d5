#include "core/lighting/tone.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

#include "core/base/constants.h"
#include "core/lighting/colour.h"

namespace pelagic {
namespace tone {

using namespace glm;
#include "core/lighting/tone.glsl"

}  // namespace tone

glm::vec3 display_colour(glm::vec3 radiance, float exposure) {
    return tone::display_colour(radiance, exposure);
}

float exposure_for(const Sky& sky) {
    // Mean radiance of a clear sky at noon, in kcd/m², and its display value: bright, well above middle grey.
    constexpr double kNoon = 6.0, kNoonShown = 0.5;
    // The exposure compensates for the light's changes to this power only: less light should look darker.
    constexpr double kAdaptation = 0.25;
    constexpr double kDarkest = 1e-3;  // [kcd/m²] deep dusk: the exposure is constant below
    const double mean = luminance(glm::dvec3(sky.sky_irradiance)) / kPi;  // radiance of the upper hemisphere
    const double seen = std::max(mean, kDarkest) / kNoon;
    return static_cast<float>(kNoonShown / kNoon * std::pow(seen, -kAdaptation));
}

float exposure_for(const Sky& sky, double stops) {
    return static_cast<float>(static_cast<double>(exposure_for(sky)) * std::exp2(stops));
}

}  // namespace pelagic
