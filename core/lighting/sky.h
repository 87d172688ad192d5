// The light above the sea: an analytic daylight, or a picture of a real sky. Both become the same: a sun that
// is a disc, and a map of everything else.
//
// Radiances are linear Rec. 709 RGB in kcd/m² (so that luminance is 0.2126 R + 0.7152 G + 0.0722 B),
// irradiances in klx; a picture's are in its own units.
#pragma once

#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "core/lighting/sky_map.h"

namespace pelagic {

struct Sky {
    SkyMap map;  // without the sun
    // Towards the middle of what is to be seen of it, unit, world: above the horizon whenever sun_radiance is
    // not 0. A sun that has set: towards the sun.
    glm::vec3 sun_direction{0.0f, 0.0f, 1.0f};
    // Mean over the whole disc, as seen from the sea, what is below the horizon black: goes to 0 while the
    // disc sets.
    glm::vec3 sun_radiance{0.0f};
    float sun_angular_radius = 0.00465f;  // [rad]
    // On a horizontal plane, of the sun alone: radiance · solid angle · sine of the direction's elevation.
    glm::vec3 sun_irradiance{0.0f};
    glm::vec3 sky_irradiance{0.0f};  // on a horizontal plane, of the rest of the upper hemisphere
};

struct Daylight {
    double sun_elevation_deg = 20.0;  // −90 … 90
    double sun_azimuth_deg = 90.0;    // towards the sun, counter-clockwise from +x
    double turbidity = 3.0;  // 1.7 … 10: extinction of the air and its haze at 0.55 μm, over the air's alone
};

// Clear daylight at sea level (atmosphere.h says which model), without stars and moon: night is black. Finite
// and smooth in its arguments, the sun below the horizon included. map_size: as SkyMap's. Throws
// std::invalid_argument for values out of range.
Sky daylight_sky(const Daylight& daylight, int map_size = 256);

// A lat-long picture: the middle column is +x, azimuth (counter-clockwise) grows to the left, the top row is
// the zenith. Rows from the top, x fastest.
struct LatLong {
    int width = 0, height = 0;
    std::vector<glm::vec3> radiance;
};

// The picture's sun is found, taken out of the map, and becomes the disc, so that it is counted once: its
// irradiance is what was taken out. A sky in which nothing stands out (overcast) has none: sun_radiance 0.
// NaN, negative pixels and those above 1e30 are refused with std::invalid_argument naming the first of them;
// so is a picture without pixels. The lower half of the picture is not used.
Sky picture_sky(const LatLong& picture, int map_size = 512);

}  // namespace pelagic
