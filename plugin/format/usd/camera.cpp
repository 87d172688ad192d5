// What a USD camera is made of: film, focal length and angles. See camera.h; the crate is in
// camera_crate.cpp.
#include "plugin/format/usd/camera.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <stdexcept>

namespace pelagic::usd {

namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

bool is_finite(const glm::dvec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

// The angle plus the number of whole turns that brings it within half a turn of `before_deg`.
double nearest_turn(double deg, double before_deg) {
    return deg + 360.0 * std::round((before_deg - deg) / 360.0);
}

glm::dvec3 nearest_turns(const glm::dvec3& deg, const glm::dvec3& before_deg) {
    return {nearest_turn(deg.x, before_deg.x), nearest_turn(deg.y, before_deg.y),
            nearest_turn(deg.z, before_deg.z)};
}

double distance_of_angles(const glm::dvec3& a, const glm::dvec3& b) {
    return std::abs(a.x - b.x) + std::abs(a.y - b.y) + std::abs(a.z - b.z);
}

}  // namespace

FilmBack film_back(double fov_deg, glm::ivec2 resolution, double film_width_mm) {
    if (!(fov_deg > 0.0 && fov_deg < 180.0)) {
        throw std::invalid_argument("USD: the camera's field of view must be between 0 and 180 degrees");
    }
    if (resolution.x < 1 || resolution.y < 1) {
        throw std::invalid_argument("USD: the camera's resolution must be positive");
    }
    const double film_width = film_width_mm / 100.0;  // in tenths of a metre
    const double half_fov_rad = fov_deg * (std::numbers::pi / 360.0);
    return {.horizontal_aperture = film_width,
            .vertical_aperture = film_width * resolution.y / resolution.x,
            .focal_length = 0.5 * film_width / std::tan(half_fov_rad)};
}

void check(const CameraPose& pose, int frame) {
    if (!is_finite(pose.position_m)) {
        throw std::invalid_argument("USD: the camera's position must be finite, at frame " +
                                    std::to_string(frame));
    }
    if (!(pose.fov_deg > 0.0 && pose.fov_deg < 180.0)) {
        throw std::invalid_argument(
            "USD: the camera's field of view must be between 0 and 180 degrees, at frame " +
            std::to_string(frame));
    }
    // Far above what rounding does to unit vectors (1e-16), and far below what a picture shows.
    constexpr double kTolerance = 1e-9;
    const bool orthonormal = std::abs(glm::length(pose.right) - 1.0) <= kTolerance &&
                             std::abs(glm::length(pose.up) - 1.0) <= kTolerance &&
                             glm::distance(glm::cross(pose.right, pose.up), pose.backward) <= kTolerance &&
                             std::abs(glm::dot(pose.right, pose.up)) <= kTolerance;
    if (!orthonormal) {  // NaN too
        throw std::invalid_argument(
            "USD: the camera's axes must be unit vectors, orthogonal and right-handed, at frame " +
            std::to_string(frame));
    }
}

// The rotation is R = Rz(z) Ry(y) Rx(x) for column vectors, and its columns are right, up and backward:
// right = (cos y cos z, cos y sin z, −sin y). Then x comes from the second row of Rz(−z) R = Ry(y) Rx(x),
// which is (0, cos x, −sin x) for any y. Where right is nearly vertical, x makes up for the error of z.
glm::dvec3 rotate_xyz_deg(const CameraPose& pose, const glm::dvec3& before_deg) {
    const double cos_y = std::hypot(pose.right.x, pose.right.y);
    // After a quarter turn of roll, right is vertical. Only z − x or z + x is determined then, and z is kept.
    constexpr double kVertical = 1e-9;
    const double z = cos_y < kVertical ? before_deg.z / kDegrees : std::atan2(pose.right.y, pose.right.x);
    const double y = std::atan2(-pose.right.z, cos_y);
    const double cos_z = std::cos(z), sin_z = std::sin(z);
    const double x =
        std::atan2(sin_z * pose.backward.x - cos_z * pose.backward.y, cos_z * pose.up.y - sin_z * pose.up.x);
    const glm::dvec3 deg(x * kDegrees, y * kDegrees, z * kDegrees);
    const glm::dvec3 one = nearest_turns(deg, before_deg);
    const glm::dvec3 other = nearest_turns({deg.x + 180.0, 180.0 - deg.y, deg.z + 180.0}, before_deg);
    return distance_of_angles(other, before_deg) < distance_of_angles(one, before_deg) ? other : one;
}

}  // namespace pelagic::usd
