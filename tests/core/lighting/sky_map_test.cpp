// The stereographic map: levels, lookup, projection, and baking.
#include "core/lighting/sky_map.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <limits>
#include <random>
#include <stdexcept>
#include <vector>

#include "core/base/constants.h"
#include "core/lighting/sky_bake.h"

namespace pelagic {
namespace {

std::vector<glm::vec3> noise(int size) {
    std::mt19937 generator(3);
    std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
    std::vector<glm::vec3> texels(static_cast<std::size_t>(size) * static_cast<std::size_t>(size));
    for (glm::vec3& texel : texels) texel = {uniform(generator), uniform(generator), uniform(generator)};
    return texels;
}

// The centre of a texel of a level.
glm::vec2 middle(const SkyMap& map, int level, int i, int j) {
    const float texel = 2.0f * kSkyMapExtent / static_cast<float>(map.size() >> level);
    return glm::vec2(-kSkyMapExtent) +
           texel * glm::vec2(static_cast<float>(i) + 0.5f, static_cast<float>(j) + 0.5f);
}

TEST(SkyMap, LevelsAreMeansDownToTheMeanOfAll) {
    const SkyMap map(16, noise(16));
    ASSERT_EQ(map.level_count(), 5);
    glm::dvec3 mean(0.0);
    for (const glm::vec3& texel : map.level(0)) mean += glm::dvec3(texel) / 256.0;
    ASSERT_EQ(map.level(4).size(), 1u);
    // Sums of 256 numbers below 1 in single precision.
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(static_cast<double>(map.level(4)[0][c]), mean[c], 1e-6);
    // A texel of a middle level: second row, third column of level 1.
    const auto& fine = map.level(0);
    const float sum = fine[2 * 16 + 4].x + fine[2 * 16 + 5].x + fine[3 * 16 + 4].x + fine[3 * 16 + 5].x;
    EXPECT_FLOAT_EQ(map.level(1)[1 * 8 + 2].x, 0.25f * sum);
}

TEST(SkyMap, LookupIsTrilinear) {
    const SkyMap map(16, noise(16));
    constexpr float kTolerance = 4e-6f;  // rounds a texel's centre to 1e-6 of a texel
    for (int level = 1; level < 4; ++level) {
        const int n = 16 >> level;
        const auto& texels = map.level(level);
        const auto at = [&](int i, int j) { return texels[static_cast<std::size_t>(j * n + i)].y; };
        const glm::vec2 a = middle(map, level, 0, 1), b = middle(map, level, 1, 1),
                        c = middle(map, level, 0, 0);
        const auto l = static_cast<float>(level);
        EXPECT_NEAR(map.radiance(a, l).y, at(0, 1), kTolerance);
        EXPECT_NEAR(map.radiance(0.75f * a + 0.25f * b, l).y, 0.75f * at(0, 1) + 0.25f * at(1, 1),
                    kTolerance);
        EXPECT_NEAR(map.radiance(0.75f * a + 0.25f * c, l).y, 0.75f * at(0, 1) + 0.25f * at(0, 0),
                    kTolerance);
        const glm::vec2 u(0.3f, -0.7f);
        EXPECT_NEAR(map.radiance(u, l + 0.25f).y,
                    0.75f * map.radiance(u, l).y + 0.25f * map.radiance(u, l + 1.0f).y, kTolerance);
    }
}

// The finest level has no kinks: the slope changes from one step to the next by no more than the curvature of a
// quadratic spline allows, where a bilinear lookup's jumps at each texel. It stays between its neighbours.
TEST(SkyMap, SharpLookupIsSmooth) {
    const SkyMap map(32, noise(32));
    constexpr float kTexel = 2.0f * kSkyMapExtent / 32.0f, kStep = 0.02f;  // of a texel
    const auto slopes_change = [&](const auto& lookup) {
        float most = 0.0f;
        for (int k = 0; k < 500; ++k) {
            const auto at = [&](int i) {
                return lookup(glm::vec2(-0.4f, -0.5f) +
                              kTexel * kStep * glm::vec2(1.0f, 0.3f) * static_cast<float>(k + i))
                    .y;
            };
            most = std::max(most, std::abs(at(2) - 2.0f * at(1) + at(0)) / kStep);
        }
        return most;
    };
    // Texels are 0 … 1: second differences of the coefficients are at most 4.
    EXPECT_LT(slopes_change([&](glm::vec2 u) { return map.radiance(u, 0.0f); }), 6.0f * kStep);
    EXPECT_GT(slopes_change([&](glm::vec2 u) { return map.trilinear(u, 0.0f); }), 10.0f * kStep);
    // Into level 1 it passes without a step.
    const glm::vec2 u(0.3f, -0.2f);
    EXPECT_NEAR(map.radiance(u, 0.9999f).y, map.radiance(u, 1.0f).y, 1e-4f);
    EXPECT_NEAR(map.radiance(u, 0.0001f).y, map.radiance(u, 0.0f).y, 1e-4f);
}

TEST(SkyMap, LookupIsClampedToEdgesAndLevels) {
    const SkyMap map(8, noise(8));
    const glm::vec3 corner = map.level(0)[0], last = map.level(3)[0];
    const float inf = std::numeric_limits<float>::infinity();
    EXPECT_EQ(map.radiance({-kSkyMapExtent, -kSkyMapExtent}, 0.0f), corner);
    EXPECT_EQ(map.radiance({-1e30f, -inf}, -5.0f), corner);
    EXPECT_EQ(map.radiance({0.1f, 0.2f}, 3.0f), last);
    EXPECT_EQ(map.radiance({0.1f, 0.2f}, inf), last);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_TRUE(std::isfinite(map.radiance({nan, 0.0f}, nan).x));
}

TEST(SkyMap, RefusesWhatIsNoMap) {
    EXPECT_THROW(SkyMap(6, std::vector<glm::vec3>(36)), std::invalid_argument);
    EXPECT_THROW(SkyMap(2, std::vector<glm::vec3>(4)), std::invalid_argument);
    EXPECT_THROW(SkyMap(8, std::vector<glm::vec3>(63)), std::invalid_argument);
    for (const float wrong :
         {-1.0f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        std::vector<glm::vec3> texels(64, glm::vec3(1.0f));
        texels[17].z = wrong;
        try {
            const SkyMap map(8, texels);
            FAIL() << wrong;
        } catch (const std::invalid_argument& error) {
            EXPECT_NE(std::string(error.what()).find("(1, 2)"), std::string::npos) << error.what();
        }
    }
}

TEST(SkyMap, ProjectionAndItsInverse) {
    // The horizon is the unit circle, the zenith the middle.
    EXPECT_EQ(sky_map_place({0.0f, 0.0f, 1.0f}), glm::vec2(0.0f));
    EXPECT_EQ(sky_map_place({0.0f, 1.0f, 0.0f}), glm::vec2(0.0f, 1.0f));
    for (float x = -1.2f; x <= 1.2f; x += 0.3f)
        for (float y = -1.2f; y <= 1.2f; y += 0.3f) {
            const glm::vec3 direction = sky_map_direction({x, y});
            // A few roundings of numbers near 1, amplified by 1/(1 + r_z) ≤ 2 below the horizon.
            EXPECT_NEAR(glm::length(direction), 1.0f, 1e-6f);
            EXPECT_LT(glm::length(sky_map_place(direction) - glm::vec2(x, y)), 2e-6f);
        }
    // Far below the horizon all places are at the edge, including the pole's.
    for (const glm::vec3 down :
         {glm::vec3(0.0f, 0.0f, -1.0f), glm::vec3(1e-20f, 0.0f, -1.0f), glm::vec3(-0.6f, 0.0f, -0.8f)}) {
        const glm::vec2 u = sky_map_place(down);
        EXPECT_FLOAT_EQ(std::max(std::abs(u.x), std::abs(u.y)), kSkyMapExtent);
    }
}

SkyDome uniform_dome(float radiance) {
    return {[=](glm::vec3) { return glm::vec3(radiance); }, [](glm::vec3, float) { return 1; }};
}

TEST(SkyBake, UniformSkyOfOneGivesPi) {
    // The largest error is from texels on the horizon: their area is known to 1/8², their cosine is below 2
    // du.
    for (const int size : {64, 256}) {
        const BakedSky baked = bake_sky_map(size, uniform_dome(1.0f));
        EXPECT_NEAR(static_cast<double>(baked.irradiance.x), kPi, 1e-3) << size;
    }
}

TEST(SkyBake, IrradianceIsWeightedWithTheCosine) {
    // L = cosθ: ∫ cos²θ dω = 2π/3.
    SkyDome dome = uniform_dome(0.0f);
    dome.radiance = [](glm::vec3 direction) { return glm::vec3(direction.z); };
    EXPECT_NEAR(static_cast<double>(bake_sky_map(128, dome).irradiance.y), kTwoPi / 3.0, 1e-3);
}

TEST(SkyBake, BelowTheHorizonTheSeaReflectsTheSky) {
    const BakedSky baked = bake_sky_map(256, uniform_dome(2.0f));
    // A uniform sky has L = E/π. Below the horizon it is diffuse_fresnel() times as bright.
    EXPECT_NEAR(baked.map.radiance({1.2f, 1.2f}, 0.0f).y, 2.0f * diffuse_fresnel(), 1e-4f);
    EXPECT_NEAR(baked.map.radiance({0.0f, -1.1f}, 0.0f).y, 2.0f * diffuse_fresnel(), 1e-4f);
    EXPECT_FLOAT_EQ(baked.map.radiance({0.0f, 0.9f}, 0.0f).y, 2.0f);
    // The mean of the whole map is that of the areas: π of 6.25 is sky. 8 × 8 samples at the horizon give it
    // to 1e-4; an edge without antialiasing would be off by parts of texels.
    const float sky = static_cast<float>(kPi) / (4.0f * kSkyMapExtent * kSkyMapExtent);
    EXPECT_NEAR(baked.map.radiance({0.0f, 0.0f}, 8.0f).y, 2.0f * (sky + (1.0f - sky) * diffuse_fresnel()),
                4e-4f);
}

// The finest level goes on past the horizon as the sky comes to it, so that the sky down to the horizon is the dome's.
TEST(SkyBake, TheSkyIsTheDomesDownToTheHorizon) {
    SkyDome dome = uniform_dome(0.0f);
    dome.radiance = [](glm::vec3 d) { return glm::vec3(2.0f - 1.5f * d.z + 0.3f * d.x, 1.0f + d.z, 0.5f); };
    const BakedSky baked = bake_sky_map(128, dome);
    for (int azimuth = 0; azimuth < 360; azimuth += 3)
        for (const double elevation : {0.0, 0.1, 0.3, 0.6, 1.0, 2.0, 5.0, 20.0}) {
            const double a = azimuth * kPi / 180.0, e = elevation * kPi / 180.0;
            const glm::vec3 d(glm::dvec3(std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e)));
            const glm::vec3 seen = baked.map.open_radiance(sky_map_place(d)), expected = dome.radiance(d);
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(seen[c], expected[c], 2e-3f) << azimuth << ' ' << elevation;
        }
}

// One value a texel gives what 64 samples give, on all levels, with an aureole 11° wide and a steep rise towards the horizon.
TEST(SkyBake, OfASmoothSkyIsThatOfManySamples) {
    SkyDome dome = uniform_dome(0.0f);
    dome.radiance = [](glm::vec3 d) {
        const float off = glm::dot(d, glm::normalize(glm::vec3(0.6f, 0.2f, 0.3f)));
        return glm::vec3(0.1f + 0.2f / std::pow(1.64f - 1.6f * off, 1.5f), std::exp(-12.0f * d.z), 1.0f);
    };
    dome.samples = [](glm::vec3, float) { return 8; };
    const BakedSky expected = bake_sky_map(256, dome);
    std::atomic<int> asked = 0;
    const BakedSky baked = bake_smooth_sky_map(256, [&](glm::vec3 direction) {
        ++asked;
        return dome.radiance(direction);
    });
    EXPECT_LT(asked, 40000);  // of 256² texels 33 000 are sky
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(baked.irradiance[c] / expected.irradiance[c], 1.0f, c == 1 ? 2e-3f : 2e-4f) << c;
    for (int level = 0; level < baked.map.level_count(); ++level)
        for (std::size_t i = 0; i < baked.map.level(level).size(); ++i)
            for (int c = 0; c < 3; ++c) {
                const float is = baked.map.level(level)[i][c], many = expected.map.level(level)[i][c];
                // The finest level isn't of means, and bends past the horizon.
                ASSERT_NEAR(is, many, level == 0 ? 0.05f * many + 1e-3f : 2e-3f * many)
                    << level << ' ' << i << ' ' << c;
            }
    for (const glm::vec3 d :
         {glm::vec3(0.6f, 0.2f, 0.3f), glm::vec3(0.0f, 0.0f, 1.0f), glm::vec3(-1.0f, 0.4f, 0.02f)}) {
        const glm::vec3 to = glm::normalize(d), expects = dome.radiance(to);
        const glm::vec3 seen = baked.map.open_radiance(sky_map_place(to));
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(seen[c], expects[c], 2e-3f * expects[c]) << d.x << ' ' << c;
    }
}

TEST(SkyBake, TexelsThatTheHorizonCrossesAreMixedByArea) {
    constexpr int kSize = 16, kParts = 64;
    const BakedSky baked = bake_sky_map(2 * kSize, uniform_dome(1.0f));
    const double below = static_cast<double>(baked.map.radiance(glm::vec2(1.25f), 0.0f).x);
    const double side = 2.5 / kSize;
    for (int j = 0; j < kSize; ++j)
        for (int i = 0; i < kSize; ++i) {
            int inside = 0;
            for (int b = 0; b < kParts; ++b)
                for (int a = 0; a < kParts; ++a)
                    inside += std::hypot(side * (i + (a + 0.5) / kParts) - 1.25,
                                         side * (j + (b + 0.5) / kParts) - 1.25) < 1.0;
            const double share = static_cast<double>(inside) / (kParts * kParts);
            // 8 × 8 samples: an edge through the texel is off by less than half a row.
            EXPECT_NEAR(static_cast<double>(baked.map.level(1)[static_cast<std::size_t>(j * kSize + i)].x),
                        share + (1.0 - share) * below, 0.5 / 8.0)
                << i << " " << j;
        }
}

TEST(SkyBake, DiffuseFresnelIsTheIntegralOfTheExactTerm) {
    constexpr double n = 1.34;  // sea water
    constexpr int kSteps = 20000;
    double sum = 0.0;
    for (int i = 0; i < kSteps; ++i) {
        // ∫ F 2 c dc with c = cosθ, from Snell's law and Fresnel's two amplitudes.
        const double c = (i + 0.5) / kSteps, t = std::sqrt(1.0 - (1.0 - c * c) / (n * n));
        const double s = (c - n * t) / (c + n * t), p = (t - n * c) / (t + n * c);
        sum += 0.5 * (s * s + p * p) * 2.0 * c / kSteps;
    }
    EXPECT_NEAR(static_cast<double>(diffuse_fresnel()), sum, 1e-5);
}

}  // namespace
}  // namespace pelagic
