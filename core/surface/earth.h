// The flat sea laid on the earth's sphere: earth.inl for vectors.
#pragma once

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "core/base/constants.h"
#include "core/surface/view.h"

namespace pelagic {

namespace earth_detail {
#include "core/surface/earth.inl"
}  // namespace earth_detail

// [1/m] of the sphere, the atmosphere's own.
inline constexpr double kEarthCurvature_per_m = 1.0 / kEarthRadius_m;

// Relative to the place round which the sea is laid [m]. curvature_per_m = 0 leaves everything as it is.
inline glm::dvec3 on_earth(glm::dvec3 flat_m, double curvature_per_m) {
    const auto at = earth_detail::on_earth(flat_m.x, flat_m.y, flat_m.z, curvature_per_m);
    return {at.x, at.y, at.z};
}
// Its inverse, up to the half circle; curvature_per_m > 0.
inline glm::dvec3 from_earth(glm::dvec3 point_m, double curvature_per_m) {
    const double radius_m = 1.0 / curvature_per_m, across_m = std::hypot(point_m.x, point_m.y),
                 up_m = radius_m + point_m.z;
    const double far_m = std::hypot(across_m, up_m);
    const double height_m = (across_m * across_m + point_m.z * (up_m + radius_m)) / (far_m + radius_m);
    const double stretch =
        across_m > 0.0 ? radius_m * std::atan2(across_m, up_m) / across_m : radius_m / up_m;
    return {point_m.x * stretch, point_m.y * stretch, height_m};
}
// The vertical (unit) at a point.
inline glm::dvec3 earth_up(glm::dvec2 flat_m, double curvature_per_m) {
    const auto up = earth_detail::earth_up(flat_m.x, flat_m.y, curvature_per_m);
    return {up.x, up.y, up.z};
}
// A direction in the axes of the place relative to the vertical there, as levelled() (level.glsl); and back.
inline glm::dvec3 to_level(glm::dvec3 direction, glm::dvec3 up) {
    const glm::dvec3 both = up + glm::dvec3(0.0, 0.0, 1.0);
    return direction - both * (glm::dot(both, direction) / (1.0 + up.z)) +
           glm::dvec3(0.0, 0.0, 2.0 * glm::dot(up, direction));
}
inline glm::dvec3 from_level(glm::dvec3 direction, glm::dvec3 up) {
    const glm::dvec3 both = up + glm::dvec3(0.0, 0.0, 1.0);
    return direction - both * (glm::dot(both, direction) / (1.0 + up.z)) + 2.0 * direction.z * up;
}

// The point of the plane whose vertical this is: the inverse of earth_up() on the earth, up to the half circle.
inline glm::dvec2 earth_place(glm::dvec3 up) {
    const double across = std::hypot(up.x, up.y);
    if (across == 0.0) return glm::dvec2(0.0);
    return glm::dvec2(up) * (kEarthRadius_m * std::atan2(across, up.z) / across);
}
// Of a view in the axes of the origin, where the earth touches z = 0: the same over its nadir, in the axes of that place.
inline View over_nadir(View view) {
    const glm::dvec3 from_centre = view.position_m + glm::dvec3(0.0, 0.0, kEarthRadius_m);
    const double radius_m = glm::length(from_centre);
    const glm::dvec3 up = radius_m > 0.0 ? from_centre / radius_m : glm::dvec3(0.0, 0.0, 1.0);
    view.position_m = glm::dvec3(earth_place(up), radius_m - kEarthRadius_m);
    for (glm::dvec3* axis : {&view.right, &view.up, &view.forward}) *axis = to_level(*axis, up);
    return view;
}

}  // namespace pelagic
