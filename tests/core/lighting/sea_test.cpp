// All terms together: their shares, variants, hard cases, and the batch interface of C++.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <stdexcept>
#include <vector>

#include "core/lighting/lighting.h"
#include "tests/core/lighting/optics.h"

namespace pelagic::optics {
namespace {

// A sky with a sun and a varied map.
Sky test_sky() {
    constexpr int kSide = 64;
    std::vector<vec3> texels(kSide * kSide);
    for (int j = 0; j < kSide; ++j)
        for (int i = 0; i < kSide; ++i) {
            const float x = (static_cast<float>(i) + 0.5f) / kSide - 0.5f,
                        y = (static_cast<float>(j) + 0.5f) / kSide - 0.5f;
            const bool above = x * x + y * y < 0.16f;
            texels[static_cast<std::size_t>(j * kSide + i)] =
                above ? vec3(2.0f + x, 3.0f + y, 4.0f - x) : vec3(0.2f, 0.25f, 0.3f);
        }
    Sky sky;
    sky.map = SkyMap(kSide, texels);
    sky.sun_direction = normalize(vec3(0.3f, 0.8f, 0.4f));
    sky.sun_radiance = vec3(1.6e6f, 1.5e6f, 1.3e6f);
    sky.sun_irradiance = vec3(46.0f, 43.0f, 37.0f);
    sky.sky_irradiance = vec3(7.0f, 9.0f, 12.0f);
    return sky;
}

const WaterBody kWaterBody{vec3(0.001f, 0.012f, 0.05f)};

std::vector<SeaPoint> random_points(int count) {
    Inputs inputs(40);
    std::vector<SeaPoint> points;
    for (int i = 0; i < count; ++i) {
        points.push_back({.to_eye = inputs.direction(1e-4),
                          .normal = inputs.direction(0.5),
                          .slope_variance = inputs.variance(1e-3, 0.4, 0.8),
                          .coverage = static_cast<float>(inputs.uniform(0.0, 1.0))});
    }
    return points;
}

std::vector<SeaRadiance> shaded(const LightingChoice& choice, const Sky& sky,
                                const std::vector<SeaPoint>& points) {
    std::vector<SeaRadiance> radiance(points.size());
    shade_sea(choice, sky, kWaterBody, points, radiance);
    return radiance;
}

template <class Function>
void for_all_choices(Function&& f) {
    for (SkyQuality quality : {SkyQuality::One, SkyQuality::Nine, SkyQuality::Integral})
        for (FresnelFit fresnel : {FresnelFit::Paper, FresnelFit::Exact})
            for (unsigned terms = 0; terms < 16; ++terms)
                f(LightingChoice{.sun = (terms & 1) != 0,
                                 .sky = (terms & 2) != 0,
                                 .water = (terms & 4) != 0,
                                 .whitecaps = (terms & 8) != 0,
                                 .sky_quality = quality,
                                 .fresnel = fresnel});
}

// A term has the same bits whichever other terms are on, and is black when off. Only whitecaps reduce the
// others.
TEST(Sea, VariantsAreTheSameTermsLeftOut) {
    const Sky sky = test_sky();
    std::vector<SeaPoint> points = random_points(20);
    for (SeaPoint& p : points) p.coverage = 0.0f;
    for_all_choices([&](const LightingChoice& choice) {
        LightingChoice all = choice;
        all.sun = all.sky = all.water = all.whitecaps = true;
        const std::vector<SeaRadiance> found = shaded(choice, sky, points),
                                       expected = shaded(all, sky, points);
        for (std::size_t i = 0; i < points.size(); ++i) {
            EXPECT_EQ(found[i].sun, choice.sun ? expected[i].sun : vec3(0.0f));
            EXPECT_EQ(found[i].sky, choice.sky ? expected[i].sky : vec3(0.0f));
            EXPECT_EQ(found[i].sea, choice.water ? expected[i].sea : vec3(0.0f));
            EXPECT_EQ(found[i].foam, vec3(0.0f));
        }
    });
}

// The batch gives the results of the shared source with the map's lookups, independently for each point.
TEST(Sea, BatchIsTheSharedSource) {
    const Sky sky = test_sky();
    const std::vector<SeaPoint> points = random_points(300);
    for (SkyQuality quality : {SkyQuality::One, SkyQuality::Nine, SkyQuality::Integral})
        for (FresnelFit fresnel : {FresnelFit::Paper, FresnelFit::Exact}) {
            Optics optics;
            optics.lookup = [&](vec2 u, float level) { return sky.map.radiance(u, level); };
            optics.kSkyMapSize = static_cast<float>(sky.map.size());
            optics.kSkyLookups = quality == SkyQuality::One ? 1 : quality == SkyQuality::Nine ? 9 : 0;
            optics.kExactFresnel = fresnel == FresnelFit::Exact;
            const Optics::SeaLight light{sky.sun_direction,
                                         sky.sun_radiance,
                                         sky.sun_angular_radius,
                                         sky.sun_irradiance,
                                         sky.sky_irradiance,
                                         plain_water(kWaterBody.reflectance),
                                         {}};
            const std::vector<SeaRadiance> found =
                shaded({.sky_quality = quality, .fresnel = fresnel}, sky, points);
            for (std::size_t i = 0; i < points.size(); ++i) {
                const SeaPoint& p = points[i];
                const auto expected = optics.sea_radiance(p.to_eye, p.normal, p.slope_variance,
                                                          {0.4f * p.coverage, 0.55f, 0.0f},
                                                          optics.no_crest_nor_bubbles(), light);
                // Other compiler flags and order of summation: a few units in the last place.
                for (int c = 0; c < 3; ++c) {
                    EXPECT_NEAR(found[i].sun[c], expected.sun[c], 1e-4f * expected.sun[c] + 1e-5f);
                    EXPECT_NEAR(found[i].sky[c], expected.sky[c], 1e-4f * expected.sky[c] + 1e-6f);
                    EXPECT_NEAR(found[i].sea[c], expected.sea[c], 1e-4f * expected.sea[c] + 1e-7f);
                    EXPECT_NEAR(found[i].foam[c], expected.foam[c], 1e-4f * expected.foam[c] + 1e-6f);
                }
                SeaRadiance alone;
                shade_sea({.sky_quality = quality, .fresnel = fresnel}, sky, kWaterBody, {&p, 1},
                          {&alone, 1});
                EXPECT_EQ(alone.sky, found[i].sky);
                EXPECT_EQ(alone.sun, found[i].sun);
            }
        }
}

// Foam replaces the other terms: with coverage w, of which foam hides d, they are 1 − d·w of their values without foam, at any angle. Waves
// hide foam as they hide the water between.
TEST(Sea, SharesAddUpToThePixel) {
    const Sky sky = test_sky();
    std::vector<SeaPoint> clear = random_points(1000), white = clear, covered = clear;
    for (SeaPoint& p : clear) p.coverage = 0.0f;
    for (SeaPoint& p : covered) p.coverage = 1.0f;
    const std::vector<SeaRadiance> none = shaded({}, sky, clear), some = shaded({}, sky, white),
                                   all = shaded({}, sky, covered);
    for (std::size_t i = 0; i < clear.size(); ++i) {
        const float share = 1.0f - 0.4f * white[i].coverage;
        for (int c = 0; c < 3; ++c) {
            EXPECT_NEAR(some[i].sun[c], share * none[i].sun[c], 1e-4f * none[i].sun[c]);
            EXPECT_NEAR(some[i].sky[c], share * none[i].sky[c], 1e-4f * none[i].sky[c]);
            EXPECT_NEAR(some[i].sea[c], share * none[i].sea[c], 1e-4f * none[i].sea[c]);
        }
        EXPECT_EQ(none[i].foam, vec3(0.0f));
        EXPECT_GT(some[i].foam.x, 0.0f);
        EXPECT_NEAR(all[i].sky.x, 0.6f * none[i].sky.x, 1e-4f * none[i].sky.x);
    }
}

// Reflected light and light from the water share one F̄: under a sky of radiance 1 over water of radiance 1
// the sum is 1. The nine lookups have their own F̄, which differs from the water's by the fit's error
// and that of reflected_again() (0.035 for slopes that are correlated and of very different size).
TEST(Sea, ReflectedAndRefractedShareTheLight) {
    Optics optics;
    optics.kWhitecaps = false;
    Inputs inputs(41);
    for (int lookups : {1, 9, 0}) {
        optics.kSkyLookups = lookups;
        for (int i = 0; i < 1000; ++i) {
            const vec3 v = inputs.direction(1e-3), s = inputs.variance(1e-3, 0.4, 0.5);
            const auto terms = optics.sea_radiance(v, vec3(0.0f, 0.0f, 1.0f), s, optics.no_foam(),
                                                   optics.no_crest_nor_bubbles(),
                                                   {vec3(0.0f, 0.0f, -1.0f),
                                                    vec3(0.0f),
                                                    0.00465f,
                                                    vec3(0.0f),
                                                    vec3(1.0f),
                                                    plain_water(vec3(0.1f)),
                                                    {}});
            const vec3 from_water =
                optics.water_radiance(vec3(0.0f, 0.0f, -1.0f), vec3(0.0f), vec3(1.0f), vec3(0.1f));
            EXPECT_NEAR(terms.sky.x + terms.sea.x / from_water.x, 1.0f, lookups == 1 ? 1e-5f : 0.035f)
                << lookups;
        }
    }
}

// Waves mirror other waves, and in them the sun. Seen 80° from above with the sun behind the eye, facets that mirror
// it directly are rare, and more light comes by way of two.
TEST(Sea, WavesMirrorTheSunInOtherWaves) {
    Optics optics;
    optics.kWhitecaps = optics.kSky = optics.kWater = false;
    const double theta = 80.0 * oracle::kPi / 180.0;
    const vec3 v(dvec3(std::sin(theta), 0.0, std::cos(theta))), up(0.0f, 0.0f, 1.0f), s(0.02f, 0.02f, 0.0f);
    const vec3 ahead = normalize(vec3(-0.9f, 0.0f, 0.42f));
    const auto frame = optics.slope_frame(up, s);
    const auto shown = [&](vec3 l) {
        const auto terms = optics.sea_radiance(
            v, up, s, optics.no_foam(), optics.no_crest_nor_bubbles(),
            {l, vec3(1.0f), 0.00465f, vec3(0.0f), vec3(0.0f), plain_water(vec3(0.0f)), {}});
        return terms.sun.x / optics.sun_reflection(v, l, frame, vec3(1.0f), 0.00465f).x;
    };
    EXPECT_GT(shown(ahead), 1.01f);
    EXPECT_LT(shown(ahead), 1.15f);
}

TEST(Sea, HardCasesStayFinite) {
    Sky sky = test_sky();
    const vec3 up(0.0f, 0.0f, 1.0f), side(1.0f, 0.0f, 0.0f), grazing = normalize(vec3(0.0f, 1.0f, 1e-7f));
    std::vector<SeaPoint> points;
    for (const vec3 v : {up, side, grazing, -up, sky.sun_direction, -sky.sun_direction})
        for (const vec3 n : {up, side, grazing, -up, normalize(vec3(0.0f, -1.0f, 1.0f)), sky.sun_direction})
            for (const vec3 s : {vec3(0.0f), vec3(1e-40f, 0.0f, 0.0f), vec3(1.0f, 1e-6f, 0.0f),
                                 vec3(0.1f, 0.1f, 0.1f), vec3(1e9f, 1e9f, 0.0f)})
                for (float w : {0.0f, 1e-30f, 1.0f, 2.0f})
                    points.push_back({.to_eye = v, .normal = n, .slope_variance = s, .coverage = w});
    for (const vec3 sun : {sky.sun_direction, up, side, normalize(vec3(1.0f, 0.0f, -1e-6f)), -up}) {
        sky.sun_direction = sun;
        for (int i = 0; i < 6; ++i) {
            const LightingChoice choice{.sky_quality = SkyQuality(i / 2), .fresnel = FresnelFit(i % 2)};
            for (const SeaRadiance& r : shaded(choice, sky, points))
                for (const vec3 term : {r.sun, r.sky, r.sea, r.foam}) {
                    const float sum = term.x + term.y + term.z;
                    ASSERT_TRUE(std::isfinite(sum) && std::min({term.x, term.y, term.z}) >= 0.0f);
                }
        }
    }
}

TEST(Sea, RefusesWhatCannotBeShaded) {
    std::vector<SeaPoint> points(2);
    std::vector<SeaRadiance> radiance(1);
    EXPECT_THROW(shade_sea({}, test_sky(), kWaterBody, points, radiance), std::invalid_argument);
    radiance.resize(2);
    EXPECT_THROW(shade_sea({}, Sky(), kWaterBody, points, radiance), std::invalid_argument);
    EXPECT_NO_THROW(shade_sea({.sky = false}, Sky(), kWaterBody, points, radiance));
}

}  // namespace
}  // namespace pelagic::optics
