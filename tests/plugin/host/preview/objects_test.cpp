// Objects in the preview: where they are, their light, their shadow and their image in the sea.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/lighting/object.h"
#include "core/surface/projected_grid.h"
#include "core/surface/view.h"
#include "plugin/format/shot/object_file.h"
#include "plugin/host/gpu/packed_frame.h"
#include "plugin/host/gpu/shader_variants.h"
#include "plugin/host/preview/drawn_objects.h"
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
            for (const glm::vec2 at :
                 {glm::vec2(-1, -1), glm::vec2(1, -1), glm::vec2(1, 1), glm::vec2(-1, 1)})
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
    scene.effects.foam_decay_s = 0.0;
    scene.camera.position_m = {0.0, -60.0, 9.0};
    scene.camera.look_at_m = {0.0, 0.0, 1.0};
    scene.camera.fov_deg = 40.0;
    scene.camera.resolution = {320, 180};
    scene.light.sun_elevation_deg = sun_elevation_deg;
    scene.light.sun_azimuth_deg = 30.0;
    return scene;
}

constexpr glm::dvec3 kHalf_m(6.0, 2.0, 4.0);
constexpr double kHeading = 20.0 * 3.14159265358979 / 180.0;

Scene with_box(Scene scene,
               const ObjectMaterial& material = {.name = "paint", .colour = glm::vec3(0.6f, 0.25f, 0.1f)}) {
    SceneObject object;
    object.name = "box";
    object.mesh = box(glm::vec3(kHalf_m), material);
    object.heading_deg = 20.0;
    scene.objects = {object};
    return scene;
}

// Whether a ray meets that box, and how far away.
std::optional<double> box_ahead(glm::dvec3 from, glm::dvec3 towards) {
    const auto turned = [](glm::dvec3 v) {
        const double c = std::cos(kHeading), s = std::sin(kHeading);
        return glm::dvec3(c * v.x + s * v.y, c * v.y - s * v.x, v.z);
    };
    from = turned(from);
    towards = turned(towards);
    double enters = 0.0, leaves = 1e30;
    for (int axis = 0; axis < 3; ++axis) {
        const double a = (-kHalf_m[axis] - from[axis]) / towards[axis],
                     b = (kHalf_m[axis] - from[axis]) / towards[axis];
        enters = std::max(enters, std::min(a, b));
        leaves = std::min(leaves, std::max(a, b));
    }
    if (leaves < enters) return {};
    return enters;
}

// One renderer for all pictures here: a driver in software takes seconds for its programs.
class ObjectStage {
  public:
    explicit ObjectStage(const Scene& scene)
        : scene_(scene), view_(view_at(scene.camera, 1)), sky_(make_sky(scene)) {
        gpu::need_context();
        const auto prepared = prepare(scene);
        mesh_ = open_sea(projected_grid(view_, projected_grid_options(*prepared)));
        frame_.emplace(std::make_shared<const Sea<float>>(picture_plan(scene, std::array{1})));
        frame_->set(scene.shot.time_s(1));
        PackedFrame packed(frame_->shared_sea(), 0);
        packed.pack(*frame_);
        water_ = make_water(scene, frame_->sea().plan().from->spectrum);
        renderer().set_sky(sky_, water_);
        renderer().upload(packed);
    }
    static SeaRenderer& renderer() {
        static SeaRenderer one;
        return one;
    }
    Picture with_objects() { return drawn(drawn_objects(*frame_, scene_, {.frame = 1.0})); }
    Picture without() { return drawn({}); }
    // The same by the programs of pictures with objects.
    Picture with_objects_elsewhere() {
        std::vector<DrawnObject> objects = drawn_objects(*frame_, scene_, {.frame = 1.0});
        for (DrawnObject& object : objects) object.place_m.y -= 2e4;  // behind the eye
        return drawn(std::move(objects));
    }
    const View& view() const { return view_; }
    const Sky& sky() const { return sky_; }
    // Where a pixel's ray meets level water; none for the sky.
    std::optional<glm::dvec3> on_water(std::size_t pixel) const {
        const auto width = static_cast<std::size_t>(view_.resolution.x);
        const glm::dvec3 towards = view_.direction(
            {static_cast<double>(pixel % width) + 0.5, static_cast<double>(pixel / width) + 0.5});
        if (towards.z >= 0.0) return {};
        return view_.position_m - towards * (view_.position_m.z / towards.z);
    }

