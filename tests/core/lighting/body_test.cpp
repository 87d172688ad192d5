// The body of water: what enters, comes back, shines through crests and from bubbles. Beside Monte Carlos of its own: tests/bench/water.cpp.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "core/lighting/lighting.h"
#include "tests/core/lighting/optics.h"

namespace pelagic::optics {
namespace {

constexpr float kLevel = 1e-8f;  // slope variance of a mirror

WaterBody body(double floor_m = 1e9, double albedo = 0.0, double chlorophyll = 0.1) {
    WaterBody water = water_body({.chlorophyll_mg_m3 = chlorophyll,
                                  .has_body = true,
                                  .floor_colour = glm::dvec3(albedo),
                                  .floor_m = floor_m});
    water.waves = vec3(kLevel, kLevel, 0.0f);
    return water;
}

Sky even_sky() {
    Sky sky;
    sky.map = SkyMap(4, std::vector<vec3>(16, vec3(1.0f)));
    sky.sky_irradiance = vec3(static_cast<float>(oracle::kPi));
    return sky;
}

Sky sunny(double elevation) {
    Sky sky;
    const double radius = 0.00465;
    sky.sun_direction = vec3(dvec3(0.0, std::cos(elevation), std::sin(elevation)));
    sky.sun_angular_radius = static_cast<float>(radius);
    sky.sun_radiance = vec3(static_cast<float>(1.0 / (oracle::kPi * radius * radius)));
    sky.sun_irradiance = vec3(static_cast<float>(std::sin(elevation)));
    return sky;
}

vec3 sea_of(const Sky& sky, const WaterBody& water, SeaPoint point, bool foam = false) {
    SeaRadiance lit;
    shade_sea({.sun = false, .sky = false, .whitecaps = foam, .air = false}, sky, water, {&point, 1},
              {&lit, 1});
    return lit.sea;
}

vec3 from(double theta, double azimuth = -oracle::kPi / 2.0) {
    return vec3(
        dvec3(std::sin(theta) * std::cos(azimuth), std::sin(theta) * std::sin(azimuth), std::cos(theta)));
}

constexpr double kDegree = oracle::kPi / 180.0;

// White light stays white, and a floor has the colour that the shot gives it.
TEST(Water, SixWavelengthsGiveTheColourBack) {
    Optics optics;
    for (const dvec3 colour : {dvec3(1.0), dvec3(0.36, 0.31, 0.23), dvec3(0.1, 0.5, 0.3), dvec3(0.02)}) {
        const WaterBody water = water_body({.has_body = true, .floor_colour = colour, .floor_m = 1.0});
        const vec3 found = optics.colour_of({water.floor_colour.shorter, water.floor_colour.longer});
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], colour[c], 2e-4);
    }
}

// Nothing is lost over a white floor under clear water: what is mirrored and what comes back are the sky.
TEST(Water, OverAWhiteFloorIsAFurnace) {
    const Sky sky = even_sky();
    for (const float s : {kLevel, 0.01f, 0.05f})
        for (const double theta : {0.0, 30.0, 60.0, 80.0}) {
            WaterBody water = body(1e-6, 1.0);
            water.waves = vec3(s, s, 0.0f);
            SeaRadiance lit;
            const SeaPoint point{.to_eye = from(theta * kDegree), .slope_variance = vec3(s, s, 0.0f)};
            shade_sea({.whitecaps = false, .air = false, .sky_quality = SkyQuality::One}, sky, water,
                      {&point, 1}, {&lit, 1});
            // A sky of 1 is mirrored by a map of 1; its lookups are blurred at grazing angles by less than this.
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(lit.sky[c] + lit.sea[c], 1.0f, 5e-3f) << s << ' ' << theta;
        }
}

