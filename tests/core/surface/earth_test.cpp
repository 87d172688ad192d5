// The sea on the earth's sphere: the map from the flat sea, what an eye sees of it, and the projected grid there.
#include "core/surface/earth.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

#include "core/surface/earth_view.h"
#include "core/surface/projected_grid.h"
#include "core/surface/rest_surface.h"
#include "core/surface/view.h"

namespace pelagic {
namespace {

constexpr glm::dvec3 kCentre(0.0, 0.0, -kEarthRadius_m);
constexpr std::array kHeights_m{0.5, 2.0, 4.0, 30.0, 100.0, 1e3, 8e3, 100e3, 400e3};

TEST(Earth, KeepsDistancesAzimuthsAndHeights) {
    for (const double s : {0.0, 1e-3, 1.0, 500.0, 7e3, 3e5, 2e6, 5e6})
        for (const double azimuth : {0.0, 1.0, 4.0})
            for (const double z : {-5.0, 0.0, 12.0}) {
                const glm::dvec2 flat = s * glm::dvec2(std::cos(azimuth), std::sin(azimuth));
                const glm::dvec3 p = on_earth(glm::dvec3(flat, z), kEarthCurvature_per_m);
                EXPECT_NEAR(glm::length(p - kCentre), kEarthRadius_m + z, 1e-6 + 1e-10 * s);
                EXPECT_LT(glm::length(from_earth(p, kEarthCurvature_per_m) - glm::dvec3(flat, z)),
                          1e-6 + 1e-9 * s);
                const double turn = std::atan2(std::hypot(p.x, p.y), p.z + kEarthRadius_m);
                EXPECT_NEAR(turn * kEarthRadius_m, s, 1e-6 + 1e-9 * s);
                if (s > 0.0) {
                    EXPECT_NEAR(std::remainder(std::atan2(p.y, p.x) - azimuth, kTwoPi), 0.0, 1e-12);
                }
                const glm::dvec3 up = earth_up(flat, kEarthCurvature_per_m);
                EXPECT_NEAR(glm::dot(up, glm::normalize(p - kCentre)), 1.0, 1e-9);
                EXPECT_NEAR(glm::length(up), 1.0, 1e-9);
                EXPECT_NEAR(glm::dot(from_level({0.0, 0.0, 1.0}, up), up), 1.0, 1e-9);
                EXPECT_EQ(on_earth(glm::dvec3(flat, z), 0.0), glm::dvec3(flat, z));  // to the last bit
                EXPECT_EQ(earth_up(flat, 0.0), glm::dvec3(0.0, 0.0, 1.0));
            }
}

// A ray from the eye meets the flat sea and the sphere where the one is said to see the other.
TEST(Earth, IsSeenWhereItsRaysMeetIt) {
    for (const double height_m : kHeights_m) {
        const EarthView earth(height_m, kEarthCurvature_per_m, 0.0);
        const double dip = std::acos(kEarthRadius_m / (kEarthRadius_m + height_m));
        EXPECT_NEAR(earth.horizon_m(), kEarthRadius_m * dip, 1e-6 * earth.horizon_m() + 0.05);
        for (const double part : {0.001, 0.1, 0.5, 0.9, 0.999}) {
            const double arc_m = part * earth.horizon_m(), flat_m = earth.flat_of(arc_m);
            EXPECT_NEAR(earth.arc_of(flat_m), arc_m, 1e-6 * earth.horizon_m());
            const glm::dvec3 way =
                on_earth({arc_m, 0.0, 0.0}, kEarthCurvature_per_m) - glm::dvec3(0.0, 0.0, height_m);
            EXPECT_NEAR(std::atan2(-way.z, way.x), std::atan2(height_m, flat_m), 1e-9);
        }
        EXPECT_EQ(earth.arc_of(1e15), earth.farthest_m());
    }
    const EarthView flat(4.0, 0.0, 10.0);
    EXPECT_EQ(flat.arc_of(1234.5), 1234.5);
    EXPECT_EQ(flat.flat_of(1234.5), 1234.5);
}

View looking(double height_m, double elevation, double fov_deg) {
    Camera camera;
    camera.resolution = {640, 360};
    camera.fov_deg = fov_deg;
    camera.position_m = {1e5, -2e5, height_m};
    camera.look_at_m =
        camera.position_m +
        height_m * glm::dvec3(0.6 * std::cos(elevation), 0.8 * std::cos(elevation), std::sin(elevation));
    return view_at(camera, 1);
}

ProjectedGridOptions options_of(double crest_m) {
    return {.cell_px = 4.0,
            .bounds = {.height_m = crest_m, .reach_m = crest_m},
            .significant_height_m = crest_m / 1.5,
            .curvature_per_m = kEarthCurvature_per_m};
}

// Without refraction: arccos(R/(R + h)) below the horizontal. On a flat sea it is none.
TEST(Earth, GivesTheGridsHorizonItsDip) {
    for (const double crest_m : {0.0, 6.0})
        for (const double height_m : kHeights_m) {
            const double dip = std::acos(kEarthRadius_m / (kEarthRadius_m + height_m));
            const View view = looking(height_m, -dip, 40.0);
            const ProjectedGrid grid = projected_grid(view, options_of(crest_m));
            double highest = -kPi;
            for (const glm::vec2& rest : grid.rest_m) {
                const glm::dvec3 p = on_earth(glm::dvec3(glm::dvec2(rest), 0.0), grid.curvature_per_m);
                ASSERT_TRUE(std::isfinite(p.x + p.y + p.z));
                highest = std::max(highest, std::atan2(p.z - height_m, std::hypot(p.x, p.y)));
            }
            EXPECT_NEAR((highest + dip) / view.pixel_tangent(), 0.0, 0.05) << height_m << " " << crest_m;
        }
}

// A planet's points rest about the origin. On its sphere they are those that the camera's own grid has over its nadir.
TEST(Planet, IsTheCamerasGridOnOneSphere) {
    for (const double away_m : {0.0, 40.0, 300e3, 3000e3}) {
        Scene scene;
        scene.camera.resolution = {160, 90};
        scene.surface.kind = SurfaceKind::Planet;
        const glm::dvec2 place_m = away_m * glm::dvec2(0.8, -0.6);
        const glm::dvec3 up = earth_up(place_m, kEarthCurvature_per_m);
        scene.camera.position_m = on_earth(glm::dvec3(place_m, 100.0), kEarthCurvature_per_m);
        scene.camera.look_at_m = scene.camera.position_m + 1e3 * from_level(glm::dvec3(0.6, 0.79, -0.05), up);
        const Extent extent{.height_m = 2.0, .reach_m = 2.0, .significant_height_m = 1.0, .unresolved = {}};
        const auto planet = make_surface(scene, extent);
        RestPoints<double> points;
        planet->points_at(1, points);
        EXPECT_EQ(points.touches_at_m, glm::dvec2(0.0));
        EXPECT_NEAR(glm::distance(points.origin_m, place_m), 0.0, 1e-3);

        const ProjectedGrid local =
            projected_grid(over_nadir(view_at(scene.camera, 1)),
                           {.cell_px = scene.surface.cell_px,
                            .bounds = {.height_m = extent.height_m, .reach_m = extent.reach_m},
                            .significant_height_m = extent.significant_height_m,
                            .curvature_per_m = kEarthCurvature_per_m});
        ASSERT_EQ(points.rest_m.size(), local.rest_m.size());
        for (std::size_t i = 0; i < local.rest_m.size(); i += 7) {
            const glm::dvec3 there =
                on_earth(glm::dvec3(points.origin_m + points.rest_m[i], 0.0), kEarthCurvature_per_m);
            const glm::dvec3 expected =
                on_earth(glm::dvec3(place_m, 0.0), kEarthCurvature_per_m) +
                from_level(on_earth(glm::dvec3(glm::dvec2(local.rest_m[i]), 0.0), kEarthCurvature_per_m), up);
            ASSERT_LT(glm::distance(there, expected), 0.02 + 1e-6 * glm::length(local.rest_m[i]))
                << away_m << " " << i;
        }
    }
}

}  // namespace
}  // namespace pelagic
