// The pattern of foam (foam_structure.glsl), for points relative to an origin in double.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

namespace pelagic {

// The largest cells of the pattern, across the wind [m].
inline constexpr int kFoamCell_m = 32;

// What a shot asks for.
struct FoamLook {
    double structure = 0.0;           // 0: smooth coverage … 1: lace
    double streaks = 0.0;             // 0 … 1, along the wind
    double wind_direction_deg = 0.0;  // blowing towards, counter-clockwise from +x
    // The part of the foam that is dense where waves break, and in what they leave; the mean over a law's foam is
    // Koepke's 0.4.
    float dense_active = 0.4f, dense_left = 0.4f;
};

// foam_structure.glsl has the members.
struct FoamPattern {
    glm::vec3 cell{0.0f}, rest{0.0f};
    glm::vec4 axes{1.0f, 0.0f, 0.0f, 0.0f}, look{0.0f, 0.0f, 0.4f, 0.4f};
};

// For points at rest relative to that origin, which may be anywhere that a double can tell millimetres. The pattern stays where
// it is for any origin.
FoamPattern foam_pattern(const FoamLook& look, glm::dvec2 origin_m);

}  // namespace pelagic
