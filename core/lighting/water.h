// The optics of the water body, from what it contains.
#pragma once

#include <glm/vec3.hpp>

namespace pelagic {

struct WaterBody {
    glm::vec3 reflectance{0.0f};  // diffuse, just below the surface, linear Rec. 709
    // For hosts that trace light through the water [1/m], at the dominant wavelengths of the primaries of Rec. 709: a
    // broader mean of such steep spectra has no colour that a display shows. Isotropic scattering of twice the
    // backscatter sends as much back.
    glm::vec3 absorption_per_m{0.0f}, backscatter_per_m{0.0f};
};

enum class WaterKind {
    Ocean,    // far from land: the optics depend on plankton alone
    Coastal,  // some sediment and yellow substance from rivers
    Turbid,   // much of both: estuaries, after storms
};

struct WaterChoice {
    WaterKind kind = WaterKind::Ocean;
    double chlorophyll_mg_m3 = 0.1;  // 0 … 100
};

// Formulas and sources: water.cpp. Throws std::invalid_argument for a chlorophyll that is negative, above 100
// or not finite.
WaterBody water_body(const WaterChoice& choice);

}  // namespace pelagic
