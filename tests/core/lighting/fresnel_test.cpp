// Fresnel reflectance of one facet, and averaged over the visible facets.
#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>

#include "tests/core/lighting/optics.h"

namespace pelagic::optics {
namespace {

constexpr int kInputs = 100000;

// The requirement is 1e-4 relative. The term is at least 0.02, so single precision gives 1e-5.
TEST(Fresnel, ExactTermIsSnellsAndFresnels) {
    Optics optics;
    Inputs inputs(1);
    for (int i = 0; i < kInputs; ++i) {
        const float c = i == 0 ? 0.0f : static_cast<float>(inputs.logarithmic(1e-6, 1.0));
        const double expected = oracle::fresnel(static_cast<double>(c));
        ASSERT_NEAR(optics.fresnel_exact(c, optics.kWaterIndex), expected, 1e-5 * expected) << c;
        ASSERT_NEAR(optics.fresnel_schlick(c), oracle::schlick(static_cast<double>(c)), 1e-6) << c;
    }
}

// From inside the water: total reflection beyond the critical angle, cos² = 1 − 1/1.34². Near it the square
// root is infinitely steep, so that an error of 1e-7 in the cosine becomes 1e-3.
TEST(Fresnel, TotalReflectionFromBelow) {
    Optics optics;
    const float inside = 1.0f / 1.34f;
    const float edge = static_cast<float>(std::sqrt(1.0 - 1.0 / (1.34 * 1.34)));
    for (float c = 0.0f; c < edge - 1e-4f; c += 1e-3f) ASSERT_EQ(optics.fresnel_exact(c, inside), 1.0f) << c;
    for (float c = edge + 1e-3f; c <= 1.0f; c += 1e-3f) {
        const double expected = oracle::fresnel(static_cast<double>(c), 1.0 / 1.34);
        ASSERT_NEAR(optics.fresnel_exact(c, inside), expected, 1e-4 * expected) << c;
    }
}

double average(double theta, dvec3 s, double (*term)(double)) {
    const dvec3 v(std::sin(theta), 0.0, std::cos(theta));
    return oracle::over_visible(v, s, 180, [&](dvec2, dvec3 f) { return term(dot(v, f)); });
}

double exact(double cosine) {
    return oracle::fresnel(cosine);
}

// Against Eq. 24's integral, for σ up to 0.5 along and across the line of sight. Our fit is within 0.006 of the mean of
// the exact term; within 0.025 and 0.05 for slopes whose correlation is 0.7 and 0.99, which it doesn't know. Eq. 26 is
// within 0.11 of the mean of Schlick's term: it was made for Smith's masking.
TEST(Fresnel, EffectiveTermsAreTheAverages) {
    Optics optics;
    for (double degrees : {0.0, 25.0, 50.0, 65.0, 75.0, 80.0, 84.0, 87.0, 89.0, 89.9}) {
        const double theta = degrees * oracle::kPi / 180.0;
        const float c = static_cast<float>(std::cos(theta));
        for (double along : {0.01, 0.05, 0.1, 0.2, 0.35, 0.5})
            for (double across : {0.02, 0.2, 0.5})
                for (double correlation : {0.0, 0.7, 0.99}) {
                    const dvec3 s(along * along, across * across, correlation * along * across);
                    EXPECT_NEAR(
                        optics.fresnel_effective_exact(c, static_cast<float>(along), static_cast<float>(s.y)),
                        average(theta, s, exact),
                        correlation > 0.9   ? 0.05
                        : correlation > 0.5 ? 0.025
                                            : 0.006)
                        << degrees << ' ' << along << ' ' << across << ' ' << correlation;
                }
        for (double sigma : {0.05, 0.1, 0.2, 0.35, 0.5}) {
            EXPECT_NEAR(optics.fresnel_effective_paper(c, static_cast<float>(sigma)),
                        average(theta, dvec3(sigma * sigma, sigma * sigma, 0.0), oracle::schlick), 0.11)
                << degrees << ' ' << sigma;
        }
    }
}

// A flat mirror has the term itself. The fit changes the cosine by a fraction of the variance, here 1e-6 of
// it, and by σ where the cosine is as small as σ; the term's slope is at most 6.
TEST(Fresnel, EffectiveTermOfAMirrorIsTheTerm) {
    Optics optics;
    for (float c = 0.0f; c <= 1.0f; c += 1e-3f) {
        EXPECT_NEAR(optics.fresnel_effective_exact(c, 1e-5f, 1e-10f),
                    optics.fresnel_exact(c, optics.kWaterIndex), 1e-4f)
            << c;
    }
}

}  // namespace
}  // namespace pelagic::optics
