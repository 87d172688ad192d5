// The camera's layer. That OpenUSD and three.js find each pose in it is tested by
// usd.openusd_reads_moving_usdc and usd.three_reads_crates.
#include "plugin/format/usd/camera.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "plugin/format/usd/crate_layer.h"

namespace pelagic::usd {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

// USD's rotateXYZ: about x first, then y, then z.
glm::dvec3 rotated(const glm::dvec3& angles_deg, glm::dvec3 v) {
    for (int axis = 0; axis < 3; ++axis) {
        const double angle = angles_deg[axis] * kDegree;
        const int i = (axis + 1) % 3, j = (axis + 2) % 3;
        const glm::dvec3 before = v;
        v[i] = before[i] * std::cos(angle) - before[j] * std::sin(angle);
        v[j] = before[i] * std::sin(angle) + before[j] * std::cos(angle);
    }
    return v;
}

CameraPose pose_of(const glm::dvec3& angles_deg, const glm::dvec3& position_m = {}) {
    return {.position_m = position_m,
            .right = rotated(angles_deg, {1, 0, 0}),
            .up = rotated(angles_deg, {0, 1, 0}),
            .backward = rotated(angles_deg, {0, 0, 1})};
}

// How far the axes are from those of a rotation by these angles.
double error_of(const glm::dvec3& angles_deg, const CameraPose& pose) {
    const CameraPose other = pose_of(angles_deg);
    return std::max({glm::distance(pose.right, other.right), glm::distance(pose.up, other.up),
                     glm::distance(pose.backward, other.backward)});
}

double largest(const glm::dvec3& v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

// A few roundings of unit vectors and of angles of some turns.
constexpr double kTolerance = 1e-14, kTolerance_deg = 1e-11;

TEST(UsdCamera, LevelViewsHaveTheAnglesThatPeopleExpect) {
    // Along +y, +x, −y and straight down and up, the picture's top towards +y.
    EXPECT_EQ(rotate_xyz_deg(CameraPose{}, {}), glm::dvec3(90, 0, 0));
    EXPECT_EQ(rotate_xyz_deg({{}, {0, -1, 0}, {0, 0, 1}, {-1, 0, 0}}, {}), glm::dvec3(90, 0, -90));
    EXPECT_EQ(rotate_xyz_deg({{}, {-1, 0, 0}, {0, 0, 1}, {0, 1, 0}}, {0, 0, 1}), glm::dvec3(90, 0, 180));
    EXPECT_EQ(rotate_xyz_deg({{}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {}), glm::dvec3(0, 0, 0));
    EXPECT_EQ(rotate_xyz_deg({{}, {1, 0, 0}, {0, -1, 0}, {0, 0, -1}}, {1, 0, 0}), glm::dvec3(180, 0, 0));
}

TEST(UsdCamera, AnglesGiveThePoseBackForEveryRotation) {
    for (double pitch = -180.0; pitch <= 540.0; pitch += 22.5) {
        for (double roll = -180.0; roll <= 180.0; roll += 22.5) {  // 90 among them: right is vertical
            for (double heading = -360.0; heading <= 360.0; heading += 22.5) {
                const CameraPose pose = pose_of({pitch, roll, heading});
                for (const glm::dvec3& before : {glm::dvec3(0), glm::dvec3(90, 0, 1000)})
                    ASSERT_LT(error_of(rotate_xyz_deg(pose, before), pose), kTolerance)
                        << pitch << " " << roll << " " << heading;
            }
        }
    }
    // Right is nearly vertical: heading and pitch are badly determined, the pose is not.
    for (const double off_deg : {1e-3, 1e-6, 1e-7, 1e-8, 1e-9, 1e-13}) {
        const CameraPose pose = pose_of({37.0, 90.0 - off_deg, 110.0});
        EXPECT_LT(error_of(rotate_xyz_deg(pose, {}), pose), 2e-9) << off_deg;  // below it, heading is kept
    }
}

TEST(UsdCamera, AnglesGoOnFromFrameToFrame) {
    // Several turns of heading, over the vertical by pitch, and a whole turn of roll.
    for (const glm::dvec3& step_deg : {glm::dvec3(0, 0, 17), glm::dvec3(0, 0, -23), glm::dvec3(7, 0, 0),
                                       glm::dvec3(-7, 0, 3), glm::dvec3(0, 7.3, 2), glm::dvec3(0, 10, 0)}) {
        const glm::dvec3 start_deg(80, 0, 170);
        glm::dvec3 angles_deg = start_deg;
        for (int frame = 0; frame < 100; ++frame) {
            const glm::dvec3 wanted_deg = start_deg + static_cast<double>(frame) * step_deg;
            angles_deg = rotate_xyz_deg(pose_of(wanted_deg), angles_deg);
            ASSERT_LT(largest(angles_deg - wanted_deg), 1e-6)
                << frame << ": " << step_deg.x << " " << step_deg.y << " " << step_deg.z;
        }
    }
}

TEST(UsdCamera, LevelCameraStaysLevelOverTheVertical) {
    // A camera with a level horizon that passes the zenith turns its heading by half a turn, from one frame
    // to the next; its roll stays 0.
    glm::dvec3 angles_deg(0);
    for (const double pitch : {170.0, 178.0, 180.0})
        angles_deg = rotate_xyz_deg(pose_of({pitch, 0, 30}), angles_deg);
    for (const double pitch : {178.0, 170.0}) {
        angles_deg = rotate_xyz_deg(pose_of({pitch, 0, 210}), angles_deg);
        EXPECT_LT(error_of(angles_deg, pose_of({pitch, 0, 210})), kTolerance);
        EXPECT_LT(std::abs(angles_deg.y), kTolerance_deg);
    }
}

TEST(UsdCamera, PosesThatAreNoRotationAreRefused) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_NO_THROW(check(pose_of({12, 34, 56}, {1, 2, 3}), 1));
    const auto expect_refused = [](const CameraPose& pose) {
        EXPECT_THROW(check(pose, 1), std::invalid_argument);
        bool called = false;
        const Camera camera{.last_frame = 9, .key_frames = {8, 9}, .pose_at = [&](int frame) {
                                return frame < 9 ? CameraPose{} : pose;
                            }};
        EXPECT_THROW(write_camera_crate(camera, [&](std::string_view) { called = true; }),
                     std::invalid_argument);
        EXPECT_FALSE(called) << "the last pose is checked before anything is written";
    };
    expect_refused({.position_m = {0, nan, 0}});
    expect_refused({.right = {nan, 0, 0}});
    expect_refused({.right = {2, 0, 0}});
    expect_refused({.up = {0, 1, 0}});
    expect_refused({.right = {-1, 0, 0}});  // left-handed
    expect_refused({.backward = {0, nan, 0}});
}

TEST(UsdCamera, CamerasThatNoStageCanHaveAreRefused) {
    const auto pose = [](int) { return CameraPose{}; };
    EXPECT_NO_THROW(camera_crate({.pose_at = pose}));
    EXPECT_THROW(camera_crate({}), std::invalid_argument);
    EXPECT_THROW(camera_crate({.fps = 0.0, .pose_at = pose}), std::invalid_argument);
    EXPECT_THROW(camera_crate({.first_frame = 2, .last_frame = 1, .pose_at = pose}), std::invalid_argument);
    EXPECT_THROW(camera_crate({.pose_at = [](int) { return CameraPose{.fov_deg = 180.0}; }}),
                 std::invalid_argument);
    EXPECT_THROW(camera_crate({.pose_at = pose, .clipping_m = {0.0, 1.0}}), std::invalid_argument);
    EXPECT_THROW(camera_crate({.pose_at = pose, .clipping_m = {2.0, 1.0}}), std::invalid_argument);
}

// Whoever asks at no time gets the shot's first frame, and no fallback of the schema's: a camera at the origin that looks down.
TEST(UsdCamera, WhatHasSamplesHasADefault) {
    const std::string bytes =
        camera_crate({.first_frame = 1, .last_frame = 9, .key_frames = {4, 6}, .pose_at = [](int frame) {
                          const double at = std::clamp(frame, 4, 6);
                          CameraPose pose = pose_of({80, 0, 10.0 * at}, {at, 2.0 * at, 7.5});
                          pose.fov_deg = 30.0 + at;
                          return pose;
                      }});
    const CrateLayer layer(bytes);
    const CrateLayer::Node camera = layer.prims_of(0).at(0);
    const auto property = [&](const char* name) {
        const auto found = layer.property(camera, name);
        EXPECT_TRUE(found && layer.has(*found, "timeSamples")) << name;
        return found.value_or(0);
    };
    EXPECT_EQ(layer.vector(property("xformOp:translate"), "default"), glm::dvec3(4.0, 8.0, 7.5));
    const auto angles_deg = layer.vector(property("xformOp:rotateXYZ"), "default");
    ASSERT_TRUE(angles_deg);
    EXPECT_LT(glm::distance(*angles_deg, glm::dvec3(80.0, 0.0, 40.0)), kTolerance_deg);
    const auto focal_length = layer.number(property("focalLength"), "default");
    ASSERT_TRUE(focal_length);
    EXPECT_EQ(*focal_length,
              static_cast<double>(static_cast<float>(film_back(34.0, Camera{}.resolution).focal_length)));
}

TEST(UsdCamera, SamplesCoverTheFramesBetweenWhichThePoseChanges) {
    const auto bytes_of = [](int first, int last, int from, int to) {
        return camera_crate({.first_frame = first,
                             .last_frame = last,
                             .key_frames = {from, to},
                             .pose_at =
                                 [=](int frame) {
                                     return pose_of({90, 0, 0}, {std::clamp(frame, from, to), 0, 0});
                                 }})
            .size();
    };
    // A time, two references and two vectors of three doubles.
    constexpr std::size_t kBytes = 8 + 2 * 8 + 2 * 24;
    const std::size_t one_step = bytes_of(1, 100, 50, 51);
    EXPECT_EQ(bytes_of(1, 100, 50, 60), one_step + 9 * kBytes);
    EXPECT_EQ(bytes_of(1, 100, 0, 200), one_step + 98 * kBytes);
    EXPECT_EQ(bytes_of(1, 2, 0, 200), one_step);
    // Moving only before or after the shot is standing still.
    const std::size_t still = bytes_of(1, 1, 0, 200);
    EXPECT_LT(still, one_step);
    EXPECT_EQ(bytes_of(1, 100, 0, 1), still);
    EXPECT_EQ(bytes_of(1, 100, 100, 200), still);
    EXPECT_EQ(bytes_of(1, 100000, 7, 7), still);
}

// What a reader that goes on lines between samples sees, beside the pose, at frames of a shot as long as there are any. The
// camera speeds up and slows down, turns once round, rolls, looks up and zooms.
TEST(UsdCamera, ALongShotHasSamplesWhereTheyAreNeeded) {
    constexpr int kFirst = -100000000, kLast = 100000000;
    const std::vector<int> keys{-90000000, -20000000, 5000000, 5000001, 80000000};
    std::size_t asked = 0;
    const auto pose_at = [&](int frame) {
        ++asked;
        const double at = std::clamp(frame, keys.front(), keys.back());
        const auto key = std::upper_bound(keys.begin(), keys.end() - 1, static_cast<int>(at));
        const double from = *(key - 1), share = (at - from) / (*key - from),
                     smooth = share * share * (3.0 - 2.0 * share);
        const double x = static_cast<double>(key - keys.begin()) + smooth;
        CameraPose pose = pose_of({80.0 + 5.0 * x, 3.0 * x, 120.0 * x}, {100.0 * x, -30.0 * x, 4.0});
        pose.fov_deg = 40.0 + 4.0 * x;
        return pose;
    };
    const Camera camera{.first_frame = kFirst, .last_frame = kLast, .key_frames = keys, .pose_at = pose_at};
    const Course course = course_of(camera);
    EXPECT_LT(course.frames.size(), 5000u);
    EXPECT_LT(asked, 200000u);
    ASSERT_EQ(course.samples.size(), course.frames.size());
    EXPECT_TRUE(std::is_sorted(course.frames.begin(), course.frames.end()));
    EXPECT_EQ(course.frames.front(), keys.front());
    EXPECT_EQ(course.frames.back(), keys.back());
    double place_m = 0.0, turn = 0.0, focal = 0.0;
    for (int frame = kFirst; frame < kLast - 40000; frame += 39979) {  // a prime
        const auto next = std::clamp<std::ptrdiff_t>(
            std::upper_bound(course.frames.begin(), course.frames.end(), frame) - course.frames.begin(), 1,
            std::ssize(course.frames) - 1);
        const auto i = static_cast<std::size_t>(next);
        const double share =
            std::clamp((frame - course.frames[i - 1]) / (course.frames[i] - course.frames[i - 1]), 0.0, 1.0);
        const CameraPose pose = pose_at(frame);
        place_m =
            std::max(place_m, glm::distance(pose.position_m, glm::mix(course.samples[i - 1].translate,
                                                                      course.samples[i].translate, share)));
        turn = std::max(turn, error_of(glm::mix(course.samples[i - 1].rotate_xyz_deg,
                                                course.samples[i].rotate_xyz_deg, share),
                                       pose));
        const double there = glm::mix(static_cast<double>(course.focal_lengths[i - 1]),
                                      static_cast<double>(course.focal_lengths[i]), share);
        focal =
            std::max(focal, std::abs(there / film_back(pose.fov_deg, camera.resolution).focal_length - 1.0));
    }
    // A pixel is 0.03 … 0.05 degrees here. What seven places between two samples show may be a little less than the most.
    EXPECT_LT(place_m, 1.2 * 2e-4);
    EXPECT_LT(turn, 1.2 * 0.02 * 0.05 * kDegree);
    EXPECT_LT(focal, 1.2 * 1e-5);
    const std::string crate = camera_crate(camera);
    EXPECT_LT(crate.size(), std::size_t{80} * course.frames.size() + 4096);
}

// One that stands still costs nothing, however long the shot and however many its keys.
TEST(UsdCamera, ALongStillShotHasNoSamples) {
    const auto still = [](int) { return CameraPose{}; };
    const Camera camera{
        .first_frame = -100000000, .last_frame = 100000000, .key_frames = {-5, 50000000}, .pose_at = still};
    EXPECT_TRUE(course_of(camera).samples.empty());
    Camera shorter = camera;
    shorter.first_frame = 1;
    shorter.last_frame = 2;
    EXPECT_EQ(camera_crate(camera).size(), camera_crate(shorter).size());
}

TEST(UsdCamera, FilmSeesTheFieldOfViewAndHasThePicturesShape) {
    for (const double fov_deg : {1.0, 50.0, 90.0, 179.0}) {
        const FilmBack film = film_back(fov_deg, {1920, 800});
        const double seen_rad = 2.0 * std::atan(0.5 * film.horizontal_aperture / film.focal_length);
        EXPECT_NEAR(seen_rad, fov_deg * std::numbers::pi / 180.0, 1e-14);  // roundings of angles below π
        EXPECT_DOUBLE_EQ(film.vertical_aperture / film.horizontal_aperture, 800.0 / 1920.0);
    }
    EXPECT_THROW(film_back(180.0, {1280, 720}), std::invalid_argument);
    EXPECT_THROW(film_back(std::numeric_limits<double>::quiet_NaN(), {1280, 720}), std::invalid_argument);
    EXPECT_THROW(film_back(50.0, {0, 1}), std::invalid_argument);
}

}  // namespace
}  // namespace pelagic::usd