// Sunlight that a level sea takes in is what Fresnel leaves; a rough one takes in more of a low sun's, as ray tracing of a Gaussian sea of
// Cox and Munk's slopes for 10 m/s says: 0.752, 0.783, 0.821, 0.892, 0.939.
TEST(Water, TakesInMoreOfALowSunWhereItIsRough) {
    Optics optics;
    for (const double elevation : {1.0, 5.0, 20.0, 60.0}) {
        const double level = 1.0 - oracle::fresnel(std::sin(elevation * kDegree));
        EXPECT_NEAR(optics.entering(sunny(elevation * kDegree).sun_direction, vec3(kLevel, kLevel, 0.0f)),
                    level, 0.01)
            << elevation;
    }
    const float up = 0.0316f, cross = 0.0222f;  // Cox and Munk 1954 at 10 m/s
    for (const auto& [elevation, entering] :
         {std::pair{1.0, 0.752f}, {5.0, 0.783f}, {10.0, 0.821f}, {20.0, 0.892f}, {30.0, 0.939f}})
        EXPECT_NEAR(optics.entering(sunny(elevation * kDegree).sun_direction, vec3(cross, up, 0.0f)),
                    entering, 0.02f)
            << elevation;
}

// A floor at no depth is all that is seen, one at a great depth nothing; between, light falls with depth where the floor is brighter than
// deep water.
TEST(Water, AColumnLiesBetweenItsFloorAndTheDeep) {
    const Sky sky = sunny(50.0 * kDegree);
    const SeaPoint point{.to_eye = from(0.5), .slope_variance = vec3(kLevel, kLevel, 0.0f)};
    const vec3 deep = sea_of(sky, body(), point);
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(sea_of(sky, body(3000.0, 0.9), point)[c], deep[c], 1e-3f * deep[c]);
        float last = 1.0f;
        for (const double depth : {1e-6, 0.5, 2.0, 8.0, 30.0, 100.0}) {
            const float seen = sea_of(sky, body(depth, 0.5), point)[c];
            EXPECT_LE(seen, last) << depth;
            EXPECT_GE(seen, 0.999f * deep[c]) << depth;
            last = seen;
        }
    }
    // Pale sand under some metres of clear water is turquoise.
    const vec3 lagoon = sea_of(sky, body(4.0, 0.5, 0.05), point);
    EXPECT_GT(lagoon.y, 1.5f * lagoon.x);
    EXPECT_GT(lagoon.z, 1.5f * lagoon.x);
}

// Towards a low sun a crest shines; with it behind the eye a face that leans to it is brighter than level water, one that leans away darker.
// Level water, and a high sun, know little of waves.
TEST(Water, WavesShapeTheLightOfALowSun) {
    WaterBody water = body();
    water.crest_light = 1.0f;
    water.crest_per_m = 0.2f;
    water.waves = vec3(0.01f, 0.01f, 0.0f);
    const auto gain = [&](double elevation, vec3 crest, bool towards_sun = true) {
        const SeaPoint point{.to_eye = from(85.0 * kDegree, (towards_sun ? -0.5 : 0.5) * oracle::kPi),
                             .slope_variance = vec3(0.01f, 0.01f, 0.0f),
                             .crest = crest};
        WaterBody without = water;
        without.crest_light = 0.0f;
        const Sky sky = sunny(elevation * kDegree);
        return sea_of(sky, water, point).y / sea_of(sky, without, point).y;
    };
    // The sun stands along +y.
    const vec3 top(0.0f, 0.05f, 1.6f), to_sun(0.0f, -0.2f, 0.5f), from_sun(0.0f, 0.2f, 0.5f);
    EXPECT_GT(gain(10.0, top), 1.3f);
    EXPECT_LT(gain(10.0, top), 4.0f);
    EXPECT_GT(gain(4.0, top), gain(15.0, top));
    EXPECT_GT(gain(10.0, to_sun, false), 1.1f);
    EXPECT_LT(gain(10.0, from_sun, false), 0.9f);
    EXPECT_NEAR(gain(60.0, to_sun, false), 1.0f, 0.25f);
    for (const double elevation : {5.0, 20.0, 60.0}) {
        EXPECT_NEAR(gain(elevation, vec3(0.0f)), 1.0f, 0.01f) << elevation;
        EXPECT_NEAR(gain(elevation, vec3(0.0f), false), 1.0f, 0.01f) << elevation;
    }
}

