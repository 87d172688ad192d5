// The spray's large drops before a camera (core/effects/spray_drops.h): parcels as soft discs in the picture.
#pragma once

#include <cstddef>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "core/effects/spray_drops.h"
#include "core/lighting/air.h"
#include "core/lighting/spray.h"
#include "core/plan/memory.h"
#include "core/surface/view.h"

namespace pelagic {

// As far from the eye drops are seen one by one, to this share; what the rest holds is in the veil.
inline constexpr double kDropsReach_m = 96.0;
inline constexpr double kDropsSquare_m = 2.0 * kDropsReach_m;  // the side of what is asked of SprayDrops
double drops_share(double distance_m);
// Of a single one: those at the eye itself, which would fill the picture, aren't seen.
double parcel_share(double distance_m);
// Whether that camera sees some, in a picture that has spray: its map then lacks them.
bool are_drops_near(const Scene& scene, const View& view);
// What they hold, of a picture that has spray.
void add_seen_drops(MemoryNeed& need, const Plan& plan);

struct SeenDrop {
    glm::dvec2 at_px{0.0};  // in the view's pixels, as View::direction() takes them
    double radius_px = 1.0;
    double section_px2 = 0.0;  // extinction
    float distance_m = 0.0f;   // from the eye
    float depth_m = 0.0f;      // half of how deep the parcel is: the sea cuts it softly
    glm::vec3 radiance{0.0f};  // through the air and the spray before it, where it hides all

    // As if spread evenly over the disc.
    float thickness() const;
    // How much of the light from behind it a place of the picture loses, behind which the sea is so far from the eye.
    float hides(glm::dvec2 place_px, float sea_m) const;
};

struct DropsEye {
    const View& view;
    double curvature_per_m = 0.0;
    const Air* air = nullptr;  // before it; null: none
    const Spray& spray;        // before it, with its light
    double late_s = 0.0;       // so long ago the drops were there: they have flown on straight
};
// Those that the view may show, the farthest first.
std::vector<SeenDrop> seen_drops(std::span<const SprayDrop> drops, const DropsEye& eye);

}  // namespace pelagic
