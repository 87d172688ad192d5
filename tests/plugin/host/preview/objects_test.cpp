// Objects in the preview: where they are, their light, their shadow and their image in the sea.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <memory>
#include <string>
#include <vector>

#include "core/lighting/object.h"
#include "core/surface/view.h"
#include "plugin/host/gpu/shader_variants.h"
#include "plugin/host/preview/offscreen.h"
#include "plugin/light/light.h"
#include "plugin/render/render.h"
#include "tests/plugin/host/preview/gpu.h"

namespace pelagic {
namespace {

std::shared_ptr<const ObjectMesh> box(glm::vec3 half_m, const ObjectMaterial& material = {}) {
    ObjectMeshData data;
    data.materials = {material};
    for (int axis = 0; axis < 3; ++axis)
        for (const float side : {-1.0f, 1.0f}) {
            glm::vec3 n(0.0f), a(0.0f), b(0.0f);
            n[axis] = side;
            a[(axis + 1) % 3] = 1.0f;
            b[(axis + 2) % 3] = side;
            const auto first = static_cast<std::uint32_t>(data.points_m.size());
            for (const glm::vec2 at : {glm::vec2(-1, -1), glm::vec2(1, -1), glm::vec2(1, 1), glm::vec2(-1, 1)})
                data.points_m.push_back(half_m * (n + at.x * a + at.y * b));
            for (const std::uint32_t i : {0u, 1u, 2u, 0u, 2u, 3u}) {
                data.triangles.push_back(first + i);
                data.normals.push_back(n);
            }
            data.material.insert(data.material.end(), 2, 0);
        }
    return std::make_shared<const ObjectMesh>(std::move(data));
}

Scene object_scene(double wind_mps, double sun_elevation_deg) {
    Scene scene;
    scene.sea.wind_speed_mps = wind_mps;
    scene.waves.cascades = {{160.0, 128}, {37.7, 128}, {8.9, 128}};
    scene.quality.level = QualityLevel::Preview;
    scene.camera.position_m = {0.0, -60.0, 9.0};
    scene.camera.look_at_m = {0.0, 0.0, 1.0};
    scene.camera.fov_deg = 40.0;
    scene.camera.resolution = {320, 180};
    scene.light.sun_elevation_deg = sun_elevation_deg;
    scene.light.sun_azimuth_deg = 30.0;
    return scene;
}

Scene with_box(Scene scene, glm::vec3 half_m = {6.0f, 2.0f, 4.0f}) {
    SceneObject object;
    object.name = "box";
    object.mesh = box(half_m, {.name = "paint", .colour = glm::vec3(0.6f, 0.25f, 0.1f)});
    object.heading_deg = 20.0;
    scene.objects = {object};
    return scene;
}

Picture drawn(const Scene& scene) {
    gpu::need_context();
    return render_offscreen(plan_offscreen(scene, 1), make_sky(scene)).picture;
}

void dump(const char* name, const Picture& p, float e) {  // TEMPORARY
    const std::string file = std::string("/tmp/view_") + name + ".ppm";
    std::FILE* f = std::fopen(file.c_str(), "wb");
    std::fprintf(f, "P6 %d %d 255\n", p.resolution.x, p.resolution.y);
    for (const SeaRadiance& l : p.layers) {
        const glm::vec3 c = radiance_of(l) * e;
        for (int i = 0; i < 3; ++i)
            std::fputc(static_cast<int>(255.0f * std::pow(glm::clamp(1.0f - std::exp(-c[i]), 0.0f, 1.0f), 1.0f / 2.2f)), f);
    }
    std::fclose(f);
}

TEST(PreviewsObjects, Dump) {
    Scene scene = with_box(object_scene(0.5, 35.0));
    scene.camera.resolution = {640, 360};
    dump("calm", drawn(scene), 0.15f);
    scene = with_box(object_scene(8.0, 35.0));
    scene.camera.resolution = {640, 360};
    dump("wind", drawn(scene), 0.15f);
    scene = with_box(object_scene(8.0, 8.0));
    scene.light.sun_azimuth_deg = 80.0;
    scene.camera.resolution = {640, 360};
    dump("low", drawn(scene), 0.25f);
    scene = with_box(object_scene(18.0, 30.0));
    scene.camera.resolution = {640, 360};
    dump("storm", drawn(scene), 0.15f);
}

TEST(PreviewsObjects, AreSeen) {
    const Scene scene = with_box(object_scene(6.0, 35.0));
    const Picture with = drawn(scene);
    EXPECT_GT(std::count(with.sea.begin(), with.sea.end(), 1), 1000);
}

}  // namespace
}  // namespace pelagic
