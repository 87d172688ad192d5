// Rain: the rings of its drops, and what it leaves of the wind's short waves.
#include "core/spectrum/rain.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/scene/canonical.h"
#include "core/spectrum/directional_spectrum.h"
#include "core/spectrum/spectral_moments.h"
#include "tests/core/spectrum/oracles.h"

namespace pelagic {
namespace {

SeaState rainy(double rain_mm_h, double wind_mps) {
    SeaState sea;
    sea.wind_speed_mps = wind_mps;
    sea.rain_mm_h = rain_mm_h;
    return sea;
}

SpectralMoments whole(const SeaState& sea) {
    return moments(DirectionalSpectrum(sea), 0.0, oracle::kInfinity);
}

// A Gaussian in the logarithm of the frequency has a closed integral: S_p Δf exp((Δf/f_p)²/(4π)).
TEST(Rain, InACalmMakesRingsOfTheTanksHeightFromAllDirections) {
    double slopes = 0.0;
    for (const double rain : {0.1, 2.0, 20.0, 100.0, 300.0}) {
        const double peak = 5.772 - 0.0018 * rain, width = 4.42 + 0.0028 * rain,
                     most = 6e-4 * 1e-4 * std::pow(rain, 0.53);  // cm² s to m² s
        const SpectralMoments rings = whole(rainy(rain, 0.0));
        EXPECT_NEAR(rings.m0 / (most * width * std::exp(std::pow(width / peak, 2) / (4.0 * oracle::kPi))),
                    1.0, 1e-3)
            << rain;
        EXPECT_NEAR(rings.xx / rings.yy, 1.0, 1e-9) << rain;
        EXPECT_NEAR(std::hypot(rings.xy, rings.east, rings.north), 0.0, 1e-9) << rain;
        EXPECT_GT(rings.mss(), slopes) << rain;
        slopes = rings.mss();
    }
    EXPECT_NEAR(1e3 * std::sqrt(whole(rainy(20.0, 0.0)).m0), 1.17, 0.01);  // mm
    EXPECT_NEAR(whole(rainy(20.0, 0.0)).mss(), 0.038, 0.001);
}

// By loss and gain of energy at each length, worked out here from what a wave loses in a layer and what wind puts in.
TEST(Rain, LeavesOfTheWindsWavesWhatTheWindKeepsUp) {
    for (const double wind : {3.0, 5.0, 10.0, 20.0})
        for (const double rain : {2.0, 20.0, 100.0}) {
            SeaState sea = rainy(0.0, wind);
            sea.depth_m = 500.0;
            const DirectionalSpectrum dry(sea), rings([&] {
                SeaState calm = rainy(rain, 0.0);
                calm.depth_m = sea.depth_m;
                return calm;
            }());
            sea.rain_mm_h = rain;
            const DirectionalSpectrum wet(sea);
            double before = 0.0;
            for (const double length_m : {0.1, 0.3, 1.0, 3.0, 10.0, 50.0}) {
                if (length_m > 10.0 && wind < 10.0) continue;  // a light wind's sea has none so long
                const double k = 2.0 * oracle::kPi / length_m, omega = dry.dispersion().omega(k),
                             friction = std::sqrt((0.8 + 0.065 * wind) * 1e-3) * wind,
                             gain = 0.04 * std::pow(friction * k / omega, 2) * omega,
                             loss = 4.0 * 1e-4 * std::cbrt(rain / 20.0) * k * k * (1.0 - std::exp(-0.2 * k)),
                             left =
                                 (wet.omnidirectional(k) - rings.omnidirectional(k)) / dry.omnidirectional(k);
                EXPECT_NEAR(left * (1.0 + loss / gain), 1.0, 1e-6) << wind << ' ' << rain << ' ' << length_m;
                EXPECT_GT(left, before);
                before = left;
            }
            const double energy = whole(sea).m0 / whole(rainy(0.0, wind)).m0;
            EXPECT_GT(energy, wind < 10.0 ? 0.4 : 0.97) << wind << ' ' << rain;
            EXPECT_LT(energy, 1.0) << wind << ' ' << rain;
        }
}

TEST(Rain, FallsOnSwellAndBuoysWavesWithoutTakingFromThem) {
    SeaState sea = rainy(50.0, 0.0);
    sea.swell = {{.height_m = 2.0, .period_s = 9.0, .direction_deg = 20.0}};
    const double rings = whole(rainy(50.0, 0.0)).m0;
    EXPECT_NEAR(whole(sea).m0 - rings, 0.25, 1e-6);
    SeaState buoy;
    buoy.spectrum = SpectrumKind::File;
    buoy.measured = oracle::made_up_buoy();
    buoy.short_waves = ShortWaves::None;
    const double dry = whole(buoy).m0;
    buoy.rain_mm_h = 50.0;
    EXPECT_NEAR(whole(buoy).m0 - rings, dry, 1e-9 * dry);
}

// Also that of a light wind's sea, which loses most of its waves.
TEST(Rain, KeepsTheHeightThatIsAskedFor) {
    for (const double wind : {0.01, 0.5, 3.0, 12.0})
        for (const double height_m : {0.1, 0.5, 3.0}) {
            SeaState sea = rainy(100.0, wind);
            sea.significant_height_m = height_m;
            const double rings = whole(rainy(100.0, 0.0)).m0;
            EXPECT_NEAR(4.0 * std::sqrt(whole(sea).m0 - rings), height_m, 1e-4 * height_m) << wind;
        }
}

// A buoy's ripples are the wind's.
TEST(Rain, CalmsTheRipplesThatAreJoinedToABuoysWaves) {
    SeaState buoy = rainy(0.0, 6.0);
    buoy.spectrum = SpectrumKind::File;
    buoy.measured = oracle::made_up_buoy();
    const DirectionalSpectrum dry(buoy);
    buoy.rain_mm_h = 20.0;
    const DirectionalSpectrum wet(buoy);
    EXPECT_LT(wet.omnidirectional(20.0) / dry.omnidirectional(20.0), 0.5);
    EXPECT_EQ(wet.omnidirectional(0.1), dry.omnidirectional(0.1));
}

// The rings alone are a calm: they set no tile's size.
TEST(Rain, InACalmHasNoPeak) {
    const DirectionalSpectrum rings(rainy(20.0, 0.0)), dry(rainy(0.0, 8.0)), wet(rainy(20.0, 8.0));
    EXPECT_TRUE(rings.is_calm());
    EXPECT_FALSE(rings.empty());
    EXPECT_EQ(rings.peak_wavenumber(), DirectionalSpectrum::kCalmPeakWavenumber);
    EXPECT_EQ(rings.longest_peak_wavenumber(), DirectionalSpectrum::kCalmPeakWavenumber);
    EXPECT_FALSE(wet.is_calm());
    EXPECT_EQ(wet.longest_peak_wavenumber(), dry.longest_peak_wavenumber());
}

// Shots of before it keep their fingerprints.
TEST(Rain, IsntSaidWhereItIsDry) {
    Scene scene;
    EXPECT_EQ(canonical(scene).find("rain_mm"), std::string::npos);
    scene.sea.rain_mm_h = 1.0;
    EXPECT_NE(canonical(scene).find("rain_mm"), std::string::npos);
}

}  // namespace
}  // namespace pelagic
