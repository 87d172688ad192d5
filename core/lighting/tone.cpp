#include "core/lighting/tone.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/glm.hpp>

#include "core/base/random.h"

namespace pelagic {
namespace tone {

using namespace glm;
#include "core/lighting/tone.glsl"

}  // namespace tone

glm::vec3 display_colour(glm::vec3 radiance, float exposure) {
    return tone::display_colour(radiance, exposure);
}

glm::vec3 dither(glm::ivec2 pixel) {
    constexpr std::uint64_t kKey = 0x646974686572;  // "dither": no other use of philox() shares its numbers
    const auto bits =
        philox({static_cast<std::uint32_t>(pixel.x), static_cast<std::uint32_t>(pixel.y), 0, 0}, kKey);
    constexpr float kUnit = 0x1p-24f;
    return {static_cast<float>(bits[0] >> 8) * kUnit, static_cast<float>(bits[1] >> 8) * kUnit,
            static_cast<float>(bits[2] >> 8) * kUnit};
}

std::array<std::uint8_t, 3> display_bytes(glm::vec3 radiance, float exposure, glm::ivec2 pixel) {
    const glm::vec3 shown = 255.0f * display_colour(radiance, exposure) + dither(pixel);
    std::array<std::uint8_t, 3> bytes{};
    for (int c = 0; c < 3; ++c)
        bytes[static_cast<std::size_t>(c)] = static_cast<std::uint8_t>(std::min(shown[c], 255.0f));
    return bytes;
}

double exposure_of_ev100(double ev) {
    constexpr double kCalibration = 12.5e-5;  // K/100 [kcd/m²]
    return 0.18 / (kCalibration * std::exp2(ev));
}

double exposure_for(double log_mean_luminance) {
    // By day a brighter light gives a slightly brighter picture; the display value of a mean of 1 kcd/m² is a little above middle
    // grey, since the bright sky is part of the mean. In twilight the eye adapts and still knows that it is no day: a tenth of
    // the light looks half as bright.
    constexpr double kShown = 0.255, kLeftByDay = 0.13, kLeftAtNight = 0.3;
    const double day = log_mean_luminance * log_mean_luminance;
    return kShown * std::pow(log_mean_luminance, kLeftAtNight - 1.0) *
           std::pow(1.0 + day, 0.5 * (kLeftByDay - kLeftAtNight));
}

}  // namespace pelagic
