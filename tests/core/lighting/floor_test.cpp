// The floor's maps: where they lie, and how they are looked up.
#include "core/lighting/floor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "tests/core/lighting/optics.h"

namespace pelagic::optics {
namespace {

Optics::FloorView glsl(const FloorSeen& seen) {
    return {seen.is_seen, seen.z_m,          seen.curvature_per_m, seen.pixel,         seen.lowest_m,
            seen.depths,  seen.depths_per_m, seen.colours,         seen.colours_first, seen.light,
            seen.coarse,  seen.shafts,       seen.shafts_look};
}

Optics shading_of(const Floor& floor) {
    Optics optics;
    optics.floor_values = floor.values();
    return optics;
}

// Rises by 0.5 a metre towards the east.
Floor beach() {
    std::vector<float> depths;
    for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 20; ++x) depths.push_back(10.0f - 0.5f * (static_cast<float>(x) + 0.5f));
    Floor floor(7.0);
    floor.set_depths({20, 4}, depths, {100.0, -2.0}, {20.0, 4.0});
    return floor;
}

TEST(Floor, IsAsDeepAsItsMapSaysAndGoesToTheLevelFloorBeyond) {
    const Floor floor = beach();
    for (double x = 100.5; x < 119.0; x += 0.37)
        EXPECT_NEAR(floor.depth_m({x, 0.3}), 10.0 - 0.5 * (x - 100.0), 1e-5);
    EXPECT_NEAR(floor.depth_m({99.99, 0.0}), 9.75, 1e-3);
    EXPECT_NEAR(floor.depth_m({97.5, 0.0}), 0.5 * (9.75 + 7.0), 1e-5);
    EXPECT_NEAR(floor.depth_m({110.0, 3.01}), 7.0, 1e-5);
    for (const glm::dvec2 far : {glm::dvec2(-5e5, 8.0), glm::dvec2(5e5, -8.0), glm::dvec2(1e12, -1e12)})
        EXPECT_EQ(floor.depth_m(far), 7.0);
    EXPECT_EQ(Floor(7.0).depth_m({3.0, 4.0}), 7.0);
}

TEST(Floor, ARayMeetsTheSlope) {
    const Floor floor = beach();
    const glm::dvec3 eye(104.0, 0.0, 2.0);
    Optics optics = shading_of(floor);
    // From the sea at rest at x = 104, a metre east per metre down: 8 − 0.5 d = d.
    const auto seen = optics.seen_floor(vec3(0.0f, 0.0f, -2.0f), vec2(1.0f, 0.0f), 0.0f, 0.01f,
                                        glsl(floor.seen_from({.position_m = eye})));
    EXPECT_NEAR(seen.depth_m, 8.0 / 1.5, 1e-3);
    EXPECT_EQ(seen.light, 1.0f);
    EXPECT_EQ(seen.colour, vec3(1.0f));
    // At so flat a sight the floor's slope is as steep as it: 8 − 0.5 · 10 d = d, and seawards it meets the level floor first.
    EXPECT_NEAR(optics
                    .seen_floor(vec3(0.0f, 0.0f, -2.0f), vec2(10.0f, 0.0f), 0.0f, 0.01f,
                                glsl(floor.seen_from({.position_m = eye})))
                    .depth_m,
                8.0 / 6.0, 1e-3);
    EXPECT_NEAR(optics
                    .seen_floor(vec3(0.0f, 0.0f, -2.0f), vec2(-10.0f, 0.0f), 0.0f, 0.01f,
                                glsl(floor.seen_from({.position_m = eye})))
                    .depth_m,
                7.0, 0.5);
    EXPECT_NEAR(floor.distance_m({104.0, 0.0, -1.0}, glm::normalize(glm::dvec3(1.0, 0.0, -1.0))),
                7.0 / 1.5 * std::sqrt(2.0), 1e-3);
    // A wave's trough below the floor still has some water.
    EXPECT_GT(optics
                  .seen_floor(vec3(15.0f, 0.0f, -9.0f), vec2(0.0f), 0.0f, 0.01f,
                              glsl(floor.seen_from({.position_m = eye})))
                  .depth_m,
              0.0f);
}

// Round the earth the sea drops away below the eye's level, and the floor with it.
TEST(Floor, LiesAsDeepFarAway) {
    const Floor floor(2.5);
    const double curvature = 1.0 / 6.371e6;
    Optics optics = shading_of(floor);
    const auto view = glsl(floor.seen_from({.position_m = {5.0, 5.0, 30.0}, .curvature_per_m = curvature}));
    for (const double far : {10.0, 1e3, 2e4}) {
        const vec3 surface(glm::dvec3(far, 0.0, -30.0 - 0.5 * curvature * far * far));
        EXPECT_TRUE(optics.is_floor_near(surface, view));
        EXPECT_NEAR(optics.seen_floor(surface, vec2(0.0f), 0.0f, 1.0f, view).depth_m, 2.5f, 0.01f) << far;
    }
    EXPECT_FALSE(optics.is_floor_near(vec3(4e4f, 0.0f, -150.0f), view));
}

TEST(Floor, APictureRepeatsAndBlursToItsMean) {
    std::vector<glm::vec3> chequers;
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x)
            chequers.push_back(vec3((x / 4 + y / 4) % 2 == 0 ? 1.0f : 0.2f, 0.5f, 0.0f));
    Floor floor(2.0);
    floor.set_colours(8, chequers, 4.0);
    Optics optics = shading_of(floor);
    for (const glm::dvec3 eye : {glm::dvec3(0.0), glm::dvec3(4e6 + 1.0, -8e6, 3.0)}) {
        const auto view = glsl(floor.seen_from({.position_m = eye}));
        const auto at = [&](double x, double y, float width) {
            return optics.floor_colour(vec2(glm::dvec2(x, y) - glm::fract(glm::dvec2(eye) / 4.0) * 4.0),
                                       width, view);
        };
        EXPECT_NEAR(at(1.0, 1.0, 0.01f).x, 1.0f, 1e-5f);
        EXPECT_NEAR(at(3.0, 1.0, 0.01f).x, 0.2f, 1e-5f);
        EXPECT_NEAR(at(-3.0, 5.0, 0.01f).x, 1.0f, 1e-5f);
        EXPECT_NEAR(at(2.3, 1.0, 100.0f).x, 0.6f, 1e-5f);
        EXPECT_NEAR(at(2.3, 1.0, 2.0f).y, 0.5f, 1e-5f);
    }
}

