// The pinhole camera against its geometric definition.
#include "core/surface/view.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "core/base/constants.h"

namespace pelagic {
namespace {

void expect_near(glm::dvec3 a, glm::dvec3 b, double tolerance) {
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], tolerance) << "component " << i;
}

Camera camera_with(glm::dvec3 position_m, glm::dvec3 look_at_m) {
    Camera camera;
    camera.position_m = position_m;
    camera.look_at_m = look_at_m;
    return camera;
}

TEST(View, FollowsKeysLinearlyAndStandsStillOutside) {
    Camera camera;
    camera.keys = {{.frame = 10, .position_m = {0.0, 0.0, 2.0}, .look_at_m = {0.0, 10.0, 2.0}},
                   {.frame = 20, .position_m = {10.0, 0.0, 4.0}, .look_at_m = {10.0, 10.0, 4.0}}};
    expect_near(view_at(camera, 1.0).position_m, {0.0, 0.0, 2.0}, 0.0);
    expect_near(view_at(camera, 10.0).position_m, {0.0, 0.0, 2.0}, 0.0);
    expect_near(view_at(camera, 12.5).position_m, {2.5, 0.0, 2.5}, 1e-15);
    expect_near(view_at(camera, 20.0).position_m, {10.0, 0.0, 4.0}, 0.0);
    expect_near(view_at(camera, 99.0).position_m, {10.0, 0.0, 4.0}, 0.0);
    expect_near(view_at(camera, 12.5).forward, {0.0, 1.0, 0.0}, 1e-15);
}

// Where the matrix has what lies along a pixel's direction: in that pixel. With a shift its middle is so many widths off
// the axis.
TEST(View, AShiftMovesThePictureAndNothingInIt) {
    Camera camera = camera_with({3.0, -20.0, 5.0}, {9.0, 4.0, 2.0});
    camera.resolution = {640, 300};
    camera.shift_x = 0.3;
    camera.shift_y = -0.7;
    const View view = view_at(camera, 1.0);
    for (const glm::dvec2 pixel : {glm::dvec2(0.0), {640.0, 0.0}, {100.5, 222.5}}) {
        const glm::dvec4 clip =
            view.clip_from(view.position_m, 0.0) * glm::dvec4(7.0 * view.direction(pixel), 1.0);
        EXPECT_NEAR((0.5 + 0.5 * clip.x / clip.w) * 640.0, pixel.x, 1e-9);
        EXPECT_NEAR((0.5 - 0.5 * clip.y / clip.w) * 300.0, pixel.y, 1e-9);
    }
    const double width = 2.0 * view.tan_half_width;
    const glm::dvec3 middle = view.direction({320.0, 150.0});
    EXPECT_NEAR(glm::dot(middle, view.right) / glm::dot(middle, view.forward), 0.3 * width, 1e-12);
    EXPECT_NEAR(glm::dot(middle, view.up) / glm::dot(middle, view.forward), -0.7 * width, 1e-12);
}

TEST(View, ALensSeesWhatIsInFocusInOnePlace) {
    Camera camera = camera_with({0.0, 0.0, 5.0}, {9.0, 40.0, 2.0});
    camera.focal_length_mm = 50.0;
    camera.f_stop = 2.0;
    camera.shift_x = 0.1;
    const View middle = view_at(camera, 1.0);
    EXPECT_NEAR(middle.fov_deg(), 39.5978, 1e-4);  // of the photographer's normal lens
    const double radius_m = aperture_radius_m(camera, middle);
    EXPECT_NEAR(radius_m, 0.0125, 1e-12);
    constexpr double kFocus_m = 8.0;
    const View beside = through_lens(middle, radius_m * glm::dvec2(0.6, -0.8), kFocus_m);
    expect_near(beside.position_m - middle.position_m, radius_m * (0.6 * middle.right - 0.8 * middle.up),
                1e-12);
    const auto seen = [](const View& view, glm::dvec3 point_m) {
        const glm::dvec4 clip = view.clip_from(glm::dvec3(0.0), 0.0) * glm::dvec4(point_m, 1.0);
        return 0.5 * glm::dvec2(clip) / clip.w * glm::dvec2(view.resolution);
    };
    const auto moved_px = [&](double ahead_m) {
        const glm::dvec3 point_m =
            middle.position_m + ahead_m * middle.forward + 0.2 * middle.right - 0.1 * middle.up;
        return glm::distance(seen(beside, point_m), seen(middle, point_m));
    };
    EXPECT_NEAR(moved_px(kFocus_m), 0.0, 1e-9);
    // The circle of confusion's radius: f²/N |s − s₀|/(s s₀) / 2 of a thin lens whose film is at f.
    const double film_px = 0.5 * middle.resolution.x / 0.018;
    for (const double ahead_m : {2.0, 30.0})
        EXPECT_NEAR(moved_px(ahead_m),
                    0.05 * radius_m * std::abs(ahead_m - kFocus_m) / (ahead_m * kFocus_m) * film_px, 1e-9);
}

