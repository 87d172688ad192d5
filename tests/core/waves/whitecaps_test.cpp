// Coverage from moments of the Jacobian: tests the functions of whitecaps.h alone.
#include "core/waves/whitecaps.h"

#include "core/scene/names.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "core/spectrum/directional_spectrum.h"

namespace pelagic {
namespace {

double to_normal(double z, double skewness) {
    return whitecaps_detail::to_normal(z, skewness).y;
}

TEST(WilsonHilferty, RisesAndIsTheIdentityWithoutSkewness) {
    for (double skewness : {-1.5, -0.24, -1e-3, 0.0, 1e-3, 0.24, 1.5}) {
        double before = -1e300;
        for (double z = -3.0; z <= 3.0; z += 0.25) {
            EXPECT_GT(to_normal(z, skewness), before);
            before = to_normal(z, skewness);
            EXPECT_EQ(to_normal(z, 0.0), z);
        }
    }
    // Across the threshold to the identity the change is (z² − 1) skewness/6: 1e-4 × 8/6 at three deviations.
    EXPECT_NEAR(to_normal(3.0, 1.01e-4), to_normal(3.0, 0.99e-4), 2e-4);
    // A Pearson III variable is a shifted gamma. Skewness 2 gives the exponential, P(x − 1 < z) = 1 − e^(−(z
    // + 1)), for which Wilson and Hilferty are accurate to 0.01.
    for (double z : {-0.5, 0.0, 1.0, 2.0})
        EXPECT_NEAR(0.5 * std::erfc(-to_normal(z, 2.0) / std::sqrt(2.0)), 1.0 - std::exp(-(z + 1.0)), 0.01);
}

TEST(Coverage, IsAShareThatRisesWithTheThresholdAndTheStepWithoutVariance) {
    for (bool third : {false, true})
        for (float mean : {-3.0f, 0.0f, 0.4f, 1.0f, 5.0f})
            for (float variance : {0.0f, 1e-38f, 1e-6f, 0.05f, 1.0f, 1e6f})
                for (float skewness : {-5.0f, -0.3f, 0.0f, 0.3f, 5.0f}) {
                    const float third_moment = skewness * variance * std::sqrt(variance);
                    float before = 0.0f;
                    for (float threshold = -4.0f; threshold <= 6.0f; threshold += 0.05f) {
                        const float w = coverage<float>({mean, variance, third_moment}, threshold, third);
                        ASSERT_TRUE(w >= 0.0f && w <= 1.0f);
                        // Of a footprint folded but for a thousandth, single precision knows three digits.
                        ASSERT_GE(w, before - (mean < 0.0f ? 1e-3f : 1e-6f));
                        before = w;
                        if (variance == 0.0f) {
                            ASSERT_EQ(w, mean < threshold ? 1.0f : 0.0f);
                        }
                    }
                }
    const float never = -std::numeric_limits<float>::infinity();
    EXPECT_EQ(coverage<float>({1.0f, 0.05f, 0.001f}, never, true), 0.0f);
    EXPECT_EQ(coverage<float>({1.0f, 0.0f, 0.0f}, never, true), 0.0f);
}

// The distribution of J that three moments stand for: a Gaussian, or a gamma variable moved and scaled.
double density(double j, double mean, double sigma, double skewness) {
    const double z = (j - mean) / sigma;
    if (skewness == 0.0) return std::exp(-0.5 * z * z) / std::sqrt(2.0 * kPi) / sigma;
    const double shape = 4.0 / (skewness * skewness), x = shape + 2.0 * z / skewness;
    if (x <= 0.0) return 0.0;
    return std::exp((shape - 1.0) * std::log(x) - x - std::lgamma(shape)) * 2.0 /
           (std::abs(skewness) * sigma);
}

// Shares of the sea's area, counted by quadrature: ∫ J p dJ from 0 to the threshold over ∫ J p dJ from 0 on.
TEST(Coverage, IsTheShareOfTheSeasArea) {
    for (double mean : {1.0, 0.6, 0.2})
        for (double sigma : {0.1, 0.3, 0.6})
            for (double skewness : {-0.3, 0.0, 0.3, 0.8}) {
                const JacobianMoments<double> j{mean, sigma * sigma, skewness * sigma * sigma * sigma};
                constexpr int kSteps = 20000;
                const double end = mean + 10.0 * sigma, step = end / kSteps;
                double sea = 0.0, foam[3] = {};
                const double thresholds[3] = {0.2, 0.5, 0.9};
                for (int i = 0; i < kSteps; ++i) {
                    const double at = (i + 0.5) * step;
                    const double part = at * density(at, mean, sigma, skewness) * step;
                    sea += part;
                    for (int t = 0; t < 3; ++t)
                        if (at < thresholds[t]) foam[t] += part;
                }
                EXPECT_NEAR(sea_area(j, true) / sea, 1.0, 0.01) << mean << ' ' << sigma << ' ' << skewness;
                // Wilson and Hilferty's approximation is good to this.
                for (int t = 0; t < 3; ++t)
                    EXPECT_NEAR(coverage(j, thresholds[t], true), foam[t] / sea, 0.005)
                        << mean << ' ' << sigma << ' ' << skewness << ' ' << thresholds[t];
            }
}

// A sea is the same however finely it is looked at: waves shown in one footprint and unresolved in another.
TEST(Coverage, OverTheSeasAreaIsTheSameAtEveryFootprint) {
    for (const double wind : {8.0, 14.0}) {
        Scene scene;
        scene.sea.wind_speed_mps = wind;
        const DirectionalSpectrum spectrum(scene.sea);
        const auto gradient = [&](double from, double to) {
            const SpectralMoments m = moments(spectrum, from, to);
            return UnresolvedGradients<double>{m.xxxx, m.xxxy, m.xxyy, m.xyyy, m.yyyy};
        };
        const double threshold =
            calibrated_threshold(moments(spectrum, 0.0, 1e9), law_coverage(scene), 1.0, true);
        const double all =
            coverage(jacobian_moments(0.0, 0.0, 0.0, 0.0, gradient(0.0, 1e9)), threshold, true);
        for (const double edge : {0.3, 3.0, 30.0}) {  // rad/m: longer waves are shown
            const UnresolvedGradients<double> shown = gradient(0.0, edge), unresolved = gradient(edge, 1e9);
            const double a = std::sqrt(shown.xxxx), b = shown.xxyy / a;
            const double d = std::sqrt(shown.yyyy - b * b), f = std::sqrt(shown.xxyy);
            std::mt19937_64 generator(7);
            std::normal_distribution<double> normal;
            double foam = 0.0, sea = 0.0;
            for (int i = 0; i < 400000; ++i) {
                const double x = normal(generator), y = normal(generator), z = normal(generator);
                const auto j = jacobian_moments(a * x, b * x + d * y, f * z, f * z, unresolved);
                const double area = sea_area(j, true);
                sea += area;
                foam += area * coverage(j, threshold, true);
            }
            EXPECT_NEAR(foam / sea / all, 1.0, 0.05) << wind << " m/s, " << edge << " rad/m";
        }
    }
}

// The gradient covariance of a real sea and a few shown derivatives: J's cumulants against random draws of the
// three Gaussians. 20 batches give the sampling error; the tolerance is five times that.
class GaussianRemainder : public testing::TestWithParam<double> {};

TEST_P(GaussianRemainder, GivesTheseJacobianMoments) {
    Scene scene;
    scene.sea.wind_speed_mps = 18.0;
    scene.sea.wind_direction_deg = 20.0;  // so that xxxy and xyyy aren't 0
    const SpectralMoments m = moments(DirectionalSpectrum(scene.sea), 0.3, 1e4);
    const double c2 = GetParam() * GetParam();
    const UnresolvedGradients<double> v{c2 * m.xxxx, c2 * m.xxxy, c2 * m.xxyy, c2 * m.xyyy, c2 * m.yyyy};
    // Cholesky factor of the covariance of (sxx, syy, sxy).
    const double a = std::sqrt(v.xxxx), b = v.xxyy / a, c = v.xxxy / a;
    const double d = std::sqrt(v.yyyy - b * b), e = (v.xyyy - b * c) / d,
                 f = std::sqrt(v.xxyy - c * c - e * e);
    ASSERT_GT(std::abs(v.xxxy), 1e-3 * v.xxxx);

    std::mt19937_64 generator(3);
    std::normal_distribution<double> normal;
    double two_moments_off = 0.0, three_moments_off = 0.0;
    for (const std::array<double, 3>& shown :
         {std::array{0.0, 0.0, 0.0}, {-0.25, 0.1, 0.12}, {0.2, -0.3, -0.05}}) {
        const auto [dxx, dyy, dxy] = shown;
        constexpr int kBatches = 20, kDraws = 50000;
        const JacobianMoments<double> theory = jacobian_moments(dxx, dyy, dxy, dxy, v);
        const double sigma = std::sqrt(theory.variance);
        std::array<std::array<double, kBatches>, 3> batches;
        const double threshold = theory.mean - 2.2 * sigma;
        double foam = 0.0, sea = 0.0;
        for (int batch = 0; batch < kBatches; ++batch) {
            std::array<double, 3> sums{};
            for (int i = 0; i < kDraws; ++i) {
                const double x = normal(generator), y = normal(generator), z = normal(generator);
                const double sxx = a * x, syy = b * x + d * y, sxy = c * x + e * y + f * z;
                const double j = (1.0 + dxx + sxx) * (1.0 + dyy + syy) - (dxy + sxy) * (dxy + sxy);
                const double difference = j - theory.mean;
                sums[0] += difference;
                sums[1] += difference * difference;
                sums[2] += difference * difference * difference;
                sea += std::max(j, 0.0);
                if (j < threshold) foam += std::max(j, 0.0);
            }
            for (int n = 0; n < 3; ++n) batches[n][batch] = sums[n] / kDraws;
        }
        const std::array<double, 3> expected{0.0, theory.variance, theory.third};
        for (int n = 0; n < 3; ++n) {
            double mean = 0.0, variance = 0.0;
            for (double value : batches[n]) mean += value / kBatches;
            for (double value : batches[n]) variance += (value - mean) * (value - mean) / (kBatches - 1);
            EXPECT_NEAR(mean, expected[n], 5.0 * std::sqrt(variance / kBatches)) << "cumulant " << n + 1;
            // The error is small against the cumulant itself or its scale, so that the test is meaningful.
            EXPECT_LT(5.0 * std::sqrt(variance / kBatches),
                      0.2 * std::max(std::abs(expected[n]), std::pow(sigma, n + 1)));
        }
        if (GetParam() > 1.0) continue;  // coverage is meant for seas; a J this skewed isn't one
        foam /= sea;
        two_moments_off += std::abs(std::log(coverage(theory, threshold, false) / foam));
        three_moments_off += std::abs(std::log(coverage(theory, threshold, true) / foam));
        EXPECT_NEAR(coverage(theory, threshold, true) / foam, 1.0, 0.1);
    }
    if (GetParam() == 1.0) {
        EXPECT_LT(three_moments_off, 0.5 * two_moments_off);
    }
}

// The choppiness of a sea, and one at which J's quadratic terms are as large as the linear ones.
INSTANTIATE_TEST_SUITE_P(Choppiness, GaussianRemainder, testing::Values(1.0, 4.0));

TEST(JacobianMoments, AreExactWhereNothingIsUnresolved) {
    const auto j = jacobian_moments(0.3f, -0.2f, 0.1f, 0.1f, UnresolvedGradients<float>{});
    EXPECT_FLOAT_EQ(j.mean, 1.3f * 0.8f - 0.01f);
    EXPECT_EQ(j.variance, 0.0f);
    EXPECT_EQ(j.third, 0.0f);
}

// Mip levels: the mixture's moments against their definition.
TEST(MomentSum, IsTheMixtureOfItsParts) {
    std::mt19937 generator(5);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    for (double scale : {1.0, 1e-3}) {  // a rough sea, and a calm one, where squares of the mean would cancel
        std::vector<JacobianMoments<float>> parts;
        for (int i = 0; i < 16; ++i) {
            const auto draw = [&] { return uniform(generator) * scale; };
            const double mean = 1.0 + draw() - 0.5 * scale, sigma = draw();
            parts.push_back({static_cast<float>(mean), static_cast<float>(sigma * sigma),
                             static_cast<float>(0.3 * sigma * sigma * sigma)});
        }
        MomentSum<float> sum;
        double mean = 0.0, variance = 0.0, third = 0.0;
        for (const auto& part : parts) {
            sum.add(part);
            mean += static_cast<double>(part.mean) / 16.0;
        }
        for (const auto& part : parts) {
            const double d = part.mean - mean;
            variance += (part.variance + d * d) / 16.0;
            third += (part.third + 3.0 * d * part.variance + d * d * d) / 16.0;
        }
        const auto whole = sum.moments();
        // Rounding in single precision, some 1e-7 per operation, relative to the parts' spread and to the
        // mean.
        EXPECT_NEAR(whole.mean, mean, 2e-7);
        EXPECT_NEAR(whole.variance / variance, 1.0, 1e-4);
        EXPECT_NEAR(whole.third / std::pow(variance, 1.5), third / std::pow(variance, 1.5),
                    1e-4 / std::sqrt(scale));
    }
    EXPECT_EQ(MomentSum<float>().moments().variance, 0.0f);
    MomentSum<float> constant;
    for (int i = 0; i < 4; ++i) constant.add({0.7f, 0.0f, 0.0f});
    EXPECT_EQ(constant.moments().variance, 0.0f);
    EXPECT_EQ(constant.moments().mean, 0.7f);
}

TEST(CalibratedThreshold, GivesTheObservedCoverageOfTheWholeSea) {
    for (double wind : {6.0, 10.0, 14.0, 20.0}) {
        Scene scene;
        scene.sea.wind_speed_mps = wind;
        const SpectralMoments m =
            moments(DirectionalSpectrum(scene.sea), 0.0, std::numeric_limits<double>::infinity());
        const auto j = jacobian_moments(0.0, 0.0, 0.0, 0.0,
                                        UnresolvedGradients<double>{m.xxxx, m.xxxy, m.xxyy, m.xyyy, m.yyyy});
        for (const bool third_moment : {false, true}) {
            const double w =
                coverage(j, calibrated_threshold(m, law_coverage(scene), 1.0, third_moment), third_moment);
            EXPECT_NEAR(w / law_coverage(scene), 1.0, 1e-6);
        }
    }
    EXPECT_EQ(calibrated_threshold({}, 0.0, 1.0, true), -std::numeric_limits<double>::infinity());
    EXPECT_EQ(calibrated_threshold({}, 0.01, 1.0, true), -std::numeric_limits<double>::infinity());
}

// However far crests are moved together, a sea that breaks has foam.
TEST(Whitecaps, OfEveryChoppinessHaveFoam) {
    Scene scene;
    scene.sea.wind_speed_mps = 14.0;
    const double law = law_coverage(scene);
    for (const double choppiness : {0.5, 1.0, 2.0, 4.0, 8.0, 9.0, 10.0}) {
        SpectralMoments m = moments(DirectionalSpectrum(scene.sea), 0.0, 6.0);
        m.scale_gradients(choppiness * choppiness);
        const auto j = jacobian_moments(0.0, 0.0, 0.0, 0.0,
                                        UnresolvedGradients<double>{m.xxxx, m.xxxy, m.xxyy, m.xyyy, m.yyyy});
        const double foam = coverage(j, calibrated_threshold(m, law, choppiness, true), true);
        EXPECT_NEAR(foam, law, 1e-6 * law) << choppiness;
    }
}

// Each in percent at a few winds, from its paper's formula.
TEST(WhitecapLaws, AreThePapers) {
    struct Seen {
        WhitecapLaw law;
        double wind_mps, sea_minus_air_c, percent;
    };
    for (const Seen& seen :
         {Seen{WhitecapLaw::Monahan1980, 10.0, 0.0, 0.9768},
          Seen{WhitecapLaw::Monahan1980, 20.0, 5.0, 11.206},
          Seen{WhitecapLaw::Monahan1986, 10.0, 0.0, 0.6919},
          Seen{WhitecapLaw::Monahan1986, 10.0, 8.0, 1.3777}, Seen{WhitecapLaw::Callaghan2008, 3.7, 0.0, 0.0},
          Seen{WhitecapLaw::Callaghan2008, 8.0, 0.0, 0.2528},
          Seen{WhitecapLaw::Callaghan2008, 14.0, 0.0, 1.9669},
          Seen{WhitecapLaw::Callaghan2008, 23.09, 0.0, 7.5947},
          Seen{WhitecapLaw::Callaghan2008, 60.0, 0.0, 7.5947}}) {
        Scene scene;
        scene.sea.wind_speed_mps = seen.wind_mps;
        scene.effects.whitecap_law = seen.law;
        scene.effects.sea_minus_air_c = seen.sea_minus_air_c;
        EXPECT_NEAR(100.0 * law_coverage(scene), seen.percent, 2e-3) << seen.wind_mps;
        scene.effects.whitecap_amount = 2.0;
        EXPECT_NEAR(100.0 * law_coverage(scene), 2.0 * seen.percent, 4e-3) << seen.wind_mps;
        scene.effects.whitecap_amount = 0.0;
        EXPECT_EQ(law_coverage(scene), 0.0);
    }
}

// A sea is never white all over, and what is stretched doesn't break: whatever the wind, the law, the amount and the waves.
TEST(WhitecapLaws, AreCapped) {
    for (const auto& word : words_of(WhitecapLaw()))
        for (const double wind_mps : {0.1, 5.0, 24.0, 40.0, 80.0})
            for (const double amount : {1.0, 100.0})
                for (const double choppiness : {0.01, 0.3, 1.0, 3.0}) {
                    Scene scene;
                    scene.sea.wind_speed_mps = wind_mps;
                    scene.effects.whitecap_law = word.value;
                    scene.effects.whitecap_amount = amount;
                    EXPECT_LE(law_coverage(scene), 0.6);
                    SpectralMoments m = moments(DirectionalSpectrum(scene.sea), 0.0, 6.0);
                    m.scale_gradients(choppiness * choppiness);
                    EXPECT_LT(calibrated_threshold(m, law_coverage(scene), choppiness, true), 1.0);
                }
}

}  // namespace
}  // namespace pelagic
