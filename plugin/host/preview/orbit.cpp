// The preview's camera, controlled by hand. See orbit.h.
#include "plugin/host/preview/orbit.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "core/base/constants.h"

namespace pelagic {
namespace {

constexpr double kHalfPi = 0.5 * kPi;
constexpr double kNearest_m = 0.5, kFarthest_m = 40e3;  // of the pivot: beyond, a mouse pixel is a leap
constexpr double kZoomStep = 0.15;
constexpr double kSlowest_mps = 2.0;  // flight speed near the water, where the height alone would be too slow
// Looking level, the pivot is this many camera heights ahead.
constexpr double kHeightsAhead = 15.0;

}  // namespace

glm::dvec3 OrbitCamera::right() const {
    return {std::sin(heading_), -std::cos(heading_), 0.0};
}

glm::dvec3 OrbitCamera::forward() const {
    return {std::cos(pitch_) * std::cos(heading_), std::cos(pitch_) * std::sin(heading_), std::sin(pitch_)};
}

glm::dvec3 OrbitCamera::middle_m() const {
    return position_m_ + distance_m_ * forward();
}

void OrbitCamera::take(const View& view) {
    position_m_ = view.position_m;
    // `right` has a heading even if the camera looks straight down.
    heading_ = std::atan2(view.right.x, -view.right.y);
    const glm::dvec3 ahead(std::cos(heading_), std::sin(heading_), 0.0);
    pitch_ = std::atan2(view.forward.z, glm::dot(view.forward, ahead));
    pitch_ = std::clamp(pitch_, -kHalfPi, kHalfPi);
    const double height_m = std::abs(position_m_.z);
    const bool meets = position_m_.z * view.forward.z < 0.0;
    const double level_m = std::max(kHeightsAhead * height_m, 10.0);
    distance_m_ = std::clamp(meets ? std::min(height_m / std::abs(view.forward.z), 10.0 * level_m) : level_m,
                             kNearest_m, kFarthest_m);
}

View OrbitCamera::view(const View& lens) const {
    View view = lens;
    view.position_m = position_m_;
    view.right = right();
    view.forward = forward();
    view.up = glm::cross(view.right, view.forward);
    return view;
}

void OrbitCamera::keep_height() {
    position_m_.z = std::clamp(position_m_.z, kLowest_m, kHighest_m);
}

void OrbitCamera::orbit(glm::dvec2 angle) {
    const glm::dvec3 middle = middle_m();
    heading_ = std::remainder(heading_ + angle.x, kTwoPi);
    // The pitch is limited by the camera's range of heights. It stays as it is if the pivot is too far from
    // both ends.
    const double lowest = std::clamp((middle.z - kHighest_m) / distance_m_, -1.0, 1.0);
    const double highest = std::clamp((middle.z - kLowest_m) / distance_m_, -1.0, 1.0);
    if (lowest < highest) pitch_ = std::clamp(pitch_ + angle.y, std::asin(lowest), std::asin(highest));
    position_m_ = middle - distance_m_ * forward();
    keep_height();
}

void OrbitCamera::look(glm::dvec2 angle) {
    heading_ = std::remainder(heading_ + angle.x, kTwoPi);
    pitch_ = std::clamp(pitch_ + angle.y, -kHalfPi, kHalfPi);
    keep_height();
}

void OrbitCamera::pan(glm::dvec2 pixels, const View& lens) {
    const View now = view(lens);
    const double pixel_m = distance_m_ * now.pixel_tangent();
    position_m_ += pixel_m * (pixels.y * now.up - pixels.x * now.right);
    keep_height();
}

void OrbitCamera::zoom(double steps) {
    const glm::dvec3 middle = middle_m();
    double nearest_m = kNearest_m, farthest_m = kFarthest_m;
    const double fall = -forward().z;  // metres of descent per metre ahead
    // The zoom ends where the path to the pivot leaves the range of heights.
    if (std::abs(fall) > 1e-9) {
        const double at_lowest_m = (kLowest_m - middle.z) / fall,
                     at_highest_m = (kHighest_m - middle.z) / fall;
        nearest_m = std::max(nearest_m, std::min(at_lowest_m, at_highest_m));
        farthest_m = std::min(farthest_m, std::max(at_lowest_m, at_highest_m));
    }
    if (nearest_m >= farthest_m) return;
    const double wanted_m = distance_m_ * std::pow(1.0 - kZoomStep, std::clamp(steps, -100.0, 100.0));
    distance_m_ = std::clamp(wanted_m, nearest_m, farthest_m);
    position_m_ = middle - distance_m_ * forward();
    keep_height();
}

void OrbitCamera::fly(const Flight& flight) {
    const double speed_mps = std::max(std::abs(position_m_.z), kSlowest_mps) * flight.haste;
    const glm::dvec3 way = flight.steering.x * right() + flight.steering.y * forward() +
                           flight.steering.z * glm::dvec3(0.0, 0.0, 1.0);
    position_m_ += way * (speed_mps * flight.seconds);
    keep_height();
}

}  // namespace pelagic
