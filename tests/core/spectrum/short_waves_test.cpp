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

// Whatever the height and the directionality that are asked for, the slopes are those of the wind. By height alone a low sea under a
// strong wind had a fifth of them, and directionality 6 made up over cross 25.
TEST(ShortWaves, SlopesAreTheWindsWhateverTheLongOnesAre) {
    oracle::Extent slopes, up_over_cross;
    for (double wind : {3.0, 5.0, 8.0, 12.0, 16.0, 20.0, 25.0})
        for (double fetch : {30e3, 300e3, 1000e3}) {
            SeaState state;
            state.wind_speed_mps = wind;
            state.fetch_m = fetch;
            const double own = height_m(state);
            for (double share : {0.25, 0.5, 1.0, 2.0})
                for (double directionality : {0.1, 1.0, 6.0}) {
                    state.significant_height_m = share * own;
                    state.directionality = directionality;
                    const SpectralMoments sea = moments(DirectionalSpectrum(state), 0.0, oracle::kInfinity);
                    slopes.add(sea.mss() / CoxMunk::at_wind(wind).total);
                    up_over_cross.add(sea.xx / sea.yy);
                    EXPECT_NEAR(sea.mss() / CoxMunk::at_wind(wind).total, 1.0, 0.15)
                        << wind << ' ' << fetch << ' ' << share << ' ' << directionality;
                    EXPECT_GT(sea.xx / sea.yy, 1.1)
                        << wind << ' ' << fetch << ' ' << share << ' ' << directionality;
                    EXPECT_LT(sea.xx / sea.yy, 1.85)
                        << wind << ' ' << fetch << ' ' << share << ' ' << directionality;
                }
        }
    RecordProperty("mss_over_cox_and_munk", slopes.text());
    RecordProperty("up_over_cross", up_over_cross.text());
}

// A height that is asked for is that of an older or a younger sea: the peak goes with it, without a jump at the sea's own.
TEST(Height, MovesThePeak) {
    SeaState state;
    state.wind_speed_mps = 12.0;
    const DirectionalSpectrum own(state);
    double before = std::numeric_limits<double>::infinity();
    for (double share : {0.25, 0.5, 0.999, 1.0, 1.001, 2.0}) {
        state.significant_height_m = share * 4.0 * std::sqrt(own.m0());
        const DirectionalSpectrum sea(state);
        EXPECT_NEAR(4.0 * std::sqrt(sea.m0()), *state.significant_height_m, 1e-6);
        EXPECT_LT(sea.peak_wavenumber(), before) << share;
        EXPECT_NEAR(sea.peak_wavenumber() / own.peak_wavenumber(), std::pow(share, -1.2),
                    0.01 * std::pow(share, -1.2))
            << share;
        before = sea.peak_wavenumber();
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
            for (double height : {0.0, 1e-12, 1e-6, 1e-3, 0.2, 3.0}) {
                SeaState state = short_sea(kind);
                state.short_waves = short_waves;
                state.significant_height_m = height;
                EXPECT_NEAR(height_m(state), height, 1e-6 * height)
                    << static_cast<int>(kind) << ", " << height;
                // Swell comes on top.
                state.swell = {{1.0, 12.0, 0.0}};
                EXPECT_NEAR(height_m(state), std::hypot(height, 1.0), 1e-6);
            }
}

TEST(Height, ChangesTheLongWavesAndNotTheWindsShortOnes) {
    SeaState state;
    state.growth = GrowthLaw::Height;
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
