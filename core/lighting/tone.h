// Tone mapping for C++, and the exposure for what a picture shows.
#pragma once

#include <array>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace pelagic {

// The sRGB display value, 0 … 1, of a radiance. radiance · exposure = 0.18 is middle grey (tone.glsl).
glm::vec3 display_colour(glm::vec3 radiance, float exposure);

// The same in 8 bits, dithered: rounded up or down with the probability that keeps the mean. Smooth skies would show
// the steps. The random numbers belong to the pixel, and are the same in every frame and picture; black and white
// stay what they are.
std::array<std::uint8_t, 3> display_bytes(glm::vec3 radiance, float exposure, glm::ivec2 pixel);
// Of a display value that is there already.
std::array<std::uint8_t, 3> dithered_bytes(glm::vec3 display, glm::ivec2 pixel);

// Those random numbers, 0 … 1 (1 excluded), one for each component.
glm::vec3 dither(glm::ivec2 pixel);

// From the light's linear sRGB to what is shown where light of this colour temperature [K] is to look as light of 6500 K does
// otherwise: von Kries' adaptation in the cones of Bradford. What has the temperature's own colour keeps its luminance. At 6500 it
// is the identity, to the last bit.
glm::mat3 white_balance(double kelvin);

// The exposure of a photographer's meter that shows this number at ISO 100 (ISO 2720: L = K 2^EV/100, K = 12.5 cd/m²): middle grey
// is a luminance of L.
double exposure_of_ev100(double ev);

// The exposure for pictures whose luminance has this logarithmic mean [kcd/m²], > 0. A brighter light gives a brighter
// picture, but by far less than it is brighter, as the eye adapts.
double exposure_for(double log_mean_luminance);

}  // namespace pelagic
