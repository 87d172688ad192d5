// What a picture from the GPU shows.
#pragma once

#include "core/lighting/lighting.h"

namespace pelagic {

// What a picture shows instead of the light.
enum class FalseColour {
    None,
    FilterLevel,         // the level that the pixel's waves come from: hues, interpolated between levels
    UnresolvedVariance,  // σxx + σyy of the waves that the pixel leaves unresolved
    Coverage,            // of whitecaps
};

struct DrawOptions {
    LightingChoice lighting;
    FoamLook foam{};
    FalseColour false_colour = FalseColour::None;
    bool sky_from_air = false;  // the sky beside the sea is the air's table's (air.h), otherwise the map's
    bool is_shaped = false;     // the sea lies on a surface that isn't flat at rest
    bool from_below = false;    // all of the picture looks through water (plugin/render/waterline.h)
    bool behind_glass = false;  // nothing nearer than the camera's front glass is seen (ditto)
    // Whose shadow, mirror image and hulls the sea has, and what of them is in the water; a host's own, where it is for one.
    bool has_objects = false;
    bool has_images = false;  // materials of the objects have pictures
    bool wireframe = false;   // the grid's edges on black
    // Each term in a separate texture, for read_layers(). Otherwise only their sum is written, which is
    // faster.
    bool layers = false;
    // Display values, for a host that has its own projection, textures without mip levels, no spray, and a function
    // `vec4 host_colour(vec4)` before the fragment shaders, from sRGB to what it stores.
    bool for_host = false;
};

}  // namespace pelagic
