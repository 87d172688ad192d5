#include "core/spectrum/dispersion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/core/spectrum/oracles.h"

namespace pelagic {
namespace {

const double kDepths[] = {0.01, 0.5, 8.0, 200.0, oracle::kInfinity};

TEST(Dispersion, DeepGravityWavesObeyOmegaSquaredIsGk) {
    // Capillarity is (γ/ρ)k²/g = 7e-10 of g at k = 0.01.
    EXPECT_NEAR(Dispersion{}.omega(0.01), std::sqrt(kGravity * 0.01), 1e-9);
}

TEST(Dispersion, ShallowWavesAllTravelAtTheRootOfGd) {
    // c = √(gd) (1 − (kd)²/6), here (kd)²/6 = 1.7e-7.
    const Dispersion puddle{0.01};
    EXPECT_NEAR(puddle.omega(0.1) / 0.1, std::sqrt(kGravity * 0.01), 1e-6);
    EXPECT_NEAR(puddle.domega_dk(0.1), std::sqrt(kGravity * 0.01), 1e-6);
    EXPECT_DOUBLE_EQ(puddle.domega_dk(0.0), std::sqrt(kGravity * 0.01));
}

TEST(Dispersion, RipplesAreSlowestNearSeventeenMillimetres) {
    // Phase and group speed are equal where the phase speed has its minimum, k = √(g ρ/γ) = 366.6 rad/m, c =
    // 0.2314 m/s.
    const double k = std::sqrt(kGravity / kCapillarity);
    const Dispersion deep;
    EXPECT_NEAR(deep.omega(k) / k, deep.domega_dk(k), 1e-14);
    EXPECT_NEAR(deep.omega(k) / k, 0.2314, 1e-4);
}

TEST(Dispersion, GroupSpeedIsTheDerivative) {
    for (double depth : kDepths) {
        const Dispersion sea{depth};
        for (double k = 1e-4; k < 1e4; k *= 3.7) {
            // Central difference over 2e-4 k: truncation below 1e-8 relative, rounding 1e-12.
            const double h = 1e-4 * k;
            const double difference = (sea.omega(k + h) - sea.omega(k - h)) / (2.0 * h);
            EXPECT_NEAR(sea.domega_dk(k) / difference, 1.0, 2e-8) << "depth " << depth << ", k " << k;
        }
    }
}

TEST(Dispersion, WavenumberInvertsOmega) {
    for (double depth : kDepths) {
        const Dispersion sea{depth};
        for (double k = 1e-6; k < 1e6; k *= 2.3) {
            EXPECT_NEAR(sea.wavenumber(sea.omega(k)) / k, 1.0, 1e-12) << "depth " << depth << ", k " << k;
        }
        EXPECT_EQ(sea.wavenumber(0.0), 0.0);
    }
}

TEST(Dispersion, OrbitsAreCirclesInDeepWaterAndFlatInShallow) {
    EXPECT_EQ(Dispersion{}.horizontal_ratio(1e-3), 1.0);
    EXPECT_EQ(Dispersion{}.horizontal_ratio(1e3), 1.0);
    // coth x = 1/x (1 + x²/3), x = 1e-3.
    EXPECT_NEAR(Dispersion{0.01}.horizontal_ratio(0.1), 1e3, 1e-3);
    EXPECT_EQ(Dispersion{0.01}.horizontal_ratio(0.0), oracle::kInfinity);
}

}  // namespace
}  // namespace pelagic
