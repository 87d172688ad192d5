// The spreading laws at every wavenumber and wind.
#include <gtest/gtest.h>

#include <cmath>

#include "core/spectrum/directional_spectrum.h"
#include "tests/core/spectrum/oracles.h"

namespace pelagic {
namespace {

TEST(Spreading, IntegratesToOneOverAllWavesAndWinds) {
    for (SpreadingKind spreading : oracle::kSpreadings) {
        for (double wind : {0.1, 1.0, 10.0, 80.0}) {
            for (double fetch : {1.0, 3e5, 1e7}) {
                SeaState state;
                state.wind_speed_mps = wind;
                state.wind_direction_deg = 33.0;
                state.fetch_m = fetch;
                state.spreading = spreading;
                const DirectionalSpectrum sea(state);
                ASSERT_FALSE(sea.empty());
                for (double k = 1e-4; k < 1e4; k *= 3.0) {
                    // Equal steps round the circle: spectrally exact for smooth shapes, h^(1+2s) for the cusp
                    // |π − θ|^2s that cos²ˢ has opposite the wind, at worst (s about 0.1) 3e-5.
                    const WavePoint point = wave_point(sea.dispersion(), k);
                    constexpr int kSteps = 1440;
                    double sum = 0.0;
                    for (int i = 0; i < kSteps; ++i) {
                        const double density =
                            sea.systems()[0].density(point, 2 * oracle::kPi * (i + 0.5) / kSteps);
                        ASSERT_TRUE(std::isfinite(density) && density >= 0.0)
                            << "wind " << wind << ", k " << k;
                        sum += density * 2 * oracle::kPi / kSteps;
                    }
                    EXPECT_NEAR(sea.systems()[0].share(point, 1.0, 1.0 + 2 * oracle::kPi), 1.0, 1e-12);
                    EXPECT_NEAR(sum, 1.0, 1e-4) << "spreading " << static_cast<int>(spreading) << ", wind "
                                                << wind << ", fetch " << fetch << ", k " << k;
                }
            }
        }
    }
}

TEST(Hasselmann, BranchesMeetAboveThePeak) {
    const HasselmannSpreading sea(0.8, 1.17);
    EXPECT_NEAR(sea.meeting_omega() / 0.8, 1.054, 1e-3);
    EXPECT_NEAR(sea.sharpness(sea.meeting_omega() * 0.999999), sea.sharpness(sea.meeting_omega() * 1.000001),
                1e-4);
    EXPECT_NEAR(sea.sharpness(0.8), 6.97, 1e-12);
    EXPECT_NEAR(sea.sharpness(1.6), 9.77 * std::pow(2.0, -2.33), 1e-12);
    EXPECT_NEAR(sea.sharpness(0.4), 6.97 * std::pow(0.5, 4.06), 1e-12);
}

TEST(DonelanBanner, BranchesMeetWithinTheirPrintedDigits) {
    const DonelanBannerSpreading sea{1.0};
    for (double x : {0.56, 0.95, 1.6}) EXPECT_NEAR(sea.beta(x - 1e-9) / sea.beta(x + 1e-9), 1.0, 0.011) << x;
    EXPECT_NEAR(sea.beta(0.94), 2.61 * std::pow(0.94, 1.3), 1e-12);
    EXPECT_NEAR(sea.beta(1e3), std::pow(10.0, -0.4), 1e-3);
}

TEST(Spreading, WavesTravelWithTheWind) {
    for (SpreadingKind spreading : oracle::kSpreadings) {
        SeaState state;
        state.spreading = spreading;
        state.wind_direction_deg = 120.0;
        const DirectionalSpectrum sea(state);
        const double k = 2.0 * sea.peak_wavenumber(), wind = 120.0 * oracle::kPi / 180.0;
        EXPECT_GT(sea.polar(k, wind), sea.polar(k, wind + 0.8));
        EXPECT_GT(sea.polar(k, wind), 3.0 * sea.polar(k, wind + oracle::kPi));
        EXPECT_NEAR(sea.polar(k, wind + 0.4), sea.polar(k, wind - 0.4), 1e-12 * sea.omnidirectional(k));
        EXPECT_NEAR(sea.arc(k, wind - 1.0, wind), sea.arc(k, wind, wind + 1.0),
                    1e-12 * sea.omnidirectional(k));
    }
}

TEST(SwellSpreading, IsNarrowestBelowThePeakAndNarrow) {
    const SwellSpreading swell{0.6};
    // Circular variance of cos²ˢ: c1 = s/(s + 1), about cos of the standard deviation, 9.3° at the peak.
    EXPECT_NEAR(swell.at(0.6).harmonic(1).real(), 75.0 / 76.0, 1e-12);
    EXPECT_GT(swell.at(0.5).harmonic(1).real(), swell.at(0.7).harmonic(1).real());
}

}  // namespace
}  // namespace pelagic