TEST(Floor, LightIsLookedUpWhereItsMapsAreAndFadesToEven) {
    Floor floor(2.0);
    constexpr int kSide = 64;
    const auto texels =
        floor.set_light({.side = kSide, .texel_m = 0.1, .from_m = {glm::dvec2(-3.2), glm::dvec2(-12.8)}});
    std::fill(texels.begin(), texels.begin() + kSide * kSide, 2.0f);
    std::fill(texels.begin() + kSide * kSide, texels.end(), 3.0f);
    Optics optics = shading_of(floor);
    const auto view = glsl(floor.seen_from({.position_m = {0.0, 0.0, 1.0}}));
    EXPECT_EQ(optics.floor_light(vec2(0.0f), 0.05f, view), 2.0f);
    EXPECT_EQ(optics.floor_light(vec2(6.0f, 0.0f), 0.05f, view), 3.0f);
    EXPECT_EQ(optics.floor_light(vec2(40.0f, 0.0f), 0.05f, view), 1.0f);
    EXPECT_EQ(optics.floor_light(vec2(0.0f), 0.4f, view), 3.0f);  // as wide as the coarser one's texels
    EXPECT_EQ(optics.floor_light(vec2(0.0f), 1.7f, view), 1.0f);
    // The finer one gives way over a quarter of its side, or its corner is seen.
    constexpr int kLarge = 2 * kSide;
    const std::span<float> large =
        floor.set_light({.side = kLarge, .texel_m = 0.1, .from_m = {glm::dvec2(-6.4), glm::dvec2(-25.6)}});
    std::fill(large.begin(), large.begin() + kLarge * kLarge, 2.0f);
    std::fill(large.begin() + kLarge * kLarge, large.end(), 3.0f);
    EXPECT_NEAR(shading_of(floor).floor_light(vec2(-4.7f, 0.0f), 0.05f,
                                              glsl(floor.seen_from({.position_m = {0.0, 0.0, 1.0}}))),
                2.5f, 1e-3f);
    floor.set_light({.side = kSide, .texel_m = 0.1, .gain = 0.5});
    EXPECT_EQ(shading_of(floor).floor_light(vec2(1e9f), 0.05f, glsl(floor.seen_from({}))), 1.0f);
    floor.set_light({});
    EXPECT_FALSE(floor.has_light());
}

TEST(Floor, MapsThatAreNoneAreRefused) {
    const auto depths = [](glm::ivec2 size, std::vector<float> values, glm::dvec2 size_m) {
        Floor floor;
        floor.set_depths(size, std::move(values), {}, size_m);
    };
    EXPECT_THROW(depths({0, 1}, {}, {1.0, 1.0}), std::invalid_argument);
    EXPECT_THROW(depths({1, 1}, {1.0f, 2.0f}, {1.0, 1.0}), std::invalid_argument);
    EXPECT_THROW(depths({1, 1}, {1.0f}, {0.0, 1.0}), std::invalid_argument);
    for (const float bad : {0.0f, -1.0f, std::numeric_limits<float>::quiet_NaN()})
        EXPECT_THROW(depths({1, 1}, {bad}, {1.0, 1.0}), std::invalid_argument);
    Floor floor;
    EXPECT_THROW(floor.set_colours(3, std::vector<glm::vec3>(9), 1.0), std::invalid_argument);
    EXPECT_THROW(floor.set_colours(2, std::vector<glm::vec3>(3), 1.0), std::invalid_argument);
}

}  // namespace
}  // namespace pelagic::optics
