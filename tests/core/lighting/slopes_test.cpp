// The distribution of slopes, and their visibility.
#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>
#include <limits>

#include "tests/core/lighting/optics.h"

namespace pelagic::optics {
namespace {

constexpr int kSlopeInputs = 100000;
constexpr double kSlack = 1e-4;  // required of single precision

TEST(SpecialFunctions, ErrorFunctionsScaledTail) {
    Optics optics;
    Inputs inputs(2);
    for (int i = 0; i < kSlopeInputs; ++i) {
        const float a = static_cast<float>(inputs.logarithmic(1e-8, 5.0));
        const double x = static_cast<double>(a), tail = std::exp(x * x) * std::erfc(x);
        ASSERT_NEAR(optics.erfcx(a), tail, 2e-6 * tail) << a;
        const double rest = 1.0 - std::sqrt(oracle::kPi) * x * tail;
        ASSERT_NEAR(optics.erfcx_remainder(a), rest, 2e-6 * rest + 1e-14 * x) << a;
    }
    // Large a: the asymptotic series 1/(√π a) (1 − 1/2a² + 3/4a⁴ − 15/8a⁶ …), whose next term is below 1e-7
    // from a = 20 on.
    for (float a : {20.0f, 100.0f, 1e3f, 1e8f}) {
        const double x = static_cast<double>(a), q = 1.0 / (2.0 * x * x);
        const double tail = (1.0 - q * (1.0 - 3.0 * q * (1.0 - 5.0 * q))) / (std::sqrt(oracle::kPi) * x);
        EXPECT_NEAR(optics.erfcx(a), tail, 2e-6 * tail) << a;
        const double rest = q * (1.0 - 3.0 * q * (1.0 - 5.0 * q));
        EXPECT_NEAR(optics.erfcx_remainder(a), rest, 2e-6 * rest) << a;
    }
    EXPECT_NEAR(optics.erfcx(0.0f), 1.0f, 2e-6f);
    EXPECT_NEAR(optics.erfcx_remainder(0.0f), 1.0f, 2e-6f);
}

// The covariance in the frame by finite differences: rotates the world and measures how a facet's slope in
// the frame changes with its world slope.
dvec3 turned_variance(dvec3 n, dvec3 s) {
    const double q = 1.0 / (1.0 + n.z);
    const dmat3 turn(dvec3(1.0 - n.x * n.x * q, -n.x * n.y * q, -n.x),
                     dvec3(-n.x * n.y * q, 1.0 - n.y * n.y * q, -n.y), n);
    const auto slope = [&](dvec2 world) {
        const dvec3 f = transpose(turn) * dvec3(-world.x, -world.y, 1.0);
        return dvec2(-f.x, -f.y) / f.z;
    };
    const dvec2 at(-n.x / n.z, -n.y / n.z);
    const double step = 1e-6 * (1.0 + length(at));
    const dvec2 x = (slope(at + dvec2(step, 0.0)) - slope(at - dvec2(step, 0.0))) / (2.0 * step);
    const dvec2 y = (slope(at + dvec2(0.0, step)) - slope(at - dvec2(0.0, step))) / (2.0 * step);
    return {s.x * x.x * x.x + s.y * y.x * y.x + 2.0 * s.z * x.x * y.x,
            s.x * x.y * x.y + s.y * y.y * y.y + 2.0 * s.z * x.y * y.y,
            s.x * x.x * x.y + s.y * y.x * y.y + s.z * (x.x * y.y + x.y * y.x)};
}

// The covariance in the frame against finite differences (with a relative error of 1e-9). Off-diagonal terms
// may cancel, so the floor is relative to the diagonal.
TEST(Slopes, FrameCarriesTheTensor) {
    Optics optics;
    Inputs inputs(3);
    for (int i = 0; i < kSlopeInputs; ++i) {
        const vec3 n = inputs.direction(0.1), s = inputs.variance(1e-3, 1.0, 0.9);
        const auto frame = optics.slope_frame(n, s);
        const dvec3 expected = turned_variance(normalize(dvec3(n)), dvec3(s));
        const double larger = std::max(expected.x, expected.y);
        ASSERT_NEAR(frame.variance.x, expected.x, kSlack * expected.x + 1e-6 * larger + 1.1e-10) << i;
        ASSERT_NEAR(frame.variance.y, expected.y, kSlack * expected.y + 1e-6 * larger + 1.1e-10) << i;
        ASSERT_NEAR(frame.variance.z, expected.z, kSlack * std::abs(expected.z) + 2e-6 * larger) << i;
        ASSERT_NEAR(length(frame.x), 1.0f, 1e-5f);
        ASSERT_NEAR(dot(frame.x, frame.y), 0.0f, 1e-5f);
        ASSERT_NEAR(dot(cross(frame.x, frame.y), frame.normal), 1.0f, 1e-5f);
    }
}

// The height of the mirrored ray.
double mirrored_height(dvec3 n, dvec3 v) {
    return 2.0 * dot(n, v) * n.z - v.z;
}

// The bent normal by definition: the paper's normal, plus as little of v as brings the mirrored ray up to the
// horizon, by bisection. Enough of v always does, because v mirrors v to itself.
dvec3 bent(dvec3 n, dvec3 v) {
    const dvec3 seen = n - 2.0 * std::min(dot(n, v), 0.0) * v;
    if (v.z <= 0.0 || mirrored_height(seen, v) >= 0.0) return seen;
    double low = 1e-12, high = 1e9;
    for (int step = 0; step < 100; ++step) {
        const double c = std::sqrt(low * high);
        (mirrored_height(normalize(seen + c * v), v) < 0.0 ? low : high) = c;
    }
    return normalize(seen + high * v);
}

// Normals in all directions, also of folded crests, seen from above: the result faces the eye, mirrors it to
// the sky, and is the nearest such normal. Directions are rounded by 1e-7; where bending sets in, the result
// changes by that over v_z.
TEST(Slopes, FacingNormalFacesTheEyeAndTheSky) {
    Optics optics;
    Inputs inputs(4);
    int away = 0, down = 0, folded = 0, kept = 0;
    for (int i = 0; i < kSlopeInputs; ++i) {
        const vec3 v = inputs.direction(1e-6);
        const vec3 n = (i % 2 == 0 ? 1.0f : -1.0f) * inputs.direction(1e-6);
        const dvec3 eye(normalize(dvec3(v))), normal(normalize(dvec3(n)));
        const vec3 facing = optics.facing_normal(n, v);
        ASSERT_NEAR(length(facing), 1.0f, 1e-6f) << i;
        ASSERT_GE(dot(facing, v), std::abs(dot(n, v)) - 1e-6f) << i;
        ASSERT_GE(mirrored_height(dvec3(facing), eye), -2e-6) << i;
        const dvec3 expected = bent(normal, eye);
        ASSERT_LE(length(dvec3(facing) - expected), 3e-6 + 1e-6 / eye.z) << i;
        const bool faces = dot(normal, eye) > 0.0;
        const double height = mirrored_height(normal - 2.0 * std::min(dot(normal, eye), 0.0) * eye, eye);
        away += !faces && height > 0.0;
        down += faces && height < 0.0 && normal.z > 0.0;
        folded += height < 0.0 && normal.z < 0.0;
        kept += faces && height > 0.0;
    }
    for (const int cases : {away, down, folded, kept}) EXPECT_GT(cases, 1000);
}

// From below the sea's level, as when a camera among the waves looks up at a crest, any mirrored ray is fine:
// the result is the paper's normal, with |n·v|.
TEST(Slopes, FacingNormalSeenFromBelowIsThePapers) {
    Optics optics;
    Inputs inputs(7);
    for (int i = 0; i < kSlopeInputs; ++i) {
        vec3 v = inputs.direction(1e-6);
        v.z = i % 100 == 0 ? 0.0f : -v.z;
        v = normalize(v);
        const vec3 n = (i % 2 == 0 ? 1.0f : -1.0f) * inputs.direction(1e-6);
        const vec3 expected = n - 2.0f * std::min(dot(n, v), 0.0f) * v;
        ASSERT_LE(length(optics.facing_normal(n, v) - expected), 2e-6f) << i;
    }
}

// Slopes that the mesh hides and the normals have, between all that never face away (mean square w0² + 3 s) and all that
// there are: seen as a mesh shows them, each as often as it is there, they lean to the eye as the visible ones do.
TEST(Slopes, VisibleNormalsHaveTheMeanSquareOfThoseThatNeverFaceAway) {
    Optics optics;
    for (const double w0 : {0.01, 0.1, 0.5, 3.0})
        for (const double hidden : {0.0, 0.02}) {
            const double sigma = 0.2, turn = 0.7, length = std::hypot(w0, 1.0);
            const vec3 v(vec2(std::cos(turn), std::sin(turn)) * static_cast<float>(1.0 / length),
                         static_cast<float>(w0 / length));
            const vec3 left(static_cast<float>(hidden), static_cast<float>(hidden), 0.0f);
            const auto w_of = [&](vec3 n) {
                return dot(dvec3(n), dvec3(v)) / static_cast<double>(n.z) * length;
            };
            double square = 0.0, before = 0.0;
            for (double x = -6.0; x <= 6.0; x += 0.01) {
                const double s = sigma * x,
                             share = 0.01 * std::exp(-0.5 * x * x) / std::sqrt(2.0 * oracle::kPi);
                const vec3 n = normalize(vec3(vec2(v) * static_cast<float>(s * length), 1.0f));
                const vec3 seen =
                    optics.visible_normal(n, v, left, static_cast<float>(sigma * sigma + hidden));
                ASSERT_NEAR(glm::length(seen), 1.0f, 1e-6f);
                ASSERT_GT(dot(seen, v), 0.0f);
                before += share * w_of(n) * w_of(n);
                square += share * w_of(seen) * w_of(seen);
                // What the pixel hides, it hides of the mesh's: normals as fine as the mesh stay.
                ASSERT_EQ(optics.visible_normal(n, v, left, 0.999f * static_cast<float>(hidden)), n);
            }
            EXPECT_NEAR(before, w0 * w0 + sigma * sigma, 2e-3 * square);
            EXPECT_NEAR(square, w0 * w0 + 3.0 * sigma * sigma, 2e-3 * square) << w0;
        }
}

// p(ζ) within 5 σ. The determinant cancels for strong correlation: with 1 − 0.99², a rounding of 1e-7 becomes
// 5e-6, times an exponent of up to 12.5.
TEST(Slopes, DensityIsTheGaussian) {
    Optics optics;
    Inputs inputs(5);
    for (int i = 0; i < kSlopeInputs; ++i) {
        const vec3 s = inputs.variance(1e-4, 1.0, 0.9);
        const oracle::Factor factor{dvec3(s)};
        const double r = 5.0 * std::sqrt(inputs.uniform(0.0, 1.0)), a = inputs.uniform(0.0, 6.3);
        const double x = r * std::cos(a), y = r * std::sin(a);
        const vec2 slope(dvec2(factor.a * x, factor.b * x + factor.c * y));
        const double expected = std::exp(-0.5 * factor.distance(dvec2(slope))) /
                                (2.0 * oracle::kPi * factor.root_of_determinant());
        ASSERT_NEAR(optics.slope_density(slope, s), expected, kSlack * expected) << i;
    }
}

// Λ, from 1e-30 (near nadir; smaller values vanish beside 1) to grazing.
// Masking, Smith's and nested: a facet is never lit more than it is seen.
TEST(Slopes, MaskingIsTheMixture) {
    Optics optics;
    Inputs inputs(6);
    for (int i = 0; i < kSlopeInputs; ++i) {
        const vec3 d = inputs.direction(1e-6), s = inputs.variance(1e-4, 1.0, 0.9),
                   l = inputs.direction(1e-6);
        const double expected = oracle::lambda(dvec3(d), dvec3(s));
        ASSERT_NEAR(optics.smith_lambda(optics.smith_argument(d, s)), expected, kSlack * expected + 1e-30)
            << i;
        const double area = static_cast<double>(d.z) * (1.0 + expected);
        ASSERT_NEAR(optics.visible_area(d, s), area, 1e-5 * area) << i;
        const auto view = optics.masked_view(d, s);
        const float w = static_cast<float>(inputs.logarithmic(1e-4, 1.0)), facing = w * l.z;
        const double seen = oracle::visible(double(w), dvec3(d), dvec3(s)),
                     lit = oracle::lit(double(w), double(facing), dvec3(d), dvec3(l), dvec3(s));
        ASSERT_NEAR(optics.visible_part(view, w), seen, kSlack * seen) << i;
        ASSERT_NEAR(optics.lit_part(view, w, facing, l, s), lit, kSlack * lit + 1e-6 * seen) << i;
        ASSERT_LE(lit, seen * (1.0 + 1e-9)) << i;
    }
}

// Eq. 11: the density of visible slopes integrates to 1 ± 1e-3 at every angle (with Eq. 9 as printed, 1.11 at
// 80° and 2.56 at 88°).
TEST(Slopes, WhatIsSeenAddsUpToOne) {
    Optics optics;
    for (const dvec3 s : {dvec3(0.04, 0.0196, 0.0), dvec3(0.0025, 0.0016, 0.001), dvec3(0.25, 0.01, -0.03),
                          dvec3(1.0, 1e-6, 0.0)})
        for (double degrees : {0.0, 30.0, 60.0, 75.0, 80.0, 85.0, 88.0, 89.0, 89.9, 90.0})
            for (double azimuth : {0.0, 1.0, 2.5}) {
                const double theta = degrees * oracle::kPi / 180.0;
                const vec3 v(dvec3(std::sin(theta) * std::cos(azimuth), std::sin(theta) * std::sin(azimuth),
                                   std::cos(theta)));
                const oracle::Factor factor(s);
                double sum = 0.0;
                constexpr int kSteps = 300;  // of 0.04 σ: the kink of (k + x)₊ costs h²/12, 1e-4
                for (int i = 0; i < kSteps; ++i)
                    for (int j = 0; j < kSteps; ++j) {
                        const double x = -6.0 + 12.0 * (i + 0.5) / kSteps,
                                     y = -6.0 + 12.0 * (j + 0.5) / kSteps;
                        const vec2 slope(dvec2(factor.a * x, factor.b * x + factor.c * y));
                        sum += static_cast<double>(optics.visible_slope_density(slope, v, vec3(s)));
                    }
                sum *= factor.root_of_determinant() * 144.0 / (kSteps * kSteps);
                EXPECT_NEAR(sum, 1.0, 1e-3) << degrees << ' ' << azimuth << ' ' << s.x;
            }
}

// Mean and variance of the visible slopes, in closed form and by summation. The rule's error is h²/12 σ with
// h = 0.04.
TEST(Slopes, FacetsThatAreSeenLeanTowardsTheEye) {
    Optics optics;
    for (const dvec3 s : {dvec3(0.04, 0.02, 0.01), dvec3(0.0025, 0.0016, -0.001)})
        for (double degrees : {0.0, 45.0, 75.0, 85.0, 89.0, 90.0}) {
            const double theta = degrees * oracle::kPi / 180.0;
            const dvec3 v(std::sin(theta) * 0.6, std::sin(theta) * 0.8, std::cos(theta));
            const auto seen = optics.visible_slopes(vec3(v), vec3(s));
            const vec2 mean = optics.mean_visible_slope(seen);
            const dvec2 expected = oracle::over_visible(v, s, 300, [](dvec2 slope, dvec3) { return slope; });
            const double sigma = std::sqrt(std::max(s.x, s.y));
            EXPECT_NEAR(mean.x, expected.x, 3e-4 * sigma) << degrees;
            EXPECT_NEAR(mean.y, expected.y, 3e-4 * sigma) << degrees;
            const double square =
                oracle::over_visible(v, s, 300, [](dvec2 slope, dvec3) { return slope.x * slope.x; });
            const double spread = static_cast<double>(seen.along.x * seen.along.x * (1.0f + seen.x.second) +
                                                      seen.across.x * seen.across.x);
            EXPECT_NEAR(spread, square, 1e-3 * square) << degrees;
        }
}

// Straight from above the line of sight has no direction, and a flat sea shows nothing of itself.
TEST(Slopes, NothingMeetsTheSeaAgainSeenFromAbove) {
    for (const float sigma : {0.0f, 1e-3f, 0.05f, 0.15f})
        EXPECT_LT(
            Optics().reflected_again(vec3(0.0f, 0.0f, 1.0f), vec3(sigma * sigma, 2.0f * sigma * sigma, 0.0f)),
            0.01f)
            << sigma;
}

// What reflected_again() fits, by summation. Errors are times F̄, their share of the light.
TEST(Slopes, LightThatMeetsTheSeaAgain) {
    Optics optics;
    for (double degrees : {0.0, 30.0, 60.0, 72.0, 80.0, 85.0, 88.0, 89.5})
        for (double along : {0.03, 0.1, 0.2, 0.3})
            for (double ratio : {0.6, 1.0, 1.6}) {
                const double theta = degrees * oracle::kPi / 180.0;
                const dvec3 v(std::sin(theta), 0.0, std::cos(theta)),
                    s(along * along, ratio * ratio * along * along, 0.0);
                const double all = oracle::over_visible(
                    v, s, 120, [&](dvec2, dvec3 f) { return oracle::fresnel(dot(v, f)); });
                const double again = oracle::over_visible(v, s, 120, [&](dvec2, dvec3 f) {
                    const double cosine = dot(v, f), w = cosine / f.z;
                    return oracle::fresnel(cosine) *
                           (1.0 -
                            std::min(oracle::lit(w, w, v, 2.0 * cosine * f - v, s) / oracle::visible(w, v, s),
                                     1.0));
                });
                EXPECT_NEAR(all * static_cast<double>(optics.reflected_again(vec3(v), vec3(s))), again, 0.015)
                    << degrees << ' ' << along << ' ' << ratio;
            }
}

TEST(Slopes, HardCasesStayFinite) {
    Optics optics;
    const float grazing = std::numeric_limits<float>::denorm_min();
    for (const vec3 s : {vec3(0.0f), vec3(1e-30f, 0.0f, 0.0f), vec3(1.0f, 1e-6f, 1e-3f),
                         vec3(1.0f, 1.0f, -1.0f), vec3(1e4f, 1e4f, 1e4f), vec3(0.04f, 0.04f, 0.05f)})
        for (const vec3 n : {vec3(0.0f, 0.0f, 1.0f), vec3(0.6f, 0.0f, 0.8f), vec3(1.0f, 0.0f, 0.0f),
                             vec3(0.0f, 0.0f, -1.0f)})
            for (const vec3 v : {vec3(0.0f, 0.0f, 1.0f), vec3(1.0f, 0.0f, 0.0f), vec3(0.0f, 1.0f, grazing),
                                 vec3(-1.0f, 0.0f, 1e-4f)}) {
                const auto frame = optics.slope_frame(optics.facing_normal(n, v), s);
                const vec3 local = optics.into_frame(frame, v);
                const auto seen = optics.visible_slopes(local, frame.variance);
                EXPECT_TRUE(
                    std::isfinite(optics.visible_slope_density(vec2(0.1f, 0.2f), local, frame.variance)));
                EXPECT_TRUE(std::isfinite(optics.smith_lambda(optics.smith_argument(local, frame.variance))));
                const auto view = optics.masked_view(local, frame.variance);
                for (float w : {0.0f, 1e-6f, 1.0f, 1e5f}) {
                    EXPECT_TRUE(std::isfinite(optics.visible_part(view, w)));
                    EXPECT_TRUE(std::isfinite(optics.lit_part(view, w, w, -local, frame.variance)));
                    EXPECT_TRUE(std::isfinite(optics.lit_part(view, w, w, n, frame.variance)));
                }
                EXPECT_TRUE(std::isfinite(optics.reflected_again(local, frame.variance)));
                EXPECT_TRUE(std::isfinite(length(seen.along) + length(seen.across) + seen.tilt +
                                          seen.x.first + seen.x.second));
            }
}

}  // namespace
}  // namespace pelagic::optics