  private:
    Picture drawn(std::vector<DrawnObject> objects) {
        const LightingChoice lighting = render_options(scene_).lighting;
        renderer().set_objects(std::move(objects), object_surroundings(lighting, sky_, water_, 0.0));
        renderer().draw(view_, mesh_,
                        {.lighting = lighting,
                         .foam = make_foam(scene_, make_foam_picture(scene_), 1.0),
                         .layers = true});
        return renderer().read_layers();
    }

    Scene scene_;
    View view_;
    Sky sky_;
    SeaMesh mesh_;
    WaterBody water_;
    std::optional<Frame<float>> frame_;
};

Scene calm_scene() {
    Scene scene = object_scene(0.1, 35.0);
    scene.surface.earth_curvature = false;
    return scene;
}

// Against rays to the box and to level water.
TEST(PreviewsObjects, AreWhereTheyStandInTheWater) {
    ObjectStage stage(with_box(calm_scene()));
    const Picture with = stage.with_objects(), without = stage.without();
    int seen = 0, wrong = 0;
    for (std::size_t i = 0; i < with.sea.size(); ++i) {
        const std::optional<glm::dvec3> water = stage.on_water(i);
        if (!water) continue;
        const glm::dvec3 way = *water - stage.view().position_m;
        const bool is_box = box_ahead(stage.view().position_m, way).value_or(1.0) < 1.0;
        seen += is_box;
        wrong += is_box != (without.sea[i] == 1 && with.sea[i] == 0);
        const float light = with.data[index(PictureLayer::Object)][3 * i + 1];
        wrong += (light > 0.0f) != (without.sea[i] == 1 && with.sea[i] == 0);
    }
    std::printf("    %d pixels show the box, %d differ\n", seen, wrong);
    EXPECT_GT(seen, 2000);
    EXPECT_LE(wrong, seen / 100);
}

// The sun behind the box, its shadow before it: half of the water's light is the sun's.
TEST(PreviewsObjects, ThrowTheirShadowsOnTheSea) {
    Scene scene = with_box(calm_scene());
    scene.light.sun_azimuth_deg = 70.0;
    ObjectStage stage(scene);
    const Picture with = stage.with_objects(), without = stage.without();
    int dark = 0, wrong = 0;
    for (std::size_t i = 0; i < with.sea.size(); ++i) {
        const std::optional<glm::dvec3> water = stage.on_water(i);
        if (!water || with.sea[i] == 0) continue;
        const glm::dvec3 sight = glm::normalize(*water - stage.view().position_m);
        if (box_ahead(*water, glm::refract(sight, glm::dvec3(0.0, 0.0, 1.0), 1.0 / 1.34)))
            continue;  // what is seen there is the box in the water
        const bool is_dark = box_ahead(*water, glm::dvec3(stage.sky().sun_direction)).has_value();
        const float left = with.layers[i].sea.y / without.layers[i].sea.y;
        dark += is_dark;
        wrong += is_dark != (left < 0.75f);
    }
    std::printf("    %d pixels in the shadow, %d differ\n", dark, wrong);
    EXPECT_GT(dark, 150);
    EXPECT_LE(wrong, dark / 50);
}