// Under fresh foam the water is white and blue-green, and it fades in a minute; without foam nothing of it is there.
TEST(Water, BubblesBrightenItUnderFoam) {
    WaterBody water = body(), without = water;
    water.bubbles = 1.0f;
    water.bubbles_m = 0.6f;
    const Sky sky = sunny(45.0 * kDegree);
    const auto seen = [&](float coverage, float active, float age_s) {
        const SeaPoint point{.to_eye = from(0.6), .coverage = coverage, .active = active, .age_s = age_s};
        // As it would be without the foam before it.
        const float clear =
            sea_of(sky, without, point, true).y / sea_of(sky, without, {.to_eye = from(0.6)}, true).y;
        return sea_of(sky, water, point, true) / clear;
    };
    const vec3 none = seen(0.0f, 0.0f, 0.0f), fresh = seen(0.5f, 0.5f, 0.0f),
               some_s = seen(0.5f, 0.0f, 10.0f), minute = seen(0.5f, 0.0f, 60.0f);
    for (int c = 0; c < 3; ++c) {
        EXPECT_EQ(none[c], sea_of(sky, without, {.to_eye = from(0.6)}, true)[c]);
        EXPECT_GT(fresh[c], some_s[c]);
        EXPECT_GT(some_s[c], minute[c]);
        EXPECT_GE(minute[c], none[c]);
    }
    EXPECT_GT(some_s.y, 1.5f * some_s.x);
    EXPECT_GT(fresh.y, 5.0f * none.y);
    EXPECT_LT(fresh.y, 1.0f / 1.34f / 1.34f);
    // However deep they are, no more comes back than came in: from a sky of 1, 1.
    for (const float gain : {1.0f, 10.0f})
        for (const float active : {0.0f, 0.5f, 1.0f}) {
            water.bubbles = gain;
            water.bubbles_m = 2.0f;
            const vec3 most =
                sea_of(even_sky(), water, {.to_eye = from(0.6), .coverage = 1.0f, .active = active}, true);
            for (int c = 0; c < 3; ++c) EXPECT_LE(most[c], 1.0f) << gain << ' ' << active;
        }
}

TEST(Water, BodysHardCasesStayFinite) {
    for (const double elevation : {-90.0, -1.0, -1e-6, 0.0, 1e-6, 0.3, 45.0, 90.0})
        for (const double depth : {1e-12, 1e-3, 1.0, 1e6, 1e9})
            for (const double chlorophyll : {0.0, 100.0})
                for (const vec3 waves :
                     {vec3(1e-10f, 1e-10f, 0.0f), vec3(0.3f, 1e-10f, 0.0f), vec3(2.0f, 2.0f, 1.999f)})
                    for (const vec3 crest : {vec3(0.0f), vec3(1e6f, -1e6f, 1e6f), vec3(0.0f, 1e-30f, -1e4f),
                                             vec3(-0.1f, -0.02f, -300.0f)})
                        for (const float bubbles_m : {0.0f, 1e-6f, 10.0f})
                            for (const double theta : {0.0, 60.0, 90.0, 120.0}) {
                                WaterBody water = body(depth, 1.0, chlorophyll);
                                water.waves = waves;
                                water.crest_light = 10.0f;
                                water.crest_per_m = bubbles_m;
                                water.bubbles = 10.0f;
                                water.bubbles_m = bubbles_m;
                                Sky sky = sunny(elevation * kDegree);
                                sky.sky_irradiance = vec3(3.0f);
                                if (elevation <= 0.0) sky.sun_irradiance = vec3(0.0f);
                                if (elevation == 90.0) sky.sun_direction = vec3(0.0f, 0.0f, 1.0f);
                                const vec3 seen = sea_of(sky, water,
                                                         {.to_eye = from(theta * kDegree),
                                                          .slope_variance = waves,
                                                          .coverage = 1.0f,
                                                          .age_s = 1e9f,
                                                          .crest = crest},
                                                         true);
                                ASSERT_TRUE(std::isfinite(seen.x + seen.y + seen.z))
                                    << elevation << ' ' << depth;
                                ASSERT_GE(std::min({seen.x, seen.y, seen.z}), 0.0f);
                                ASSERT_LT(std::max({seen.x, seen.y, seen.z}), 100.0f);
                            }
}

}  // namespace
}  // namespace pelagic::optics
