// The short waves that join a sea's spectrum, and the heights that a sea is given or kept to.
#include <gtest/gtest.h>

#include <cmath>

#include "core/spectrum/cox_munk.h"
#include "core/spectrum/directional_spectrum.h"
#include "core/spectrum/spectral_moments.h"
#include "tests/core/spectrum/oracles.h"

namespace pelagic {
namespace {

double height_m(const SeaState& state) {
    return 4.0 * std::sqrt(DirectionalSpectrum(state).m0());
}

std::vector<SpectrumKind> every_spectrum() {
    std::vector<SpectrumKind> kinds = oracle::kAnalytic;
    kinds.push_back(SpectrumKind::File);
    return kinds;
}

SeaState short_sea(SpectrumKind kind) {
    SeaState state;
    state.spectrum = kind;
    if (kind == SpectrumKind::File) state.measured = oracle::made_up_buoy();
    return state;
}

TEST(ShortWaves, SlopesAreThoseOfTheSunsGlitter) {
    // Every spectrum, with every spreading of its long waves: beyond a few peak wavenumbers they are one sea.
    for (const SpectrumKind kind : oracle::kAnalytic)
        for (double wind = 5.0; wind <= 20.0; wind += 2.5) {
            SeaState state = short_sea(kind);
            state.wind_speed_mps = wind;
            const SpectralMoments sea = moments(DirectionalSpectrum(state), 0.0, oracle::kInfinity);
            const CoxMunk glitter = CoxMunk::at_wind(wind);
            EXPECT_NEAR(sea.mss() / glitter.total, 1.0, 0.15) << static_cast<int>(kind) << ", " << wind;
            EXPECT_GT(sea.xx / sea.yy, 1.3) << static_cast<int>(kind) << ", " << wind;
            EXPECT_LT(sea.xx / sea.yy, 1.6) << static_cast<int>(kind) << ", " << wind;
        }
}

// Slope variance of waves that travel against the wind, of all.
double share_against_the_wind(const SeaState& state) {
    const DirectionalSpectrum sea(state);
    double against = 0.0, all = 0.0;
    for (double k = 0.01; k < 1e4; k *= 1.05) {
        against += k * k * k * sea.arc(k, 0.5 * oracle::kPi, 1.5 * oracle::kPi);
        all += k * k * k * sea.omnidirectional(k);
    }
    return against / all;
}

TEST(ShortWaves, RunWithTheWind) {
    SeaState state;
    EXPECT_LT(share_against_the_wind(state), 0.15);
    state.short_waves = ShortWaves::None;
    EXPECT_GT(share_against_the_wind(state), 0.3);
}

TEST(ShortWaves, LeaveTheLongOnesAsTheyAre) {
    for (const SpectrumKind kind : every_spectrum()) {
        SeaState with = short_sea(kind), without = with;
        without.short_waves = ShortWaves::None;
        const DirectionalSpectrum joined(with), own(without);
        EXPECT_EQ(joined.peak_wavenumber(), own.peak_wavenumber());
        for (double x : {0.8, 1.0, 1.5, 2.9}) {
            const double k = x * own.peak_wavenumber();
            EXPECT_DOUBLE_EQ(joined.omnidirectional(k), own.omnidirectional(k)) << static_cast<int>(kind);
            EXPECT_DOUBLE_EQ(joined.polar(k, 0.4), own.polar(k, 0.4)) << static_cast<int>(kind);
        }
        // Whatever joins holds little of the energy. Tessendorf's spectrum has a tail of its own taste.
        if (kind != SpectrumKind::Phillips && kind != SpectrumKind::Omega2) {
            EXPECT_NEAR(joined.m0() / own.m0(), 1.0, 0.03) << static_cast<int>(kind);
        }
    }
}

TEST(ShortWaves, JoinWithoutAStep) {
    for (const SpectrumKind kind : every_spectrum()) {
        const DirectionalSpectrum sea(short_sea(kind));
        // k³ S_k is nearly constant up there: from 1.5 to 100 peaks no step of 2 % of k changes it by more than 12 %.
        const double peak = sea.peak_wavenumber();
        for (double k = (kind == SpectrumKind::File ? 40.0 : 1.5) * peak; k < 100.0 * peak; k *= 1.02) {
            const double here = k * k * k * sea.omnidirectional(k), next = k * 1.02;
            EXPECT_NEAR(next * next * next * sea.omnidirectional(next) / here, 1.0, 0.12)
                << static_cast<int>(kind);
        }
    }
}

TEST(ShortWaves, AreElfouhailysOwnWhereTheSeaIs) {
    SeaState state = short_sea(SpectrumKind::Elfouhaily), without = state;
    without.short_waves = ShortWaves::None;
    for (double fetch : {1.0, 1e4, 1e7}) {
        state.fetch_m = without.fetch_m = fetch;
        const DirectionalSpectrum joined(state), own(without);
        for (double k = 0.01; k < 1e3; k *= 1.3)
            EXPECT_NEAR(joined.omnidirectional(k), own.omnidirectional(k), 1e-12 * own.omnidirectional(k))
                << k;
    }
}

TEST(Height, IsTheOneAskedForWhateverTheSpectrum) {
    for (const SpectrumKind kind : every_spectrum())
        for (const ShortWaves short_waves : {ShortWaves::Elfouhaily, ShortWaves::None})
            for (double height : {0.0, 1e-3, 0.2, 3.0}) {
                SeaState state = short_sea(kind);
                state.short_waves = short_waves;
                state.significant_height_m = height;
                EXPECT_NEAR(height_m(state), height, 1e-6 * height) << static_cast<int>(kind);
                // Swell comes on top.
                state.swell = {{1.0, 12.0, 0.0}};
                EXPECT_NEAR(height_m(state), std::hypot(height, 1.0), 1e-6);
            }
}

TEST(Height, ChangesTheLongWavesAndNotTheWindsShortOnes) {
    SeaState state;
    const DirectionalSpectrum own(state);
    state.significant_height_m = 3.5;
    const DirectionalSpectrum higher(state);
    for (double k : {10.0, 100.0, 1000.0}) EXPECT_EQ(higher.omnidirectional(k), own.omnidirectional(k));
    const double peak = own.peak_wavenumber();
    EXPECT_GT(higher.omnidirectional(peak), 1.5 * own.omnidirectional(peak));
}

TEST(Height, IsLimitedByDepth) {
    for (const SpectrumKind kind : every_spectrum())
        for (double depth : {0.01, 0.5, 3.0}) {
            SeaState state = short_sea(kind);
            state.wind_speed_mps = 20.0;
            state.depth_m = depth;
            EXPECT_LE(height_m(state), 0.6 * depth * (1.0 + 1e-6)) << static_cast<int>(kind);
        }
}

}  // namespace
}  // namespace pelagic
