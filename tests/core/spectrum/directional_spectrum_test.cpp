#include "core/spectrum/directional_spectrum.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/spectrum/spectral_moments.h"
#include "core/spectrum/viscous_cutoff.h"
#include "tests/core/spectrum/cell_energy.h"
#include "tests/core/spectrum/oracles.h"

namespace pelagic {
namespace {

TEST(DirectionalSpectrum, WavenumberSpectrumIsTheFrequencySpectrumAtAnyDepth) {
    // S_k dk = S dω, whatever the depth: the densities at matching k and ω.
    for (double depth : {3.0, 30.0, oracle::kInfinity}) {
        SeaState state;
        state.spectrum = SpectrumKind::PiersonMoskowitz;
        state.short_waves = ShortWaves::None;
        state.wind_speed_mps = 5.0;  // waves that 3 m of water can carry
        state.depth_m = depth;
        const DirectionalSpectrum sea(state);
        const PiersonMoskowitz law(5.0);
        const double top =
            sea.omnidirectional(sea.peak_wavenumber());  // below 1e-14 of it nothing is counted
        for (double k = 0.05; k < 1e3; k *= 2.0) {
            const double expected =
                law.density(sea.dispersion().omega(k)) * sea.dispersion().domega_dk(k) * viscous_cutoff(k);
            EXPECT_NEAR(sea.omnidirectional(k), expected, 1e-12 * expected + 1e-14 * top);
        }
        EXPECT_NEAR(sea.m0() / law.m0(), 1.0, 1e-6);
        EXPECT_NEAR(sea.dispersion().omega(sea.peak_wavenumber()), law.peak_omega(), 1e-12);
    }
}

TEST(DirectionalSpectrum, ArcIsTheIntegralOfPolar) {
    SeaState state;
    state.wind_direction_deg = 20.0;
    state.swell = {{1.5, 11.0, 80.0}, {0.5, 18.0, -140.0}};
    for (SpreadingKind spreading : oracle::kSpreadings) {
        state.spreading = spreading;
        const DirectionalSpectrum sea(state);
        for (double k : {0.01, 0.033, 0.1, 1.0, 100.0}) {
            const double all = sea.omnidirectional(k);
            EXPECT_NEAR(sea.arc(k, -1.0, -1.0 + 2 * oracle::kPi) / all, 1.0, 1e-10);
            // Simpson with 2e-4 rad steps; the cusp |π − θ|^2s of a flat Hasselmann (s = 0.1) costs h^1.2/60:
            // 6e-7.
            const double sum = oracle::simpson(0.3, 4.0, 10000, [&](double t) { return sea.polar(k, t); });
            EXPECT_NEAR(sea.arc(k, 0.3, 4.0) / all, sum / all, 1e-6);
            EXPECT_NEAR(sea.arc(k, 4.0, 0.3), -sea.arc(k, 0.3, 4.0), 1e-14 * all);
            EXPECT_NEAR(sea.arc(k, 0.3 - 6 * oracle::kPi, 4.0 - 6 * oracle::kPi) / all,
                        sea.arc(k, 0.3, 4.0) / all, 1e-12);
        }
    }
}

TEST(DirectionalSpectrum, PeaksAreTheFullestAndTheLongest) {
    SeaState state;
    state.swell = {{1.5, 15.0, 80.0}, {0.01, 25.0, 0.0}};
    const DirectionalSpectrum sea(state);
    ASSERT_EQ(sea.systems().size(), 4u);  // the wind's long and short waves, two swells
    EXPECT_EQ(sea.peak_wavenumber(), sea.systems()[0].peak_wavenumber());
    EXPECT_EQ(sea.longest_peak_wavenumber(),
              sea.systems()[2].peak_wavenumber());  // the fourth holds 1e-5 of m0
}

TEST(DirectionalSpectrum, CalmIsEmptyEverywhere) {
    SeaState state;
    state.wind_speed_mps = 0.0;
    state.swell = {{0.0, 10.0, 0.0}};
    const DirectionalSpectrum sea(state);
    EXPECT_TRUE(sea.empty());
    EXPECT_EQ(sea.m0(), 0.0);
    for (double k : {0.0, 1e-3, 1.0}) {
        EXPECT_EQ(sea.omnidirectional(k), 0.0);
        EXPECT_EQ(sea.polar(k, 1.0), 0.0);
        EXPECT_EQ(sea.arc(k, 0.0, 1.0), 0.0);
    }
    EXPECT_EQ(sea.peak_wavenumber(), DirectionalSpectrum::kCalmPeakWavenumber);
    EXPECT_EQ(sea.longest_peak_wavenumber(), DirectionalSpectrum::kCalmPeakWavenumber);
    EXPECT_EQ(oracle::cell_energy(sea, {-1.0, 1.0, -1.0, 1.0}), 0.0);
    const SpectralMoments none = moments(sea, 0.0, oracle::kInfinity);
    EXPECT_EQ(none.m0, 0.0);
    EXPECT_EQ(none.energy_period_s(), 0.0);
}

TEST(DirectionalSpectrum, HardCasesStayFinite) {
    for (SpectrumKind kind : oracle::kAnalytic) {
        for (SpreadingKind spreading : oracle::kSpreadings) {
            for (double wind : {0.0, 1e-6, 0.1, 80.0}) {
                for (double fetch : {1.0, 1e7}) {
                    for (double depth : {0.01, 20.0, oracle::kInfinity}) {
                        SeaState state;
                        state.spectrum = kind;
                        state.spreading = spreading;
                        state.wind_speed_mps = wind;
                        state.fetch_m = fetch;
                        state.depth_m = depth;
                        SCOPED_TRACE(testing::Message()
                                     << "spectrum " << static_cast<int>(kind) << ", spreading "
                                     << static_cast<int>(spreading) << ", wind " << wind << ", fetch "
                                     << fetch << ", depth " << depth);
                        const DirectionalSpectrum sea(state);
                        EXPECT_EQ(sea.m0() > 0.0, wind >= 0.1);
                        EXPECT_TRUE(std::isfinite(sea.peak_wavenumber()) && sea.peak_wavenumber() > 0.0);
                        EXPECT_TRUE(std::isfinite(sea.longest_peak_wavenumber()));
                        const auto good = [](double v) { return std::isfinite(v) && v >= 0.0; };
                        for (double k : {0.0, 1e-300, 1e-6, 1e-2, 1.0, 1e3, 1e6, 1e100}) {
                            EXPECT_TRUE(good(sea.omnidirectional(k))) << k;
                            EXPECT_TRUE(good(sea.polar(k, 0.3))) << k;
                            EXPECT_TRUE(good(sea.arc(k, 0.3, 0.4))) << k;
                        }
                        const SpectralMoments all = moments(sea, 0.0, oracle::kInfinity);
                        for (double v :
                             {all.m0, all.m_minus1, all.xx, all.yy, all.xxxx, all.xxyy, all.yyyy}) {
                            EXPECT_TRUE(good(v));
                        }
                        EXPECT_TRUE(std::isfinite(all.xy) && std::isfinite(all.xxxy) &&
                                    std::isfinite(all.xyyy));
                        EXPECT_TRUE(good(oracle::cell_energy(sea, {-0.01, 0.01, -0.01, 0.01})));
                        EXPECT_TRUE(good(oracle::cell_energy(sea, {0.1, 0.2, -0.1, 0.1, 0.05, 0.15})));
                        EXPECT_TRUE(good(oracle::cell_energy(sea, {100.0, 101.0, 0.0, 1.0})));
                    }
                }
            }
        }
    }
}

TEST(DirectionalSpectrum, ViscosityEndsTheSlopes) {
    // What is left beyond the cutoff: exp(−(2)²) of the energy at twice its wavenumber.
    EXPECT_NEAR(viscous_cutoff(2.0 * kViscousWavenumber), std::exp(-4.0), 1e-15);
    EXPECT_NEAR(viscous_cutoff(10.0), 1.0, 3e-6);
}

}  // namespace
}  // namespace pelagic