// Keys at uneven frames, with a stand and turns in them.
Camera smooth_camera() {
    Camera camera;
    camera.interpolation = CameraInterpolation::Smooth;
    camera.keys = {
        {.frame = 1, .position_m = {0.0, 0.0, 9.0}, .look_at_m = {0.0, 50.0, 0.0}, .fov_deg = 60.0},
        {.frame = 31,
         .position_m = {30.0, 5.0, 2.0},
         .look_at_m = {0.0, 60.0, 1.0},
         .fov_deg = 4.0,
         .roll_deg = 9.0},
        {.frame = 35,
         .position_m = {38.0, 5.0, 1.0},
         .look_at_m = {9.0, 66.0, 4.0},
         .fov_deg = 1.5,
         .roll_deg = 8.0},
        {.frame = 75,
         .position_m = {38.0, 5.0, 1.0},
         .look_at_m = {9.0, 66.0, 4.0},
         .fov_deg = 1.5,
         .roll_deg = 8.0},
        {.frame = 90, .position_m = {10.0, -40.0, 30.0}, .look_at_m = {-9.0, 6.0, 2.0}, .fov_deg = 90.0}};
    return camera;
}

// What a view shows of its pose, the roll as the tilt of its right side.
std::array<double, 8> numbers_of(const View& view) {
    return {view.position_m.x, view.position_m.y, view.position_m.z, view.forward.x,
            view.forward.y,    view.forward.z,    view.right.z,      view.fov_deg()};
}

TEST(View, SmoothKeysAreMetAndTheWayBetweenHasNoCorner) {
    const Camera camera = smooth_camera();
    Camera straight = camera;
    straight.interpolation = CameraInterpolation::Linear;
    constexpr double kStep = 1e-5;
    double largest_corner = 0.0;
    for (const CameraKey& key : camera.keys) {
        EXPECT_EQ(numbers_of(view_at(camera, key.frame)), numbers_of(view_at(straight, key.frame)));
        if (&key == &camera.keys.front() || &key == &camera.keys.back()) continue;
        const auto jump = [&](const Camera& of, std::size_t i) {
            const auto at = [&](double frame) { return numbers_of(view_at(of, frame))[i]; };
            return std::abs(at(key.frame + kStep) - 2.0 * at(key.frame) + at(key.frame - kStep)) / kStep;
        };
        for (std::size_t i = 0; i < 8; ++i) {
            EXPECT_LT(jump(camera, i), 1e-3) << "number " << i << ", key at " << key.frame;
            largest_corner = std::max(largest_corner, jump(straight, i));
        }
    }
    EXPECT_GT(largest_corner, 1.0) << "nothing to round";
}

