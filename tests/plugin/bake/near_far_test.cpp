// Baked meshes from near to far: one list of faces for the shot, and a sea that stays where it is when the camera moves.
#include <gtest/gtest.h>

#include <array>
#include <map>
#include <tuple>
#include <utility>
#include <variant>

#include "tests/plugin/bake/baked_mesh.h"

namespace {

using namespace pelagic;
using namespace pelagic::test;

class NearFarBake : public BakedMeshes {};

Scene near_far_scene(glm::dvec3 position_m, bool is_round) {
    Scene scene;
    scene.shot.last_frame = 3;
    scene.sea.wind_speed_mps = 12.0;
    scene.waves.cascades = {{.size_m = 200.0, .resolution = 128}, {.size_m = 31.0, .resolution = 64}};
    scene.surface.kind = SurfaceKind::NearFar;
    scene.surface.size_m = 100.0;
    scene.surface.resolution = 48;
    scene.surface.earth_curvature = is_round;
    scene.camera.position_m = position_m;
    scene.camera.look_at_m = position_m + glm::dvec3(10.0, 40.0, -1.0);
    scene.quality.level = QualityLevel::Preview;
    return scene;
}

// What a vertex is, by its place at rest and its footprint.
using Vertices = std::map<std::tuple<double, double, float>, std::size_t>;

Vertices vertices_of(const Scene& scene, int frame) {
    const Plan plan = plan_bake(scene);
    RestPoints<float> at;
    plan.surface->points_at(frame, at);
    Vertices vertices;
    for (std::size_t i = 0; i < at.rest_m.size(); ++i) {
        const glm::dvec2 place = at.origin_m + glm::dvec2(at.rest_m[i]);
        vertices[{place.x, place.y, at.cell_m[i]}] = i;
    }
    return vertices;
}

// One frame from two places: wherever both meshes have a vertex of the same cells, the sea is the same there, to the last bit.
TEST_F(NearFarBake, TheSeaStaysWhereItIsWhenTheCameraMoves) {
    for (const bool is_round : {false, true}) {
        // None of the ways below crosses one of the earth's own steps.
        const Scene scene = near_far_scene({1040.0, -2044.0, 4.0}, is_round);
        const Vertices before = vertices_of(scene, 3);
        const Mesh mesh = baked(scene, 3);
        ASSERT_EQ(mesh.points.size(), before.size());
        const std::string faces = bytes_of(folder_ / usd::topology_file(scene.shot.name, "usdc"));
        for (const glm::dvec3 way_m : {glm::dvec3(0.4, -0.3, 0.1), {5.3, -9.1, 3.0}, {-17.9, 11.0, 60.0}}) {
            SCOPED_TRACE(std::to_string(way_m.x) + (is_round ? ", round" : ", flat"));
            const Scene other = near_far_scene(scene.camera.position_m + way_m, is_round);
            const Vertices after = vertices_of(other, 3);
            const Mesh moved = baked(other, 3);
            EXPECT_TRUE(bytes_of(folder_ / usd::topology_file(scene.shot.name, "usdc")) == faces);
            ASSERT_EQ(moved.origin_m, mesh.origin_m);
            std::size_t shared = 0;
            for (const auto& [vertex, i] : after) {
                const auto found = before.find(vertex);
                if (found == before.end()) continue;
                ++shared;
                ASSERT_EQ(moved.points[i], mesh.points[found->second]);
                ASSERT_EQ(moved.normals[i], mesh.normals[found->second]);
                ASSERT_EQ(moved.velocities[i], mesh.velocities[found->second]);
            }
            EXPECT_GT(shared, after.size() * 7 / 10);
        }
    }
}

// Faces stand once in the topology's layer; frames have points and an origin alone.
TEST_F(NearFarBake, FramesHoldNoFaces) {
    for (const MeshFormat format : {MeshFormat::Usda, MeshFormat::Usdc}) {
        Scene scene = near_far_scene({1e6, 2e6, 4.0}, true);
        scene.output.mesh = format;
        scene.camera.keys = {
            {.frame = 1, .position_m = {1e6, 2e6, 4.0}, .look_at_m = {1e6, 2e6 + 50.0, 0.0}},
            {.frame = 3, .position_m = {1e6 + 5e3, 2e6, 900.0}, .look_at_m = {1e6, 2e6 + 50.0, 0.0}}};
        bake(scene, {.out = folder_, .frames = {}, .progress = {}, .cancel = nullptr});
        const std::string extension(word_of(format));
        const auto arrays_of = [&](const std::string& file) {
            std::map<std::string, std::size_t> arrays;
            const usd::MeshLayer layer = usd::read_mesh_layer(bytes_of(folder_ / file));
            for (const usd::MeshArray& array : layer.arrays)
                arrays[array.name] =
                    std::visit([](const auto& values) { return values.size(); }, array.values);
            return std::pair(arrays, layer.origin_m.has_value());
        };
        const auto topology = arrays_of(usd::topology_file(scene.shot.name, extension)).first;
        EXPECT_TRUE(topology.contains("faceVertexCounts") && topology.contains("faceVertexIndices"));
        for (int frame = 1; frame <= 3; ++frame) {
            const auto [arrays, has_origin] = arrays_of(usd::frame_file(scene.shot.name, frame, extension));
            EXPECT_FALSE(arrays.contains("faceVertexCounts") || arrays.contains("faceVertexIndices"));
            EXPECT_EQ(arrays.at("points"), 3 * plan_bake(scene).surface->needs(std::array{frame}).points);
            EXPECT_TRUE(has_origin);
            expect_exact(read(scene, frame), reference_of(scene, frame));
        }
    }
}

}  // namespace
