#include "core/lighting/daylight_disc.h"

#include <algorithm>
#include <cmath>

#include "core/base/constants.h"
#include "core/lighting/atmosphere.h"
#include "core/lighting/colour.h"

namespace pelagic {

Disc disc_at(double turbidity, double elevation_rad, double radius_rad) {
    constexpr int kStrips = 16;
    const double lowest = std::max(-radius_rad, -elevation_rad);
    Disc disc;
    disc.elevation_rad = elevation_rad;
    if (lowest >= radius_rad) return disc;
    const auto at = [&](double up) {
        return into_gamut(colour_of(transmittance_to_sea(turbidity, elevation_rad + up))) /
               (kPi * radius_rad * radius_rad);
    };
    disc.low = at(lowest);
    disc.middle = at(0.5 * (lowest + radius_rad));
    disc.high = at(radius_rad);
    const double height = (radius_rad - lowest) / kStrips;
    glm::dvec3 sum(0.0);
    double moment = 0.0;
    for (int i = 0; i < kStrips; ++i) {
        const double up = lowest + (i + 0.5) * height;
        const double area = 2.0 * std::sqrt(std::max(0.0, radius_rad * radius_rad - up * up)) * height;
        const glm::dvec3 light = area * colour_of(transmittance_to_sea(turbidity, elevation_rad + up));
        sum += light;
        moment += luminance(light) * up;
    }
    const double area = kPi * radius_rad * radius_rad;  // [sr], for a small disc
    disc.radiance = into_gamut(sum) / (area * area);
    if (luminance(sum) > 0.0) disc.elevation_rad += moment / luminance(sum);
    return disc;
}

}  // namespace pelagic
