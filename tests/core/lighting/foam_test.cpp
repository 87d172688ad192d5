// Whitecaps, and the light scattered back out of the water.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <tuple>

#include "core/lighting/lighting.h"
#include "tests/core/lighting/optics.h"

namespace pelagic::optics {
namespace {

constexpr double kFoamRadius = 0.00465;
constexpr double kBumps = 0.1;  // slope variance of the foam's own roughness

dvec3 rough(dvec3 s) {
    return s + dvec3(kBumps, kBumps, 0.0);
}

// The closed form of foam.glsl in double; E max(x, 0) of a normal x by numerical integration.
double foam(dvec3 v, dvec3 l, dvec3 waves) {
    const dvec3 s = rough(waves);
    const double sine = std::sqrt(v.x * v.x + v.y * v.y);
    const dvec2 d = dvec2(v.x, v.y) / sine, turned(s.x * d.x + s.z * d.y, s.z * d.x + s.y * d.y);
    const double sigma = std::sqrt(dot(d, turned)), k = v.z / (sigma * sine);
    const double upper = 0.5 * std::erfc(-k / std::sqrt(2.0)),
                 here = std::exp(-0.5 * k * k) / std::sqrt(2.0 * oracle::kPi);
    // Smith's part, and the nested part: the χ distribution of three degrees of freedom.
    const double outside = 1.0 - upper, both = upper - outside;
    const double nested = both / k - 2.0 * k * outside + 2.0 * here;
    const double first = (1.0 - oracle::kNested) * upper / (k * upper + here) + oracle::kNested * nested,
                 second = (1.0 - oracle::kNested) * here / (k * upper + here) +
                          oracle::kNested * (2.0 - 2.0 * k * nested);
    const dvec2 along = turned / sigma,
                across = dvec2(-d.y, d.x) * (std::sqrt(s.x * s.y - s.z * s.z) / sigma), mean = -first * along;
    const dvec2 light(l.x, l.y);
    const double spread = std::sqrt(std::pow(dot(across, light), 2.0) +
                                    std::pow(dot(along, light), 2.0) * (1.0 + second - first * first));
    const double middle = l.z - dot(mean, light), x = middle / spread;
    const double facing = 0.5 * std::erfc(-x / std::sqrt(2.0)) * middle +
                          spread * std::exp(-0.5 * x * x) / std::sqrt(2.0 * oracle::kPi);
    const double up = 1.0 / std::sqrt(1.0 + dot(mean, mean) + dot(across, across) + dot(along, along));
    const double w = v.z - mean.x * v.x - mean.y * v.y;
    const double sun = oracle::kPi * kFoamRadius * kFoamRadius * facing * up *
                       oracle::lit(w, facing, v, l, s) / oracle::visible(w, v, s);
    return (1e5 * sun + 0.5 + 0.5 * up) / oracle::kPi;
}

TEST(Foam, SingleIsDouble) {
    Optics optics;
    Inputs inputs(31);
    for (int i = 0; i < 100000; ++i) {
        const vec3 v = inputs.direction(1e-4), l = inputs.direction(1e-4),
                   s = inputs.variance(1e-3, 0.7, 0.9);
        if (v.z > 0.9999f) continue;
        const auto frame = optics.slope_frame(vec3(0.0f, 0.0f, 1.0f), s);
        const double expected = foam(normalize(dvec3(v)), normalize(dvec3(l)), dvec3(s));
        const vec3 found =
            optics.foam_radiance(v, l, frame, vec3(1e5f), float(kFoamRadius), vec3(1.0f), 1.0f, 0.0f);
        ASSERT_NEAR(found.y, expected, 1e-4 * expected) << i;
    }
}

// Diffuse facets of albedo 1 reflect no more than they receive: the share of light from any direction that
// reaches any eye is at most 1 (single scattering: light on shaded or averted facets is lost). 1e-2, because
// the closed form uses the facets' mean tilt.
TEST(Foam, ReflectsNoMoreThanItGets) {
    Optics optics;
    for (float sigma : {0.01f, 0.15f, 0.4f})
        for (double degrees : {1.0, 40.0, 70.0, 85.0, 89.5}) {
            const double theta = degrees * oracle::kPi / 180.0;
            const vec3 v(dvec3(std::sin(theta), 0.0, std::cos(theta)));
            const auto frame =
                optics.slope_frame(vec3(0.0f, 0.0f, 1.0f), vec3(sigma * sigma, sigma * sigma, 0.0f));
            double sum = 0.0;
            constexpr int kSteps = 60;
            for (int i = 0; i < kSteps; ++i)
                for (int j = 0; j < kSteps; ++j) {
                    const double z = (i + 0.5) / kSteps, a = 2.0 * oracle::kPi * (j + 0.5) / kSteps,
                                 q = std::sqrt(1.0 - z * z);
                    const vec3 l(dvec3(q * std::cos(a), q * std::sin(a), z));
                    const vec3 found = optics.foam_radiance(v, l, frame, vec3(1.0f), float(kFoamRadius),
                                                            vec3(0.0f), 1.0f, 0.0f);
                    sum += static_cast<double>(found.y) /
                           (oracle::kPi * kFoamRadius * kFoamRadius);  // per solid angle of the sun
                }
            sum *= 2.0 * oracle::kPi / (kSteps * kSteps);
            EXPECT_LE(sum, 1.01) << sigma << ' ' << degrees;
            EXPECT_GT(sum, 0.6) << sigma << ' ' << degrees;
        }
}

// Koepke's 0.22 over black water, and bluish over blue water, which shows through thin foam.
TEST(Foam, IsKoepkesAndShowsTheWater) {
    Optics optics;
    EXPECT_NEAR(optics.kFoamOpacity * optics.kWhiteFoam, 0.22f, 1e-6f);
    const SeaAlbedo black = sea_albedo({.reflectance = vec3(0.0f)}),
                    blue = sea_albedo({.reflectance = vec3(0.0f, 0.01f, 0.05f)});
    EXPECT_NEAR(black.foam.y, 0.22f, 1e-6f);
    EXPECT_NEAR(black.foam.x / black.foam.y, 0.94f, 1e-6f);  // its water takes some of the red
    EXPECT_NEAR(blue.foam.z, 0.22f + 0.6f * blue.water.z, 1e-6f);
    EXPECT_GT(blue.water.z, 0.01f);
}

// Between bubbles the water mirrors the sun and the sky as it does without them, and shines: foam that hides nothing changes nothing.
TEST(Foam, HidesWhatItsOpacitySays) {
    Optics optics;
    Inputs inputs(33);
    const Optics::SeaLight light{
        normalize(vec3(0.5f, 0.0f, 0.3f)), vec3(1e4f), float(kFoamRadius), vec3(0.7f), vec3(1.0f),
        plain_water(vec3(0.02f)),          {}};
    for (int i = 0; i < 1000; ++i) {
        const vec3 v = inputs.direction(1e-3), s = inputs.variance(1e-3, 0.1, 0.9);
        const vec3 up(0.0f, 0.0f, 1.0f);
        const auto terms = [&](float opacity) {
            return optics.sea_radiance(v, up, s, {opacity, 0.55f, 0.0f}, optics.no_crest_nor_bubbles(),
                                       light);
        };
        const auto none = terms(0.0f), some = terms(0.25f), all = terms(1.0f);
        EXPECT_EQ(none.foam, vec3(0.0f));
        for (const auto& [clear, left, white] :
             {std::tuple{none.sun, some.sun, some.foam}, {none.sea, some.sea, some.foam}}) {
            EXPECT_NEAR(left.x, 0.75f * clear.x, 1e-5f * clear.x);
            EXPECT_NEAR(white.x, 0.25f * all.foam.x, 1e-5f * all.foam.x);
        }
        EXPECT_EQ(all.sun + all.sea, vec3(0.0f));
    }
}

// L = R E_d/(π n²), where E_d is the light that enters, including what the surface's underside reflects.
TEST(Water, RadianceOutOfTheWater) {
    Optics optics;
    Inputs inputs(32);
    for (int i = 0; i < 100000; ++i) {
        const vec3 l = inputs.direction(1e-5);
        const double sun = inputs.logarithmic(1e-3, 100.0), sky = inputs.logarithmic(1e-3, 20.0),
                     r = inputs.uniform(0.0, 0.33);
        const double down = sun * (1.0 - oracle::fresnel(static_cast<double>(l.z))) + sky * (1.0 - 0.06751);
        const double expected = r / (1.0 - 0.48 * r) * down / (oracle::kPi * 1.34 * 1.34);
        const vec3 found = optics.water_radiance(l, vec3(float(sun)), vec3(float(sky)), vec3(float(r)));
        // 1 − F of a grazing sun has an absolute rounding error of 1e-7.
        ASSERT_NEAR(found.x, expected, 1e-4 * expected + 1e-7 * r * sun) << i;
    }
}

// 0.06751 is the exact term averaged over a uniform sky, ∫ F 2 cosθ d cosθ.
TEST(Water, ShareOfTheSkyThatStaysOutside) {
    double sum = 0.0;
    constexpr int kSteps = 20000;
    for (int i = 0; i < kSteps; ++i) {
        const double c = (i + 0.5) / kSteps;
        sum += 2.0 * c * oracle::fresnel(c) / kSteps;
    }
    EXPECT_NEAR(sum, 0.06751, 1e-5);
}

// 0.48 is the same from below, for isotropic light.
TEST(Water, ShareThatStaysInside) {
    double sum = 0.0;
    constexpr int kSteps = 20000;
    for (int i = 0; i < kSteps; ++i) {
        const double c = (i + 0.5) / kSteps;
        sum += 2.0 * c * oracle::fresnel(c, 1.0 / 1.34) / kSteps;
    }
    EXPECT_NEAR(sum, 0.48, 0.01);
}

// Opaque foam damps the ripples below it: of the difference that they make to its light a part is left, and the mean stays (at slopes of 0.3
// it is 6 % less). A film rides on them, and without foam, or where nothing is hidden, the frame is the water's.
TEST(Foam, LiesOnRipplesAsABlanket) {
    Optics optics;
    const vec3 to_sun = normalize(vec3(0.6f, 0.0f, 0.5f)), to_eye = normalize(vec3(-0.5f, 0.1f, 0.5f)),
               variance(0.01f, 0.01f, 0.0f), crest(0.05f, -0.02f, 0.3f);
    const auto light = [&](float slope, float opacity) {
        const auto frame = optics.frame_of_foam(normalize(vec3(-crest.x - slope, -crest.y, 1.0f)), variance,
                                                opacity, to_eye, crest);
        return static_cast<double>(
            optics
                .foam_radiance(to_eye, to_sun, frame, vec3(1e5f), float(kFoamRadius), vec3(1.0f), 1.0f, 0.0f)
                .x);
    };
    for (const float ripple : {0.12f, 0.16f, 0.2f}) {
        const double high = light(ripple, 0.0f), low = light(-ripple, 0.0f),
                     difference = std::abs(high - low);
        EXPECT_GT(difference, 0.1 * (high + low)) << ripple;
        EXPECT_LT(std::abs(light(ripple, 1.0f) - light(-ripple, 1.0f)), 0.25 * difference) << ripple;
        EXPECT_GT(std::abs(light(ripple, 0.2f) - light(-ripple, 0.2f)), 0.75 * difference) << ripple;
        EXPECT_NEAR((light(ripple, 1.0f) + light(-ripple, 1.0f)) / (high + low), 1.0, 0.03) << ripple;
    }
    // A crest that folds: finite, and no rougher than slopes of 1.
    for (const float z : {1.0f, 0.1f, 0.0f, -0.5f}) {
        const auto frame =
            optics.frame_of_foam(normalize(vec3(1.0f, 0.2f, z)), variance, 1.0f, to_eye, crest);
        EXPECT_LT(frame.variance.x + frame.variance.y, 1.1f) << z;
        EXPECT_TRUE(std::isfinite(frame.normal.x) && std::isfinite(frame.normal.z)) << z;
    }
}

}  // namespace
}  // namespace pelagic::optics
