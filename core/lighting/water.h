// The colour of the water body, from what it contains.
#pragma once

#include <glm/vec3.hpp>

namespace pelagic {

// Diffuse reflectance just below the surface, linear Rec. 709.
struct WaterBody {
    glm::vec3 reflectance{0.0f};
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
