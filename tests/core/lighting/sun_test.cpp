// The reflected sun: Eq. 15, extended by the disc's angular width.
#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>

#include "tests/core/lighting/optics.h"

namespace pelagic::optics {
namespace {

constexpr double kRadius = 0.00465;
constexpr double kSolidAngle = oracle::kPi * kRadius * kRadius;

dvec2 half_slope(dvec3 v, dvec3 l) {
    const dvec3 h = v + l;
    return dvec2(-h.x, -h.y) / h.z;
}

// Two directions perpendicular to l.
void across(dvec3 l, dvec3& x, dvec3& y) {
    x = normalize(cross(std::abs(l.x) < 0.7 ? dvec3(1.0, 0.0, 0.0) : dvec3(0.0, 1.0, 0.0), l));
    y = cross(l, x);
}

// The variance of the half vector's slope over the disc, by moving the light. The disc's own is (ρ/2)² along
// any axis.
dvec3 disc_variance(dvec3 v, dvec3 l) {
    dvec3 x, y;
    across(l, x, y);
    constexpr double kStep = 1e-6;
    const dvec2 p =
        (half_slope(v, normalize(l + kStep * x)) - half_slope(v, normalize(l - kStep * x))) / (2.0 * kStep);
    const dvec2 q =
        (half_slope(v, normalize(l + kStep * y)) - half_slope(v, normalize(l - kStep * y))) / (2.0 * kStep);
    const double r = 0.25 * kRadius * kRadius;
    return r * dvec3(p.x * p.x + q.x * q.x, p.y * p.y + q.y * q.y, p.x * p.y + q.x * q.y);
}

TEST(Sun, DiscsWidthInSlopes) {
    Optics optics;
    Inputs inputs(10);
    for (int i = 0; i < 100000; ++i) {
        const vec3 v = inputs.direction(1e-3), l = inputs.direction(1e-3);
        const vec3 h = normalize(v + l);
        if (h.z < 0.05f || dot(v, h) < 0.02f) continue;  // steeper than any waves; see HardCasesStayFinite
        const dvec3 expected = disc_variance(dvec3(v), dvec3(l));
        const vec3 found = optics.disc_slope_variance(v, l, h, float(kRadius));
        // v·h and h_z have rounding errors of 6e-8.
        const double slack = 1e-4 + 1e-6 / static_cast<double>(h.z * dot(v, h));
        const double larger = std::max(expected.x, expected.y);
        ASSERT_NEAR(found.x, expected.x, slack * larger) << i;
        ASSERT_NEAR(found.y, expected.y, slack * larger) << i;
        ASSERT_NEAR(found.z, expected.z, slack * larger) << i;
    }
}

// An isotropic Gaussian convolved with a disc that has this share of the squared width, by summation over the
// disc. In units in which both variances sum to 1.
double blurred_disc(double distance, double share) {
    const double radius = 2.0 * std::sqrt(share), sigma2 = 1.0 - share, at = std::sqrt(distance);
    constexpr int kSteps = 96;
    double sum = 0.0;
    for (int i = 0; i < kSteps; ++i)
        for (int j = 0; j < kSteps; ++j) {
            const double r = radius * std::sqrt((i + 0.5) / kSteps),
                         a = 2.0 * oracle::kPi * (j + 0.5) / kSteps;
            const double d2 = at * at + r * r - 2.0 * at * r * std::cos(a);
            sum += std::exp(-0.5 * d2 / sigma2) / (2.0 * oracle::kPi * sigma2);
        }
    return sum / (kSteps * kSteps);
}

// Within 4 % of the density's peak, from purely Gaussian to purely the disc.
TEST(Sun, ProfileIsABlurredDisc) {
    Optics optics;
    for (double share : {0.001, 0.05, 0.2, 0.4, 0.6, 0.8, 0.9, 0.97}) {
        const double peak = blurred_disc(0.0, share);
        double sum = 0.0;
        constexpr double kStep = 0.05;
        for (double r2 = 0.5 * kStep; r2 < 40.0; r2 += kStep) {
            const double found = static_cast<double>(optics.disc_density(float(r2), float(share), 1.0f));
            sum += oracle::kPi * kStep * found;
            if (r2 < 12.0) {
                EXPECT_NEAR(found, blurred_disc(r2, share), 0.04 * peak) << share << ' ' << r2;
            }
        }
        EXPECT_NEAR(sum, 1.0, 2e-3) << share;  // the closed form is exact, the quadrature isn't
    }
}

// Eq. 15 in double, with the profile as the comment in sun.glsl has it and the disc's width by moving the
// light.
double reflected(dvec3 v, dvec3 l, dvec3 s) {
    const dvec3 h = normalize(v + l);
    const dvec3 disc = disc_variance(v, l), sum = s + disc;
    const oracle::Factor factor(sum);
    const double e =
        std::min(oracle::Factor(disc).root_of_determinant() / factor.root_of_determinant(), 0.999);
    const double y = e * e / std::sqrt(1.0 - e) *
                     (4.0 / 3.0 + 0.7485 * e - 0.4462 * e * e + 2.7252 * std::pow(e, 3) -
                      1.0427 * std::pow(e, 4) - 1.5111 * std::pow(e, 5));
    const double width = 2.0 / (0.5 * y + 1.0 / (1.0 + 0.25 * y + 0.0347 * y * y));
    const double density =
        -std::expm1(-y) / y /
        (oracle::kPi * width * (-std::expm1(-y) + std::exp(factor.distance(half_slope(v, l)) / width - y))) /
        factor.root_of_determinant();
    const double w = dot(v, h) / h.z;
    const double part = kSolidAngle * density * oracle::lit(w, w, v, l, sum) / (4.0 * std::pow(h.z, 4));
    const double rise = std::clamp(l.z / kRadius, 0.0, 1.0);
    return std::min(part, 1.0) * rise * rise * (3.0 - 2.0 * rise) * oracle::fresnel(dot(v, h));
}

// 1e-4 relative, with a floor of 1e-5 of the sun's radiance. Directions are rounded by 6e-8, which makes
// 6e-8/h_z |v + l| in the half vector's slope. On a mirror-like sea that is a notable part of σ, three σ from
// the centre.
TEST(Sun, SingleIsDouble) {
    Optics optics;
    Inputs inputs(11);
    int bright = 0;
    for (int i = 0; i < 200000; ++i) {
        const vec3 v = inputs.direction(1e-3), s = inputs.variance(3e-3, 0.5, 0.9);
        // Chooses a light whose half vector is within the waves' slopes: elsewhere the result would be 0.
        const oracle::Factor factor{dvec3(s)};
        const double r = 3.0 * std::sqrt(inputs.uniform(0.0, 1.0)), a = inputs.uniform(0.0, 6.3);
        const dvec3 h = normalize(dvec3(-factor.a * r * std::cos(a),
                                        -factor.b * r * std::cos(a) - factor.c * r * std::sin(a), 1.0));
        const dvec3 mirrored = 2.0 * dot(dvec3(v), h) * h - dvec3(v);
        if (mirrored.z < 1e-3 || dot(dvec3(v), h) < 0.02) continue;
        const vec3 l(normalize(mirrored));
        const auto frame = optics.slope_frame(vec3(0.0f, 0.0f, 1.0f), s);
        const double expected = reflected(normalize(dvec3(v)), normalize(dvec3(l)), dvec3(s));
        const double found =
            static_cast<double>(optics.sun_reflection(v, l, frame, vec3(1.0f), float(kRadius)).x);
        const double least = std::sqrt(static_cast<double>(std::min(s.x, s.y)) * 0.19);
        const double rounding = 3.0 * 1.2e-7 / (least * h.z * h.z * 2.0 * dot(dvec3(v), h));
        ASSERT_NEAR(found, expected, (1e-4 + rounding) * expected + 1e-5) << i;
        bright += expected > 1e-3;
    }
    EXPECT_GT(bright, 1000);
}

// Where the slopes spread wider than the disc: the mean of Eq. 15 over the disc, point by point.
TEST(Sun, WideWavesSeeTheAverageOverTheDisc) {
    Optics optics;
    for (const dvec3 s : {dvec3(0.02, 0.015, 0.004), dvec3(0.0002, 0.0001, 0.0)})
        for (double view : {10.0, 50.0, 75.0})
            for (double off : {0.0, 1.0, 2.0}) {
                const double theta = view * oracle::kPi / 180.0;
                const dvec3 v(-std::sin(theta), 0.0, std::cos(theta));
                const dvec3 h = normalize(dvec3(off * std::sqrt(s.x), -0.5 * off * std::sqrt(s.y), 1.0));
                const dvec3 l = 2.0 * dot(v, h) * h - v;
                if (l.z < 0.02) continue;
                dvec3 x, y;
                across(l, x, y);
                const oracle::Factor factor(s);
                double sum = 0.0;
                constexpr int kSteps = 40;
                for (int i = 0; i < kSteps; ++i)
                    for (int j = 0; j < kSteps; ++j) {
                        const double r = kRadius * std::sqrt((i + 0.5) / kSteps),
                                     a = 2.0 * oracle::kPi * (j + 0.5) / kSteps;
                        const dvec3 d = normalize(l + r * (std::cos(a) * x + std::sin(a) * y));
                        const dvec3 half = normalize(v + d);
                        const double p = std::exp(-0.5 * factor.distance(half_slope(v, d))) /
                                         (2.0 * oracle::kPi * factor.root_of_determinant());
                        const double w = dot(v, half) / half.z;
                        sum += p * oracle::fresnel(dot(v, half)) * oracle::lit(w, w, v, d, s) /
                               (4.0 * std::pow(half.z, 4));
                    }
                const double expected = kSolidAngle * sum / (kSteps * kSteps);
                const auto frame = optics.slope_frame(vec3(0.0f, 0.0f, 1.0f), vec3(s));
                const double found = static_cast<double>(
                    optics.sun_reflection(vec3(v), vec3(l), frame, vec3(1.0f), float(kRadius)).x);
                EXPECT_NEAR(found, expected, 0.03 * expected) << view << ' ' << off << ' ' << s.x;
            }
}

// A mirror: the disc's image has the disc's light, L F times its solid angle; it is nowhere brighter than L
// F, and black beyond its rim. 3 %: the rim is a thirtieth of the radius wide, and F varies across the disc.
TEST(Sun, MirrorShowsTheDisc) {
    Optics optics;
    const auto frame = optics.slope_frame(vec3(0.0f, 0.0f, 1.0f), vec3(0.0f));
    for (double elevation : {85.0, 45.0, 20.0, 10.0, 5.0}) {
        const double height = elevation * oracle::kPi / 180.0;
        const vec3 l(dvec3(std::cos(height), 0.0, std::sin(height)));
        const dvec3 centre(-std::cos(height), 0.0, std::sin(height));
        dvec3 x, y;
        across(centre, x, y);
        double sum = 0.0, peak = 0.0;
        constexpr int kSteps = 200;
        constexpr double kWindow = 1.5 * kRadius;
        for (int i = 0; i < kSteps; ++i)
            for (int j = 0; j < kSteps; ++j) {
                const double p = kWindow * (2.0 * (i + 0.5) / kSteps - 1.0),
                             q = kWindow * (2.0 * (j + 0.5) / kSteps - 1.0);
                const vec3 v(normalize(centre + p * x + q * y));
                const double found =
                    static_cast<double>(optics.sun_reflection(v, l, frame, vec3(1.0f), float(kRadius)).x);
                sum += found * (4.0 * kWindow * kWindow) / (kSteps * kSteps);
                peak = std::max(peak, found / oracle::fresnel(static_cast<double>(dot(v, normalize(v + l)))));
                if (std::hypot(p, q) > 1.15 * kRadius) {
                    EXPECT_LT(found, 0.02) << elevation;
                }
            }
        EXPECT_LE(peak, 1.0 + 1e-5) << elevation;
        EXPECT_GT(peak, 0.97) << elevation;
        const double expected = kSolidAngle * oracle::fresnel(std::sin(height));
        EXPECT_NEAR(sum, expected, 0.03 * expected) << elevation;
    }
}

// Reciprocity: exchanging eye and sun changes the radiance by the ratio of their cosines. Where the peak isn't
// limited to the sun's own radiance, and both are above the disc's rise.
TEST(Sun, EyeAndSunMayBeExchanged) {
    Optics optics;
    Inputs inputs(13);
    int bright = 0;
    for (int i = 0; i < 100000; ++i) {
        const vec3 v = inputs.direction(0.01), l = inputs.direction(0.01),
                   s = inputs.variance(0.05, 0.5, 0.8);
        const auto frame = optics.slope_frame(vec3(0.0f, 0.0f, 1.0f), s);
        const float there = v.z * optics.sun_reflection(v, l, frame, vec3(1.0f), float(kRadius)).x,
                    back = l.z * optics.sun_reflection(l, v, frame, vec3(1.0f), float(kRadius)).x;
        ASSERT_NEAR(there, back, 1e-4f * there + 1e-9f) << i;
        bright += there > 1e-6f;
    }
    EXPECT_GT(bright, 1000);
}

// No facet is brighter than the sun itself, for any waves.
TEST(Sun, NeverBrighterThanTheSun) {
    Optics optics;
    Inputs inputs(12);
    for (int i = 0; i < 100000; ++i) {
        const vec3 v = inputs.direction(1e-6), l = inputs.direction(1e-6), n = inputs.direction(1e-2);
        const auto frame = optics.slope_frame(optics.facing_normal(n, v), inputs.variance(1e-6, 2.0, 1.0));
        const float found = optics.sun_reflection(v, l, frame, vec3(1.0f), float(kRadius)).x;
        ASSERT_GE(found, 0.0f) << i;  // false for a NaN
        ASSERT_LE(found, static_cast<float>(
                             oracle::fresnel(static_cast<double>(std::min(1.0f, dot(v, normalize(v + l)))))) +
                             1e-5f)
            << i;
    }
}

// The sun sets without a jump, even where the disc's rim (a thirtieth of its radius) crosses the mirror
// direction. Steps are a thousandth of the radius, and rounded directions vary by as much.
TEST(Sun, SetsSmoothly) {
    Optics optics;
    for (const vec3 s : {vec3(0.0f), vec3(0.02f, 0.015f, 0.0f)}) {
        const auto frame = optics.slope_frame(vec3(0.0f, 0.0f, 1.0f), s);
        const vec3 v = normalize(vec3(-1.0f, 0.0f, 0.006f));
        const auto shown = [&](double height) {
            return optics
                .sun_reflection(v, vec3(dvec3(std::cos(height), 0.0, std::sin(height))), frame, vec3(1.0f),
                                float(kRadius))
                .x;
        };
        for (double height : {-1.0, -1e-3, -1e-9, 0.0}) EXPECT_EQ(shown(height), 0.0f);
        float last = 0.0f;
        for (double height = 0.0; height < 2.0 * kRadius; height += 1e-3 * kRadius) {
            const float now = shown(height);
            EXPECT_NEAR(now, last, 0.1f);
            last = now;
        }
    }
}

TEST(Sun, HardCasesStayFinite) {
    Optics optics;
    const vec3 up(0.0f, 0.0f, 1.0f), side(1.0f, 0.0f, 0.0f);
    for (const vec3 v : {up, side, -side, normalize(vec3(1.0f, 0.0f, 1e-6f))})
        for (const vec3 l : {up, -up, side, -side, normalize(vec3(1.0f, 1e-7f, 1e-6f)),
                             normalize(vec3(-1.0f, 0.0f, -1e-6f))})
            for (const vec3 n : {up, side, -up, normalize(vec3(1.0f, 1.0f, 1e-20f))})
                for (const vec3 s : {vec3(0.0f), vec3(1e6f, 1.0f, 1e3f), vec3(1e-38f, 1.0f, 0.0f)}) {
                    const auto frame = optics.slope_frame(optics.facing_normal(n, v), s);
                    const float found = optics.sun_reflection(v, l, frame, vec3(1.0f), float(kRadius)).x;
                    EXPECT_TRUE(std::isfinite(found) && found >= 0.0f && found <= 1.0f);
                }
}

}  // namespace
}  // namespace pelagic::optics