// A black box that glows: its image is Fresnel's term times the glow.
TEST(PreviewsObjects, AreMirroredByCalmWater) {
    constexpr float kGlow = 50.0f;
    Scene scene =
        with_box(calm_scene(),
                 {.name = "lamp", .colour = glm::vec3(0.0f), .roughness = 1.0f, .glow = glm::vec3(1.0f)});
    scene.objects.front().glow_cd_m2 = 1e3 * static_cast<double>(kGlow);
    ObjectStage stage(scene);
    const Picture with = stage.with_objects(), without = stage.without();
    int mirrored = 0, wrong = 0;
    std::vector<double> of_expected;
    for (std::size_t i = 0; i < with.sea.size(); ++i) {
        const std::optional<glm::dvec3> water = stage.on_water(i);
        if (!water || with.sea[i] == 0) continue;
        glm::dvec3 ray = glm::normalize(*water - stage.view().position_m);
        const double cosine = -ray.z;
        ray.z = -ray.z;
        const bool is_image = box_ahead(*water, ray).has_value();
        // Fresnel's equations for an index of 1.34.
        const double g = std::sqrt(1.34 * 1.34 + cosine * cosine - 1.0);
        const double a = (g - cosine) / (g + cosine),
                     b = (cosine * (g + cosine) - 1.0) / (cosine * (g - cosine) + 1.0);
        const double whole = 0.5 * a * a * (1.0 + b * b) * static_cast<double>(kGlow);
        const double more = static_cast<double>(with.layers[i].sky.y - without.layers[i].sky.y);
        mirrored += is_image;
        wrong += is_image != (more > 0.5 * whole);
        if (is_image) of_expected.push_back(static_cast<double>(with.layers[i].sky.y) / whole);
    }
    std::ranges::nth_element(of_expected,
                             of_expected.begin() + static_cast<std::ptrdiff_t>(of_expected.size() / 2));
    const double median = of_expected[of_expected.size() / 2];
    std::printf("    %d pixels in the image, %d differ; median %.3f of what a mirror shows\n", mirrored,
                wrong, median);
    EXPECT_GT(mirrored, 2000);
    EXPECT_LE(wrong, mirrored / 12);  // small waves blur its edge
    EXPECT_NEAR(median, 1.0, 0.05);
}

// What waves show of a lamp above them, against the rays of pelagic render, in squares of pixels where either shows some.
void compare_images(const char* name, double wind_mps) {
    constexpr int kSide = 6;
    Scene scene =
        with_box(object_scene(wind_mps, 35.0),
                 {.name = "lamp", .colour = glm::vec3(0.0f), .roughness = 1.0f, .glow = glm::vec3(1.0f)});
    scene.objects.front().glow_cd_m2 = 50e3;
    scene.camera.resolution = {160, 90};
    scene.objects.front().up_m =
        5.5;  // all of it above the crests: the preview shows nothing through the surface
    ObjectStage stage(scene);
    const Picture with = stage.with_objects(), without = stage.with_objects_elsewhere();
    RenderOptions options = render_options(scene);
    options.samples = 1;
    Picture rays;
    Renderer(scene, options, stage.sky(), std::array{1}).render(1, rays);
    const std::vector<float>& mirrored = rays.data[index(PictureLayer::Reflection)];
    ASSERT_FALSE(mirrored.empty());
    const glm::ivec2 squares = with.resolution / kSide;
    std::vector<double> ours(static_cast<std::size_t>(squares.x * squares.y)), theirs(ours.size());
    for (int y = 0; y < squares.y * kSide; ++y)
        for (int x = 0; x < squares.x * kSide; ++x) {
            const auto at = static_cast<std::size_t>(y * with.resolution.x + x);
            if (with.sea[at] == 0 || rays.sea[at] == 0) continue;
            const auto square = static_cast<std::size_t>(y / kSide * squares.x + x / kSide);
            ours[square] += static_cast<double>(with.layers[at].sky.y - without.layers[at].sky.y);
            theirs[square] += static_cast<double>(mirrored[3 * at + 1]);
        }
    const double most = *std::ranges::max_element(theirs);
    std::vector<double> ratios;
    double all_ours = 0.0, all_theirs = 0.0;
    for (std::size_t i = 0; i < ours.size(); ++i) {
        all_ours += ours[i];
        all_theirs += theirs[i];
        if (std::max(ours[i], theirs[i]) > 0.1 * most) ratios.push_back(ours[i] / theirs[i]);
    }
    ASSERT_GT(ratios.size(), 20u);
    std::ranges::sort(ratios);
    const auto part = [&](std::size_t tenths) { return ratios[ratios.size() * tenths / 10]; };
    std::printf("    %s: %zu squares, median %.3f of the rays', 80 %% between %.3f and %.3f; in all %.3f\n",
                name, ratios.size(), part(5), part(1), part(9), all_ours / all_theirs);
    EXPECT_NEAR(part(5), 1.0, 0.1);
    EXPECT_NEAR(all_ours / all_theirs, 1.0, 0.1);
}
// Ten seconds: no other test sees where rays go that waves have mirrored, and how wide.
TEST(PreviewsObjects, AreMirroredByWavesAsRaysSay) {
    compare_images("calm", 0.1);
    compare_images("trade wind", 8.0);
    compare_images("storm", 18.0);
}

