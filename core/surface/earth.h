// The flat sea laid on the earth's sphere: earth.inl for vectors.
#pragma once

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "core/base/constants.h"

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
// The vertical (unit) at a point.
inline glm::dvec3 earth_up(glm::dvec2 flat_m, double curvature_per_m) {
    const auto up = earth_detail::earth_up(flat_m.x, flat_m.y, curvature_per_m);
    return {up.x, up.y, up.z};
}
// A direction relative to the vertical there, in the axes of the place: the inverse of levelled() (level.glsl).
inline glm::dvec3 from_level(glm::dvec3 direction, glm::dvec3 up) {
    const glm::dvec3 both = up + glm::dvec3(0.0, 0.0, 1.0);
    return direction - both * (glm::dot(both, direction) / (1.0 + up.z)) + 2.0 * direction.z * up;
}

}  // namespace pelagic
