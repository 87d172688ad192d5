// Bands of cascades: disjoint, complete, functions of the sizes alone.
#include "core/scene/cascade_bands.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/base/constants.h"

namespace pelagic {
namespace {

TEST(CascadeBands, BeginAtEightPeriodsOfTheTile) {
    const std::vector<double> sizes_m{400.0, 50.0, 5.0};
    const std::vector<double> edges = lower_edges(sizes_m);
    ASSERT_EQ(edges.size(), 3u);
    EXPECT_EQ(edges[0], 0.0);
    // The wavelength at the edge goes eight times into the tile; a few roundings of 1.1e-16 each.
    EXPECT_NEAR(50.0 / (kTwoPi / edges[1]), 8.0, 8.0 * 1e-15);
    EXPECT_NEAR(5.0 / (kTwoPi / edges[2]), 8.0, 8.0 * 1e-15);
    EXPECT_TRUE(lower_edges({}).empty());
}

// By hand: tiles of ratio 4 put the edge at 32 modes of the larger one. A mode at 32.7 on the diagonal still
// reaches it with the corner of its cell, so the disc has radius 33, and the last usable mode is N/2 − 1: N
// = 68.
TEST(CascadeBands, SufficientResolutionByHand) {
    EXPECT_EQ(sufficient_resolution(400.0, kTwoPi * 32.0 / 400.0), 68);
    // The bound met exactly: a disc of 32 modes and no more, whatever the rounding.
    for (const double size_m : {400.0, 0.3, 7.7, 123456.7}) {
        EXPECT_EQ(sufficient_resolution(size_m, kTwoPi * (32.0 - std::sqrt(0.5)) / size_m), 66) << size_m;
    }
    EXPECT_EQ(sufficient_resolution(400.0, 0.0), 16);
    // Larger than an int holds: no overflow, and larger than any grid.
    EXPECT_GT(sufficient_resolution(1e6, 1e9), kMaxCascadeResolution);
    EXPECT_GT(sufficient_resolution(1e300, 1e300), kMaxCascadeResolution);
}

TEST(CascadeBands, SufficientResolutionIsTheSmallest) {
    std::mt19937 random(2);
    for (int i = 0; i < 2000; ++i) {
        const double size_m = std::uniform_real_distribution<double>(1.0, 1000.0)(random);
        const double edge = kTwoPi / size_m * std::uniform_real_distribution<double>(0.1, 3000.0)(random);
        const int n = sufficient_resolution(size_m, edge);
        const auto reach = [&](int resolution) {
            return (resolution / 2 - 1 - std::sqrt(0.5)) * kTwoPi / size_m;
        };
        EXPECT_EQ(n % 2, 0);
        EXPECT_GE(reach(n),
                  edge * (1.0 - 1e-11));  // the slack that sufficient_resolution allows for rounding, × 10
        if (n > 16) {
            EXPECT_LT(reach(n - 2), edge);
        }
    }
}

}  // namespace
}  // namespace pelagic
