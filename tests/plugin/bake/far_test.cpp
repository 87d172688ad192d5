// Meshes wherever the camera is: places near it are as exact a million or a hundred million metres from the world's
// origin as they are there. A file's points are floats, relative to the origin that the file names.
//
// Only what follows the camera can lie far out. A patch is centred on the world's origin and has at most 8192 quads a
// side, so that its finest place is a 16384th of its largest, and a float holds that place a thousand times as finely
// (APatchIsAsExactAtItsEdge).
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <glm/geometric.hpp>
#include <iterator>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/evaluate/evaluate.h"
#include "core/scene/keys.h"
#include "core/scene/limits.h"
#include "core/scene/names.h"
#include "plugin/bake/bake.h"
#include "plugin/format/usd/layers.h"
#include "tests/plugin/bake/baked_mesh.h"

namespace {

using namespace pelagic;
using namespace pelagic::test;

// Twice the area of a triangle or a quad, as a vector along its normal.
glm::dvec3 doubled_area(const Mesh& mesh, const std::int32_t* c, std::int32_t count) {
    return glm::cross(mesh.place_m(c[count - 2]) - mesh.place_m(c[0]),
                      mesh.place_m(c[count - 1]) - mesh.place_m(c[count - 3]));
}

struct Quality {
    std::size_t faces = 0, without_area = 0;
    double off_normal =
        0.0;  // root mean square of 1 − cosine between a face's own normal and those at its corners
};

Quality quality_of(const Mesh& mesh) {
    Quality quality{.faces = mesh.counts.size()};
    const std::int32_t* next = mesh.corners.data();
    for (const std::int32_t count : mesh.counts) {
        const std::int32_t* const corners = next;
        next += count;
        const glm::dvec3 area = doubled_area(mesh, corners, count);
        if (!(glm::length(area) > 0.0)) {
            ++quality.without_area;
            continue;
        }
        glm::dvec3 normal(0.0);
        for (std::int32_t i = 0; i < count; ++i)
            normal += glm::dvec3(mesh.normals[static_cast<std::size_t>(corners[i])]);
        const double off = 1.0 - glm::dot(glm::normalize(area), glm::normalize(normal));
        quality.off_normal += off * off;
    }
    quality.off_normal = std::sqrt(quality.off_normal / static_cast<double>(quality.faces));
    return quality;
}

class FarOut : public BakedMeshes {};

Scene scene_at(glm::dvec2 place_m, double height_m = 4.0) {
    Scene scene;
    scene.shot.last_frame = 4;
    scene.sea.wind_speed_mps = 12.0;
    scene.waves.cascades = {{.size_m = 200.0, .resolution = 128}, {.size_m = 31.0, .resolution = 64}};
    scene.surface.size_m = 100.0;
    scene.surface.resolution = 32;
    scene.surface.cell_px = 6.0;
    scene.surface.earth_curvature = false;
    scene.camera.resolution = {192, 108};
    scene.camera.position_m = glm::dvec3(place_m, height_m);
    scene.camera.look_at_m = glm::dvec3(place_m + glm::dvec2(10.0, 40.0), height_m - 3.0);
    scene.quality.level = QualityLevel::Preview;
    return scene;
}

// A flat cage of 24 × 24 faces, 4 m each, round a place; refined twice.
std::shared_ptr<const Cage> flat_cage(glm::dvec2 middle_m) {
    constexpr int kFaces = 24;
    CageMesh mesh;
    for (int y = 0; y <= kFaces; ++y)
        for (int x = 0; x <= kFaces; ++x)
            mesh.points_m.emplace_back(middle_m + 4.0 * (glm::dvec2(x, y) - 0.5 * kFaces), 0.0);
    for (int y = 0; y < kFaces; ++y)
        for (int x = 0; x < kFaces; ++x) {
            const int corner = y * (kFaces + 1) + x;
            mesh.face_counts.push_back(4);
            mesh.indices.insert(mesh.indices.end(),
                                {corner, corner + 1, corner + kFaces + 2, corner + kFaces + 1});
        }
    return std::make_shared<const Cage>(std::move(mesh));
}

// From the world's origin to the last place that a camera may have.
const std::vector<glm::dvec2> kPlaces_m{
    {0.0, 0.0},  {-1e4, 1e4},          {1e6, 1e6},  {-1e6, 1234.567},
    {1e7, -1e7}, {-9.87654321e6, 1e7}, {1e8, -1e8}, {-1e9 + 0.3, 1e9 - 50.0}};

// Those that see no farther than a quarter of its circle.
const std::vector<glm::dvec2> kPlacesOfAPlanet_m{
    {0.0, 0.0}, {-1e4, 1e4}, {1e6, 0.0}, {-1e6, 1234.567}, {2.1e6, -3e6}};

TEST_F(FarOut, EverySurfaceInEveryFormatIsAsExactAsAtTheOrigin) {
    for (const std::string& kind : key_of("surface.kind").choices)
        for (const std::string& format : key_of("output.mesh").choices) {
            if (format == "none") continue;
            Quality near;
            const bool is_planet = kind == word_of(SurfaceKind::Planet),
                       is_cage = kind == word_of(SurfaceKind::Cage);
            std::vector<glm::dvec2> places_m = is_planet ? kPlacesOfAPlanet_m : kPlaces_m;
            // How far out a surface is exact is no matter of the format, which must say its origin as exactly there.
            if (format != word_of(MeshFormat::Usdc))
                places_m = {places_m.front(), places_m[3], places_m.back()};
            for (const glm::dvec2 place_m : places_m) {
                SCOPED_TRACE(kind + " as " + format + ", camera at " + std::to_string(place_m.x) + ", " +
                             std::to_string(place_m.y));
                Scene scene = scene_at(place_m);
                ASSERT_FALSE(set_value(scene, key_of("surface.kind"), kind));
                if (is_planet) to_planet(scene);
                // No cage lies farther out.
                if (is_cage && !limits::kCagePoint_m.holds(2.0 * glm::length(place_m))) continue;
                if (is_cage) scene.surface.cage = flat_cage(place_m);
                ASSERT_FALSE(set_value(scene, key_of("output.mesh"), format));
                const Mesh mesh = baked(scene, 3);
                const Quality quality = quality_of(mesh);
                ASSERT_GT(quality.faces, 500u);
                EXPECT_EQ(quality.without_area, 0u);
                if (place_m == glm::dvec2(0.0)) near = quality;
                // Of other waves of the same sea: 0.6 … 1.6, measured, as what lies before the camera has few faces.
                EXPECT_LT(quality.off_normal, 2.0 * near.off_normal);
                expect_exact(mesh, reference_of(scene, 3));
            }
        }
}

// From a hand above the water to the stratosphere, straight down, through any lens, with fine cells: where one step for
// the origins of all cameras would be too long.
TEST_F(FarOut, NoCameraTearsItsGrid) {
    for (const auto& [height_m, fov_deg] : {std::pair(0.1, 10.0), {3.0, 1.0}, {20e3, 120.0}})
        for (const glm::dvec2 place_m : {glm::dvec2(2047.0, -2047.0), glm::dvec2(1e7, -1e7)}) {
            SCOPED_TRACE(std::to_string(height_m) + " m high, " + std::to_string(fov_deg) + "°, at " +
                         std::to_string(place_m.x));
            Scene scene = scene_at(place_m, height_m);
            scene.surface.kind = SurfaceKind::ProjectedGrid;
            scene.surface.cell_px = 1.0;
            scene.sea.wind_speed_mps = 0.0;
            scene.camera.fov_deg = fov_deg;
            scene.camera.resolution = {300, 16};
            scene.camera.look_at_m = scene.camera.position_m + glm::dvec3(0.0, 0.1, -1.0);
            const Mesh mesh = baked(scene, 1);
            EXPECT_EQ(quality_of(mesh).without_area, 0u);
            expect_exact(mesh, reference_of(scene, 1));
        }
}

// A camera that crosses from one origin to the next in the middle of the shot.
TEST_F(FarOut, AStepOfTheOriginMovesNothing) {
    constexpr double kStep_m = 4096.0;
    Scene scene = scene_at({});
    scene.shot.time_scale = 0.5;
    scene.surface.kind = SurfaceKind::ProjectedGrid;
    scene.camera.keys.clear();
    const glm::dvec2 edge_m{(244.0 + 0.5) * kStep_m, 3e6};
    for (const int frame : {1, 4}) {
        const glm::dvec2 place_m = edge_m + glm::dvec2((frame - 2.5) * 80.0, frame);
        scene.camera.keys.push_back({.frame = frame,
                                     .position_m = glm::dvec3(place_m, 9.0),
                                     .look_at_m = glm::dvec3(place_m + glm::dvec2(30.0, 50.0), 0.0)});
    }
    bake(scene, {.out = folder_, .frames = {}, .progress = {}, .cancel = nullptr});
    std::vector<glm::dvec3> origins_m;
    std::map<int, std::string> bytes;
    for (int frame = 1; frame <= 4; ++frame) {
        SCOPED_TRACE(frame);
        const Mesh mesh = read(scene, frame);
        origins_m.push_back(mesh.origin_m);
        expect_exact(mesh, reference_of(scene, frame), scene.shot.time_scale);
        bytes[frame] = bytes_of(folder_ / usd::frame_file(scene.shot.name, frame, "usdc"));
    }
    EXPECT_EQ(origins_m[0], origins_m[1]);
    EXPECT_EQ(origins_m[2] - origins_m[1], glm::dvec3(kStep_m, 0.0, 0.0));
    EXPECT_EQ(origins_m[2], origins_m[3]);
    EXPECT_EQ(glm::mod(origins_m[0], glm::dvec3(kStep_m)), glm::dvec3(0.0));

    // Alone, each is the same; and for a camera that is elsewhere, each is made again.
    baked(scene, 3);
    EXPECT_EQ(bytes_of(folder_ / usd::frame_file(scene.shot.name, 3, "usdc")), bytes[3]);
    for (CameraKey& key : scene.camera.keys) {
        key.position_m.x += kStep_m;
        key.look_at_m.x += kStep_m;
    }
    const RunReport report = bake(scene, {.out = folder_, .frames = {3}, .progress = {}, .cancel = nullptr});
    EXPECT_EQ(report.done, 1);
    EXPECT_EQ(read(scene, 3).origin_m, origins_m[3] + glm::dvec3(kStep_m, 0.0, 0.0));
}

// Where a float holds the world's places finely enough, the world's origin is the mesh's.
TEST_F(FarOut, NearTheWorldsOriginTheMeshHasThatOne) {
    for (const glm::dvec2 place_m : {glm::dvec2(0.0), glm::dvec2(-2000.0, 2000.0)}) {
        Scene scene = scene_at(place_m);
        scene.surface.kind = SurfaceKind::ProjectedGrid;
        EXPECT_EQ(baked(scene, 1).origin_m, glm::dvec3(0.0));
    }
}

TEST(FarOutSurface, APatchIsAsExactAtItsEdge) {
    const double finest = 1.0 / limits::kSurfaceResolution.high;
    for (const double size_m : {limits::kSurfaceSize_m.low, 200.0, limits::kSurfaceSize_m.high}) {
        const auto edge_m = static_cast<float>(0.5 * size_m);
        EXPECT_LT(edge_m - std::nextafter(edge_m, 0.0f), 1e-3 * finest * size_m);
    }
}

}  // namespace
