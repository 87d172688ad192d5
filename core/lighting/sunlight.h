// Sunlight by wavelength, and what colour a part of it has.
#pragma once

#include <array>
#include <glm/vec3.hpp>

namespace pelagic {

inline constexpr int kBands = 16;  // of the visible spectrum, equally wide
// Beyond, the eye has less than 0.5 % left, and the fitted functions (sunlight.cpp) no longer the right hue.
inline constexpr double kShortest_um = 0.380, kLongest_um = 0.700;  // [μm]
using BandValues = std::array<double, kBands>;

// The middle of a band [μm].
constexpr double band_um(int band) {
    return kShortest_um + (kLongest_um - kShortest_um) * (band + 0.5) / kBands;
}

// What each band gives to the irradiance of the sun outside of the atmosphere, at the mean distance: linear
// Rec. 709 in klx. A band's share may have negative components (a pure colour is outside of the gamut), their
// sum is the sun's colour.
const std::array<glm::dvec3, kBands>& sunlight_colours();

// Σ values[i] · colours[i], a colour again.
glm::dvec3 colour_of(const BandValues& fraction_of_sunlight);

}  // namespace pelagic
