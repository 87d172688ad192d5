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

// Where waves are far wider than the disc, the half vector's covariance over h_z² is that of slopes.
TEST(Sun, DiscsWidthInSlopes) {
    Optics optics;
    Inputs inputs(10);
    for (int i = 0; i < 100000; ++i) {
        const vec3 v = inputs.direction(1e-3), l = inputs.direction(1e-3);
        const vec3 h = v + l, half = normalize(h);
        if (half.z < 0.05f || dot(v, half) < 0.02f)
            continue;  // steeper than any waves; see HardCasesStayFinite
        dvec3 x, y;
        across(dvec3(l), x, y);
        const dvec3 expected = disc_variance(dvec3(v), dvec3(l));
        const auto found = optics.half_vector(h, vec3(0.0f), vec3(0.5 * kRadius * x), vec3(0.5 * kRadius * y),
                                              vec2(-h.x, -h.y) / h.z);
        const dvec3 slopes = dvec3(found.covariance) / static_cast<double>(h.z * h.z);
        // v·h and h_z have rounding errors of 6e-8.
        const double slack = 1e-4 + 1e-6 / static_cast<double>(half.z * dot(v, half));
        const double larger = std::max(expected.x, expected.y);
        ASSERT_NEAR(slopes.x, expected.x, slack * larger) << i;
        ASSERT_NEAR(slopes.y, expected.y, slack * larger) << i;
        ASSERT_NEAR(slopes.z, expected.z, slack * larger) << i;
        ASSERT_NEAR(static_cast<double>(found.disc_root), static_cast<double>(found.root), 1e-6) << i;
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

// Eq. 15 as printed, beside the same in double precision; and what it is worth: on waves wider than the disc, the eye and the
// sun 20° above the horizon or higher, ours differs from it by Schlick's error (23 % at 45°) and by the masking.
TEST(Sun, AsThePaperPrintsIt) {
    Optics optics;
    Inputs inputs(14);
    int seen = 0;
    for (int i = 0; i < 20000; ++i) {
        const vec3 v = inputs.direction(0.05), l = inputs.direction(0.05),
                   s = inputs.variance(0.05, 0.5, 0.8);
        const float found = optics.sun_reflection_paper(v, l, s, vec3(1.0f), float(kRadius)).x;
        const dvec3 h = normalize(dvec3(v) + dvec3(l));
        const oracle::Factor factor{dvec3(s)};
        const double density = std::exp(-0.5 * factor.distance(half_slope(dvec3(v), dvec3(l)))) /
                               (2.0 * oracle::kPi * factor.root_of_determinant());
        const double masking = 1.0 + oracle::lambda(dvec3(v), dvec3(s)) + oracle::lambda(dvec3(l), dvec3(s));
        const double expected = kSolidAngle * density * oracle::schlick(dot(dvec3(v), h)) /
                                (4.0 * std::pow(h.z, 4) * static_cast<double>(v.z) * masking);
        if (expected < 1e-9) continue;  // tails: the exponent's rounding
        ++seen;
        ASSERT_NEAR(static_cast<double>(found), expected, 2e-3 * expected) << i;
        if (std::min(v.z, l.z) < 0.34f || expected < 1e-6) continue;
        const auto frame = optics.slope_frame(vec3(0.0f, 0.0f, 1.0f), s);
        const double ours =
            static_cast<double>(optics.sun_reflection(v, l, frame, vec3(1.0f), float(kRadius)).x);
        ASSERT_NEAR(ours, expected, 0.6 * expected) << i;
    }
    EXPECT_GT(seen, 4000);
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
        EXPECT_LE(peak, 1.001)
            << elevation;  // F is that of the mirrored point, here that of the disc's centre
        EXPECT_GT(peak, 0.97) << elevation;
        const double expected = kSolidAngle * oracle::fresnel(std::sin(height));
        EXPECT_NEAR(sum, expected, 0.03 * expected) << elevation;
    }
}

// Reciprocity: exchanging eye and sun changes the radiance by the ratio of their cosines. Where the peak isn't
// limited to the sun's own radiance, and both are well above the horizon; 2 %, since only the sun is a disc.
TEST(Sun, EyeAndSunMayBeExchanged) {
    Optics optics;
    Inputs inputs(13);
    int bright = 0;
    for (int i = 0; i < 100000; ++i) {
        const vec3 v = inputs.direction(0.05), l = inputs.direction(0.05),
                   s = inputs.variance(0.05, 0.5, 0.8);
        const auto frame = optics.slope_frame(vec3(0.0f, 0.0f, 1.0f), s);
        const float there = v.z * optics.sun_reflection(v, l, frame, vec3(1.0f), float(kRadius)).x,
                    back = l.z * optics.sun_reflection(l, v, frame, vec3(1.0f), float(kRadius)).x;
        ASSERT_NEAR(there, back, 0.02f * there + 1e-7f) << i;
        bright += there > 1e-6f;
    }
    EXPECT_GT(bright, 1000);
}

// Of a disc that is 1 in the mean: where part of it has set, what is left is brighter than the mean.
float brightest(vec3 to_sun) {
    const vec2 spread = Optics().disc_spread(to_sun.z, float(kRadius));
    return 1.00001f * float(0.25 * kRadius * kRadius) / (spread.x * spread.y);
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
        ASSERT_LE(found, brightest(l)) << i;
    }
}

