// The water above places, asked of everybody who says it: C, C++ and Python have one answer.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "pelagic/ocean.h"
#include "plugin/format/shot/shot.h"
#include "plugin/light/light.h"
#include "tests/plugin/host/procedural/opened.h"

namespace pelagic {
namespace {

using namespace test;

constexpr double kTime_s = 2.5, kFootprint_m = 0.5;

// Cascades of its own, so that who asks has no say in which there are.
std::string sea_text(double choppiness) {
    return "[sea]\nwind_speed_mps = 15.0\n[waves]\nchoppiness = " + std::to_string(choppiness) +
           "\ncascades = [ { size_m = 250.0, resolution = 256 }, { size_m = 31.0, resolution = 128 } ]\n";
}
std::vector<glm::dvec2> places() {
    std::vector<glm::dvec2> places;
    for (int i = 0; i < 60; ++i) places.emplace_back(7.3 * i - 200.0, 151.0 - 5.9 * i);
    return places;
}

struct InC {
    explicit InC(const std::string& text) {
        pelagic_open_options options = PELAGIC_INIT(pelagic_open_options);
        options.finest_cell_m = options.finest_pixel_m = kFootprint_m;
        sea = open_text(text, &options);
        frame = frame_of(sea, kTime_s, kTime_s);
    }
    pelagic_status ask(const std::vector<glm::dvec2>& places, double footprint_m,
                       pelagic_water* water) const {
        return pelagic_water_at(frame.get(), places.empty() ? nullptr : &places[0].x, places.size(),
                                footprint_m, water, &error);
    }
    SeaHandle sea;
    FrameHandle frame;
    mutable pelagic_error error{};
};

// x, y, … of each: heights, then normals and velocities.
std::vector<float> water_in_python(const std::string& text, const std::vector<glm::dvec2>& places) {
    std::string list;
    for (const glm::dvec2 place : places) {
        char one[80];
        std::snprintf(one, sizeof one, "(%.17g, %.17g),", place.x, place.y);
        list += one;
    }
    const std::string program =
        "import pelagic\nscene = pelagic.Scene.from_text('''" + text +
        "''')\nframe = pelagic.Frame(pelagic.Sea(scene, cell_m=0.5, pixel_m=0.5))\n"
        "frame.set(2.5)\nfound = frame.heights([" +
        list +
        "])\nfor h, n, v in zip(found['height_m'], found['normal'], found['velocity']):\n"
        "    print(*(float(x).hex() for x in (h, *n, *v)), sep='\\n')\n";
    FILE* pipe = popen((PELAGIC_PYTHON_COMMAND " -c \"" + program + "\"").c_str(), "r");
    std::vector<float> values;
    char line[80];
    while (pipe && std::fgets(line, sizeof line, pipe)) values.push_back(std::strtof(line, nullptr));
    EXPECT_TRUE(pipe && pclose(pipe) == 0);
    return values;
}

TEST(OneWater, IsTheSameInCAndCppAndPython) {
    // A sea, one with a lee and a slick, and one that has folded over itself.
    const std::string places_text =
        "masks = [ { east_m = -50.0, north_m = 40.0, edge_m = 90.0, waves = 0.3, ripples = 0.0 } ]\n";
    for (const std::string& text : {sea_text(1.0), sea_text(1.0) + places_text, sea_text(8.0)}) {
        const auto at = places();
        Ocean ocean(parse_shot(text, "shot.toml", check_scene), kFootprint_m);
        ocean.set(kTime_s);
        std::vector<WaterState> water(at.size());
        ocean.water_at(at, water);
        const InC c(text);
        std::vector<pelagic_water> c_water(at.size(), PELAGIC_INIT(pelagic_water));
        ASSERT_EQ(c.ask(at, 0.0, c_water.data()), PELAGIC_OK) << c.error.message;
        const std::vector<float> python = water_in_python(text, at);
        ASSERT_EQ(python.size(), 7 * at.size());
        for (std::size_t i = 0; i < at.size(); ++i) {
            const WaterState& here = water[i];
            const std::array<float, 7> values{here.height_m,      here.normal.x,       here.normal.y,
                                              here.normal.z,      here.velocity_mps.x, here.velocity_mps.y,
                                              here.velocity_mps.z};
            EXPECT_EQ(c_water[i].size, sizeof(pelagic_water));
            const pelagic_water& there = c_water[i];
            const std::array<float, 7> c_values{
                there.height_m,        there.normal[0],       there.normal[1],      there.normal[2],
                there.velocity_mps[0], there.velocity_mps[1], there.velocity_mps[2]};
            for (std::size_t k = 0; k < values.size(); ++k) {
                EXPECT_EQ(values[k], c_values[k]) << "C, place " << i << ", value " << k;
                EXPECT_EQ(values[k], python[7 * i + k]) << "Python, place " << i << ", value " << k;
            }
        }
    }
}

TEST(OneWater, InCItHasTheFootprintThatIsAskedFor) {
    const InC c(sea_text(1.0));
    const auto at = places();
    std::vector<pelagic_water> fine(at.size(), PELAGIC_INIT(pelagic_water)), coarse = fine;
    ASSERT_EQ(c.ask(at, 0.0, fine.data()), PELAGIC_OK);
    ASSERT_EQ(c.ask(at, 8.0, coarse.data()), PELAGIC_OK);
    const auto tilt = [](const std::vector<pelagic_water>& water) {
        double sum = 0.0;
        for (const pelagic_water& here : water) sum += 1.0 - static_cast<double>(here.normal[2]);
        return sum;
    };
    EXPECT_LT(tilt(coarse), 0.5 * tilt(fine));
}

// A program of a later version has longer structures, and gets what this one knows.
TEST(OneWater, InCEachIsAsLargeAsTheFirstSays) {
    struct Longer {
        pelagic_water water;
        double later;
    };
    const InC c(sea_text(1.0));
    const auto at = places();
    std::vector<pelagic_water> plain(at.size(), PELAGIC_INIT(pelagic_water));
    ASSERT_EQ(c.ask(at, 0.0, plain.data()), PELAGIC_OK);
    std::vector<Longer> longer(at.size(), Longer{.water = PELAGIC_INIT(pelagic_water), .later = 5.0});
    longer[0].water.size = sizeof(Longer);
    ASSERT_EQ(c.ask(at, 0.0, &longer[0].water), PELAGIC_OK);
    for (std::size_t i = 0; i < at.size(); ++i) {
        EXPECT_EQ(longer[i].water.height_m, plain[i].height_m);
        EXPECT_EQ(longer[i].later, 5.0);
    }
}

TEST(OneWater, InCWhatIsNotAcceptedIsRefusedAndChangesNothing) {
    const InC c(sea_text(1.0));
    pelagic_water water = PELAGIC_INIT(pelagic_water), none{};
    water.height_m = 77.0f;
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(c.ask({}, 0.0, nullptr), PELAGIC_OK);
    for (const double no_place : {nan, 2e9, -std::numeric_limits<double>::infinity()})
        EXPECT_EQ(c.ask({{1.0, no_place}}, 0.0, &water), PELAGIC_INVALID_ARGUMENT);
    for (const double no_footprint : {nan, -1.0, 1e7})
        EXPECT_EQ(c.ask({{1.0, 2.0}}, no_footprint, &water), PELAGIC_INVALID_ARGUMENT);
    EXPECT_EQ(c.ask({{1.0, 2.0}}, 0.0, nullptr), PELAGIC_INVALID_ARGUMENT);
    EXPECT_EQ(c.ask({{1.0, 2.0}}, 0.0, &none), PELAGIC_INVALID_ARGUMENT);
    const double place[2] = {1.0, 2.0};
    EXPECT_EQ(pelagic_water_at(nullptr, place, 1, 0.0, &water, nullptr), PELAGIC_INVALID_ARGUMENT);
    EXPECT_EQ(pelagic_water_at(c.frame.get(), nullptr, 1, 0.0, &water, nullptr), PELAGIC_INVALID_ARGUMENT);
    EXPECT_EQ(water.height_m, 77.0f);
}

}  // namespace
}  // namespace pelagic
