// The light above the sea, from an analytic daylight model or from a picture of a real sky. Both give a sun
// disc, and a map of everything else.
//
// Radiances are linear Rec. 709 RGB in kcd/m² (luminance is 0.2126 R + 0.7152 G + 0.0722 B), irradiances in
// klx. Those of a picture are in the picture's own units.
#pragma once

#include <functional>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/lighting/sky_map.h"

namespace pelagic {

class AirModel;

struct Sky {
    SkyMap map;  // without the sun
    // Unit, world axes: towards the centre of the disc's visible part, which is above the horizon whenever
    // sun_radiance is not 0. After sunset: towards the sun.
    glm::vec3 sun_direction{0.0f, 0.0f, 1.0f};
    // Mean over the whole disc as seen from the sea, the part below the horizon counted as black; falls to 0
    // while the sun sets.
    glm::vec3 sun_radiance{0.0f};
    float sun_angular_radius = 0.00465f;  // [rad]
    // Of the sun alone, on a horizontal plane: radiance · solid angle · sine of sun_direction's elevation.
    glm::vec3 sun_irradiance{0.0f};
    // For pictures of the disc itself: how much lower than sun_direction the middle of all of it is [rad], and, over
    // sun_radiance, the radiance at its lowest place above the horizon, at its highest, and half-way between them.
    float sun_lower = 0.0f;
    glm::vec3 limb_low{1.0f}, limb_middle{1.0f}, limb_high{1.0f};
    glm::vec3 sky_irradiance{0.0f};  // on a horizontal plane, of the upper hemisphere without the sun
    // Before the sea (air.h). None: the sea is seen as if there were no air.
    std::shared_ptr<const AirModel> air{};
};

struct Daylight {
    double sun_elevation_deg = 20.0;  // −90 … 90
    double sun_azimuth_deg = 90.0;    // towards the sun, counter-clockwise from +x
    double turbidity = 3.0;  // 1.7 … 10: extinction of air and haze over that of air alone, at 0.55 μm
};

// Clear daylight at sea level (model: atmosphere.h), without stars and moon: night is black. Finite and
// smooth in its arguments, also for a sun below the horizon. map_size: as for SkyMap; below 64 texels are wider than sun's
// aureole and horizon's haze are smooth, and the light is off by percents. Throws
// std::invalid_argument for values out of range.
Sky daylight_sky(const Daylight& daylight, int map_size = 256);
// Its sun alone, a thousand times as fast: map, light of the sky and air are missing.
Sky daylight_sun(const Daylight& daylight);

// A lat-long picture. The middle column is +x; azimuth grows counter-clockwise, which is to the left; the top
// row is the zenith. Rows from the top, x fastest.
struct LatLong {
    int width = 0, height = 0;
    std::vector<glm::vec3> radiance;
};

// Such a picture that is read in parts, since a large one takes gigabytes.
struct LatLongRows {
    int width = 0, height = 0;
    int rows_in_piece =
        1;  // rows are stored in pieces of this many, from the top: a piece is read as a whole
    double rotation_rad = 0.0;  // the middle column's azimuth
    // Rows from the first one on, as many as there are pixels for. Called from several threads.
    std::function<void(int first_row, std::span<glm::vec3> radiance)> read;
};

// Removes the picture's sun from the map and makes it the disc, so that it counts once; sun_irradiance is
// what was removed. Where nothing stands out (overcast) there is no sun: sun_radiance is 0. The lower half of
// the picture is not used, nor read. Throws std::invalid_argument for a picture without pixels, and for values that
// are NaN, negative or above 1e30, naming the first of them; and what read() throws.
//
// Each row is read twice, those near the sun three times. Some hundred rows are held at a time. map_size 0: 512, or
// 1024 for pictures that fill as many at the horizon.
Sky picture_sky(const LatLongRows& picture, int map_size = 0);
// The same of a picture in memory; values of its lower half are looked at, too.
Sky picture_sky(const LatLong& picture, int map_size = 0);

// The sky as such a picture, width / 2 rows, without the sun's disc: each pixel the mean over its solid angle.
// Below the horizon is what the sea reflects of the sky. Throws std::invalid_argument for a width that is odd
// or out of range, and for a sky without a map.
inline constexpr int kLeastLatLong = 8, kLargestLatLong = 16384;
LatLong lat_long(const Sky& sky, int width);

}  // namespace pelagic
