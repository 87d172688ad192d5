// The lighting against the waves themselves: facets of a real surface, each a mirror weighted by its area
// projected towards the eye, unless another hides it (Bruneton, Neyret, Holzschuch 2010, Eq. 5 as a sum instead
// of a Gaussian). With choppy waves and several reflections: tests/bench/README.md, Fig. 10.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <memory>
#include <vector>

#include "core/evaluate/evaluate.h"
#include "core/lighting/lighting.h"
#include "core/surface/patch.h"

namespace pelagic {
namespace {

constexpr double kTile_m = 100.0;
constexpr int kPoints = 1024;

// Normals on a lattice over one tile of waves between 0.4 m and 100 m, and the spectrum's slope variance of
// those waves. Without choppiness, so that all facets have equal area at rest.
struct Facets {
    std::vector<glm::vec3> normals;
    std::vector<glm::vec3> positions_m;
    glm::vec3 slope_variance{0.0f};
};

const Facets& facets() {
    static const Facets made = [] {
        Scene scene;
        scene.sea.wind_speed_mps = 5.0;
        scene.waves.choppiness = 0.0;
        scene.waves.cascades = {{.size_m = kTile_m, .resolution = 512}};
        Query query;
        query.products = products(Product::Position, Product::Normal);
        query.lattice = Lattice{0.0, kTile_m / kPoints};
        query.only_cascade = 0;
        const auto sea = std::make_shared<const Sea<float>>(make_plan(scene, {query}));
        Frame<float> frame(sea);
        frame.set(0.0);
        const auto rest_m =
            rest_points<float>({.per_side = kPoints, .spacing_m = kTile_m / kPoints, .first_m = 0.0});
        Facets result;
        result.normals.resize(rest_m.size());
        result.positions_m.resize(rest_m.size());
        Results<float> results;
        results.set(Product::Position, {result.positions_m.data()});
        results.set(Product::Normal, {result.normals.data()});
        evaluate(frame, 0, Points<float>{.count = rest_m.size(), .rest_m = {rest_m.data()}}, results);
        const SpectralMoments shown = sea->resolved_moments(0);
        result.slope_variance = glm::vec3(shown.xx, shown.yy, shown.xy);
        return result;
    }();
    return made;
}

// Hu et al. 2006, Eq. 2.
double fresnel(double c) {
    constexpr double n = 1.34;
    const double g = std::sqrt(n * n - 1.0 + c * c), ratio = (g - c) / (g + c);
    const double along = (c * (g + c) - 1.0) / (c * (g - c) + 1.0);
    return 0.5 * ratio * ratio * (1.0 + along * along);
}

// Facets that the eye sees, along an axis of the lattice: towards +x, or with `turned` towards +y. Each row of the
// periodic tile is followed from the eye's side, twice round, under the highest line of sight so far.
std::vector<char> seen(double elevation_deg, bool turned) {
    const double rise = std::tan(elevation_deg * 3.14159265358979 / 180.0) * kTile_m / kPoints;
    std::vector<char> result(facets().normals.size());
    for (int row = 0; row < kPoints; ++row) {
        double highest = -1e9;
        for (int i = 2 * kPoints - 1; i >= 0; --i) {
            const int at = i % kPoints, index = turned ? at * kPoints + row : row * kPoints + at;
            const double line = facets().positions_m[static_cast<std::size_t>(index)].z - rise * i;
            if (i < kPoints) result[static_cast<std::size_t>(index)] = line >= highest;
            highest = std::max(highest, line);
        }
    }
    return result;
}

// The mean of `value` over the facets that face the eye, of those that `open` lists.
template <class Value>
double seen_mean(glm::vec3 to_eye, const std::vector<char>& open, Value&& value) {
    double sum = 0.0, area = 0.0;
    for (std::size_t i = 0; i < open.size(); ++i) {
        const glm::vec3 normal = facets().normals[i];
        const float cosine = glm::dot(to_eye, normal);
        if (!open[i] || cosine <= 0.0f) continue;
        const double share = static_cast<double>(cosine / normal.z);
        area += share;
        sum += share * value(normal, static_cast<double>(cosine));
    }
    return sum / area;
}

glm::vec3 direction(double elevation_deg, double azimuth_deg) {
    const double elevation = elevation_deg * 3.14159265358979 / 180.0;
    const double azimuth = azimuth_deg * 3.14159265358979 / 180.0;
    return {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
            std::sin(elevation)};
}

SeaRadiance shaded(const Sky& sky, const SeaPoint& point) {
    SeaRadiance radiance;
    shade_sea({.whitecaps = false, .sky_quality = SkyQuality::One}, sky, {.reflectance = glm::vec3(0.05f)},
              {&point, 1}, {&radiance, 1});
    return radiance;
}

// One tile's variance is within 5 % of the spectrum's. That changes 1 − F̄ by 0.7 % (at grazing, its
// logarithm changes by 0.14 times the variance's). The fit of F̄ is accurate to 0.006. Water that is seen in other
// waves adds up to 0.025, which these facets don't have, and waves of few octaves without choppiness hide fewer of the grazing
// facets than kNested counts, which is up to 0.02.
TEST(LightingReference, RefractedLightIsThatOfTheFacetsSeen) {
    const Sky sky = daylight_sky({});
    // Seen straight down on a mirror F is known, so this gives the radiance from the water.
    const float from_below = shaded(sky, {}).sea.y / static_cast<float>(1.0 - fresnel(1.0));
    for (const double elevation_deg : {1.0, 2.0, 5.0, 15.0, 40.0})
        for (const bool turned : {false, true}) {
            const glm::vec3 to_eye = direction(elevation_deg, turned ? 90.0 : 0.0);
            const double expected = seen_mean(to_eye, seen(elevation_deg, turned),
                                              [](glm::vec3, double cosine) { return 1.0 - fresnel(cosine); });
            const double got = static_cast<double>(
                shaded(sky, {.to_eye = to_eye, .slope_variance = facets().slope_variance}).sea.y /
                from_below);
            EXPECT_GT(got, expected - 0.02) << "elevation " << elevation_deg << (turned ? ", towards y" : "");
            EXPECT_LT(got, expected + 0.045)
                << "elevation " << elevation_deg << (turned ? ", towards y" : "");
        }
}

// A wide sun, so that some 1e4 facets of the tile mirror it, in patches of some ten: 3 %. The variance's 5 %
// enters twice, at 1 σ from the centre. A high sun, so that no wave shades it.
TEST(LightingReference, SunIsThatOfTheFacetsSeen) {
    Sky sky = daylight_sky({.sun_elevation_deg = 50.0, .sun_azimuth_deg = 0.0});
    sky.sun_angular_radius = 0.03f;
    for (const double elevation_deg : {35.0, 45.0, 60.0}) {
        const glm::vec3 to_eye = direction(elevation_deg, 180.0);
        const std::vector<char> all(facets().normals.size(), 1);
        const double share = seen_mean(to_eye, all, [&](glm::vec3 normal, double cosine) {
            const glm::vec3 mirrored = 2.0f * static_cast<float>(cosine) * normal - to_eye;
            return glm::length(mirrored - sky.sun_direction) < sky.sun_angular_radius ? fresnel(cosine) : 0.0;
        });
        const float got = shaded(sky, {.to_eye = to_eye, .slope_variance = facets().slope_variance}).sun.y;
        EXPECT_NEAR(static_cast<double>(got / sky.sun_radiance.y) / share, 1.0, 0.1)
            << "elevation " << elevation_deg;
    }
}

}  // namespace
}  // namespace pelagic
