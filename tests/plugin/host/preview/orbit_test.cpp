// The preview's camera: movements can be undone, invariants hold, and no pose is special.
#include "plugin/host/preview/orbit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <random>
#include <vector>

#include "core/base/constants.h"

namespace pelagic {
namespace {

// Sums and a few trigonometric functions in double: some 1e-16 of the largest number, over tens of steps.
constexpr double kRounding = 1e-12;

constexpr double kHalfPi = 0.5 * kPi;

// A pose with a heading and a pitch, without roll.
View pose(glm::dvec3 position_m, double heading, double pitch) {
    View view;
    view.position_m = position_m;
    view.forward = {std::cos(pitch) * std::cos(heading), std::cos(pitch) * std::sin(heading),
                    std::sin(pitch)};
    view.right = {std::sin(heading), -std::cos(heading), 0.0};
    view.up = glm::cross(view.right, view.forward);
    return view;
}

// Poses from the water's edge to 20 km, at the origin and a million metres away, also straight down and up.
std::vector<View> poses() {
    std::vector<View> all;
    for (const double height_m : {0.5, 4.0, 300.0, 20e3})
        for (const double pitch : {-kHalfPi, -1.5, -0.7, -0.01, 0.0, 0.3, kHalfPi})
            for (const double heading : {0.0, 1.0, kHalfPi, 3.0, -2.0})
                for (const double x_m : {0.0, 1e6})
                    all.push_back(pose({x_m, -60.0, height_m}, heading, pitch));
    return all;
}

OrbitCamera camera_at(const View& view) {
    OrbitCamera camera;
    camera.take(view);
    return camera;
}

void expect_same_directions(const View& a, const View& b, double tolerance) {
    EXPECT_LE(glm::length(a.right - b.right), tolerance);
    EXPECT_LE(glm::length(a.up - b.up), tolerance);
    EXPECT_LE(glm::length(a.forward - b.forward), tolerance);
}

TEST(Orbit, ATakenViewComesBack) {
    for (const View& view : poses()) {
        const View back = camera_at(view).view(view);
        EXPECT_EQ(back.position_m, view.position_m);
        expect_same_directions(back, view, kRounding);
        EXPECT_EQ(back.tan_half_width, view.tan_half_width);
        EXPECT_EQ(back.resolution, view.resolution);
    }
}

TEST(Orbit, TheMiddleIsOnTheSeaWhereTheGazeMeetsIt) {
    const OrbitCamera down = camera_at(pose({5.0, 6.0, 100.0}, 0.3, -0.8));
    EXPECT_NEAR(down.middle_m().z, 0.0, 100.0 * kRounding);
    EXPECT_NEAR(down.distance_m(), 100.0 / std::sin(0.8), 100.0 * kRounding);
    // Where the sea isn't in the middle, the pivot is straight ahead at a finite distance.
    for (const double pitch : {0.0, 0.5, -1e-6}) {
        const OrbitCamera level = camera_at(pose({5.0, 6.0, 100.0}, 0.3, pitch));
        EXPECT_GT(level.distance_m(), 100.0);
        EXPECT_LT(level.distance_m(), 40e3);
    }
}

TEST(Orbit, TurningRoundKeepsTheMiddleAndTheDistance) {
    for (const View& view : poses()) {
        OrbitCamera camera = camera_at(view);
        const glm::dvec3 middle = camera.middle_m();
        const double distance_m = camera.distance_m();
        const double scale_m = glm::length(middle) + distance_m;
        // The lowest height limits how far down the camera may go; these small rotations stay above it.
        if (middle.z + distance_m < kLowest_m || view.forward.z > -0.1 || view.position_m.z < 4.0) continue;
        for (const glm::dvec2 angle : {glm::dvec2(0.3, 0.05), glm::dvec2(-2.0, -0.4), glm::dvec2(9.0, 3.0)}) {
            camera.orbit(angle);
            EXPECT_NEAR(glm::length(camera.middle_m() - middle), 0.0, kRounding * scale_m);
            EXPECT_NEAR(glm::length(camera.position_m() - middle), distance_m, kRounding * scale_m);
        }
    }
}

TEST(Orbit, TurnsAreUndoneByTheirOpposites) {
    const View view = pose({1e6, -40.0, 200.0}, 0.4, -0.6);
    OrbitCamera camera = camera_at(view);
    camera.orbit({0.7, -0.3});
    EXPECT_GT(glm::length(camera.position_m() - view.position_m), 10.0) << "it did move";
    camera.orbit({-0.7, 0.3});
    EXPECT_LE(glm::length(camera.position_m() - view.position_m), 1e6 * kRounding);
    camera.look({0.5, 0.2});
    camera.look({-0.5, -0.2});
    expect_same_directions(camera.view(view), view, kRounding);
    camera.zoom(3.5);
    EXPECT_LT(camera.position_m().z, 0.6 * view.position_m.z) << "3.5 steps of 15 % leave 57 %";
    camera.zoom(-3.5);
    EXPECT_LE(glm::length(camera.position_m() - view.position_m), 1e6 * kRounding);
}

TEST(Orbit, StraightDownIsNoSpecialPose) {
    // Over the vertical and back in small steps: no axis of the picture moves by more than a step.
    for (const bool round_the_middle : {true, false}) {
        const View view = pose({3.0, 4.0, 500.0}, 0.9, -1.4);
        OrbitCamera camera = camera_at(view);
        View last = camera.view(view);
        bool was_vertical = false;
        for (int i = 0; i < 60; ++i) {
            const double step = i < 30 ? -0.01 : 0.01;
            round_the_middle ? camera.orbit({0.0, step}) : camera.look({0.0, step});
            const View now = camera.view(view);
            // A chord is shorter than its arc.
            expect_same_directions(now, last, 0.01 + kRounding);
            was_vertical = was_vertical || now.forward.z == -1.0;
            last = now;
        }
        EXPECT_TRUE(was_vertical);
        EXPECT_LE(glm::length(last.right - view.right), kRounding);
    }
    // At the vertical, rotations are about the picture's centre: up follows the heading.
    OrbitCamera camera = camera_at(pose({0.0, 0.0, 500.0}, kHalfPi, -kHalfPi));
    EXPECT_LE(glm::length(camera.view(View{}).up - glm::dvec3(0.0, 1.0, 0.0)), kRounding);
    camera.orbit({0.25, 0.0});
    EXPECT_LE(glm::length(camera.view(View{}).up - glm::dvec3(-std::sin(0.25), std::cos(0.25), 0.0)),
              kRounding);
    EXPECT_NEAR(glm::length(camera.position_m() - glm::dvec3(0.0, 0.0, 500.0)), 0.0, 500.0 * kRounding);
}

TEST(Orbit, WhatIsInTheMiddleFollowsTheHand) {
    const View lens = pose({10.0, 20.0, 80.0}, -1.1, -0.5);
    OrbitCamera camera = camera_at(lens);
    const glm::dvec3 grabbed = camera.middle_m();
    const glm::dvec2 hand(37.0, -21.0);
    camera.pan(hand, lens);
    // The pixel that shows the point now, by the pinhole model: tangents from the picture's centre.
    const View view = camera.view(lens);
    const glm::dvec3 to = grabbed - view.position_m;
    const double depth_m = glm::dot(to, view.forward);
    EXPECT_NEAR(glm::dot(to, view.right) / depth_m / view.pixel_tangent(), hand.x, 1e-9);
    EXPECT_NEAR(-glm::dot(to, view.up) / depth_m / view.pixel_tangent(), hand.y, 1e-9);
}

TEST(Orbit, AFlightIsACamerasHeightASecond) {
    for (const double height_m : {10.0, 1000.0}) {
        const View view = pose({0.0, 0.0, height_m}, 0.0, 0.0);
        OrbitCamera camera = camera_at(view);
        camera.fly({.steering = {0.0, 1.0, 0.0}, .seconds = 2.0});
        EXPECT_NEAR(camera.position_m().x, 2.0 * height_m, height_m * kRounding);
        EXPECT_NEAR(camera.position_m().z, height_m, height_m * kRounding);
        camera.fly({.steering = {1.0, 0.0, 0.0}, .seconds = 1.0, .haste = 5.0});  // right of +x is −y
        EXPECT_NEAR(camera.position_m().y, -5.0 * height_m, height_m * kRounding);
    }
    // In level flight the frame rate doesn't matter.
    OrbitCamera whole = camera_at(pose({0.0, 0.0, 30.0}, 0.7, 0.0)), halves = whole;
    whole.fly({.steering = {0.3, 1.0, 0.0}, .seconds = 0.5});
    for (int i = 0; i < 2; ++i) halves.fly({.steering = {0.3, 1.0, 0.0}, .seconds = 0.25});
    EXPECT_LE(glm::length(whole.position_m() - halves.position_m()), 30.0 * kRounding);
}

TEST(Orbit, HandsStayBetweenTheWaterAndTwentyKilometres) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> anything(-1.0, 1.0);
    int low = 0, high = 0;
    for (const View& view : poses()) {
        OrbitCamera camera = camera_at(view);
        for (int i = 0; i < 40; ++i) {
            switch (random() % 5) {
                case 0:
                    camera.orbit({7.0 * anything(random), 3.0 * anything(random)});
                    break;
                case 1:
                    camera.look({7.0 * anything(random), 3.0 * anything(random)});
                    break;
                case 2:
                    camera.pan({4000.0 * anything(random), 4000.0 * anything(random)}, view);
                    break;
                case 3:
                    camera.zoom(60.0 * anything(random));
                    break;
                default:
                    camera.fly({.steering = {anything(random), anything(random), anything(random)},
                                .seconds = 2.0,
                                .haste = 5.0});
            }
            const View now = camera.view(view);
            ASSERT_GE(now.position_m.z, kLowest_m);
            ASSERT_LE(now.position_m.z, kHighest_m);
            ASSERT_TRUE(std::isfinite(now.position_m.x + now.position_m.y));
            ASSERT_NEAR(glm::length(now.forward), 1.0, kRounding);
            ASSERT_NEAR(glm::dot(now.up, now.forward), 0.0, kRounding);
            ASSERT_GE(now.up.z, 0.0) << "never upside down";
            low += now.position_m.z == kLowest_m;
            high += now.position_m.z == kHighest_m;
        }
    }
    EXPECT_GT(low, 0);
    EXPECT_GT(high, 0);
}

TEST(Orbit, AShotsCameraMayBeAnywhereUntilItIsTouched) {
    const View view = pose({0.0, 0.0, -3.0}, 0.0, 0.2);  // under water, looking up
    OrbitCamera camera = camera_at(view);
    EXPECT_EQ(camera.view(view).position_m.z, -3.0);
    camera.look({0.1, 0.0});
    EXPECT_EQ(camera.view(view).position_m.z, kLowest_m);
}

}  // namespace
}  // namespace pelagic
