// Sunlight by wavelength, and the colour of a filtered part of it.
#pragma once

#include <array>
#include <glm/vec3.hpp>

namespace pelagic {

inline constexpr int kBands = 16;  // of the visible spectrum, equally wide
// Beyond this range the eye has less than 0.5 % of its response, and the fits (sunlight.cpp) lose the hue.
inline constexpr double kShortest_um = 0.380, kLongest_um = 0.700;  // [μm]
using BandValues = std::array<double, kBands>;

// The centre of a band [μm].
constexpr double band_um(int band) {
    return kShortest_um + (kLongest_um - kShortest_um) * (band + 0.5) / kBands;
}

// Each band's part of the sun's irradiance outside the atmosphere, at the mean distance: linear Rec. 709 in
// klx. Single bands may have negative components (pure colours lie outside the gamut); their sum is the sun's
// colour.
const std::array<glm::dvec3, kBands>& sunlight_colours();

// The colour Σ values[i] · colours[i].
glm::dvec3 colour_of(const BandValues& fraction_of_sunlight);

}  // namespace pelagic
