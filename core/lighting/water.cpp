// The water body, by what it holds. Its reflectance where it is no more than that: R = 0.33 b_b/a (Morel and Prieur 1977; Darles et al. 2007), here as
// R = 0.33 b_b/(a + b_b), which stays below 0.33 where scattering outweighs absorption. Absorption a and
// backscattering b_b:
//
// water        a: Pope and Fry 1997
//              b_b = ½ 0.00288 m⁻¹ (λ/500 nm)^−4.32, sea water (Morel 1974)
// plankton     a = (a_w + 0.06 A(λ) C^0.65)(1 + 0.2 exp(−0.014(λ − 440))): A and the yellow substance that
// comes with
//              plankton, Prieur and Sathyendranath 1981 in Morel's form of 1991
//              b_b = (0.002 + 0.02(½ − ¼ log₁₀ C) 550/λ) 0.30 C^0.62 (Gordon and Morel 1983, Morel 1988);
//              of a body (0.002 + 0.01(½ − ¼ log₁₀ C)(λ/550)^ν) 0.416 C^0.766, ν = ½(log₁₀ C − 0.3), not above 0
//              (Morel and Maritorena 2001), and in all directions b = 0.416 C^0.766 (λ/550)^ν
// rivers       yellow substance: a = a_y exp(−0.014(λ − 440)) (Bricaud, Morel, Prieur 1981)
//              mineral particles of concentration s: a = 0.041 m²/g s exp(−0.0123(λ − 443)), scattering 0.51
// m²/g s
//              (Babin et al. 2003), of which 0.018 is backscattered (Petzold 1972)
//
// λ in nm, chlorophyll C in mg/m³. The CIE 1931 observer (Gaussians of Wyman, Sloan, Shirley 2013) and the
// primaries of Rec. 709 turn the spectrum into a colour, scaled so that a reflectance of 1 is (1, 1, 1).
#include "core/lighting/water.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <stdexcept>

#include "core/lighting/colour.h"
#include "core/lighting/lighting.h"

namespace pelagic {
namespace {

constexpr std::size_t kSpectrumBands = 31;  // 400, 410 … 700 nm

// [1/m], Pope and Fry 1997.
constexpr std::array<double, kSpectrumBands> kWaterAbsorption{
    0.00663, 0.00473, 0.00454, 0.00495, 0.00635, 0.00922, 0.00979, 0.0106, 0.0127, 0.0150, 0.0204,
    0.0325,  0.0409,  0.0434,  0.0474,  0.0565,  0.0619,  0.0695,  0.0896, 0.1351, 0.2224, 0.2644,
    0.2755,  0.2916,  0.3108,  0.340,   0.410,   0.439,   0.465,   0.516,  0.624};

// Relative to 440 nm, Prieur and Sathyendranath 1981.
constexpr std::array<double, kSpectrumBands> kPlanktonAbsorption{
    0.687, 0.828, 0.913, 0.973, 1.000, 0.944, 0.917, 0.870, 0.798, 0.750, 0.668,
    0.618, 0.528, 0.474, 0.416, 0.357, 0.294, 0.276, 0.291, 0.282, 0.236, 0.252,
    0.276, 0.317, 0.334, 0.356, 0.441, 0.595, 0.502, 0.329, 0.215};

struct Optics {
    double absorption, backscatter, scattering;  // [1/m]; the latter of a body alone
};

// Between the table's wavelengths linear.
double at(const std::array<double, kSpectrumBands>& table, double wavelength) {
    const double place = std::clamp((wavelength - 400.0) / 10.0, 0.0, kSpectrumBands - 1.0);
    const std::size_t below = std::min(static_cast<std::size_t>(place), kSpectrumBands - 2);
    return std::lerp(table[below], table[below + 1], place - static_cast<double>(below));
}

Optics optics_at(double wavelength, const WaterChoice& water) {
    const double c =
        std::max(water.chlorophyll_mg_m3, 0.01);  // the clearest natural water; 0 has no logarithm
    const double a_clear =
        (at(kWaterAbsorption, wavelength) + 0.06 * at(kPlanktonAbsorption, wavelength) * std::pow(c, 0.65)) *
        (1.0 + 0.2 * std::exp(-0.014 * (wavelength - 440.0)));
    const double a = a_clear + water.yellow_per_m * std::exp(-0.014 * (wavelength - 440.0)) +
                     0.041 * water.minerals_g_m3 * std::exp(-0.0123 * (wavelength - 443.0));
    const double sea_water = 0.5 * 0.00288 * std::pow(wavelength / 500.0, -4.32);
    // The brackets are negative above 100 mg/m³: water_body() rejects such water.
    const double few = 0.5 - 0.25 * std::log10(c);
    const double plankton =
        water.has_body
            ? (0.002 +
               0.01 * few * std::pow(wavelength / 550.0, std::min(0.5 * (std::log10(c) - 0.3), 0.0))) *
                  0.416 * std::pow(c, 0.766)
            : (0.002 + 0.02 * few * 550.0 / wavelength) * 0.30 * std::pow(c, 0.62);
    const double minerals = 0.51 * water.minerals_g_m3;
    const double whole_plankton =
        0.416 * std::pow(c, 0.766) * std::pow(wavelength / 550.0, std::min(0.5 * (std::log10(c) - 0.3), 0.0));
    return {a, sea_water + plankton + 0.018 * minerals, 2.0 * sea_water + whole_plankton + minerals};
}

// Of the primaries of Rec. 709 under its white, D65, to the nearest band.
constexpr std::array<double, 3> kDominant_nm{610.0, 550.0, 460.0};

float& band(WaterBands& of, std::size_t i) {
    const int place = static_cast<int>(i % 3);
    return i < 3 ? of.shorter[place] : of.longer[place];
}

}  // namespace

WaterBody water_body(const WaterChoice& choice) {
    const double c = choice.chlorophyll_mg_m3;
    if (!(c >= 0.0 && c <= 100.0)) {
        throw std::invalid_argument("water: give a chlorophyll between 0 and 100 mg/m³");
    }
    WaterBody water;
    for (int channel = 0; channel < 3; ++channel) {
        const Optics at = optics_at(kDominant_nm[channel], choice);
        water.absorption_per_m[channel] = static_cast<float>(at.absorption);
        water.backscatter_per_m[channel] = static_cast<float>(at.backscatter);
    }
    if (!choice.has_body) {
        glm::dvec3 sum(0.0), white(0.0);
        for (std::size_t i = 0; i < kSpectrumBands; ++i) {
            const double wavelength = 400.0 + 10.0 * static_cast<double>(i);
            const glm::dvec3 seen = observed_xyz(wavelength);
            const Optics at = optics_at(wavelength, choice);
            sum += 0.33 * at.backscatter / (at.absorption + at.backscatter) * seen;
            white += seen;
        }
        // Blues outside the gamut have a negative red, which no display shows.
        water.reflectance = glm::max(rec709_of(sum) / rec709_of(white), glm::dvec3(0.0));
        return water;
    }
    water.has_body = true;
    water.floor_m = static_cast<float>(std::min(choice.floor_m, 1e9));
    for (std::size_t i = 0; i < kWaterBands_nm.size(); ++i) {
        const Optics at = optics_at(kWaterBands_nm[i], choice);
        band(water.absorption, i) = static_cast<float>(at.absorption);
        band(water.backscatter, i) = static_cast<float>(at.backscatter);
        band(water.scattering, i) = static_cast<float>(at.scattering);
    }
    water.floor_colour = bands_of(glm::vec3(choice.floor_colour));
    return water;
}

}  // namespace pelagic
