// What the water itself sends back: its reflectance from what is in it.
#pragma once

#include <glm/vec3.hpp>

namespace pelagic {

// What the water itself sends back, as colours: diffuse reflectance just below the surface, linear Rec. 709.
struct WaterBody {
    glm::vec3 reflectance{0.0f};
};

enum class WaterKind {
    Ocean,    // far from land: what is in it comes from plankton alone
    Coastal,  // some sediment and yellow substance of rivers
    Turbid,   // much of both: estuaries, after storms
};

struct WaterChoice {
    WaterKind kind = WaterKind::Ocean;
    double chlorophyll_mg_m3 = 0.1;  // 0 … 100
};

// Formulas and sources: water.cpp. Throws std::invalid_argument for a chlorophyll that is negative, not
// finite, or above 100.
WaterBody water_body(const WaterChoice& choice);

}  // namespace pelagic
