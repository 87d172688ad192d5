#include "core/lighting/tone.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/glm.hpp>

#include "core/base/random.h"
#include "core/lighting/primaries.h"

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
    return dithered_bytes(display_colour(radiance, exposure), pixel);
}

std::array<std::uint8_t, 3> dithered_bytes(glm::vec3 display, glm::ivec2 pixel) {
    const glm::vec3 shown = 255.0f * display + dither(pixel);
    std::array<std::uint8_t, 3> bytes{};
    for (int c = 0; c < 3; ++c)
        bytes[static_cast<std::size_t>(c)] = static_cast<std::uint8_t>(std::clamp(shown[c], 0.0f, 255.0f));
    return bytes;
}

namespace {

// Of Planck's radiator, Y = 1: Krystek 1985, "An algorithm to calculate correlated colour temperature", in CIE 1960 (u, v); within
// 1e-4 from 1000 to 15 000 K.
glm::dvec3 planckian_xyz(double kelvin) {
    const double t = kelvin, t2 = kelvin * kelvin;
    const double u = (0.860117757 + 1.54118254e-4 * t + 1.28641212e-7 * t2) /
                     (1.0 + 8.42420235e-4 * t + 7.08145163e-7 * t2),
                 v = (0.317398726 + 4.22806245e-5 * t + 4.20481691e-8 * t2) /
                     (1.0 - 2.89741816e-5 * t + 1.61456053e-7 * t2);
    // x = 3u/(2u − 8v + 4), y = 2v/(2u − 8v + 4)
    return {1.5 * u / v, 1.0, (4.0 - u - 10.0 * v) / (2.0 * v)};
}

}  // namespace

glm::mat3 white_balance(double kelvin) {
    // Written by rows: IEC 61966-2-1.
    const glm::dmat3 xyz_of_rgb =
        glm::transpose(glm::dmat3(0.4123907993, 0.3575843394, 0.1804807884, 0.2126390059, 0.7151686788,
                                  0.0721923154, 0.0193308187, 0.1191947798, 0.9505321522));
    const glm::dmat3 cones_of_rgb = bradford() * xyz_of_rgb;
    constexpr double kNeutral = 6500.0;
    const glm::dvec3 gain = bradford() * planckian_xyz(kNeutral) / (bradford() * planckian_xyz(kelvin)) - 1.0;
    glm::dmat3 change(0.0);
    for (int i = 0; i < 3; ++i) change[i][i] = gain[i];
    return glm::mat3(glm::dmat3(1.0) + glm::inverse(cones_of_rgb) * change * cones_of_rgb);
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