// What one sees of a box in the water, in squares of pixels, against the rays of pelagic render.
void compare_in_water(const char* name, double wind_mps, double up_m, double distance_m) {
    constexpr int kSide = 4;
    Scene scene =
        with_box(object_scene(wind_mps, 50.0), {.name = "paint", .colour = glm::vec3(0.7f, 0.6f, 0.2f)});
    scene.camera.position_m = {0.0, -distance_m, 9.0};
    scene.camera.look_at_m = {0.0, 0.0, -1.0};
    scene.camera.resolution = {160, 90};
    scene.objects.front().up_m = up_m;
    scene.objects.front().foam = 0.0;
    ObjectStage stage(scene);
    const Picture with = stage.with_objects(), without = stage.with_objects_elsewhere();
    const auto by_rays = [&](const Scene& of) {
        RenderOptions options = render_options(of);
        options.samples = 1;
        Picture made;
        Renderer(of, options, stage.sky(), std::array{1}).render(1, made);
        return made;
    };
    Scene bare = scene;
    bare.objects.clear();
    const Picture rays = by_rays(scene), bare_rays = by_rays(bare);
    const std::vector<float>& shown = rays.data[index(PictureLayer::Reflection)];
    const glm::ivec2 squares = with.resolution / kSide;
    std::vector<glm::dvec2> all(static_cast<std::size_t>(squares.x * squares.y));  // ours, theirs
    for (int y = 0; y < squares.y * kSide; ++y)
        for (int x = 0; x < squares.x * kSide; ++x) {
            const auto at = static_cast<std::size_t>(y * with.resolution.x + x);
            if (with.sea[at] == 0 || rays.sea[at] == 0) continue;
            const auto own = [at](const Picture& of) {
                return static_cast<double>(of.layers[at].sea.x + of.layers[at].sky.x);
            };
            all[static_cast<std::size_t>(y / kSide * squares.x + x / kSide)] += glm::dvec2(
                own(with) - own(without), static_cast<double>(shown[3 * at]) + own(rays) - own(bare_rays));
        }
    double most = 0.0;
    glm::dvec2 sum(0.0);
    for (const glm::dvec2& square : all) most = std::max(most, square.y);
    std::vector<double> ratios;
    for (const glm::dvec2& square : all) {
        sum += square;
        if (std::max(square.x, square.y) > 0.2 * most) ratios.push_back(square.x / square.y);
    }
    ASSERT_GT(ratios.size(), 20u);
    std::ranges::sort(ratios);
    const auto part = [&](std::size_t tenths) { return ratios[ratios.size() * tenths / 10]; };
    std::printf("    %s: %zu squares, median %.3f of the rays', 80 %% between %.3f and %.3f; in all %.3f\n",
                name, ratios.size(), part(5), part(1), part(9), sum.x / sum.y);
    EXPECT_NEAR(part(5), 1.0, 0.05);
    EXPECT_NEAR(sum.x / sum.y, 1.0, 0.05);
}
// Seven seconds: no other test sees what is under water in a preview.
TEST(PreviewsObjects, AreSeenInTheWaterAsRaysSay) {
    compare_in_water("calm, from aside", 0.1, -4.6, 40.0);
    compare_in_water("trade wind", 8.0, -5.5, 20.0);
    compare_in_water("half in the water", 0.1, -3.0, 9.0);
}

