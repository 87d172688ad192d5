// sea.directionality and waves.band_gains: what they do to the spectrum, and that all its integrals follow.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>
#include <vector>

#include "core/spectrum/band_gains.h"
#include "core/spectrum/directed.h"
#include "core/spectrum/directional_spectrum.h"
#include "core/spectrum/spectral_moments.h"
#include "tests/core/spectrum/oracles.h"

namespace pelagic {
namespace {

constexpr double kEverything = std::numeric_limits<double>::infinity();

// A sea of each spreading, measured and swell among them.
std::vector<SeaState> every_spreading() {
    std::vector<SeaState> seas;
    for (const SpreadingKind spreading : oracle::kSpreadings) {
        SeaState sea;
        sea.spreading = spreading;
        sea.wind_direction_deg = 40.0;
        seas.push_back(sea);
    }
    SeaState measured;
    measured.spectrum = SpectrumKind::File;
    measured.measured = oracle::made_up_buoy();
    measured.swell = {{1.0, 12.0, 200.0}};
    seas.push_back(measured);
    return seas;
}

TEST(Directionality, KeepsEveryDensityADensity) {
    for (SeaState state : every_spreading())
        for (const double directionality : {0.01, 0.2, 0.9, 1.0, 1.5, 4.0, 20.0}) {
            state.directionality = directionality;
            const DirectionalSpectrum sea(state);
            for (const WaveSystem& system : sea.systems())
                for (const double times : {0.9, 1.0, 2.0, 8.0, 100.0}) {
                    const double k = times * system.peak_wavenumber();
                    const WavePoint point = wave_point(sea.dispersion(), k);
                    EXPECT_NEAR(system.share(point, -2.0, 2.0 * oracle::kPi - 2.0), 1.0, 1e-9);
                    // The share is the density's integral, and the harmonics are its coefficients.
                    constexpr int kSteps =
                        8192;  // a cusp at the back of almost isotropic waves costs some 1e-5
                    double part = 0.0;
                    Harmonics found;
                    for (int i = 0; i < kSteps; ++i) {
                        const double theta = -oracle::kPi + 2.0 * oracle::kPi * (i + 0.5) / kSteps,
                                     step = 2.0 * oracle::kPi / kSteps;
                        const double density = system.density(point, theta);
                        ASSERT_GE(density, 0.0);
                        if (theta > -1.0 && theta < 2.0) part += density * step;
                        found.first += density * std::polar(step, theta);
                        found.second += density * std::polar(step, 2.0 * theta);
                        found.fourth += density * std::polar(step, 4.0 * theta);
                    }
                    // Half a step at either end may be in or out, which counts where a needle lies there.
                    const double ends =
                        oracle::kPi / kSteps * (system.density(point, -1.0) + system.density(point, 2.0));
                    EXPECT_NEAR(system.share(point, -1.0, 2.0), part, 3e-3 + ends);
                    const Harmonics own = system.harmonics(point);
                    EXPECT_NEAR(std::abs(own.first - found.first), 0.0, 5e-5) << directionality;
                    EXPECT_NEAR(std::abs(own.second - found.second), 0.0, 5e-5) << directionality;
                    EXPECT_NEAR(std::abs(own.fourth - found.fourth), 0.0, 5e-5) << directionality;
                }
        }
}

TEST(Directionality, MoreIsNarrowerOfLongAndShortWaves) {
    std::vector<SeaState> states = every_spreading(), by_height = states;
    for (SeaState& state : by_height) state.growth = GrowthLaw::Height;
    states.insert(states.end(), by_height.begin(), by_height.end());
    for (SeaState state : states) {
        double before_long = -1.0, before_short = -1.0;
        for (const double directionality : {0.1, 0.5, 1.0, 2.0, 5.0}) {
            state.directionality = directionality;
            const DirectionalSpectrum sea(state);
            const auto mean = [&](double k) {  // 1: all waves travel one way
                std::complex<double> sum;
                double all = 0.0;
                const WavePoint point = wave_point(sea.dispersion(), k);
                for (const WaveSystem& system : sea.systems()) {
                    sum += system.energy(point) * system.harmonics(point).first;
                    all += system.energy(point);
                }
                return std::abs(sum) / all;
            };
            const double of_long = mean(sea.peak_wavenumber()), of_short = mean(200.0);
            EXPECT_GT(of_long, before_long) << directionality;
            // The wind's short waves are what they are, unless all waves were asked for.
            const bool is_joined =
                state.growth == GrowthLaw::HeightAndPeak && state.short_waves != ShortWaves::None;
            if (!is_joined) {
                EXPECT_GT(of_short, before_short) << directionality;
            } else if (before_short >= 0.0) {
                EXPECT_NEAR(of_short, before_short, 1e-6) << directionality;
            }
            before_long = of_long;
            before_short = of_short;
        }
    }
}

TEST(Directionality, LeavesHeightAndSlopeAsTheyAre) {
    for (SeaState state : every_spreading()) {
        const SpectralMoments own = moments(DirectionalSpectrum(state), 0.0, kEverything);
        for (const double directionality : {0.3, 3.0}) {
            state.directionality = directionality;
            const SpectralMoments all = moments(DirectionalSpectrum(state), 0.0, kEverything);
            EXPECT_NEAR(all.m0 / own.m0, 1.0, 1e-12);
            EXPECT_NEAR(all.mss() / own.mss(), 1.0, 1e-12);
        }
    }
}

std::vector<BandGain> two_bands() {
    return {{2.0, 10.0, 1.5}, {5.0, 40.0, 0.5}};
}

TEST(BandGains, CountWholeWithinAndNotAtAllOutside) {
    const std::vector<BandGain> bands = two_bands();
    const DirectionalSpectrum plain{SeaState{}}, gained(SeaState{}, bands);
    const auto gain_at = [&](double wavelength_m) {
        const double k = 2.0 * oracle::kPi / wavelength_m;
        return std::sqrt(gained.omnidirectional(k) / plain.omnidirectional(k));
    };
    for (const double wavelength_m : {0.01, 1.0, 1.7, 47.0, 90.0})
        EXPECT_NEAR(gain_at(wavelength_m), 1.0, 1e-12);
    for (const double wavelength_m : {2.3, 3.0, 4.4}) EXPECT_NEAR(gain_at(wavelength_m), 1.5, 1e-12);
    for (const double wavelength_m : {5.7, 7.0, 8.8})
        EXPECT_NEAR(gain_at(wavelength_m), 0.75, 1e-12);  // both
    for (const double wavelength_m : {11.3, 20.0, 35.0}) EXPECT_NEAR(gain_at(wavelength_m), 0.5, 1e-12);
    const std::vector<BandGain> turned{{10.0, 2.0, 1.5}, {40.0, 5.0, 0.5}};  // edges in the other order
    EXPECT_EQ(DirectionalSpectrum(SeaState{}, turned).m0(), gained.m0());
    EXPECT_NEAR(gain_at(2.0), 1.25, 1e-9) << "half of it at the edge itself";
    // Smooth: no step is larger than a quintic's steepest.
    for (double wavelength_m = 1.0; wavelength_m < 60.0; wavelength_m *= 1.001)
        EXPECT_LT(std::abs(gain_at(1.001 * wavelength_m) - gain_at(wavelength_m)), 0.01);
}

// Every integral is of the gained spectrum: against sums over fine steps of its own values.
TEST(BandGains, AreInEveryIntegral) {
    for (const std::vector<BandGain>& bands :
         {two_bands(), {{0.001, 3.0, 0.0}}, {{20.0, 1000.0, 0.0}}, {{3.0, 3.1, 4.0}}}) {
        SeaState state;
        state.swell = {{1.0, 9.0, 50.0}};
        const DirectionalSpectrum gained(state, bands);
        double m0 = 0.0, mss = 0.0;
        constexpr double kStep = 1e-4;
        for (double k = 1e-3; k < 2e4; k *= 1.0 + kStep) {
            const double middle = k * (1.0 + 0.5 * kStep),
                         energy = gained.omnidirectional(middle) * k * kStep;
            m0 += energy;
            mss += energy * middle * middle;
        }
        EXPECT_NEAR(gained.m0() / m0, 1.0, 1e-5);
        const SpectralMoments all = moments(gained, 0.0, kEverything);
        EXPECT_NEAR(all.m0 / m0, 1.0, 1e-5);
        EXPECT_NEAR(all.mss() / mss, 1.0, 1e-5);
    }
    // Without any wave left: a calm.
    const std::vector<BandGain> none{{1e-3, 1e5, 0.0}};
    EXPECT_LT(DirectionalSpectrum(SeaState{}, none).m0(), 1e-12);
}

}  // namespace
}  // namespace pelagic
