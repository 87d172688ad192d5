// Counter-based random numbers: the published known answers, and the moments of the normal distribution.
#include "core/base/random.h"

#include <gtest/gtest.h>

#include <cmath>

namespace pelagic {
namespace {

using Words = std::array<std::uint32_t, 4>;

// Random123 1.09 (Salmon et al.), tests/kat_vectors: philox4x32 with 10 rounds. Key words low, then high.
TEST(Philox, GivesThePublishedKnownAnswers) {
    EXPECT_EQ(philox({0, 0, 0, 0}, 0), (Words{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
    EXPECT_EQ(philox({0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff}, 0xffffffffffffffff),
              (Words{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
    EXPECT_EQ(philox({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, 0x299f31d0a4093822),
              (Words{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

TEST(NormalPair, HasTheMomentsOfTwoIndependentNormals) {
    constexpr int kDraws = 400000;
    double m1 = 0, m2 = 0, m3 = 0, m4 = 0, cross = 0, cross_squares = 0, largest = 0;
    for (std::uint32_t i = 0; i < kDraws; ++i) {
        // The kind of counters that grids of modes use: neighbours differ in one word, negative numbers wrap.
        const auto xi = normal_pair({i % 4, i % 1000, 0u - i / 1000, 0u}, 7);
        for (double x : xi) {
            m1 += x;
            m2 += x * x;
            m3 += x * x * x;
            m4 += x * x * x * x;
            largest = std::max(largest, std::abs(x));
        }
        cross += xi[0] * xi[1];
        cross_squares += (xi[0] * xi[0] - 1.0) * (xi[1] * xi[1] - 1.0);
    }
    // Five standard errors of each mean: Var(x) = 1, Var(x²) = 2, Var(x³) = 15, Var(x⁴) = 96, Var(xy) = 1,
    // Var((x² − 1)(y² − 1)) = 4.
    const double n = 2.0 * kDraws, pairs = kDraws;
    EXPECT_NEAR(m1 / n, 0.0, 5.0 * std::sqrt(1.0 / n));
    EXPECT_NEAR(m2 / n, 1.0, 5.0 * std::sqrt(2.0 / n));
    EXPECT_NEAR(m3 / n, 0.0, 5.0 * std::sqrt(15.0 / n));
    EXPECT_NEAR(m4 / n, 3.0, 5.0 * std::sqrt(96.0 / n));
    EXPECT_NEAR(cross / pairs, 0.0, 5.0 * std::sqrt(1.0 / pairs));
    EXPECT_NEAR(cross_squares / pairs, 0.0, 5.0 * std::sqrt(4.0 / pairs));
    // The largest of 8e5 normals: P(|x| > 6) = 2e-9 each, P(none > 4) = e^−50.
    EXPECT_GT(largest, 4.0);
    EXPECT_LT(largest, 6.5);
}

TEST(NormalPair, ChangesWithEveryWordOfCounterAndKey) {
    const auto reference = normal_pair({1, 2, 3, 4}, 5);
    for (const auto& other : {normal_pair({0, 2, 3, 4}, 5), normal_pair({1, 0, 3, 4}, 5),
                              normal_pair({1, 2, 0, 4}, 5), normal_pair({1, 2, 3, 0}, 5),
                              normal_pair({1, 2, 3, 4}, 6), normal_pair({1, 2, 3, 4}, 5 + (1ull << 32))})
        EXPECT_NE(reference, other);
    EXPECT_EQ(reference, normal_pair({1, 2, 3, 4}, 5));
}

}  // namespace
}  // namespace pelagic
