// The light of objects: energy, and irradiance whose integral is known.
#include "core/lighting/object.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <glm/geometric.hpp>
#include <random>
#include <vector>

namespace pelagic {
namespace {

constexpr double kObjectPi = 3.14159265358979;

glm::vec3 object_sight(double sine_of_elevation, double azimuth) {
    const double level = std::sqrt(1.0 - sine_of_elevation * sine_of_elevation);
    return glm::vec3(glm::dvec3(level * std::cos(azimuth), level * std::sin(azimuth), sine_of_elevation));
}

// A white furnace: a white body in light of radiance 1 from all sides sends that to any eye, however rough its varnish is. The sun goes
// through all directions: a midpoint rule.
TEST(ObjectsLight, OfWhiteBodiesIsAllThatFallsOnThem) {
    constexpr int kRows = 160, kColumns = 320;
    for (const float roughness : {0.4f, 0.7f, 1.0f})
        for (const double seen : {0.05, 0.15, 0.5, 0.95}) {
            const ObjectLook white{.colour = glm::vec3(1.0f), .roughness = roughness};
            const glm::vec3 to_eye = object_sight(seen, 0.0), normal(0.0f, 0.0f, 1.0f);
            Sky sky;
            sky.sun_angular_radius = 1e-3f;
            sky.sun_radiance = glm::vec3(static_cast<float>(1e6 / kObjectPi));  // an irradiance of 1
            double sum = 0.0;
            for (int row = 0; row < kRows; ++row)
                for (int column = 0; column < kColumns; ++column) {
                    sky.sun_direction =
                        object_sight((row + 0.5) / kRows, 2.0 * kObjectPi * (column + 0.5) / kColumns);
                    sum += static_cast<double>(object_of_sun(white, sky, to_eye, normal).y);
                }
            sum *= 2.0 * kObjectPi / (kRows * kColumns);
            const glm::vec3 round = object_of_surroundings(
                white, static_cast<float>(seen), glm::vec3(static_cast<float>(kObjectPi)), glm::vec3(1.0f));
            EXPECT_NEAR(sum, 1.0, 0.012) << roughness << ' ' << seen;
            EXPECT_NEAR(round.y, 1.0f, 1e-6f);
        }
}

// What the varnish reflects is a fit to the mean over facets, which chance finds here; and its own mean another.
TEST(ObjectsLight, OfVarnishIsTheMeanOverItsFacets) {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    constexpr int kFacets = 40000;
    double largest = 0.0;
    for (const float roughness : {0.0f, 0.25f, 0.45f, 0.65f, 0.85f, 1.0f})
        for (const float seen : {0.01f, 0.05f, 0.15f, 0.3f, 0.6f, 1.0f}) {
            const glm::vec3 to_eye(std::sqrt(1.0f - seen * seen), 0.0f, seen);
            double sum = 0.0;
            for (int i = 0; i < kFacets; ++i) {
                const float radius = std::sqrt(unit(random)), angle = 6.2831853f * unit(random);
                const glm::vec3 facet =
                    mirrored_facet(to_eye, roughness, {radius * std::cos(angle), radius * std::sin(angle)});
                ASSERT_NEAR(glm::length(facet), 1.0f, 1e-5f);
                const float facing = glm::dot(to_eye, facet), leaving = 2.0f * facing * facet.z - to_eye.z;
                if (leaving > 0.0f) sum += static_cast<double>(mirrored_by_facet(facing, leaving, roughness));
            }
            const double error =
                std::abs(sum / kFacets - static_cast<double>(object_reflectance(seen, roughness)));
            largest = std::max(largest, error);
            EXPECT_LT(error, 0.007 + 0.003) << roughness << ' ' << seen;  // the fit's, and chance's
        }
    std::printf("    the fit errs by %.4f\n", largest);
}

// A mirror shows the sun by Fresnel's part, and no more.
TEST(ObjectsLight, OfAMirrorShowsTheSunItself) {
    Sky sky;
    sky.sun_radiance = glm::vec3(1e6f);
    const ObjectLook mirror{.colour = glm::vec3(0.0f), .roughness = 0.0f};
    for (const double height : {0.01, 0.1, 0.7, 1.0}) {
        sky.sun_direction = object_sight(height, kObjectPi);
        const float shown =
            object_of_sun(mirror, sky, object_sight(height, 0.0), glm::vec3(0.0f, 0.0f, 1.0f)).y;
        EXPECT_GT(shown, 0.0f);
        EXPECT_LE(shown, 1e6f);
    }
}

// Half of a uniform sky lights a wall, all of it a deck, and what comes up to a keel is what the sea reflects.
TEST(ObjectsLight, OfAUniformSkyIsKnown) {
    Sky sky;
    sky.map = SkyMap(32, std::vector<glm::vec3>(32 * 32, glm::vec3(1.0f)));
    sky.sky_irradiance = glm::vec3(static_cast<float>(kObjectPi));
    WaterBody black;
    black.reflectance = glm::vec3(0.0f);
    const LightingChoice choice;
    const ObjectSurroundings light = object_surroundings(choice, sky, black, 0.0);
    const auto on = [&](glm::vec3 normal) {
        return static_cast<double>(object_irradiance(light, normal).y) / kObjectPi;
    };
    const double deck = on({0.0f, 0.0f, 1.0f}), wall = on({1.0f, 0.0f, 0.0f}), other = on({0.6f, 0.8f, 0.0f}),
                 keel = on({0.0f, 0.0f, -1.0f});
    std::printf("    deck %.4f, walls %.4f and %.4f, keel %.4f of the sky's\n", deck, wall, other, keel);
    EXPECT_NEAR(deck, 1.0, 0.03);
    EXPECT_NEAR(keel, 0.0675, 0.03);  // Fresnel's term over a hemisphere
    EXPECT_GT(wall, 0.5);
    EXPECT_LT(wall, 0.65);
    EXPECT_NEAR(wall, other, 0.01);
    // Foam of all the sea reflects more than black water.
    EXPECT_GT(object_irradiance(object_surroundings(choice, sky, black, 1.0), {0.0f, 0.0f, -1.0f}).y, 0.1f);
}

}  // namespace
}  // namespace pelagic
