// The spray's large drops before a camera (core/effects/spray_drops.h): parcels as soft discs in the picture.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "core/effects/spray_drops.h"
#include "core/lighting/air.h"
#include "core/lighting/spray.h"
#include "core/surface/view.h"

namespace pelagic {

// As far from the eye drops are seen one by one, to this share; what the rest holds is in the veil.
inline constexpr double kDropsReach_m = 96.0;
double drops_share(double distance_m);
// Of a single one: those at the eye itself, which would fill the picture, aren't seen.
double drop_share(double distance_m);

struct SeenDrop {
    glm::dvec2 at_px{0.0};  // in the view's pixels, as View::direction() takes them
    double radius_px = 1.0;
    double section_px2 = 0.0;  // extinction
    float distance_m = 0.0f;   // from the eye
    float depth_m = 0.0f;      // half of how deep the parcel is: the sea cuts it softly
    glm::vec3 radiance{0.0f};  // through the air and the spray before it, where it hides all

    // How much of the light from behind it a place of the picture loses, behind which the sea is so far from the eye.
    float hides(glm::dvec2 place_px, float sea_m) const;
};

// Those that the view may show, the farthest first. The spray has its light.
std::vector<SeenDrop> seen_drops(std::span<const SprayDrop> drops, const View& view, double curvature_per_m,
                                 const Air* air, const Spray& spray);

}  // namespace pelagic