// What waves lose of the sun's light behind a box, against the rays of pelagic render: which pixels, and how much of it there.
void compare_shadows(const char* name, double wind_mps) {
    Scene scene = with_box(object_scene(wind_mps, 35.0));
    scene.light.sun_azimuth_deg = 70.0;
    scene.camera.resolution = {160, 90};
    scene.objects.front().foam = 0.0;
    scene.objects.front().up_m = 5.5;  // above the crests
    ObjectStage stage(scene);
    const Picture with = stage.with_objects(), without = stage.without();
    const auto by_rays = [&](const Scene& of) {
        RenderOptions options = render_options(of);
        options.samples = 1;
        options.layers.set(index(PictureLayer::Shadow));
        Picture made;
        Renderer(of, options, stage.sky(), std::array{1}).render(1, made);
        return made;
    };
    const Picture rays = by_rays(scene);
    Scene bare = scene;
    bare.objects.clear();
    const Picture bare_rays = by_rays(bare);
    const std::vector<float>& share = rays.data[index(PictureLayer::Shadow)];
    ASSERT_FALSE(share.empty());
    // Of the light out of the water, which waves' slopes hardly change; the sun's glitter is in few pixels.
    const auto lost = [](const Picture& a, const Picture& b, std::size_t i) {
        return static_cast<double>(b.layers[i].sea.y - a.layers[i].sea.y);
    };
    std::vector<double> whole;
    for (std::size_t i = 0; i < share.size(); ++i)
        if (with.sea[i] && rays.sea[i] && share[i] == 0.0f)
            whole.push_back(lost(rays, bare_rays, i) / static_cast<double>(bare_rays.layers[i].sea.y));
    ASSERT_GT(whole.size(), 50u);  // a storm hides most of it
    std::ranges::sort(whole);
    const double half = 0.5 * whole[whole.size() / 2];
    double ours = 0.0, theirs = 0.0;
    int dark = 0, wrong = 0;
    for (std::size_t i = 0; i < share.size(); ++i) {
        if (!with.sea[i] || !rays.sea[i]) continue;
        const double own = lost(with, without, i);
        if (share[i] == 0.0f) {
            ours += own;
            theirs += lost(rays, bare_rays, i);
        }
        dark += share[i] < 0.5f;
        wrong += (share[i] < 0.5f) != (own > half * static_cast<double>(without.layers[i].sea.y));
    }
    std::printf("    %s: %d pixels in the shadow, %d differ; it is %.3f as deep as the rays'\n", name, dark,
                wrong, ours / theirs);
    EXPECT_LE(wrong, dark / 10);
    EXPECT_NEAR(ours / theirs, 1.0, 0.1);
}
// Some seconds: no other test sees a shadow on waves, nor how dark it is.
TEST(PreviewsObjects, ThrowTheirShadowsOnWavesAsRaysSay) {
    compare_shadows("calm", 0.1);
    compare_shadows("trade wind", 8.0);
    compare_shadows("storm", 18.0);
}

// In the sun and in the shade, with the water's light from below. The preview doesn't know that water in an object's shadow sends it less
// light, nor what the object hides of waves' mirrored sky: together some hundredths.
TEST(PreviewsObjects, AreLitAsRaysSay) {
    Scene scene = with_box(object_scene(8.0, 35.0));
    scene.camera.resolution = {160, 90};
    for (const double azimuth_deg : {30.0, 250.0}) {
        scene.light.sun_azimuth_deg = azimuth_deg;
        ObjectStage stage(scene);
        const Picture with = stage.with_objects();
        RenderOptions options = render_options(scene);
        options.samples = 1;
        Picture rays;
        Renderer(scene, options, stage.sky(), std::array{1}).render(1, rays);
        const std::vector<float>&ours = with.data[index(PictureLayer::Object)],
              &theirs = rays.data[index(PictureLayer::Object)];
        std::vector<double> ratios;
        for (std::size_t i = 1; i < ours.size(); i += 3)
            if (ours[i] > 0.0f && theirs[i] > 0.0f)
                ratios.push_back(static_cast<double>(ours[i] / theirs[i]));
        ASSERT_GT(ratios.size(), 500u);
        std::ranges::sort(ratios);
        const double median = ratios[ratios.size() / 2];
        std::printf("    sun at %.0f: median %.3f of the rays', 80 %% between %.3f and %.3f\n", azimuth_deg,
                    median, ratios[ratios.size() / 10], ratios[ratios.size() * 9 / 10]);
        EXPECT_NEAR(median, 1.0, 0.1);
    }
}

