// The front glass of a camera that is in the water or half in it, and the water that climbs it: what shows as a line between water and air.
//
// Against a level wall water rises to the height h at which its surface is inclined by φ, sin φ/2 = h/2l, with the capillary length
// l = √(σ/ρg) (Landau and Lifshitz, Fluid Mechanics, §61), and at the glass by 90° less the contact angle. A sight through this wedge is
// mirrored by its surface from within, which looks down into the water, or refracted out of it, and then looks down at the sea before the
// glass, or at the sky.
#pragma once

#include <glm/vec3.hpp>
#include <span>

#include "core/lighting/lighting.h"

namespace pelagic {

// A camera is in air, behind its front glass: of radiance in the water it sees that part, 1/n², with n as kWaterIndex
// (special.glsl), and of radiance above it all.
inline constexpr float kBehindGlass = 1.0f / (1.34f * 1.34f);

inline constexpr double kCapillary_m = 2.7e-3;  // of sea water, σ = 0.0735 N/m
// As high as it climbs with a contact angle of 30°, as of glass that was wet before.
inline constexpr double kMeniscus_m = kCapillary_m;
// The glass is far out of focus: over so much up and down its edge gives way to what is seen above it, as through an aperture of 2 mm.
inline constexpr double kMeniscusBlur_m = 1e-3;

// The part of a sight that goes through it, by its height on the glass above the level water there [m]: 0 … 1.
float meniscus_share(double height_m);

// A sight (unit) through the glass, and its height there, ≥ 0 (above kMeniscus_m as at that).
struct MeniscusSight {
    glm::vec3 direction{0.0f};
    float height_m = 0.0f;
};

// Writes for sights[i] what a camera behind the glass sees, radiance[i]. height_m: of the eye above the sea at rest, as in shade_water();
// forward (unit): the glass' normal. The sea that is seen through it is level, and the sun's disc isn't seen in it. Throws
// std::invalid_argument if the spans differ in length, or if choice.sky is on and the sky has no map.
void shade_meniscus(const LightingChoice& choice, const Sky& sky, const WaterBody& water, float height_m,
                    glm::vec3 forward, std::span<const MeniscusSight> sights, std::span<SeaRadiance> radiance,
                    const FloorSeen& floor = {});

// a where b's share is 0, b where it is 1.
SeaRadiance mixed(const SeaRadiance& a, const SeaRadiance& b, float share);

}  // namespace pelagic
