// Bounds of regions while the shutter is open are never left; how much larger they are than needed is printed.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <glm/common.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "tests/plugin/host/procedural/opened.h"

namespace pelagic {
namespace {

using namespace test;

struct Box {
    glm::dvec3 low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};
};

// What so many points a side of the region do in the shutter's time, at footprints of this size.
Box seen(const FrameHandle& frame, const pelagic_region& region, int side, float footprint_m,
         double shutter_s) {
    std::vector<glm::vec2> rests;
    std::vector<float> times_s;
    for (int y = 0; y <= side; ++y)
        for (int x = 0; x <= side; ++x)
            for (const double share : {0.0, 0.5, 1.0}) {
                rests.emplace_back(static_cast<float>((region.max_m[0] - region.min_m[0]) * x / side),
                                   static_cast<float>((region.max_m[1] - region.min_m[1]) * y / side));
                times_s.push_back(static_cast<float>(share * shutter_s));
                if (shutter_s == 0.0) break;
            }
    const std::vector<float> footprints_m(rests.size(), footprint_m);
    std::vector<glm::vec3> positions(rests.size());
    pelagic_points points = PELAGIC_INIT(pelagic_points);
    points.origin_m[0] = region.min_m[0];
    points.origin_m[1] = region.min_m[1];
    points.count = rests.size();
    points.rest_m = &rests[0].x;
    points.cell_m = footprints_m.data();
    points.time_s = times_s.data();
    pelagic_values values = PELAGIC_INIT(pelagic_values);
    values.position_m = &positions[0].x;
    EXPECT_EQ(pelagic_evaluate(frame.get(), &points, &values, nullptr), PELAGIC_OK);
    Box box;
    for (const glm::vec3& position : positions) {
        const glm::dvec3 at = glm::dvec3(position) + glm::dvec3(region.min_m[0], region.min_m[1], 0.0);
        box.low = glm::min(box.low, at);
        box.high = glm::max(box.high, at);
    }
    return box;
}

// Of each Nth example, at so many points a side of each region, whose side is so many peak waves, or 1 m; finest_cell_m as
// pelagic_open_options has it.
void expect_never_left(std::size_t every, int side, const std::vector<double>& sides_in_waves,
                       double finest_cell_m) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    std::vector<std::filesystem::path> shots;
    for (const auto& entry : std::filesystem::directory_iterator(PELAGIC_SOURCE_DIR "/examples"))
        if (entry.path().extension() == ".toml") shots.push_back(entry.path());
    std::sort(shots.begin(), shots.end());
    ASSERT_GE(shots.size(), 8u);
    std::printf(
        "largest extent along an axis, of what %d x %d points reach; regions in peak waves, and of 1 m\n",
        side, side);
    for (std::size_t i = 0; i < shots.size(); i += every) {
        const std::filesystem::path& shot = shots[i];
        pelagic_open_options options = PELAGIC_INIT(pelagic_open_options);
        options.finest_cell_m = finest_cell_m;
        const SeaHandle sea = open_file(shot.string(), &options);
        pelagic_info info = PELAGIC_INIT(pelagic_info);
        ASSERT_EQ(pelagic_get_info(sea.get(), &info, nullptr), PELAGIC_OK);
        std::printf("  %-24s", shot.stem().string().c_str());
        for (const double shutter_s : {0.0, 1.0 / 48.0}) {
            const FrameHandle frame = frame_of(sea, 4.0, 4.0 + shutter_s);
            for (const double waves : sides_in_waves) {
                const double side_m = waves > 0.0 ? waves * info.peak_wavelength_m : 1.0;
                double worst = 0.0;
                // The finest cells alone, some coarser ones, and all that there are.
                for (const double footprint_m : {info.finest_cell_m, 5.0, 0.0}) {
                    pelagic_region region = PELAGIC_INIT(pelagic_region);
                    for (int axis = 0; axis < 2; ++axis) {
                        region.min_m[axis] = 2e4 * (uniform(random) - 0.5);
                        region.max_m[axis] = region.min_m[axis] + side_m;
                    }
                    region.finest_cell_m = region.coarsest_cell_m = footprint_m;
                    pelagic_box box = PELAGIC_INIT(pelagic_box);
                    pelagic_error error;
                    ASSERT_EQ(pelagic_bounds(frame.get(), &region, &box, &error), PELAGIC_OK)
                        << error.message;
                    const Box is = seen(frame, region, side, static_cast<float>(footprint_m), shutter_s);
                    for (int axis = 0; axis < 3; ++axis) {
                        ASSERT_LE(box.min_m[axis], is.low[axis]) << shot << " axis " << axis;
                        ASSERT_GE(box.max_m[axis], is.high[axis]) << shot << " axis " << axis;
                        if (footprint_m == info.finest_cell_m)
                            worst = std::max(
                                worst, (box.max_m[axis] - box.min_m[axis]) / (is.high[axis] - is.low[axis]));
                    }
                }
                std::printf(" %6.2f", worst);
            }
        }
        std::printf("\n");
    }
}

TEST(ProceduralBounds, AreNeverLeft) {
    expect_never_left(3, 24, {2.0, 0.0}, 0.2);
}
// Each, as fine as its camera sees it, which takes a minute.
TEST(ProceduralBounds, OfTheFinestSeasAreNeverLeft) {
    expect_never_left(1, 128, {4.0, 2.0, 0.0}, 0.0);
}

}  // namespace
}  // namespace pelagic
