#include "core/spectrum/spectral_moments.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/core/spectrum/oracles.h"

namespace pelagic {
namespace {

TEST(SpectralMoments, AreThePlainIntegrals) {
    for (SpreadingKind spreading : oracle::kSpreadings) {
        for (double depth : {4.0, oracle::kInfinity}) {
            SeaState state;
            state.spectrum = SpectrumKind::PiersonMoskowitz;
            state.spreading = spreading;
            state.wind_direction_deg = 35.0;
            state.depth_m = depth;
            state.swell = {{1.0, 10.0, 100.0}};
            const DirectionalSpectrum sea(state);
            const double lo = 0.03, hi = 3.0;
            // Straight from the definition: midpoints in ln k (1 %) and angle (0.5°), second order: 1e-5.
            SpectralMoments plain;
            const int rings = 460, rays = 720;
            double x = 0.0, y = 0.0;
            for (int i = 0; i < rings; ++i) {
                const double dlog = std::log(hi / lo) / rings, k = lo * std::exp((i + 0.5) * dlog);
                const double ratio = sea.dispersion().horizontal_ratio(k);
                for (int j = 0; j < rays; ++j) {
                    const double t = 2 * oracle::kPi * (j + 0.5) / rays, c = std::cos(t), s = std::sin(t);
                    const double e = sea.polar(k, t) * k * dlog * 2 * oracle::kPi / rays;
                    const double slope = k * k * e, jacobian = slope * ratio * ratio;
                    plain.m0 += e;
                    plain.m_minus1 += e / sea.dispersion().omega(k);
                    plain.xx += slope * c * c;
                    plain.xy += slope * c * s;
                    plain.yy += slope * s * s;
                    plain.xxxx += jacobian * c * c * c * c;
                    plain.xxxy += jacobian * c * c * c * s;
                    plain.xxyy += jacobian * c * c * s * s;
                    plain.xyyy += jacobian * c * s * s * s;
                    plain.yyyy += jacobian * s * s * s * s;
                    x += e * c;
                    y += e * s;
                }
            }
            const SpectralMoments got = moments(sea, lo, hi);
            const auto near = [](double a, double b, double scale) {
                EXPECT_NEAR(a / scale, b / scale, 1e-4);
            };
            near(got.m0, plain.m0, plain.m0);
            near(got.m_minus1, plain.m_minus1, plain.m_minus1);
            near(got.xx, plain.xx, plain.mss());
            near(got.xy, plain.xy, plain.mss());
            near(got.yy, plain.yy, plain.mss());
            near(got.xxxx, plain.xxxx, plain.xxxx);
            near(got.xxxy, plain.xxxy, plain.xxxx);
            near(got.xxyy, plain.xxyy, plain.xxxx);
            near(got.xyyy, plain.xyyy, plain.xxxx);
            near(got.yyyy, plain.yyyy, plain.xxxx);
            EXPECT_NEAR(got.mean_direction(), std::atan2(y, x), 1e-4);
        }
    }
}

TEST(SpectralMoments, BandsAddUp) {
    SeaState state;
    state.swell = {{1.0, 10.0, 100.0}};
    const DirectionalSpectrum sea(state);
    const SpectralMoments all = moments(sea, 0.0, oracle::kInfinity);
    SpectralMoments sum;
    const double edges[] = {0.0, 0.041, 0.3, 17.0, oracle::kInfinity};
    for (int i = 0; i < 4; ++i) {
        const SpectralMoments band = moments(sea, edges[i], edges[i + 1]);
        sum.m0 += band.m0;
        sum.xx += band.xx;
        sum.xxyy += band.xxyy;
    }
    EXPECT_NEAR(sum.m0 / all.m0, 1.0, 1e-7);
    EXPECT_NEAR(sum.xx / all.xx, 1.0, 1e-7);
    EXPECT_NEAR(sum.xxyy / all.xxyy, 1.0, 1e-7);
    EXPECT_NEAR(all.m0, sea.m0(), 1e-12);
    EXPECT_EQ(moments(sea, 2.0, 1.0).m0, 0.0);
}

TEST(SpectralMoments, DeepWaterJacobianVariancesAddUpToTheSlopes) {
    // cos⁴ + 2 cos² sin² + sin⁴ = 1 and coth = 1.
    const DirectionalSpectrum sea{SeaState{}};
    const SpectralMoments all = moments(sea, 0.0, oracle::kInfinity);
    EXPECT_NEAR((all.xxxx + 2 * all.xxyy + all.yyyy) / all.mss(), 1.0, 1e-12);
}

TEST(SpectralMoments, EnergyPeriodOfPiersonMoskowitz) {
    // ∫S/ω dω over ∫S dω with t = β(ω0/ω)⁴: Γ(5/4)/(β^¼ ω0).
    SeaState state;
    state.spectrum = SpectrumKind::PiersonMoskowitz;
    state.short_waves = ShortWaves::None;
    const SpectralMoments all = moments(DirectionalSpectrum(state), 0.0, oracle::kInfinity);
    const double w0 = 9.81 / (1.026 * 10.0);
    EXPECT_NEAR(all.energy_period_s(), 2 * oracle::kPi * std::tgamma(1.25) / (std::pow(0.74, 0.25) * w0),
                1e-5);
    EXPECT_NEAR(all.significant_height_m(), 4 * std::sqrt(all.m0), 1e-14);
}

}  // namespace
}  // namespace pelagic