// A hull in waves by the preview and by rays; of both the picture and what they show where only one has the body.
struct BothHulls {
    Picture ours, rays;
    std::size_t rim = 0, only_ours = 0, only_rays = 0;  // pixels; rim: of the body, beside the sea
};
BothHulls hull_pictures(const char* name, Scene scene, std::shared_ptr<const ObjectMesh> mesh,
                        double foam = 1.0) {
    SceneObject object;
    object.name = name;
    object.mesh = std::move(mesh);
    object.heading_deg = 30.0;
    object.floats = true;
    object.foam = foam;
    scene.objects = {object};
    scene.camera.resolution = {320, 180};
    ObjectStage stage(scene);
    BothHulls both;
    both.ours = stage.with_objects();
    RenderOptions options = render_options(scene);
    options.samples = 1;
    Renderer(scene, options, stage.sky(), std::array{1}).render(1, both.rays);
    const auto body = [](const Picture& picture, std::size_t i) {
        return picture.data[index(PictureLayer::Object)][3 * i + 1] > 0.0f;
    };
    for (std::size_t i = 0; i < both.rays.sea.size(); ++i) {
        const bool ours = body(both.ours, i), rays = body(both.rays, i);
        const auto width = static_cast<std::size_t>(scene.camera.resolution.x);
        both.rim += rays && i >= width && i + width < both.rays.sea.size() &&
                    (both.rays.sea[i - 1] || both.rays.sea[i + 1] || both.rays.sea[i - width] ||
                     both.rays.sea[i + width]);
        both.only_ours += ours && !rays;
        both.only_rays += rays && !ours;
    }
    std::printf("    %s: %zu pixels at the body's rim; %zu only in the preview, %zu only by rays\n", name,
                both.rim, both.only_ours, both.only_rays);
    return both;
}

// Five faces: walls of the water's height and half as high again, and a bottom.
std::shared_ptr<const ObjectMesh> barge() {
    const glm::vec3 half(8.0f, 3.0f, 1.0f);
    ObjectMeshData data = box(half)->data();
    // The face towards +z is the last.
    data.triangles.resize(data.triangles.size() - 6);
    data.normals.resize(data.triangles.size());
    data.material.resize(data.triangles.size() / 3);
    return std::make_shared<const ObjectMesh>(std::move(data));
}

std::shared_ptr<const ObjectMesh> trawler_mesh() {
    static const auto mesh = load_object(PELAGIC_SOURCE_DIR "/examples/data/trawler.obj");
    return mesh;
}

Scene swell_scene() {
    Scene scene = object_scene(9.0, 40.0);
    scene.camera.position_m = {3.0, -26.0, 9.0};
    scene.camera.look_at_m = {0.0, 0.0, 0.0};
    scene.camera.fov_deg = 50.0;
    return scene;
}

TEST(PreviewsObjects, KeepTheWaterOutAsRaysSay) {
    const BothHulls trawler = hull_pictures("trawler", swell_scene(), trawler_mesh());
    EXPECT_GT(trawler.rim, 300u);
    EXPECT_LE(trawler.only_ours + trawler.only_rays, trawler.rim / 50);
    // Nothing hides what is inside.
    const BothHulls open = hull_pictures("barge", swell_scene(), barge());
    EXPECT_GT(open.rim, 300u);
    EXPECT_LE(open.only_ours + open.only_rays, open.rim / 50);
}

