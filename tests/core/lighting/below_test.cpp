// What an eye in the water sees (below.glsl): the surface from below, and the water between.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <span>

#include "core/lighting/floor.h"
#include "core/lighting/lighting.h"
#include "core/lighting/meniscus.h"
#include "tests/core/lighting/optics.h"

namespace pelagic::optics {
namespace {

constexpr float kMirror = 1e-10f;  // slope variance of a mirror
constexpr double kIndex = 1.34, kOneDegree = oracle::kPi / 180.0;

vec3 tilted(double theta, double azimuth = 0.0) {
    return vec3(
        dvec3(std::sin(theta) * std::cos(azimuth), std::sin(theta) * std::sin(azimuth), std::cos(theta)));
}

WaterBody deep_body(double chlorophyll, double floor_m = 1e9, double albedo = 0.0, float waves = kMirror) {
    WaterBody water = water_body({.chlorophyll_mg_m3 = chlorophyll,
                                  .has_body = true,
                                  .floor_colour = glm::dvec3(albedo),
                                  .floor_m = floor_m});
    water.waves = vec3(waves, waves, 0.0f);
    return water;
}

Sky lit_by(double sun_deg, float of_sky) {
    Sky sky;
    sky.map = SkyMap(4, std::vector<vec3>(16, vec3(of_sky)));
    sky.sky_irradiance = vec3(of_sky * static_cast<float>(oracle::kPi));
    sky.sun_direction = tilted((90.0 - sun_deg) * kOneDegree, 0.7);
    if (sun_deg <= 0.0) return sky;
    const float solid_angle =
        static_cast<float>(oracle::kPi) * sky.sun_angular_radius * sky.sun_angular_radius;
    sky.sun_radiance = vec3(1.0f / solid_angle);
    sky.sun_irradiance = vec3(sky.sun_direction.z);
    return sky;
}

// Of a facet, by Snell and Fresnel.
double let_by_facet(double cosine) {
    const double sine2 = kIndex * kIndex * (1.0 - cosine * cosine);
    if (sine2 >= 1.0) return 0.0;
    const double beyond = std::sqrt(1.0 - sine2);
    const double s = (kIndex * cosine - beyond) / (kIndex * cosine + beyond),
                 p = (cosine - kIndex * beyond) / (cosine + kIndex * beyond);
    return 1.0 - 0.5 * (s * s + p * p);
}

// The nine facets let through what all visible ones do, that is the integral over their slopes.
TEST(Below, NineFacetsLetThroughWhatAllDo) {
    Optics optics;
    double sum2 = 0.0;
    int cases = 0;
    for (const float variance : {1e-4f, 1e-3f, 5e-3f, 0.02f, 0.05f})
        for (int degrees = 0; degrees <= 85; degrees += 5) {
            const vec3 v = tilted(degrees * kOneDegree, 0.3), slopes(variance, variance, 0.0f);
            const double s = std::sqrt(static_cast<double>(variance));
            double found = 0.0, all = 0.0;
            constexpr int kSteps = 240;
            for (int i = 0; i < kSteps; ++i)
                for (int j = 0; j < kSteps; ++j) {
                    const dvec2 slope = 5.0 * s * (2.0 * dvec2(i + 0.5, j + 0.5) / double{kSteps} - 1.0);
                    const double seen = optics.visible_slope_density(vec2(slope), v, slopes);
                    all += seen;
                    found += seen * let_by_facet(dot(dvec3(v), normalize(dvec3(-slope, 1.0))));
                }
            const float ours =
                optics.sky_from_below(v, optics.slope_frame(vec3(0.0f, 0.0f, 1.0f), slopes)).through;
            const double error = static_cast<double>(ours) - found / all;
            sum2 += error * error;
            ++cases;
            EXPECT_NEAR(ours, found / all, 0.03) << variance << ' ' << degrees;
        }
    EXPECT_LT(std::sqrt(sum2 / cases), 0.008);
}

// By reciprocity a uniform light in the water gets out as much as one above gets in, over n².
TEST(Below, LetsOutWhatComesIn) {
    Optics optics;
    for (const float variance : {kMirror, 5e-3f, 0.0275f}) {
        const vec3 slopes(variance, variance, 0.0f);
        double out = 0.0;
        constexpr int kSteps = 400;
        for (int i = 0; i < kSteps; ++i) {
            const double theta = 90.0 * kOneDegree * (i + 0.5) / kSteps;
            const float part =
                optics.sky_from_below(tilted(theta), optics.slope_frame(vec3(0.0f, 0.0f, 1.0f), slopes))
                    .through;
            out += part * std::sin(2.0 * theta) * 90.0 * kOneDegree / kSteps;
        }
        const double in = optics.entering_from_sky(slopes);
        EXPECT_NEAR(out, in / (kIndex * kIndex), 0.012) << variance;
    }
}

// All that all eyes see of the sun is what of its light enters.
TEST(Below, TheSunSeenFromEverywhereIsWhatEnters) {
    Optics optics;
    constexpr double kSunRadius = 0.00465;
    for (const float variance : {2e-3f, 0.01f, 0.03f})
        for (const double sun_deg : {20.0, 45.0, 80.0}) {
            const vec3 slopes(variance, variance, 0.0f), sun = tilted((90.0 - sun_deg) * kOneDegree, 0.7);
            const Optics::SlopeFrame frame = optics.slope_frame(vec3(0.0f, 0.0f, 1.0f), slopes);
            double seen = 0.0;
            constexpr int kSteps = 500;
            for (int i = 0; i < kSteps; ++i)
                for (int j = 0; j < 2 * kSteps; ++j) {
                    const double theta = 90.0 * kOneDegree * (i + 0.5) / kSteps,
                                 azimuth = oracle::kPi * (j + 0.5) / kSteps;
                    const vec3 light = optics.sun_from_below(tilted(theta, azimuth), sun, frame, vec3(1.0f),
                                                             static_cast<float>(kSunRadius));
                    seen += light.x * std::sin(theta) * std::cos(theta);
                }
            seen *= 90.0 * kOneDegree / kSteps * oracle::kPi / kSteps;
            const double whole = oracle::kPi * kSunRadius * kSunRadius * static_cast<double>(sun.z);
            EXPECT_NEAR(seen / whole, optics.entering(sun, slopes), 0.02) << variance << ' ' << sun_deg;
        }
}

// Just below a level sea, straight down, is what the sea shows above: n² of it, before the surface takes its part.
TEST(Below, JustBelowTheSurfaceIsTheWaterThatIsSeenFromAbove) {
    for (const double chlorophyll : {0.01, 0.1, 1.0, 10.0})
        for (const double sun_deg : {-10.0, 5.0, 30.0, 70.0})
            for (const double floor_m : {0.5, 3.0, 30.0, 1e9}) {
                const WaterBody water = deep_body(chlorophyll, floor_m, 0.3);
                const Sky sky = lit_by(sun_deg, 0.1f);
                const LightingChoice choice{.sun = false, .sky = false, .whitecaps = false, .air = false};
                const SeaPoint point{.slope_variance = vec3(kMirror, kMirror, 0.0f)};
                SeaRadiance above, below;
                shade_sea(choice, sky, water, {&point, 1}, {&above, 1});
                const vec3 down(0.0f, 0.0f, -1.0f);
                shade_water(choice, sky, water, 0.0f, {&down, 1}, {&below, 1});
                const double shown = let_by_facet(1.0) / (kIndex * kIndex);
                for (int c = 0; c < 3; ++c)
                    EXPECT_NEAR(shown * below.sea[c], above.sea[c], 0.005 * above.sea[c] + 1e-6)
                        << chlorophyll << ' ' << sun_deg << ' ' << floor_m << ' ' << c;
            }
}

SeaRadiance through_meniscus(vec3 direction, double height_m, const WaterBody& water, const Sky& sky,
                             const LightingChoice& choice = {}, vec3 forward = {0.0f, 1.0f, 0.0f}) {
    const MeniscusSight sight{direction, static_cast<float>(height_m)};
    SeaRadiance lit;
    shade_meniscus(choice, sky, water, 0.0f, forward, {&sight, 1}, {&lit, 1});
    return lit;
}

// A level sight at the glass meets water that is inclined by φ, 60° at the top. From 41.7° on it comes out, and looks down at the sea before
// it; below that it is mirrored, and looks down by 2φ.
TEST(Meniscus, MirrorsTheWaterAndShowsTheSeaBeforeIt) {
    const WaterBody water = deep_body(0.1);
    const Sky sky = lit_by(-10.0, 1.0f);
    const vec3 level(0.0f, 1.0f, 0.0f);
    const auto height_m = [](double inclined_deg) {
        return 2.0 * kCapillary_m * std::sin(0.5 * inclined_deg * kOneDegree);
    };
    EXPECT_NEAR(height_m(60.0), kMeniscus_m, 1e-9);
    for (const double inclined_deg : {60.0, 50.0, 43.0}) {
        const double within = 90.0 - inclined_deg;  // of incidence
        const double out = std::asin(kIndex * std::sin(within * kOneDegree)) / kOneDegree;
        const double down = out - within;  // below the horizon
        const double into = std::sqrt(1.0 - std::pow(std::cos(down * kOneDegree) / kIndex, 2));
        const double expected = let_by_facet(std::cos(within * kOneDegree)) * (1.0 - let_by_facet(into));
        const SeaRadiance lit = through_meniscus(level, height_m(inclined_deg), water, sky, {.water = false});
        EXPECT_NEAR(lit.sky.y, expected, 1e-3) << inclined_deg;
    }
    for (const double inclined_deg : {40.0, 20.0, 2.0}) {
        const vec3 mirrored = tilted((90.0 + 2.0 * inclined_deg) * kOneDegree, 0.5 * oracle::kPi);
        SeaRadiance seen;
        shade_water({}, sky, water, 0.0f, {&mirrored, 1}, {&seen, 1});
        const SeaRadiance lit = through_meniscus(level, height_m(inclined_deg), water, sky);
        EXPECT_EQ(lit.sky, vec3(0.0f)) << inclined_deg;
        EXPECT_NEAR(lit.sea.y / seen.sea.y * static_cast<float>(kIndex * kIndex), 1.0f, 1e-3f)
            << inclined_deg;
    }
}

// At the water's level it goes over into what is below, and above its top into what is seen there.
TEST(Meniscus, HasNoEdges) {
    EXPECT_EQ(meniscus_share(0.0), 1.0f);
    EXPECT_NEAR(meniscus_share(kMeniscus_m), 0.5f, 1e-5f);
    EXPECT_EQ(meniscus_share(kMeniscus_m + 1.01 * kMeniscusBlur_m), 0.0f);
    const WaterBody water = deep_body(1.0, 3.0, 0.4);
    const Sky sky = lit_by(40.0, 0.1f);
    const vec3 down = tilted(100.0 * kOneDegree, 0.5);
    SeaRadiance below;
    shade_water({}, sky, water, 0.0f, {&down, 1}, {&below, 1});
    EXPECT_NEAR(through_meniscus(down, 0.0, water, sky).sea.y, kBehindGlass * below.sea.y, 1e-6f);
}

TEST(Meniscus, IsFiniteFromEverySide) {
    const WaterBody water = deep_body(0.1, 2.0, 1.0);
    const Sky sky = lit_by(40.0, 0.1f);
    for (const double glass : {0.0, 1e-4, 90.0, 179.99, 180.0})
        for (const double theta : {0.0, 1e-4, 60.0, 90.0, 120.0, 180.0})
            for (const double height_m : {0.0, 1e-9, 1e-3, 2.7e-3, 1.0}) {
                const SeaRadiance lit = through_meniscus(tilted(theta * kOneDegree, 0.7), height_m, water,
                                                         sky, {}, tilted(glass * kOneDegree, 0.7));
                for (const vec3& part : {lit.sky, lit.sea})
                    for (int c = 0; c < 3; ++c)
                        ASSERT_TRUE(std::isfinite(part[c]) && part[c] >= 0.0f)
                            << glass << ' ' << theta << ' ' << height_m;
            }
}

// Whatever the eye's depth, the way it looks, the water, the floor and the sun.
TEST(Below, HostileCasesAreFinite) {
    const float depths[] = {0.0f, 1e-6f, 0.3f, 20.0f, 500.0f, 9000.0f};
    for (const double chlorophyll : {0.0, 0.1, 100.0})
        for (const double sun_deg : {-90.0, -1.0, 0.0, 1e-3, 40.0, 90.0})
            for (const double floor_m : {1e-3, 10.0, 1e4, 1e9})
                for (const float waves : {kMirror, 0.1f})
                    for (const float depth_m : depths) {
                        // With the harshest of shafts: dark, or dark but for one texel.
                        Floor floor(floor_m);
                        std::span<float> shafts = floor.set_shafts({.side = 64,
                                                                    .texel_m = 1.0,
                                                                    .depth_m = 1.0,
                                                                    .from_m = {-32.0, -32.0},
                                                                    .gain = 10.0});
                        std::fill(shafts.begin(), shafts.end(), 0.0f);
                        if (waves != kMirror) shafts[32 * 64 + 33] = 1e6f;
                        floor.halve_shafts();
                        const FloorSeen seen = floor.seen_from({.position_m = {0.0, 0.0, -depth_m}});
                        for (const double theta :
                             {0.0, 1e-4, 48.27, 60.0, 89.999, 90.0, 90.001, 130.0, 180.0}) {
                            WaterBody water = deep_body(chlorophyll, floor_m, 1.0, waves);
                            water.bubbles = 10.0f;
                            water.bubbles_m = theta < 50.0 ? 1e-6f : 10.0f;
                            const Sky sky = lit_by(sun_deg, 0.1f);
                            const vec3 direction = tilted(theta * kOneDegree, 0.7);
                            SeaRadiance lit[2];
                            shade_water({}, sky, water, -depth_m, {&direction, 1}, {lit, 1}, seen);
                            const SeaPoint point{.to_eye = -direction,
                                                 .normal = tilted(0.4, 2.0),
                                                 .slope_variance = vec3(waves, waves, 0.0f),
                                                 .coverage = 0.5f};
                            const float distance_m = depth_m / std::max(std::abs(direction.z), 1e-3f);
                            shade_sea_from_below({}, sky, water, -depth_m, {&point, 1}, {&distance_m, 1},
                                                 {lit + 1, 1}, {}, seen);
                            for (const SeaRadiance& of : lit)
                                for (const vec3& part : {of.sun, of.sky, of.sea, of.foam})
                                    for (int c = 0; c < 3; ++c)
                                        ASSERT_TRUE(std::isfinite(part[c]) && part[c] >= 0.0f)
                                            << chlorophyll << ' ' << sun_deg << ' ' << floor_m << ' ' << waves
                                            << ' ' << depth_m << ' ' << theta;
                        }
                    }
}

// Under a sky that is the same everywhere nothing in the water is brighter than n² of it, nor than the sky that is seen through a level
// surface just above the eye.
TEST(Below, NothingOutshinesTheSky) {
    const Sky sky = lit_by(-10.0, 1.0f);
    for (const double chlorophyll : {0.01, 0.1, 1.0, 10.0})
        for (const float waves : {kMirror, 0.01f, 0.05f})
            for (const float depth_m : {0.01f, 1.0f, 10.0f, 50.0f})
                for (int degrees = 0; degrees < 90; degrees += 3) {
                    WaterBody water = deep_body(chlorophyll, 1e9, 0.0, waves);
                    water.bubbles = 1.0f;
                    water.bubbles_m = 0.5f;
                    const vec3 direction = tilted(degrees * kOneDegree);
                    SeaPoint point{.to_eye = -direction, .slope_variance = vec3(waves, waves, 0.0f)};
                    point.bubbles = degrees % 2 == 0 ? 0.0f : 0.7f;
                    const float distance_m = depth_m / direction.z;
                    SeaRadiance lit;
                    shade_sea_from_below({}, sky, water, -depth_m, {&point, 1}, {&distance_m, 1}, {&lit, 1});
                    for (int c = 0; c < 3; ++c)
                        EXPECT_LT(lit.sky[c] + lit.sea[c], kIndex * kIndex)
                            << chlorophyll << ' ' << waves << ' ' << depth_m << ' ' << degrees;
                }
}

// A veil of bubbles: what it sends back, lets through and spreads is all that falls on it, and of a beam no more comes out than went in.
TEST(Below, BubblesKeepTheLight) {
    Optics optics;
    for (const float bubbles : {0.01f, 0.1f, 0.5f, 1.0f, 3.0f, 10.0f}) {
        for (const float cosine : {0.0f, 0.1f, 0.7f, 1.0f}) {
            const Optics::BubbleVeil veil = optics.bubble_veil(bubbles, cosine);
            EXPECT_NEAR(veil.back + veil.sharp + veil.spread, 1.0f, 1e-6f);
            EXPECT_TRUE(veil.back >= 0.0f && veil.sharp >= 0.0f && veil.spread >= 0.0f) << bubbles;
        }
        for (const double of_sun : {0.666, 0.8, 1.0}) {
            double spread = 0.0;
            constexpr int kSteps = 400;
            for (int i = 0; i < kSteps; ++i) {
                const double cosine = (i + 0.5) / kSteps;
                for (int k = 0; k < kSteps; ++k) {
                    const double azimuth = 2.0 * oracle::kPi * (k + 0.5) / kSteps;
                    const double between =
                        cosine * of_sun +
                        std::sqrt((1.0 - cosine * cosine) * (1.0 - of_sun * of_sun)) * std::cos(azimuth);
                    spread += cosine / of_sun * 2.0 * oracle::kPi / (kSteps * kSteps) *
                              optics.bubble_veil(bubbles, static_cast<float>(cosine)).spread *
                              optics.ahead_of_bubbles(static_cast<float>(between), bubbles,
                                                      static_cast<float>(of_sun));
                }
            }
            const Optics::BubbleVeil veil = optics.bubble_veil(bubbles, static_cast<float>(of_sun));
            EXPECT_LE(veil.back + veil.sharp + spread, 1.001) << bubbles << ' ' << of_sun;
            EXPECT_GT(spread, 0.25 * veil.spread) << bubbles << ' ' << of_sun;
        }
    }
}

// Bubbles hang under the surface: less of the window's edge, light round the sun, and none of it without them or above the eye.
TEST(Below, BubblesVeilTheWindow) {
    const Sky sky = lit_by(50.0, 1.0f);
    const auto seen = [&](double degrees, float bubbles, float gain, float distance_m) {
        WaterBody water = deep_body(0.1, 1e9, 0.0, 0.003f);
        water.bubbles = gain;
        water.bubbles_m = 0.5f;
        SeaPoint point{.to_eye = -tilted(degrees * kOneDegree, 0.7),
                       .slope_variance = vec3(0.003f, 0.003f, 0.0f)};
        point.bubbles = bubbles;
        SeaRadiance lit;
        shade_sea_from_below({}, sky, water, -5.0f, {&point, 1}, {&distance_m, 1}, {&lit, 1});
        return lit;
    };
    const SeaRadiance clear = seen(0.0, 0.0f, 1.0f, 5.0f), veiled = seen(0.0, 0.5f, 1.0f, 5.0f);
    EXPECT_NEAR(veiled.sky.y / clear.sky.y, std::exp(-0.5f * 3.75f * 0.5f), 1e-3f);
    EXPECT_GT(veiled.sea.y, clear.sea.y);
    // Round the sun, which lies at asin(cos(50°)/n) = 28.7°, more of its light than opposite it.
    EXPECT_GT(seen(20.0, 0.5f, 1.0f, 5.0f).sea.y, 1.3f * seen(-20.0, 0.5f, 1.0f, 5.0f).sea.y);
    for (const double degrees : {0.0, 30.0, 60.0}) {
        const SeaRadiance none = seen(degrees, 0.0f, 1.0f, 5.0f), off = seen(degrees, 0.9f, 0.0f, 5.0f);
        EXPECT_EQ(none.sky, off.sky);
        EXPECT_EQ(none.sea, off.sea);
        EXPECT_EQ(none.sun, off.sun);
        EXPECT_NEAR(seen(degrees, 0.9f, 1.0f, 1e-5f).sky.y / seen(degrees, 0.0f, 1.0f, 1e-5f).sky.y, 1.0f,
                    1e-3f);
    }
}

}  // namespace
}  // namespace pelagic::optics