TEST(View, SmoothHeightsAndAnglesKeepBetweenTheirKeys) {
    const Camera camera = smooth_camera();
    for (std::size_t i = 0; i + 1 < camera.keys.size(); ++i) {
        const CameraKey &from = camera.keys[i], &to = camera.keys[i + 1];
        for (int step = 0; step <= 100; ++step) {
            const View view = view_at(camera, from.frame + 0.01 * step * (to.frame - from.frame));
            const auto expect_between = [&](double value, double a, double b) {
                EXPECT_GE(value, std::min(a, b) - 1e-9) << "between keys " << i << " and " << i + 1;
                EXPECT_LE(value, std::max(a, b) + 1e-9) << "between keys " << i << " and " << i + 1;
            };
            expect_between(view.position_m.z, from.position_m.z, to.position_m.z);
            expect_between(view.fov_deg(), *from.fov_deg, *to.fov_deg);
        }
    }
    EXPECT_EQ(view_at(camera, 50.0), view_at(camera, 40.0)) << "equal keys are a stand";
    EXPECT_EQ(view_at(camera, -5.0), view_at(camera, 1.0));
    EXPECT_EQ(view_at(camera, 95.0), view_at(camera, 90.0));
}

TEST(View, OneOrTwoSmoothKeysAreTheLinearOnes) {
    for (const std::size_t count : {1, 2}) {
        Camera smooth = smooth_camera();
        smooth.keys.resize(count);
        Camera straight = smooth;
        straight.interpolation = CameraInterpolation::Linear;
        for (double frame = 0.0; frame < 40.0; frame += 0.25)
            EXPECT_EQ(view_at(smooth, frame), view_at(straight, frame));
    }
}

// Keys on a circle, at any angle to the axes, give nearly the circle: straight lines would cut off 8 % of its radius.
TEST(View, ASmoothWayDoesNotDependOnTheAxes) {
    for (const double turned : {0.0, 0.3, 0.7}) {
        Camera camera;
        camera.interpolation = CameraInterpolation::Smooth;
        for (int i = 0; i < 9; ++i) {
            const double angle = turned + i * kPi / 4.0;
            camera.keys.push_back({.frame = 10 * i, .position_m = {std::cos(angle), std::sin(angle), 2.0}});
        }
        for (double frame = 10.0; frame <= 70.0; frame += 0.5)
            EXPECT_NEAR(glm::length(glm::dvec2(view_at(camera, frame).position_m)), 1.0, 0.02) << turned;
    }
}

TEST(View, KeysMayZoomAndRoll) {
    Camera camera;
    camera.fov_deg = 40.0;
    camera.keys = {{.frame = 10, .position_m = {0.0, 0.0, 2.0}, .look_at_m = {0.0, 10.0, 2.0}},
                   {.frame = 20,
                    .position_m = {0.0, 0.0, 2.0},
                    .look_at_m = {0.0, 10.0, 2.0},
                    .fov_deg = 60.0,
                    .roll_deg = 180.0}};
    EXPECT_NEAR(view_at(camera, 1.0).fov_deg(), 40.0, 1e-13) << "a key without an angle has the camera's";
    EXPECT_NEAR(view_at(camera, 15.0).fov_deg(), 50.0, 1e-13);
    EXPECT_NEAR(view_at(camera, 30.0).fov_deg(), 60.0, 1e-13);
    expect_near(view_at(camera, 10.0).right, {1.0, 0.0, 0.0}, 0.0);
    // A quarter turn: the right side points down, and the picture's top is where the right side was.
    expect_near(view_at(camera, 15.0).right, {0.0, 0.0, -1.0}, 1e-15);
    expect_near(view_at(camera, 15.0).up, {1.0, 0.0, 0.0}, 1e-15);
    expect_near(view_at(camera, 15.0).forward, {0.0, 1.0, 0.0}, 0.0);
    expect_near(view_at(camera, 20.0).up, {0.0, 0.0, -1.0}, 1e-15);
}

