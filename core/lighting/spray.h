// Spray before an eye, as a map round its nadir: how high the sea is there, and how much the spray above it dims. spray.glsl says
// how rays go through it.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <optional>
#include <span>
#include <vector>

#include "core/lighting/lighting.h"

namespace pelagic {

// The largest threads of spray at birth [m]: along the wind, across it. spray.glsl has their height.
inline constexpr int kThreadLong_m = 24, kThreadBroad_m = 4;

// spray.glsl has the members.
struct SprayThreads {
    glm::vec4 cell{0.0f}, wind{1.0f, 0.0f, 0.0f, 0.0f}, born{0.0f, 0.0f, 1.0f, 0.0f};
    glm::vec2 names{0.0f};
    float per_m = 0.0f, pixel_rad = 0.0f;
};

// Empty: there is none.
struct Spray {
    int columns = 0, rows = 0;  // at least 2 each
    glm::vec2 azimuth{1.0f, 0.0f};
    float columns_per_rad = 1.0f, first_m = 1.0f, row_step = 0.1f;
    // Torn: ribbons, linear between heights of 0, 1, 2.5 and 5 steps, and haze everywhere. Otherwise spray over each texel. Haze and spray fall off by
    // exp(−z/scale).
    bool is_torn = false;
    float scale_m = 1.0f, step_m = 1.0f;
    float haze_per_m = 0.0f;   // extinction at the surface
    glm::vec2 forward{0.85f};  // mean cosines of what the sun's light is scattered into, half each
    float eye_m = 0.0f, top_m = 0.0f;
    // Its light (light_spray()).
    glm::vec3 to_sun{0.0f, 0.0f, 1.0f}, sun{0.0f}, above{0.0f}, below{0.0f}, low_ahead{0.0f},
        low_beside{0.0f}, low_behind{0.0f};
    SprayThreads threads{};  // none: ribbons are as smooth as the map
    // columns × rows, columns fastest: the surface's height in the axes of the eye's nadir [m], and the extinctions there [1/m]: at the surface, at 1 and
    // at 2.5 steps. Where it is torn, once more as many: how far up ribbons stay there, in steps (SprayRibbons), and nothing.
    std::vector<glm::vec4> texels{};
    bool empty() const { return texels.empty(); }
};

// The light that falls on it, of the terms that are on: from the sun, from the sky, and from a sea of which so much is foam.
void light_spray(Spray& spray, const LightingChoice& choice, const Sky& sky, const WaterBody& water,
                 double foam);

struct SpraySeen {
    float transmittance = 1.0f;
    glm::vec3 scattered{0.0f};
};
// Before what lies in a direction from the eye (unit), at a distance [m]; none: before the sky. on_sea: a place of the sea
// itself. Finite.
SpraySeen spray_before(const Spray& spray, glm::vec3 direction, std::optional<float> distance_m, bool on_sea);

// What ribbons have at a place over what the map says, 1 on average: place_m from the eye's nadir, height_m above where ribbons begin, the map's extinction there [1/m],
// and what a pixel sees [m].
float spray_thread(const Spray& spray, glm::vec2 place_m, float height_m, float extinction_per_m,
                   float pixel_m);

// The radiance that spray so high above the sea at rest sends on in a direction from the eye (unit), where it hides all behind it: of the
// same light, by the same phase function, below the haze there. Finite.
glm::vec3 spray_light(const Spray& spray, glm::vec3 direction, float height_m);

// What an eye sees of radiance[i], of places of the sea, through the spray and the air before them, which see_through() (air.h) has
// counted already. Spray counts as before the air: what it takes of the air's own light is what the air before the spray would have added.
// Its light goes into the layer `air`. Throws std::invalid_argument if the spans differ in length. Without spray nothing changes.
void see_through_spray(const Spray& spray, std::span<const glm::vec3> to_eye,
                       std::span<const float> distance_m, std::span<SeaRadiance> radiance);
// The same of one that is no sea: the sky, or with a distance something else. How much of it is left.
float see_through_spray(const Spray& spray, glm::vec3 direction, std::optional<float> distance_m,
                        SeaRadiance& radiance);

}  // namespace pelagic
