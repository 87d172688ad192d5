// What the waves of a frame make of the sun's light on the floor: caustics (core/lighting/floor.h).
#pragma once

#include <atomic>
#include <cstddef>

#include "core/lighting/floor.h"
#include "core/lighting/water.h"
#include "core/plan/plan.h"
#include "core/surface/view.h"
#include "core/waves/frame.h"
#include "pelagic/scene.h"
#include "plugin/render/drawn_sea.h"

namespace pelagic {

// Before which camera, of which sun, through what water.
struct FloorLightWanted {
    View view;
    WaterBody water;
    glm::vec3 sun_direction{0.0f, 0.0f, 1.0f};
    float sun_angular_radius = 0.0f;
    double gain = 1.0;
    double finest_m = 0.0, finest_cell_m = 0.0;  // footprints of this view alone, of pixels and cells
    int side = 1024;                             // texels of a map
    bool is_below = false;                       // some of the view looks through water: shafts are made
    bool operator==(const FloorLightWanted&) const = default;
};

struct FloorLightNeeds {
    std::size_t held_bytes = 0;    // by the maps
    std::size_t making_bytes = 0;  // beside them at most, while one is made
    std::size_t texels = 0;        // of all of them, made anew at each moment
    std::size_t bytes() const { return held_bytes + making_bytes; }
};
// waves_m: how high waves are, by which a camera may be in the water; finest_m: the finest footprint of pixels, beside which a level
// floor's pattern may be too fine to show.
FloorLightNeeds floor_light_needs(const Scene& scene, const WaterBody& water, double waves_m,
                                  double finest_m = 0.0, int side = FloorLightWanted{}.side);
// Of the shot's frame that needs most, in pictures by this plan (picture_plan()).
FloorLightNeeds most_floor_light_needs(const Scene& scene, const Plan& plan);

// For a view, whichever others its frame's plan is for: with both footprints.
void set_footprints(FloorLightWanted& wanted, const DrawnSea& drawn, const SeaView& seen);

// Whether the water lets so much of the floor's light out that its pattern shows: to a hundredth of what falls on it, at the clearest of the
// wavelengths.
bool shows_floor(const WaterBody& water, double depth_m);

// Sets the floor's light, or takes it away where nothing of it shows: caustics (plugin/light/caustics.h) on maps before the camera, on
// texels of the world, so that they are the same whatever it sees. For a view from below the same on a plane in the water, for shafts. All threads
// of the calling arena. Throws BuildCancelled.
template <class T>
void light_floor(Floor& floor, const Frame<T>& frame, const FloorLightWanted& wanted,
                 const std::atomic<bool>* cancel = nullptr);

}  // namespace pelagic