TEST(View, StandsUprightAndLooksAlongZWithNorthUp) {
    for (const glm::dvec3 target : {glm::dvec3(3.0, 4.0, -2.0), {-5.0, 1.0, 9.0}, {0.0, -1.0, 0.0}}) {
        const View view = view_at(camera_with({0.0, 0.0, 0.0}, target), 1.0);
        expect_near(view.forward, glm::normalize(target), 1e-15);
        EXPECT_NEAR(view.right.z, 0.0, 1e-15);
        EXPECT_GT(view.up.z, 0.0);
        expect_near(glm::cross(view.right, view.forward), view.up, 1e-15);
        EXPECT_NEAR(glm::length(view.up), 1.0, 1e-15);
    }
    const View down = view_at(camera_with({1.0, 2.0, 50.0}, {1.0, 2.0, 0.0}), 1.0);
    expect_near(down.up, {0.0, 1.0, 0.0}, 1e-15);
    expect_near(down.right, {1.0, 0.0, 0.0}, 1e-15);
    const View up = view_at(camera_with({1.0, 2.0, -50.0}, {1.0, 2.0, 0.0}), 1.0);
    expect_near(up.up, {0.0, 1.0, 0.0}, 1e-15);
    expect_near(up.right, {-1.0, 0.0, 0.0}, 1e-15);
}

TEST(View, TheBordersAreHalfTheFieldOfViewAway) {
    Camera camera = camera_with({0.0, 0.0, 3.0}, {0.0, 7.0, 3.0});
    camera.fov_deg = 70.0;
    camera.resolution = {640, 480};
    const View view = view_at(camera, 1.0);
    const double half = 35.0 * kPi / 180.0;
    expect_near(view.direction({320.0, 240.0}), {0.0, 1.0, 0.0}, 1e-15);
    expect_near(view.direction({640.0, 240.0}), {std::sin(half), std::cos(half), 0.0}, 1e-15);
    const double tan_top = std::tan(half) * 480.0 / 640.0;
    expect_near(view.direction({320.0, 0.0}), glm::normalize(glm::dvec3(0.0, 1.0, tan_top)), 1e-15);
}

// A point seen through a pixel projects onto that pixel, also a million metres from the world's origin.
TEST(View, ClipCoordinatesAgreeWithDirections) {
    Camera camera = camera_with({1e6, -1e6, 12.0}, {1e6 + 30.0, -1e6 + 50.0, 4.0});
    camera.resolution = {1920, 800};
    const View view = view_at(camera, 1.0);
    const glm::dvec3 origin_m(1e6 + 5.0, -1e6 - 3.0, 0.0);
    const double near_m = 0.1;
    const glm::mat4 clip(view.clip_from(origin_m, near_m));  // in single precision, as in a shader
    for (const glm::dvec2 pixel : {glm::dvec2(0.5, 0.5), {1700.25, 90.0}, {960.0, 400.0}, {3.0, 799.0}})
        for (const double distance_m : {0.2, 30.0, 4000.0}) {
            const glm::dvec3 p = view.position_m - origin_m + distance_m * view.direction(pixel);
            const glm::vec4 c = clip * glm::vec4(glm::vec3(p), 1.0f);
            // Rounding coordinates of some 10 m to single precision moves a point 0.2 m away by up to 1e-6 m:
            // 5e-6 of half the picture, a hundredth of a pixel.
            EXPECT_NEAR(0.5 * (1.0 + c.x / c.w) * 1920.0, pixel.x, 0.02);
            EXPECT_NEAR(0.5 * (1.0 - c.y / c.w) * 800.0, pixel.y, 0.02);
            const double depth_m = distance_m * glm::dot(view.direction(pixel), view.forward);
            EXPECT_NEAR(c.z / c.w, 1.0 - 2.0 * near_m / depth_m, 2e-5);
        }
    // The projection has no far plane: the horizon's depth is 1.
    const glm::dvec4 horizon = view.clip_from(view.position_m, near_m) * glm::dvec4(1e12 * view.forward, 1.0);
    EXPECT_LE(horizon.z, horizon.w);
    EXPECT_NEAR(horizon.z / horizon.w, 1.0, 1e-12);
    const glm::dvec4 nearest =
        view.clip_from(view.position_m, near_m) * glm::dvec4(near_m * view.forward, 1.0);
    EXPECT_NEAR(nearest.z / nearest.w, -1.0, 1e-12);
}

}  // namespace
}  // namespace pelagic
