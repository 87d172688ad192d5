// The optics of the water body, from what it contains.
#pragma once

#include <array>
#include <glm/vec3.hpp>

namespace pelagic {

// Values at 440, 480, 520 nm and at 555, 590, 630 nm. One wavelength for each channel errs by 0.07 in a path's transmittance, six by 0.006.
struct WaterBands {
    glm::vec3 shorter{0.0f}, longer{0.0f};
    bool operator==(const WaterBands&) const = default;
};

// [nm]
inline constexpr std::array<double, 6> kWaterBands_nm{440.0, 480.0, 520.0, 555.0, 590.0, 630.0};

struct WaterBody {
    glm::vec3 reflectance{
        0.0f};  // diffuse, just below the surface, linear Rec. 709; of a body under a sky, with its floor
    // For hosts that trace light through the water [1/m], at the dominant wavelengths of the primaries of Rec. 709: a
    // broader mean of such steep spectra has no colour that a display shows. Isotropic scattering of twice the
    // backscatter sends as much back.
    glm::vec3 absorption_per_m{0.0f}, backscatter_per_m{0.0f};

    // Without a body the water is the constant reflectance, lit through a level surface. With one (water.glsl) light enters through a
    // rough surface, depends on the ways of sun and eye, and comes back from a floor, through crests and from bubbles.
    bool has_body = false;
    WaterBands absorption{}, backscatter{};  // [1/m]
    WaterBands scattering{};                 // in all directions [1/m], for eyes in the water
    WaterBands floor_colour{};               // its reflectance
    float floor_m = 1e9f;                    // how deep it lies; 1e6 and more: there is none
    glm::vec3 waves{1e-10f, 1e-10f, 0.0f};   // slope variances of all waves: xx, yy, xy
    float crest_light = 0.0f;                // times what waves' shape does to the sun's light in the water
    float crest_per_m = 0.0f;                // wavenumber of the waves that have crests [1/m]; 0: none
    float bubbles = 0.0f;                    // times the bubbles' backscatter
    float bubbles_m = 0.0f;                  // their depth, e-folding
    bool operator==(const WaterBody&) const = default;
};

struct WaterChoice {
    double chlorophyll_mg_m3 = 0.1;  // 0 … 100
    double yellow_per_m = 0.0;       // absorption of yellow substance from rivers, at 440 nm
    double minerals_g_m3 = 0.0;      // mineral particles
    bool has_body = false;
    glm::dvec3 floor_colour{0.0};  // of a body's floor: 0 … 1, linear Rec. 709
    double floor_m = 1e9;          // > 0
};

// The optics of such water: of a body all but its waves, crests and bubbles, which are the sea's. Formulas and sources: water.cpp. Throws
// std::invalid_argument for a chlorophyll that is negative, above 100 or not finite.
WaterBody water_body(const WaterChoice& choice);

}  // namespace pelagic
