// The camera's view. See view.h.
#include "core/surface/view.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <stdexcept>
#include <string>
#include <type_traits>

#include "core/base/constants.h"
#include "core/scene/lens.h"
#include "core/scene/limits.h"

namespace pelagic {
namespace {

struct Pose {
    glm::dvec3 position_m{0.0}, look_at_m{0.0};
    double fov_deg = 50.0, roll_deg = 0.0;
};

Pose pose_of(const Camera& camera, const CameraKey& key) {
    return {key.position_m, key.look_at_m, key.fov_deg.value_or(lens_fov_deg(camera)), key.roll_deg};
}

Pose straight(const Pose& from, const Pose& to, double t) {
    return {from.position_m + t * (to.position_m - from.position_m),
            from.look_at_m + t * (to.look_at_m - from.look_at_m),
            from.fov_deg + t * (to.fov_deg - from.fov_deg),
            from.roll_deg + t * (to.roll_deg - from.roll_deg)};
}

// The slope at a key of a curve of cubics, from those of the lines before and after it: the slope of the parabola through
// the key and its neighbours, which uneven keys don't jerk. It is at most three times either line's: with more, a cubic
// would go back and forth between its keys (Fritsch and Carlson, SIAM J. Numer. Anal. 17, 1980). So a camera that stands
// between two equal keys stands still.
template <class Value>
Value slope_at(const Value& before, double frames_before, const Value& after, double frames_after) {
    constexpr double kSteepest = 3.0;
    const auto size = [](const Value& v) {
        if constexpr (std::is_same_v<Value, double>)
            return std::abs(v);
        else
            return glm::length(v);
    };
    // A number stays between its keys': no camera dips below the sea, no angle of view below zero.
    if constexpr (std::is_same_v<Value, double>)
        if (before * after <= 0.0) return 0.0;
    const Value slope = (frames_after * before + frames_before * after) / (frames_before + frames_after);
    const double largest = kSteepest * std::min(size(before), size(after));
    return size(slope) > largest ? slope * (largest / size(slope)) : slope;
}

// C1 in time: cubics through the keys, of which there are three or more; the first and the last slope are the straight
// lines'. Along the sea a place is one vector, so that its way doesn't depend on the axes.
Pose smooth(const Camera& camera, std::size_t from, double t) {
    const auto& keys = camera.keys;
    const auto frames = [&](std::size_t i) { return static_cast<double>(keys[i + 1].frame) - keys[i].frame; };
    const auto curve = [&](const auto& value) {
        const auto at = [&](std::size_t i) { return value(pose_of(camera, keys[i])); };
        const auto line = [&](std::size_t i) { return (at(i + 1) - at(i)) / frames(i); };
        const auto slope = [&](std::size_t i) {
            if (i == 0) return line(0);
            if (i + 1 == keys.size()) return line(i - 1);
            return slope_at(line(i - 1), frames(i - 1), line(i), frames(i));
        };
        const double u = 1.0 - t, span = frames(from);
        return u * u * (at(from) * (1.0 + 2.0 * t) + slope(from) * (t * span)) +
               t * t * (at(from + 1) * (1.0 + 2.0 * u) - slope(from + 1) * (u * span));
    };
    const auto place = [&](glm::dvec3 Pose::*point) {
        return glm::dvec3(curve([&](const Pose& pose) { return glm::dvec2(pose.*point); }),
                          curve([&](const Pose& pose) { return (pose.*point).z; }));
    };
    return {place(&Pose::position_m), place(&Pose::look_at_m),
            curve([](const Pose& pose) { return pose.fov_deg; }),
            curve([](const Pose& pose) { return pose.roll_deg; })};
}

Pose pose_at(const Camera& camera, double frame) {
    const auto& keys = camera.keys;
    if (keys.empty()) return {camera.position_m, camera.look_at_m, lens_fov_deg(camera), 0.0};
    const auto after = std::upper_bound(keys.begin(), keys.end(), frame,
                                        [](double f, const CameraKey& key) { return f < key.frame; });
    if (after == keys.begin()) return pose_of(camera, *after);
    const Pose from = pose_of(camera, *(after - 1));
    if (after == keys.end()) return from;
    // In double: the difference of two ints may overflow an int.
    const double first = (after - 1)->frame, t = (frame - first) / (after->frame - first);
    if (camera.interpolation == CameraInterpolation::Smooth && keys.size() > 2)
        return smooth(camera, static_cast<std::size_t>(after - keys.begin()) - 1, t);
    return straight(from, pose_of(camera, *after), t);
}

}  // namespace

double View::fov_deg() const {
    return std::atan(tan_half_width) * (360.0 / kPi);
}

glm::dvec3 View::direction(glm::dvec2 pixel) const {
    const double tangent = pixel_tangent();
    const glm::dvec2 middle = middle_tangents();
    return glm::normalize(forward + right * ((pixel.x - 0.5 * resolution.x) * tangent + middle.x) +
                          up * ((0.5 * resolution.y - pixel.y) * tangent + middle.y));
}

// Rows of the matrix, with d = forward · (p − position): x = right · (p − position) / tan, y likewise with
// the picture's proportions, both less the middle's own times d; z = d − 2 near, w = d. Then z/w = 1 − 2 near/d: −1 at near, 1 at infinity.
glm::dmat4 View::clip_from(glm::dvec3 origin_m, double near_m) const {
    const glm::dvec3 offset_m = origin_m - position_m;
    const double tan_half_height = tan_half_width * resolution.y / resolution.x;
    const glm::dvec2 middle = 2.0 * shift * glm::dvec2(1.0, tan_half_width / tan_half_height);
    const glm::dvec3 x = right / tan_half_width - middle.x * forward,
                     y = up / tan_half_height - middle.y * forward;
    const double depth_m = glm::dot(forward, offset_m);
    glm::dmat4 clip(0.0);
    for (int i = 0; i < 3; ++i) clip[i] = glm::dvec4(x[i], y[i], forward[i], forward[i]);
    clip[3] = glm::dvec4(glm::dot(x, offset_m), glm::dot(y, offset_m), depth_m - 2.0 * near_m, depth_m);
    return clip;
}

View checked_view(View view) {
    constexpr double kAxisTolerance =
        1e-3;  // of axes that a host has in single precision, turned a few times
    for (int axis = 0; axis < 3; ++axis)
        if (!limits::kCameraCoordinate_m.holds(view.position_m[axis]))
            throw std::invalid_argument(
                "position_m: is outside the range; accepted: " + text_of(limits::kCameraCoordinate_m) + " m");
    const glm::dvec3 x = view.right, y = view.up, z = view.forward;
    const auto is = [](double value, double wanted) { return std::abs(value - wanted) < kAxisTolerance; };
    if (!is(glm::dot(x, x), 1.0) || !is(glm::dot(z, z), 1.0) || !is(glm::dot(x, z), 0.0) ||
        !is(glm::length(glm::cross(x, z) - y), 0.0))
        throw std::invalid_argument(
            "right, up, forward: accepted: unit vectors at right angles, with up = right × forward");
    view.forward = glm::normalize(z);
    view.right = glm::normalize(x - glm::dot(x, view.forward) * view.forward);
    view.up = glm::cross(view.right, view.forward);
    for (int axis = 0; axis < 2; ++axis)
        if (!limits::kLensShift.holds(view.shift[axis]))
            throw std::invalid_argument("shift: is outside the range; accepted: " +
                                        text_of(limits::kLensShift) + " widths of the picture");
    const auto tangent = [](double fov_deg) { return std::tan(fov_deg * (kPi / 360.0)); };
    if (!(view.tan_half_width >= tangent(limits::kFov_deg.low) &&
          view.tan_half_width <= tangent(limits::kFov_deg.high)))
        throw std::invalid_argument(
            "tan_half_width: is outside the range; accepted: that of a field of view of " +
            text_of(limits::kFov_deg) + " degrees");
    for (const int pixels : {view.resolution.x, view.resolution.y})
        if (!limits::kImageResolution.holds(pixels))
            throw std::invalid_argument("resolution: is outside the range; accepted: " +
                                        text_of(limits::kImageResolution));
    return view;
}

View view_at(const Camera& camera, double frame) {
    const Pose pose = pose_at(camera, frame);
    View view;
    view.position_m = pose.position_m;
    view.resolution = camera.resolution;
    view.shift = {camera.shift_x, camera.shift_y};
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

double aperture_radius_m(const Camera& camera, const View& view) {
    return camera.f_stop > 0.0 ? 0.5 * focal_length_m(camera, view.tan_half_width) / camera.f_stop : 0.0;
}

View through_lens(View view, glm::dvec2 offset_m, double focus_m) {
    view.position_m += offset_m.x * view.right + offset_m.y * view.up;
    view.shift -= offset_m / (2.0 * view.tan_half_width * focus_m);
    return view;
}

}  // namespace pelagic
