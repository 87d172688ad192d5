// Every shape over direction: a density, its integral and its harmonics belong together.
#include "core/spectrum/angular.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "tests/core/spectrum/oracles.h"

namespace pelagic {
namespace {

using oracle::simpson;

template <class Shape>
void expect_consistent(const Shape& shape, const char* name, double parameter) {
    SCOPED_TRACE(testing::Message() << name << " " << parameter);
    // Simpson on 4000 intervals of h = 1.6e-3 rad. Smooth shapes: h⁴/180 times the fourth derivative, 1e-8
    // for the narrowest here (half width 0.02). The worst is the cusp |π − θ|^0.6 of s = 0.3: h^1.6/60 =
    // 6e-7.
    constexpr int kHalf = 2000;
    EXPECT_NEAR(simpson(-oracle::kPi, oracle::kPi, kHalf, [&](double t) { return shape.density(t); }), 1.0,
                1e-6);
    EXPECT_NEAR(shape.cumulative(oracle::kPi) - shape.cumulative(-oracle::kPi), 1.0, 1e-12);
    for (double from : {-3.0, -0.7, 0.0, 0.02, 1.3}) {
        for (double to : {-2.0, 0.01, 0.5, 3.1}) {
            const double arc = simpson(from, to, kHalf, [&](double t) { return shape.density(t); });
            EXPECT_NEAR(shape.cumulative(to) - shape.cumulative(from), arc, 1e-6) << from << " to " << to;
            EXPECT_NEAR(shape.cumulative(to + 2 * oracle::kPi) - shape.cumulative(to), 1.0, 1e-12);
            EXPECT_NEAR(shape.cumulative(to - 14 * oracle::kPi) - shape.cumulative(to), -7.0, 1e-12);
        }
    }
    for (int n = 0; n <= 5; ++n) {
        const double re = simpson(-oracle::kPi, oracle::kPi, kHalf,
                                  [&](double t) { return shape.density(t) * std::cos(n * t); });
        const double im = simpson(-oracle::kPi, oracle::kPi, kHalf,
                                  [&](double t) { return shape.density(t) * std::sin(n * t); });
        EXPECT_NEAR(shape.harmonic(n).real(), re, 1e-6) << n;
        EXPECT_NEAR(shape.harmonic(n).imag(), im, 1e-6) << n;
    }
    for (double t = -10.0; t < 10.0; t += 0.01) EXPECT_GE(shape.density(t), 0.0) << t;
}

TEST(Angular, CosinePowerIsADensity) {
    for (double s : {0.0, 1e-9, 0.3, 1.0, 7.9, 8.0, 20.0, 75.0, 1000.0})
        expect_consistent(CosinePower(s), "s", s);
}

TEST(Angular, CosinePowerOfAHugeExponentIsANeedle) {
    // For s → ∞ a Gaussian of variance 2/s: 1/√(2π·2/s) high, with erf for its arcs. cos² near 1 is known to
    // 1e-16, its power to s times that, 1e-6.
    const double s = 1e10, sigma = std::sqrt(2.0 / s);
    const CosinePower needle(s);
    EXPECT_NEAR(needle.density(0.0) * std::sqrt(2.0 * oracle::kPi) * sigma, 1.0, 1e-9);
    EXPECT_NEAR(needle.cumulative(sigma), 0.5 * std::erf(std::sqrt(0.5)), 1e-6);
    EXPECT_NEAR(needle.cumulative(3.0), 0.5, 1e-14);
    EXPECT_EQ(needle.density(3.0), 0.0);
}

TEST(Angular, CosinePowerNormMatchesTheGammaFunction) {
    for (double s : {0.1, 2.5, 9.0, 60.0}) {
        const double exact =
            std::exp(std::lgamma(s + 1.0) - std::lgamma(s + 0.5)) / (2.0 * std::sqrt(oracle::kPi));
        EXPECT_NEAR(CosinePower(s).density(0.0) / exact, 1.0, 1e-11) << s;
    }
}

TEST(Angular, SechSquaredIsADensity) {
    for (double beta : {0.01, 0.398, 1.24, 2.44, 30.0}) expect_consistent(SechSquared(beta), "beta", beta);
}

TEST(Angular, CosineSquaredIsADensity) {
    expect_consistent(CosineSquared(), "cos²", 2.0);
}

TEST(Angular, SecondHarmonicIsADensity) {
    for (double delta : {0.0, 0.3, 1.0}) expect_consistent(SecondHarmonic(delta), "delta", delta);
}

TEST(Angular, SecondHarmonicIsThePapersForBothSensesTogether) {
    const SecondHarmonic shape(0.4);
    for (double t = 0.0; t < 6.3; t += 0.1) {
        EXPECT_NEAR(shape.density(t) + shape.density(t + oracle::kPi),
                    (1.0 + 0.4 * std::cos(2 * t)) / oracle::kPi, 1e-14);
    }
    EXPECT_NEAR(shape.density(oracle::kPi), 0.0, 1e-15);
}

TEST(Angular, MaximumEntropyHasTheGivenCoefficients) {
    const std::complex<double> i(0.0, 1.0);
    struct Given {
        std::complex<double> c1, c2;
    };
    for (const Given& g :
         {Given{0.0, 0.0}, Given{0.5, 0.1}, Given{0.8 * std::exp(2.0 * i), 0.5 * std::exp(3.5 * i)},
          Given{0.9, 0.7}, Given{0.01 * i, 0.9}, Given{0.6, 0.36}, Given{0.95, 0.83}}) {
        const MaximumEntropy shape(g.c1, g.c2);
        expect_consistent(shape, "|c1|", std::abs(g.c1));
        EXPECT_NEAR(std::abs(shape.harmonic(1) - g.c1), 0.0, 1e-12);
        EXPECT_NEAR(std::abs(shape.harmonic(2) - g.c2), 0.0, 1e-12);
    }
}

TEST(Angular, MaximumEntropyWithEqualRootsStaysExact) {
    // φ1²/4 + φ2 = 0 makes both roots r: c1 = 2r/(1 + r²).
    const double r = 0.5, phi1 = 2 * r, phi2 = -r * r;
    const double c1 = phi1 / (1.0 - phi2);
    expect_consistent(MaximumEntropy(c1, phi1 * c1 + phi2), "equal roots", r);
}

TEST(Angular, MaximumEntropyMovesImpossibleCoefficientsToTheEdge) {
    using C = std::complex<double>;
    for (const auto& [c1, c2] : {std::pair{C(0.5, 0.2), C(-0.9, 0.3)}, std::pair{C(1.0, 0.0), C(1.0, 0.0)},
                                 std::pair{C(1.3, 0.0), C(-2.0, 0.0)}, std::pair{C(0.0, 0.0), C(1.0, 0.0)}}) {
        const MaximumEntropy shape(c1, c2);
        const C got1 = shape.harmonic(1), got2 = shape.harmonic(2);
        EXPECT_LE(std::abs(got1), MaximumEntropy::kMaxFirst + 1e-12);
        EXPECT_LE(std::abs(got2 - got1 * got1), MaximumEntropy::kMaxSecond * (1.0 - std::norm(got1)) + 1e-12);
        EXPECT_NEAR(shape.cumulative(oracle::kPi) - shape.cumulative(-oracle::kPi), 1.0, 1e-9);
        for (double t = 0.0; t < 6.3; t += 1e-3) {
            EXPECT_TRUE(std::isfinite(shape.density(t)));
            EXPECT_GE(shape.density(t), 0.0);
            EXPECT_GE(shape.cumulative(t + 1e-3), shape.cumulative(t) - 1e-9);
        }
    }
}

}  // namespace
}  // namespace pelagic