TEST(PreviewsObjects, HaveFoamAlongTheirHullsAsPicturesDo) {
    Scene scene = swell_scene();
    scene.effects.foam_structure = 0.0;  // so that each pixel's foam is its coverage
    const BothHulls with = hull_pictures("with foam", scene, trawler_mesh()),
                    without = hull_pictures("without", scene, trawler_mesh(), 0.0);
    std::vector<double> differences;
    double ours = 0.0, rays = 0.0, most = 0.0;
    for (std::size_t i = 0; i < with.rays.sea.size(); ++i) {
        if (with.rays.sea[i] == 0 || with.ours.sea[i] == 0) continue;
        const auto along = [&](const Picture BothHulls::*of) {
            return static_cast<double>((with.*of).layers[i].foam.y - (without.*of).layers[i].foam.y);
        };
        const double a = along(&BothHulls::ours), b = along(&BothHulls::rays);
        ours += a;
        rays += b;
        most = std::max(most, b);
        if (std::max(std::abs(a), std::abs(b)) > 1e-3) differences.push_back(std::abs(a - b));
    }
    ASSERT_GT(differences.size(), 300u);
    std::ranges::sort(differences);
    const auto part = [&](std::size_t tenths) {
        return differences[differences.size() * tenths / 10] / most;
    };
    std::printf(
        "    foam in all %.4f of the rays'; in %zu pixels, of the brightest the difference is %.1e in half of them, 90 %% have %.1e\n",
        ours / rays, differences.size(), part(5), part(9));
    EXPECT_NEAR(ours / rays, 1.0, 0.05);
    EXPECT_LE(part(5), 0.01);
    EXPECT_LE(part(9), 0.05);
}

// A checker on the box: near, where it shows its squares, and far away, where it is grey.
TEST(PreviewsObjects, HaveThePicturesThatRenderHas) {
    for (const double away : {1.0, 14.0}) {
        Scene scene = with_box(calm_scene());
        scene.camera.position_m = away * glm::dvec3(-30.0, -50.0, 9.0);
        scene.camera.fov_deg = 20.0 / away;
        scene.camera.resolution = {160, 90};
        constexpr int kSide = 64;
        std::vector<std::uint16_t> rgb;
        for (int y = 0; y < kSide; ++y)
            for (int x = 0; x < kSide; ++x) {
                const bool is_bright = (x / 8 + y / 8) % 2 == 0;
                rgb.insert(rgb.end(), {static_cast<std::uint16_t>(is_bright ? 0x3a00 : 0x2e66), 0x3400,
                                       static_cast<std::uint16_t>(is_bright ? 0x2e66 : 0x3a00)});
            }
        ObjectMeshData mesh = scene.objects[0].mesh->data();
        mesh.images = {std::make_shared<const ObjectImage>(kSide, kSide, std::move(rgb))};
        mesh.materials.push_back({.name = "plain", .colour = glm::vec3(0.5f)});
        mesh.materials[0].image = 0;
        mesh.material[10] = mesh.material[11] = 1;  // the top
        for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
            const glm::vec3 n = glm::abs(mesh.normals[i]),
                            at = mesh.points_m[mesh.triangles[i]] / glm::vec3(kHalf_m);
            const float often = away == 1.0 ? 0.5f : 64.0f;
            mesh.image_at.push_back(often * (n.x > 0.5f ? glm::vec2(at.y, at.z) : glm::vec2(at.x, at.z)));
        }
        scene.objects[0].mesh = std::make_shared<const ObjectMesh>(std::move(mesh));
        ObjectStage stage(scene);
        const Picture ours = stage.with_objects();
        RenderOptions options = render_options(scene);
        options.layers = parse_picture_layers("all");
        options.samples = 1;
        Picture rays;
        Renderer(scene, options, make_sky(scene), std::array{1}).render(1, rays);
        // Of red to blue: the light is about the same, whatever else the two make of it.
        std::vector<double> differences;
        double least = 1.0, most = 0.0;
        for (std::size_t i = 0; i < rays.layers.size(); ++i) {
            const auto red = [&](const Picture& of) {
                const float* light = &of.data[index(PictureLayer::Object)][3 * i];
                return light[1] > 0.0f ? static_cast<double>(light[0] / (light[0] + light[2])) : -1.0;
            };
            if (red(ours) < 0.0 || red(rays) < 0.0) continue;
            differences.push_back(std::abs(red(ours) - red(rays)));
            least = std::min(least, red(rays));
            most = std::max(most, red(rays));
        }
        ASSERT_GT(differences.size(), 1000u);
        std::ranges::sort(differences);
        const double median = differences[differences.size() / 2],
                     nearly_all = differences[differences.size() * 95 / 100];
        std::printf("    %zu pixels, red %.2f ... %.2f: difference %.4f in half, 95 %% have %.4f\n",
                    differences.size(), least, most, median, nearly_all);
        EXPECT_LE(median, 0.03);
        EXPECT_LE(nearly_all, 0.12);
        EXPECT_EQ(most - least > 0.4, away == 1.0);
    }
}

