// The lens of a shot's camera, from the keys that say it.
#pragma once

#include <cmath>

#include "core/base/constants.h"
#include "pelagic/scene.h"

namespace pelagic {

// Its horizontal angle of view where no camera key has one of its own.
inline double lens_fov_deg(const Camera& camera) {
    if (!camera.focal_length_mm) return camera.fov_deg;
    return std::atan(0.5 * camera.sensor_width_mm / *camera.focal_length_mm) * (360.0 / kPi);
}

// What a lens of this angle of view has before the camera's film.
inline double focal_length_m(const Camera& camera, double tan_half_width) {
    return 1e-3 * 0.5 * camera.sensor_width_mm / tan_half_width;
}

}  // namespace pelagic