// What is visible of a disc whose middle has this elevation: its share, and the elevation of its centre.
struct Visible {
    double share = 0.0, centre = 0.0;
};
Visible visible_disc(double elevation) {
    constexpr int kSteps = 4000;
    double area = 0.0, moment = 0.0;
    for (int i = 0; i < kSteps; ++i) {
        const double up = kRadius * (2.0 * (i + 0.5) / kSteps - 1.0);
        if (elevation + up <= 0.0) continue;
        const double strip = 2.0 * std::sqrt(kRadius * kRadius - up * up) * (2.0 * kRadius / kSteps);
        area += strip;
        moment += strip * (elevation + up);
    }
    return {area / (oracle::kPi * kRadius * kRadius), area > 0.0 ? moment / area : 0.0};
}

// The sun sets without a jump and not at once, even where the disc's rim (a thirtieth of its radius) crosses the mirror
// direction: a flat sea shows the half that has not set. Steps are a thousandth of the radius, rounded directions vary
// by as much, and the rim of what is left of the disc is narrower than the whole one's.
TEST(Sun, SetsSmoothly) {
    Optics optics;
    for (const vec3 s : {vec3(0.0f), vec3(0.02f, 0.015f, 0.0f)}) {
        const auto frame = optics.slope_frame(vec3(0.0f, 0.0f, 1.0f), s);
        const vec3 v = normalize(vec3(-1.0f, 0.0f, 0.004f));
        const auto shown = [&](double height, double share) {
            return optics
                .sun_reflection(v, vec3(dvec3(std::cos(height), 0.0, std::sin(height))), frame,
                                vec3(float(share)), float(kRadius))
                .x;
        };
        for (double height : {-1.0, -1e-3, -1e-9, 0.0}) EXPECT_EQ(shown(height, 1.0), 0.0f);
        float last = 0.0f;
        for (double elevation = -kRadius; elevation < 2.0 * kRadius; elevation += 1e-3 * kRadius) {
            const Visible visible = visible_disc(elevation);
            const float now = shown(visible.centre, visible.share);
            ASSERT_NEAR(now, last, 0.15f) << elevation / kRadius;
            if (s.x == 0.0f && std::abs(elevation / kRadius - 0.5) < 0.4) {
                EXPECT_GT(now, 0.7f) << elevation / kRadius;
            }
            last = now;
        }
    }
}

// Eq. 15 summed over what is visible of the disc, point by point: no linearisation.
double over_the_disc(double elevation, double view, double azimuth, dvec3 s) {
    const dvec3 v(-std::cos(view), 0.0, std::sin(view));
    const oracle::Factor factor(s);
    constexpr int kSteps = 120;
    const double step = 2.0 * kRadius / kSteps;
    double sum = 0.0;
    for (int j = 0; j < kSteps; ++j) {
        const double up = (j + 0.5) * step - kRadius, e = elevation + up;
        if (e <= 0.0) continue;
        for (int i = 0; i < kSteps; ++i) {
            const double aside = (i + 0.5) * step - kRadius, a = azimuth + aside;
            if (aside * aside + up * up > kRadius * kRadius) continue;
            const dvec3 d(std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e));
            const dvec3 half = normalize(v + d);
            const double distance = factor.distance(half_slope(v, d));
            if (distance > 100.0) continue;
            const double w = dot(v, half) / half.z;
            sum += std::exp(-0.5 * distance) * oracle::fresnel(dot(v, half)) * oracle::lit(w, w, v, d, s) /
                   (2.0 * oracle::kPi * factor.root_of_determinant() * 4.0 * std::pow(half.z, 4));
        }
    }
    return sum * step * step;
}

// The sun on the horizon and half below it, seen in a far sea's facets: beneath the sun within a quarter of the sum
// over the disc, and aside no light where the sum has none. Before, the disc's image in slopes grew without bounds
// towards the horizon, all of which shone; and beneath the sun it was dimmed twice.
TEST(Sun, OnTheHorizonLightsWhatIsBeneathIt) {
    Optics optics;
    const vec3 flat(0.0f, 0.0f, 1.0f);
    for (const dvec3 s : {dvec3(0.03, 0.025, 0.003), dvec3(0.006, 0.004, 0.0)})
        for (const double radii : {-0.6, 0.0, 0.5, 1.0, 2.0, 5.0})
            for (const double view : {0.0005, 0.002, 0.005, 0.02, 0.08}) {
                const double elevation = radii * kRadius, beneath = over_the_disc(elevation, view, 0.0, s);
                const Visible visible = visible_disc(elevation);
                const auto frame = optics.slope_frame(flat, vec3(s));
                const vec3 v(dvec3(-std::cos(view), 0.0, std::sin(view)));
                for (const double azimuth :
                     {0.0, 0.5 * kRadius, kRadius, 3.0 * kRadius, 0.05, 0.2, 1.0, 2.5, oracle::kPi}) {
                    const dvec3 l(std::cos(visible.centre) * std::cos(azimuth),
                                  std::cos(visible.centre) * std::sin(azimuth), std::sin(visible.centre));
                    const double found =
                        visible.share *
                        static_cast<double>(
                            optics.sun_reflection(v, vec3(l), frame, vec3(1.0f), float(kRadius)).x);
                    const double expected = over_the_disc(elevation, view, azimuth, s);
                    // A segment's pointed ends are an ellipse's here.
                    const double rim = azimuth == kRadius ? 0.12 : 0.01;
                    EXPECT_NEAR(found, expected, 0.25 * expected + rim * beneath)
                        << radii << ' ' << view << ' ' << azimuth / kRadius << ' ' << s.x;
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
                    EXPECT_TRUE(std::isfinite(found) && found >= 0.0f && found <= brightest(l));
                }
}

}  // namespace
}  // namespace pelagic::optics
