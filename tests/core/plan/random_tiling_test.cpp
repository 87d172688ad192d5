// The rule of a cascade's copies: where they lie, and how they blend.
#include "core/plan/random_tiling.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

namespace pelagic {
namespace {

TEST(Copies, SquaresOfTheirWeightsAddUpToOne) {
    for (int i = 0; i <= 5000; ++i) {
        const double middle = i / 10000.0;
        const BlendWeights<double> wide = blend_weights(middle);
        EXPECT_NEAR(wide.own * wide.own + wide.next * wide.next, 1.0, 1e-15);
        const BlendWeights<float> narrow = blend_weights(static_cast<float>(middle));
        EXPECT_NEAR(narrow.own, wide.own, 1e-6);
        EXPECT_NEAR(narrow.next, wide.next, 1e-6);
        EXPECT_NEAR(narrow.rate, wide.rate, 1e-4);
    }
}

// Both sides of a border see the same there, and the middle of a cell is one copy alone.
TEST(Copies, BlendFromOneCellToTheNext) {
    const BlendWeights<double> border = blend_weights(0.5);
    EXPECT_NEAR(border.own, border.next, 1e-15);
    for (const double middle : {0.0, 0.1, kPlainHalf}) {
        const BlendWeights<double> plain = blend_weights(middle);
        EXPECT_EQ(plain.own, 1.0);
        EXPECT_EQ(plain.next, 0.0);
        EXPECT_EQ(plain.rate, 0.0);
    }
    // The ramp begins without a step, of the weights or of what they change by.
    const BlendWeights<double> inside = blend_weights(kPlainHalf + 1e-9);
    EXPECT_NEAR(inside.own, 1.0, 1e-15);
    EXPECT_NEAR(inside.next, 0.0, 1e-15);
    EXPECT_NEAR(inside.rate, 0.0, 1e-6);
}

TEST(Copies, KnowTheirWeightsGradient) {
    constexpr double kStep = 1e-6;
    for (double middle = kPlainHalf + 1e-3; middle < 0.5 - kStep; middle += 1e-3) {
        const BlendWeights<double> low = blend_weights(middle - kStep), at = blend_weights(middle),
                                   high = blend_weights(middle + kStep);
        EXPECT_NEAR((high.own - low.own) / (2.0 * kStep), -at.next * at.rate, 1e-6);
        EXPECT_NEAR((high.next - low.next) / (2.0 * kStep), at.own * at.rate, 1e-6);
    }
}

// What shaders must find as well.
TEST(Copies, HaveKnownOffsets) {
    const auto offset = [](uint key, uint i, uint j) {
        const TileOffset<double> of = tile_offset<double>(key, i, j);
        return std::pair(of.x * kTileSteps, of.y * kTileSteps);
    };
    EXPECT_EQ(offset(1u, 0u, 0u), std::pair(0.0, 0.0));
    // pcg3d of (0, 0, 1), (1, 1, 0), (1, 2, 4294967293), by the paper's lines in Python; the upper ten bits.
    EXPECT_EQ(offset(0u, 0u, 1u), std::pair(509.0, 419.0));
    EXPECT_EQ(offset(1u, 1u, 0u), std::pair(952.0, 996.0));
    EXPECT_EQ(offset(1u, 2u, 4294967293u), std::pair(973.0, 939.0));
}

TEST(Copies, LieAnywhereAndDifferBySeedAndCascade) {
    std::set<uint> keys;
    for (std::uint64_t seed : {0ull, 1ull, 2ull, 1ull << 32, (1ull << 63) - 1})
        for (int cascade = 0; cascade < 16; ++cascade) keys.insert(tiling_key(seed, cascade));
    EXPECT_EQ(keys.size(), 80u);
    // Offsets are even, along each axis and from cell to cell.
    constexpr int kSide = 200, kBins = 16;
    std::vector<int> x(kBins), y(kBins), apart(kBins);
    for (int j = -kSide / 2; j < kSide / 2; ++j)
        for (int i = -kSide / 2; i < kSide / 2; ++i) {
            const auto at = tile_offset<double>(7u, static_cast<uint>(i), static_cast<uint>(j));
            const auto next = tile_offset<double>(7u, static_cast<uint>(i + 1), static_cast<uint>(j));
            ++x[static_cast<std::size_t>(at.x * kBins)];
            ++y[static_cast<std::size_t>(at.y * kBins)];
            const double between = next.x - at.x;
            ++apart[static_cast<std::size_t>((between < 0.0 ? between + 1.0 : between) * kBins)];
        }
    const double mean = kSide * kSide / double{kBins}, most = 5.0 * std::sqrt(mean);
    for (const std::vector<int>& counts : {x, y, apart})
        for (const int count : counts) EXPECT_NEAR(count, mean, most);
}

TEST(Copies, AreTheSameFarAway) {
    const TilePlace near = tile_place(0.3), far = tile_place(1e12 + 0.25);
    EXPECT_EQ(near.cell, 0);
    EXPECT_DOUBLE_EQ(near.from_middle, 0.3);
    EXPECT_EQ(far.cell, 1000000000000);
    EXPECT_NEAR(far.from_middle, 0.25, 1e-3);
    EXPECT_EQ(tile_place(-0.7).cell, -1);
    EXPECT_EQ(tile_place(std::nan("")).cell, 0);
    EXPECT_EQ(tile_place(1e300).cell, 0);
}

}  // namespace
}  // namespace pelagic
