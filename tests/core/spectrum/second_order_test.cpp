// The kernels of pairs against the conditions at the free surface, solved here by themselves.
#include "core/spectrum/second_order.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/base/constants.h"
#include "core/spectrum/directional_spectrum.h"

namespace pelagic {
namespace {

constexpr double kDeep = std::numeric_limits<double>::infinity();

// K⁺ (or K⁻ with sign −1) of two waves of height 1: from Laplace's equation and both conditions at z = 0 to second order, whose
// products of first-order terms are taken at phases and projected.
double solved_kernel(double k1, double theta1, double k2, double theta2, double depth_m, double sign) {
    const auto t = [&](double k) { return std::isinf(depth_m) ? 1.0 : std::tanh(k * depth_m); };
    const double k[]{k1, k2}, theta[]{theta1, theta2};
    double omega[2], x[2], y[2];
    for (int i : {0, 1}) {
        omega[i] = std::sqrt(kGravity * k[i] * t(k[i]));
        x[i] = k[i] * std::cos(theta[i]);
        y[i] = k[i] * std::sin(theta[i]);
    }
    constexpr int kPhases = 8;
    double kinematic = 0.0, dynamic = 0.0;  // of sin χ, of cos χ
    for (int a = 0; a < kPhases; ++a)
        for (int b = 0; b < kPhases; ++b) {
            const double phase[]{kTwoPi * a / kPhases, kTwoPi * b / kPhases};
            double height = 0.0, slope_x = 0.0, slope_y = 0.0;
            double u = 0.0, v = 0.0, w = 0.0, w_z = 0.0, rate_z = 0.0;  // φ's gradient, φ_zz, φ_zt
            for (int i : {0, 1}) {
                const double c = std::cos(phase[i]), s = std::sin(phase[i]), potential = kGravity / omega[i];
                height += c;
                slope_x -= x[i] * s;
                slope_y -= y[i] * s;
                u += potential * x[i] * c;
                v += potential * y[i] * c;
                w += potential * k[i] * t(k[i]) * s;
                w_z += potential * k[i] * k[i] * s;
                rate_z -= potential * k[i] * t(k[i]) * omega[i] * c;
            }
            const double chi = phase[0] + sign * phase[1];
            const double per = 2.0 / (kPhases * kPhases);
            kinematic += per * std::sin(chi) * (height * w_z - slope_x * u - slope_y * v);
            dynamic += per * std::cos(chi) * (-height * rate_z - 0.5 * (u * u + v * v + w * w));
        }
    // η₂ = E cos χ, φ₂ = P sin χ cosh κ(z + d)/cosh κd:  Ω E − κ tanh(κd) P = kinematic,  g E − Ω P = dynamic.
    const double kappa = std::hypot(x[0] + sign * x[1], y[0] + sign * y[1]);
    const double frequency = omega[0] + sign * omega[1], rise = kappa * t(kappa);
    const double height =
        (kinematic * frequency - dynamic * rise) / (frequency * frequency - kGravity * rise);
    return 2.0 * height;  // ½ a₁ a₂ K
}

TEST(SecondOrder, MeetsTheConditionsAtTheFreeSurface) {
    for (double depth_m : {kDeep, 40.0, 8.0})
        for (double k2 : {0.031, 0.05, 0.2})
            for (double turn : {0.0, 0.4, 1.3, 2.2, 3.0}) {
                const double k1 = 0.03, theta1 = 0.7;
                const PairKernels kernels = pair_kernels(k1, theta1, k2, theta1 + turn, depth_m);
                const double tolerance = 1e-9 * (k1 + k2) * (1.0 + 1.0 / std::pow(k1 * depth_m, 3));
                EXPECT_NEAR(kernels.sum + kernels.displaced,
                            solved_kernel(k1, theta1, k2, theta1 + turn, depth_m, 1.0), tolerance)
                    << depth_m << " " << k2 << " " << turn;
                EXPECT_NEAR(kernels.difference - kernels.displaced,
                            solved_kernel(k1, theta1, k2, theta1 + turn, depth_m, -1.0), tolerance)
                    << depth_m << " " << k2 << " " << turn;
                const PairKernels turned = pair_kernels(k2, theta1 + turn, k1, theta1, depth_m);
                EXPECT_NEAR(turned.sum, kernels.sum, tolerance);
                EXPECT_NEAR(turned.difference, kernels.difference, tolerance);
            }
}

TEST(SecondOrder, HasItsLimits) {
    // Longuet-Higgins and Stewart 1960: waves that go the same way in deep water.
    const PairKernels same = pair_kernels(0.03, 0.2, 0.05, 0.2, kDeep);
    EXPECT_NEAR(same.sum, 0.0, 1e-12);
    EXPECT_NEAR(same.difference, 2.0 * 0.03, 1e-12);
    // Stokes: a wave with itself in water of any depth, a²k/4 (3 coth³ − coth) cos 2ψ.
    const double k = 0.1, depth_m = 9.0, c = 1.0 / std::tanh(k * depth_m);
    const PairKernels itself = pair_kernels(k, 1.0, k, 1.0, depth_m);
    EXPECT_NEAR(itself.sum + itself.displaced, k * (3.0 * c * c * c - c), 1e-12);
    EXPECT_NEAR(itself.sum, shallow_wavenumber(k, depth_m), 1e-12);
    for (double opposite : {0.0, kPi}) {
        const PairKernels equal = pair_kernels(k, 0.0, k, opposite, kDeep);
        EXPECT_TRUE(std::isfinite(equal.difference) && std::isfinite(equal.sum));
    }
}

// Of a narrow sea in deep water crests and troughs are those of Stokes's waves with Rayleigh's heights: skewness 3 k √m0.
TEST(SecondOrder, OfASwellIsThatOfStokes) {
    SeaState sea;
    sea.wind_speed_mps = 0.0;
    sea.swell = {{.height_m = 4.0, .period_s = 12.0, .direction_deg = 30.0}};
    const DirectionalSpectrum spectrum(sea);
    const SecondOrder pairs = second_order(spectrum);
    EXPECT_NEAR(pairs.skewness(), 3.0 * spectrum.peak_wavenumber() * 1.0,
                0.1 * pairs.skewness());  // a swell's own width
    sea.swell.clear();
    EXPECT_EQ(second_order(DirectionalSpectrum(sea)).skewness(), 0.0);
}

// In shallow water pairs would add without bounds.
TEST(SecondOrder, HasALimitInShallowWater) {
    for (double depth_m : {0.01, 0.5, 2.0, 10.0, 100.0, 1e9}) {
        SeaState sea;
        sea.depth_m = depth_m;
        sea.swell = {{.height_m = 1.0, .period_s = 25.0, .direction_deg = 180.0}};
        const SecondOrder pairs = second_order(DirectionalSpectrum(sea));
        ASSERT_TRUE(std::isfinite(pairs.skewness())) << depth_m;
        EXPECT_LE(std::abs(pairs.skewness()) * pairs.limit(), SecondOrder::kLargestSkewness * (1.0 + 1e-12));
        EXPECT_GT(pairs.limit(), 0.0);
    }
}

}  // namespace
}  // namespace pelagic
