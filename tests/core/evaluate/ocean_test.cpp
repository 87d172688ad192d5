// The water at a place as others ask for it: that of the query, wherever the place is, whoever asks beside.
#include "pelagic/ocean.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <thread>
#include <vector>

#include "tests/core/waves/samples.h"

namespace pelagic {
namespace {

using namespace test;

constexpr double kFootprint_m = 0.5;

Scene gale() {
    Scene scene;
    scene.sea.wind_speed_mps = 15.0;
    scene.waves.cascades = {{.size_m = 250.0, .resolution = 256}, {.size_m = 31.0, .resolution = 128}};
    return scene;
}
std::vector<glm::dvec2> places(int count, glm::dvec2 origin_m = {}) {
    std::vector<glm::dvec2> places;
    for (const glm::dvec2 place : random_points<double>(3000.0, count)) places.push_back(place + origin_m);
    return places;
}
std::vector<WaterState> asked(const Ocean& ocean, const std::vector<glm::dvec2>& places) {
    std::vector<WaterState> water(places.size());
    ocean.water_at(places, water);
    return water;
}
bool same(const WaterState& a, const WaterState& b) {
    return a.height_m == b.height_m && a.normal == b.normal && a.velocity_mps == b.velocity_mps;
}

TEST(Ocean, TheWaterIsThatOfThePointThatIsDisplacedThere) {
    Ocean ocean(gale(), kFootprint_m);
    ocean.set(2.5);
    const auto frame =
        frame_of<double>(gale(), {filtered(products(Position, Normal, Velocity), kFootprint_m)}, 2.5);
    const auto rest = random_points<double>(3000.0, 1000);
    Values values;
    QueryRunner<double>().run(frame, 0, Points<double>{.count = rest.size(), .rest_m = {rest.data()}},
                              values);
    std::vector<glm::dvec2> there;
    for (const auto& position : values.vectors(Position)) there.emplace_back(position);
    const std::vector<WaterState> water = asked(ocean, there);
    for (std::size_t i = 0; i < rest.size(); ++i) {
        EXPECT_NEAR(water[i].height_m, values.vectors(Position)[i].z, 3e-3f) << i;
        EXPECT_LT(glm::length(water[i].normal - values.vectors(Normal)[i]), 0.02f) << i;
        EXPECT_LT(glm::length(water[i].velocity_mps - values.vectors(Velocity)[i]), 0.02f) << i;
    }
}

TEST(Ocean, AThousandFloatsAreAnsweredAsOne) {
    Ocean ocean(gale(), kFootprint_m);
    ocean.set(2.5);
    const auto floats = places(1000);
    const std::vector<WaterState> together = asked(ocean, floats);
    for (const std::size_t i : {0, 1, 500, 999})
        EXPECT_TRUE(same(ocean.water_at(floats[i]), together[i])) << i;
    EXPECT_TRUE(asked(ocean, {}).empty());
}

TEST(Ocean, ThreadsMayAskTogether) {
    Ocean ocean(gale(), kFootprint_m);
    ocean.set(2.5);
    const auto floats = places(300);
    const std::vector<WaterState> expected = asked(ocean, floats);
    std::vector<std::vector<WaterState>> answers(4);
    std::vector<std::thread> threads;
    for (auto& answer : answers) threads.emplace_back([&] { answer = asked(ocean, floats); });
    for (std::thread& thread : threads) thread.join();
    for (const auto& answer : answers)
        EXPECT_TRUE(std::equal(answer.begin(), answer.end(), expected.begin(), expected.end(), same));
}

// The sea repeats after its largest cascade; a million metres away single precision alone would lose 6 cm.
TEST(Ocean, AFarPlaceLosesNothing) {
    Scene scene = gale();
    scene.waves.tiling = Tiling::Periodic;
    scene.waves.cascades = {{.size_m = 256.0, .resolution = 256}};
    Ocean ocean(scene, kFootprint_m);
    for (const double away_m : {256.0, 1048576.0, 256.0 * 3906250.0 - 4096.0})
        EXPECT_NEAR(ocean.water_at({3.25 + away_m, -8.5 - away_m}).height_m,
                    ocean.water_at({3.25, -8.5}).height_m, 2e-3f);
}

TEST(Ocean, TheTimeIsTheLastThatWasSet) {
    Ocean ocean(gale(), kFootprint_m);
    const WaterState at_begin = ocean.water_at({3.0, -8.0});
    ocean.set(7.0);
    const WaterState later = ocean.water_at({3.0, -8.0});
    EXPECT_FALSE(same(later, at_begin));
    ocean.set(0.0);
    EXPECT_TRUE(same(ocean.water_at({3.0, -8.0}), at_begin));
    Ocean moved = std::move(ocean);
    moved.set(7.0);
    EXPECT_TRUE(same(moved.water_at({3.0, -8.0}), later));
}

TEST(Ocean, AFoldedSeaIsFiniteAtEachTime) {
    Scene scene = gale();
    scene.waves.choppiness = 8.0;
    Ocean ocean(scene, kFootprint_m);
    for (const double t_s : {0.0, 1.0, 0.5}) {
        ocean.set(t_s);
        for (const WaterState& water : asked(ocean, places(50))) {
            for (const float value : {water.height_m, water.normal.x, water.normal.y, water.normal.z,
                                      water.velocity_mps.x, water.velocity_mps.y, water.velocity_mps.z})
                EXPECT_TRUE(std::isfinite(value));
        }
    }
}

TEST(Ocean, WhatIsNotAcceptedIsRefused) {
    Ocean ocean(gale(), kFootprint_m);
    for (const double no_place : {std::nan(""), std::numeric_limits<double>::infinity(), 2e9})
        EXPECT_THROW(ocean.water_at({no_place, 0.0}), std::invalid_argument);
    const std::vector<glm::dvec2> two(2);
    std::vector<WaterState> one(1);
    EXPECT_THROW(ocean.water_at(two, one), std::invalid_argument);
    EXPECT_THROW(ocean.set(std::nan("")), std::invalid_argument);
    EXPECT_THROW(Ocean(gale(), -1.0), std::invalid_argument);
    Scene no_scene = gale();
    no_scene.sea.wind_speed_mps = -3.0;
    EXPECT_THROW(Ocean{no_scene}, std::invalid_argument);
    // A budget is for outputs: what is asked at places has its own footprint.
    Scene hurried = gale();
    hurried.quality.frame_ms = 0.01;
    EXPECT_TRUE(same(Ocean(hurried, kFootprint_m).water_at({1.0, 2.0}), ocean.water_at({1.0, 2.0})));
}

}  // namespace
}  // namespace pelagic
