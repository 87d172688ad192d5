// Caustics: what waves make of the sun's light on a plane or a floor below them (core/lighting/floor.h), and on a plane above, to which they
// mirror it.
#pragma once

#include <atomic>
#include <cstddef>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <span>

#include "core/lighting/floor.h"
#include "core/waves/frame.h"

namespace pelagic {

// The sun, and the slope variances xx, yy, xy of all waves that it shines through (WaterBody::waves).
struct SunThroughWaves {
    glm::vec3 to_sun{0.0f, 0.0f, 1.0f};  // unit
    float angular_radius = 0.0f;         // [rad]
    glm::vec3 waves{0.0f};
    bool is_mirrored = false;  // by their surface, upwards; else it is refracted, downwards
    bool operator==(const SunThroughWaves&) const = default;
};

// How much of the pattern shows, 0 … 1: near the horizon hardly any of the sun's light gets in, and the pattern goes by then, rather than in
// one frame.
double caustics_share(const SunThroughWaves& sun);
// The horizontal way of its light below a level sea, or above it, per metre of depth or height.
glm::dvec2 level_way(const SunThroughWaves& sun);

// Square texels of the world; what falls on them over what a level sea lets fall there, or in the mean over waves of the sun's mirrored light.
struct CausticsMap {
    glm::dvec2 from_m{0.0};  // the first one's corner
    double texel_m = 1.0;
    int side = 0;
    std::span<float> texels;
    bool is_periodic =
        false;  // what its blur misses beyond an edge is at the other one; otherwise it is even light
    glm::dvec2 along{
        1.0, 0.0};  // unit: of its rows, which follow each other to its left; as it is here from the south
};

// On what it falls, and from how far.
struct CausticsOn {
    double depth_m =
        1.0;  // of the plane, or of the floor where its pattern is to be sharp; of mirrored light the plane's height
    double level_m = 0.0;  // from which that counts, over the sea at rest
    // How much the floor's depth differs from that, where it isn't level.
    double uneven_m = std::numeric_limits<double>::infinity();
    double most_margin_m = 0.0;  // light from further round the map isn't looked for
    double finest_cell_m = 0.0;  // of the query's footprints
};
// How far round a map light is looked for [m].
double caustics_margin_m(const SunThroughWaves& sun, const Floor& floor, double m0, const CausticsOn& on);

// Cells of the sea, as wide as a map's texels, send what they let in by Snell's law for their own slopes to the floor, where it is spread by the
// slopes that they don't resolve and by the sun's disc. So all light arrives somewhere, and its mean is 1. Mirrored light is that
// on upright walls that face it; what slopes throw farther than the margin is even light. The frame's query has
// positions, normals and slope variances at the map's footprint. All threads of the calling arena. Throws BuildCancelled.
template <class T>
void find_caustics(const CausticsMap& map, const Floor& floor, const Frame<T>& frame, int query,
                   const SunThroughWaves& sun, const CausticsOn& on, const std::atomic<bool>* cancel);
// What that holds beside the map [bytes]; margin: over the map's side.
std::size_t caustics_bytes(int side, double margin, bool is_mirrored = false);

}  // namespace pelagic
