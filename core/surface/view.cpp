// The camera's view. See view.h.
#include "core/surface/view.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "core/base/constants.h"

namespace pelagic {
namespace {

struct Pose {
    glm::dvec3 position_m{0.0}, look_at_m{0.0};
    double fov_deg = 50.0, roll_deg = 0.0;
};

Pose pose_of(const Camera& camera, const CameraKey& key) {
    return {key.position_m, key.look_at_m, key.fov_deg.value_or(camera.fov_deg), key.roll_deg};
}

Pose pose_at(const Camera& camera, double frame) {
    const auto& keys = camera.keys;
    if (keys.empty()) return {camera.position_m, camera.look_at_m, camera.fov_deg, 0.0};
    const auto after = std::upper_bound(keys.begin(), keys.end(), frame,
                                        [](double f, const CameraKey& key) { return f < key.frame; });
    if (after == keys.begin()) return pose_of(camera, *after);
    const Pose from = pose_of(camera, *(after - 1));
    if (after == keys.end()) return from;
    const Pose to = pose_of(camera, *after);
    // In double: the difference of two ints may overflow an int.
    const double first = (after - 1)->frame, t = (frame - first) / (after->frame - first);
    return {from.position_m + t * (to.position_m - from.position_m),
            from.look_at_m + t * (to.look_at_m - from.look_at_m),
            from.fov_deg + t * (to.fov_deg - from.fov_deg),
            from.roll_deg + t * (to.roll_deg - from.roll_deg)};
}

}  // namespace

double View::fov_deg() const {
    return std::atan(tan_half_width) * (360.0 / kPi);
}

glm::dvec3 View::direction(glm::dvec2 pixel) const {
    const double tangent = pixel_tangent();
    return glm::normalize(forward + right * ((pixel.x - 0.5 * resolution.x) * tangent) +
                          up * ((0.5 * resolution.y - pixel.y) * tangent));
}

// Rows of the matrix, with d = forward · (p − position): x = right · (p − position) / tan, y likewise with
// the picture's proportions, z = d − 2 near, w = d. Then z/w = 1 − 2 near/d: −1 at near, 1 at infinity.
glm::dmat4 View::clip_from(glm::dvec3 origin_m, double near_m) const {
    const glm::dvec3 offset_m = origin_m - position_m;
    const double tan_half_height = tan_half_width * resolution.y / resolution.x;
    const glm::dvec3 x = right / tan_half_width, y = up / tan_half_height;
    const double depth_m = glm::dot(forward, offset_m);
    glm::dmat4 clip(0.0);
    for (int i = 0; i < 3; ++i) clip[i] = glm::dvec4(x[i], y[i], forward[i], forward[i]);
    clip[3] = glm::dvec4(glm::dot(x, offset_m), glm::dot(y, offset_m), depth_m - 2.0 * near_m, depth_m);
    return clip;
}

View view_at(const Camera& camera, double frame) {
    const Pose pose = pose_at(camera, frame);
    View view;
    view.position_m = pose.position_m;
    view.resolution = camera.resolution;
    view.tan_half_width = std::tan(pose.fov_deg * (kPi / 360.0));
    const glm::dvec3 way_m = pose.look_at_m - pose.position_m;
    const double distance_m = glm::length(way_m);
    // Between two keys a camera may pass through its target. It then has a new camera's direction.
    view.forward = distance_m > 0.0 ? way_m / distance_m : glm::dvec3(0.0, 1.0, 0.0);
    // Below this the horizontal part of the direction is rounding noise, and the picture's up would be, too.
    constexpr double kVertical = 1e-9;
    const bool vertical = std::hypot(view.forward.x, view.forward.y) < kVertical;
    const glm::dvec3 upright = vertical ? glm::dvec3(0.0, 1.0, 0.0) : glm::dvec3(0.0, 0.0, 1.0);
    const glm::dvec3 right = glm::normalize(glm::cross(view.forward, upright));
    const glm::dvec3 up = glm::cross(right, view.forward);
    const double roll = pose.roll_deg * (kPi / 180.0);
    view.right = std::cos(roll) * right - std::sin(roll) * up;
    view.up = std::sin(roll) * right + std::cos(roll) * up;
    return view;
}

}  // namespace pelagic