TEST(PreviewsObjects, AreCountedInTheMemory) {
    gpu::need_context();
    const Scene bare = object_scene(8.0, 35.0);
    Scene with = with_box(bare);
    with.objects.front().foam = 0.0;                              // which would ask the sea for more
    EXPECT_GT(DrawnObjects::bytes(with), std::size_t{80} << 20);  // two pictures and the shadow
    EXPECT_EQ(DrawnObjects::bytes(bare), 0u);
    EXPECT_EQ(offscreen_memory(plan_offscreen(with, 1), 2).bytes(),
              offscreen_memory(plan_offscreen(bare, 1), 2).bytes() + DrawnObjects::bytes(with));
}

TEST(PreviewsObjects, ChangeNothingWhereThereAreNone) {
    ObjectStage stage(with_box(calm_scene()));
    const auto bits = [](const Picture& picture) {
        std::vector<float> all;
        for (const SeaRadiance& of : picture.layers)
            for (const glm::vec3& term : {of.sun, of.sky, of.sea, of.foam, of.air})
                all.insert(all.end(), {term.x, term.y, term.z});
        return all;
    };
    const std::vector<float> before = bits(stage.without());
    stage.with_objects();
    EXPECT_EQ(bits(stage.without()), before);
    DrawOptions options;
    const SeaLayout layout(std::make_shared<const Sea<float>>(picture_plan(calm_scene(), std::array{1})), 0);
    const std::string plain = ShaderVariant::of_sea(layout, options, 256).fragment().text();
    EXPECT_EQ(plain.find("sun_shadow"), std::string::npos);
    options.has_objects = true;
    EXPECT_NE(ShaderVariant::of_sea(layout, options, 256).fragment().text().find("sun_shadow"),
              std::string::npos);
    // A host's own objects shadow the sea by a texture that doesn't compare.
    DrawOptions host;
    host.for_host = true;
    const auto text_of_host = [&] { return ShaderVariant::of_sea(layout, host, 256).fragment().text(); };
    EXPECT_EQ(text_of_host().find("sun_blockers"), std::string::npos);
    host.has_objects = true;
    EXPECT_NE(text_of_host().find("sun_blockers"), std::string::npos);
    EXPECT_EQ(text_of_host().find("sampler2DShadow"), std::string::npos);
}

// A renderer keeps its programs by them, also when its window reads a shot again whose bodies have pictures by now.
TEST(PreviewsObjects, HaveAnotherKeyWithPicturesThanWithoutThem) {
    DrawOptions plain, painted;
    painted.has_images = true;
    for (const ObjectPicture picture : {ObjectPicture::Seen, ObjectPicture::Mirrored, ObjectPicture::InWater})
        EXPECT_NE(ShaderVariant::of_object(plain, 256, picture).key(),
                  ShaderVariant::of_object(painted, 256, picture).key());
}

}  // namespace
}  // namespace pelagic
