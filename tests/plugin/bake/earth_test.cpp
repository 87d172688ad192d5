// Meshes on the earth's sphere: the camera's own grid, which touches z = 0 below the camera, and a planet, which touches it at
// the world's origin.
#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <string>
#include <vector>

#include "tests/plugin/bake/baked_mesh.h"

namespace {

using namespace pelagic;
using namespace pelagic::test;

class OnTheEarth : public BakedMeshes {};

constexpr double kDegree = kPi / 180.0;

// Over that place of the plane, looking this far down and to the north-east.
Scene scene_from(SurfaceKind kind, glm::dvec2 place_m, double height_m, double down_deg) {
    Scene scene;
    scene.shot.last_frame = 3;
    scene.sea.wind_speed_mps = 10.0;
    scene.waves.cascades = {{.size_m = 200.0, .resolution = 128}, {.size_m = 31.0, .resolution = 64}};
    scene.surface.kind = kind;
    scene.quality.level = QualityLevel::Preview;
    scene.camera.resolution = {160, 90};
    scene.camera.position_m = glm::dvec3(place_m, height_m);
    const double down = down_deg * kDegree;
    scene.camera.look_at_m =
        scene.camera.position_m +
        height_m * glm::dvec3(0.6 * std::cos(down), 0.8 * std::cos(down), -std::sin(down));
    if (kind == SurfaceKind::Planet) to_planet(scene);
    return scene;
}

constexpr std::array kRound{SurfaceKind::ProjectedGrid, SurfaceKind::Planet};
const std::vector<glm::dvec2> kPlacesOnEarth_m{{0.0, 0.0}, {3000.0, -200.0}, {-0.8e6, 0.6e6}};

double dip_of(double height_m) {
    return std::acos(kEarthRadius_m / (kEarthRadius_m + height_m));
}

// The centre of the sphere on which a camera's sea lies.
glm::dvec3 centre_of(const Scene& scene, glm::dvec2 place_m) {
    return scene.surface.kind == SurfaceKind::Planet ? glm::dvec3(0.0, 0.0, -kEarthRadius_m)
                                                     : glm::dvec3(place_m, -kEarthRadius_m);
}

// A calm sea is the sphere itself, its normals are the verticals, and seen from the camera it ends at the horizon's dip.
TEST_F(OnTheEarth, ACalmSeaIsTheSphereUpToItsHorizon) {
    for (const SurfaceKind kind : kRound)
        for (const glm::dvec2 place_m : kPlacesOnEarth_m)
            for (const double height_m : {2.0, 100.0, 8e3, 100e3, 400e3}) {
                SCOPED_TRACE(std::string(word_of(kind)) + " from " + std::to_string(height_m) + " m over " +
                             std::to_string(place_m.x));
                Scene scene = scene_from(kind, place_m, height_m, dip_of(height_m) / kDegree);
                scene.sea.wind_speed_mps = 0.0;
                const Mesh mesh = baked(scene, 1);
                const glm::dvec3 centre_m = centre_of(scene, place_m);
                const glm::dvec3 zenith = glm::normalize(scene.camera.position_m - centre_m);
                double off_m = 0.0, off_normal = 0.0, highest = -kPi;
                for (std::size_t i = 0; i < mesh.points.size(); ++i) {
                    const glm::dvec3 place = mesh.place_m(static_cast<std::int32_t>(i));
                    const glm::dvec3 from_centre_m = place - centre_m;
                    off_m = std::max(off_m, std::abs(glm::length(from_centre_m) - kEarthRadius_m) /
                                                (1e-3 + 2.0 * resolution_m(mesh.points[i])));
                    off_normal = std::max(off_normal, glm::distance(glm::normalize(from_centre_m),
                                                                    glm::dvec3(mesh.normals[i])));
                    const glm::dvec3 seen = glm::normalize(place - scene.camera.position_m);
                    highest = std::max(highest, std::asin(glm::dot(seen, zenith)));
                    ASSERT_EQ(mesh.velocities[i], glm::vec3(0.0f));
                }
                EXPECT_LE(off_m, 1.0);
                EXPECT_LE(off_normal, 1e-6);
                const double pixel = 2.0 * std::tan(0.5 * scene.camera.fov_deg * kDegree) /
                                     static_cast<double>(scene.camera.resolution.x);
                EXPECT_NEAR(highest / pixel, -dip_of(height_m) / pixel, 0.1);
            }
}

// Positions, normals and velocities of waves: the flat sea's, laid on the sphere by angles; down, to the limb and past it.
TEST_F(OnTheEarth, WavesAreTheFlatSeasRelativeToTheVertical) {
    for (const SurfaceKind kind : kRound)
        for (const glm::dvec2 place_m : kPlacesOnEarth_m)
            for (const double height_m : {4.0, 100e3, 400e3})
                for (const double down_deg : {90.0, dip_of(height_m) / kDegree, -5.0}) {
                    SCOPED_TRACE(std::string(word_of(kind)) + " from " + std::to_string(height_m) +
                                 " m over " + std::to_string(place_m.x) + ", " + std::to_string(down_deg) +
                                 " degrees down");
                    const Scene scene = scene_from(kind, place_m, height_m, down_deg);
                    const Reference reference = reference_of(scene, 2);
                    expect_exact(baked(scene, 2), reference);
                    const glm::dvec3 centre_m = centre_of(scene, place_m);
                    for (std::size_t i = 0; i < reference.up.size(); ++i)
                        ASSERT_LT(
                            glm::distance(reference.places_m[i], centre_m + kEarthRadius_m * reference.up[i]),
                            8.0 * reference.significant_height_m);
                }
}

// Each of a planet's files depends on its shot and its frame alone: not on the range, the threads, or on what another kind of
// surface left in the folder. The camera stands over the origin, where both grids are the same but for rounding.
TEST_F(OnTheEarth, APlanetsFrameIsTheSameAlone) {
    Scene scene = scene_from(SurfaceKind::ProjectedGrid, {}, 2e3, 20.0);
    const auto file = folder_ / usd::frame_file(scene.shot.name, 3, word_of(scene.output.mesh));
    const auto bake_range = [&](const std::vector<int>& frames) {
        bake(scene, {.out = folder_, .frames = frames, .progress = {}, .cancel = nullptr});
        return bytes_of(file);
    };
    const std::string of_grid = bake_range({3});
    scene.surface.kind = SurfaceKind::Planet;
    const std::string over_grid = bake_range({});
    EXPECT_NE(over_grid, of_grid);
    for (const std::size_t threads : {1, 2}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        fs::remove_all(folder_);
        EXPECT_EQ(bake_range({3}), over_grid) << threads << " threads";
    }
}

}  // namespace
