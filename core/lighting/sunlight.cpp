// The sun as a black body, seen by the CIE 1931 observer.
#include "core/lighting/sunlight.h"

#include <cmath>

#include "core/lighting/colour.h"

namespace pelagic {
namespace {

// The black body that fits the visible part of the extraterrestrial spectrum. (The sun's effective
// temperature, 5772 K, fits its total radiation.)
constexpr double kSunColour_K = 5900.0;
// The luminous solar constant: Darula, Kittler, Gueymard 2005.
constexpr double kSunIlluminance_klx = 133.3;
constexpr double kSecondRadiation_umK = 14387.8;  // hc/k_B

// Planck's law by wavelength, without its constant factor.
double planck(double um) {
    return 1.0 / (std::pow(um, 5.0) * std::expm1(kSecondRadiation_umK / (um * kSunColour_K)));
}

std::array<glm::dvec3, kBands> tabulated() {
    constexpr int kSteps = 64;  // per band: steps of 0.4 nm; the narrowest lobe is 12 nm wide
    std::array<glm::dvec3, kBands> bands{};
    double y = 0.0;
    for (int b = 0; b < kBands; ++b) {
        glm::dvec3 sum(0.0);
        for (int i = 0; i < kSteps; ++i) {
            const double um = band_um(b) + (kLongest_um - kShortest_um) / kBands * ((i + 0.5) / kSteps - 0.5);
            sum += planck(um) * observed_xyz(1e3 * um);
        }
        y += sum.y;
        bands[static_cast<std::size_t>(b)] = rec709_of(sum);
    }
    for (glm::dvec3& band : bands) band *= kSunIlluminance_klx / y;
    return bands;
}

}  // namespace

const std::array<glm::dvec3, kBands>& sunlight_colours() {
    static const std::array<glm::dvec3, kBands> colours = tabulated();
    return colours;
}

glm::dvec3 colour_of(const BandValues& fraction_of_sunlight) {
    const auto& colours = sunlight_colours();
    glm::dvec3 sum(0.0);
    for (std::size_t b = 0; b < colours.size(); ++b) sum += fraction_of_sunlight[b] * colours[b];
    return sum;
}

}  // namespace pelagic
