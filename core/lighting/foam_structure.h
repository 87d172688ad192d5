// The pattern of foam (foam_structure.glsl), for points relative to an origin in double.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <memory>

#include "core/lighting/foam_image.h"

namespace pelagic {

// The largest cells of the pattern, across the wind [m].
inline constexpr int kFoamCell_m = 32;

// What a shot asks for.
struct FoamLook {
    std::shared_ptr<const FoamImage> image{};  // the artist's pattern, in place of the own one
    double image_m = 10.0;                     // the side of it
    double structure = 0.0;                    // 0: smooth coverage … 1: lace
    double streaks = 0.0;                      // 0 … 1, along the wind
    double wind_direction_deg = 0.0;           // blowing towards, counter-clockwise from +x
    std::uint64_t seed = 0;                    // each sea has its pattern elsewhere
    // Of foam where waves break, and of what they leave: the share of its area that it hides (the mean over a law's foam is
    // Koepke's 0.4), and what that reflects.
    float fresh_opacity = 0.4f, old_opacity = 0.4f;
    float fresh_albedo = 0.55f, old_albedo = 0.55f;
};

// foam_structure.glsl has the members.
struct FoamPattern {
    glm::vec3 cell{0.0f}, rest{0.0f};
    glm::vec4 axes{1.0f, 0.0f, 0.0f, 0.0f}, look{0.0f, 0.0f, 0.4f, 0.4f};
    glm::vec2 white{0.55f, 0.55f};
    glm::vec4 image{0.0f};
    const FoamImage* picture = nullptr;  // the look's
};

// For points at rest relative to that origin, which may be anywhere that a double can tell millimetres. The pattern stays where
// it is for any origin.
FoamPattern foam_pattern(const FoamLook& look, glm::dvec2 origin_m);

}  // namespace pelagic
