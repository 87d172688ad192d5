// The sun's disc through the air, from sea level.
#pragma once

#include <glm/vec3.hpp>

namespace pelagic {

// The part of the sun's disc above the horizon.
struct Disc {
    glm::dvec3 radiance{0.0};    // mean over the whole disc, the part below the horizon counted as black
    double elevation_rad = 0.0;  // of the visible part's centre
    glm::dvec3 low{0.0}, middle{0.0}, high{0.0};  // radiance, at the limbs of the visible part and half-way
};

// Integrates strips of equal elevation: near the horizon the lower edge is redder and darker than the upper.
Disc disc_at(double turbidity, double elevation_rad, double radius_rad);

}  // namespace pelagic
