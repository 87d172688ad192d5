// Whole frames: the preview's picture against the CPU's (plugin/render), by pixel, before tone mapping.
#include <gtest/gtest.h>
#include <array>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <string>
#include <thread>
#include <vector>

#include "plugin/host/gpu/foam_worker.h"
#include "plugin/host/preview/offscreen.h"
#include "plugin/light/light.h"
#include "plugin/render/render.h"
#include "tests/plugin/host/preview/compare.h"
#include "tests/plugin/host/preview/gpu.h"

namespace pelagic {
namespace {

void compare_frame(const char* name, Scene scene, glm::ivec2 size = {640, 360}) {
    gpu::need_context();
    scene.camera.resolution = size;
    RenderOptions options = render_options(scene);
    options.samples = 1;
    const Sky sky = make_sky(scene);
    Picture cpu;
    Renderer(scene, options, sky, std::array{5}).render(5, cpu);
    const OffscreenPicture gpu = render_offscreen(plan_offscreen(scene, 5), sky);
    ASSERT_EQ(gpu.picture.resolution, cpu.resolution);
    const Difference difference = compare(cpu, gpu.picture);
    std::printf("    %s: median %.1e, 99th percentile %.1e, at silhouettes %.1f %% of the pixels\n", name,
                difference.median, difference.last_percent, 100.0 * difference.silhouettes);
    // The picture contains sea and sky, and each of the terms.
    const auto sea_pixels = std::count(cpu.sea.begin(), cpu.sea.end(), 1);
    EXPECT_GT(sea_pixels, size.x * size.y / 4);
    EXPECT_LT(difference.silhouettes, 0.25);
    EXPECT_GT(difference.median, 0.0);  // two different implementations
    EXPECT_LE(difference.median, 1e-3);
    EXPECT_LE(difference.last_percent, 1e-2);
}

Scene scene_of(glm::dvec3 position_m, glm::dvec3 look_at_m) {
    Scene scene;
    scene.sea.wind_speed_mps = 10.0;
    scene.waves.cascades = {{160.0, 256}, {37.7, 256}, {8.9, 256}, {2.1, 256}};
    scene.quality.level = QualityLevel::Preview;
    scene.camera.position_m = position_m;
    scene.camera.look_at_m = look_at_m;
    return scene;
}

TEST(PreviewsPicture, IsTheCpusFromADeck) {
    compare_frame("from a deck", scene_of({0.0, -60.0, 4.0}, {0.0, 0.0, 0.0}));
}
TEST(PreviewsPicture, IsTheCpusFromAPlaneFarFromTheOrigin) {
    Scene scene = scene_of({1e6, -1e6, 1500.0}, {1e6, -1e6 + 8000.0, 0.0});
    scene.sea.wind_speed_mps = 16.0;
    compare_frame("from a plane", scene);
}
// Haze, the horizon's dip, and the sky as it looks from there.
TEST(PreviewsPicture, IsTheCpusFromTheStratosphere) {
    Scene scene = scene_of({0.0, 0.0, 20e3}, {0.0, 30e3, 15e3});
    scene.light.turbidity = 6.0;
    compare_frame("from 20 km", scene);
}
// From day into night: each place has its own sun.
TEST(PreviewsPicture, IsTheCpusOverTheTerminator) {
    Scene scene = scene_of({0.0, 0.0, 400e3}, {0.0, -500e3, 150e3});
    scene.light.sun_elevation_deg = 3.0;
    scene.light.sun_azimuth_deg = 90.0;
    compare_frame("over the terminator", scene);
}
TEST(PreviewsPicture, IsTheCpusOfTrains) {
    Scene scene = scene_of({0.0, -60.0, 12.0}, {0.0, 0.0, 2.0});
    scene.waves.model = WaveModel::Trochoid;
    scene.waves.cascades.clear();
    compare_frame("of trains", scene);
}

TEST(PreviewsPicture, IsTheCpusOfCopiesAtRandomOffsets) {
    Scene scene = scene_of({3e4, -60.0, 12.0}, {3e4, 0.0, 0.0});
    scene.waves.tiling = Tiling::Random;
    compare_frame("of copies", scene, {320, 180});
}
// A mesh that is no whole grid, and one with heights and normals of its own: no other test has their vertices and shaders.
TEST(PreviewsPicture, IsTheCpusOfAPatchInNothing) {
    Scene scene = scene_of({0.0, -26.0, 9.0}, {0.0, 0.0, 0.0});
    scene.surface.size_m = 30.0;
    scene.surface.beyond = Beyond::Nothing;
    compare_frame("of a patch in nothing", scene, {320, 180});
}
Scene slope_scene() {
    Scene scene = scene_of({0.0, -30.0, 14.0}, {0.0, 0.0, 4.0});
    CageMesh mesh;
    mesh.points_m = {{-14.0, -12.0, 3.0}, {14.0, -12.0, 3.0}, {14.0, 12.0, 6.0}, {-14.0, 12.0, 9.0}};
    mesh.face_counts = {4};
    mesh.indices = {0, 1, 2, 3};
    scene.surface.kind = SurfaceKind::Cage;
    scene.surface.cage = std::make_shared<const Cage>(mesh);
    scene.surface.cage_level.is_adaptive = true;
    return scene;
}
TEST(PreviewsPicture, IsTheCpusOfACageInTheSea) {
    Scene scene = slope_scene();
    scene.effects.foam_decay_s = 2.0;
    scene.surface.beyond = Beyond::Sea;
    compare_frame("of a cage in the sea", scene, {320, 180});
}
// From among the crests, and over them.
Scene sprayed_scene(glm::dvec3 position_m, glm::dvec3 look_at_m) {
    Scene scene = scene_of(position_m, look_at_m);
    scene.sea.wind_speed_mps = 20.0;
    scene.effects.spray = true;
    scene.effects.spray_gain = 20.0;
    return scene;
}
TEST(PreviewsPicture, IsTheCpusOfSpray) {
    compare_frame("of spray", sprayed_scene({0.0, -60.0, 12.0}, {0.0, 0.0, 8.0}), {320, 180});
}
TEST(PreviewsPicture, IsTheCpusOfSprayFromAPlane) {
    compare_frame("of spray from a plane", sprayed_scene({1e6, -1e6, 400.0}, {1e6, -1e6 + 1500.0, 0.0}),
                  {320, 180});
}

// What waves that broke before have left, near and far, in both hosts alike.
Scene living_scene(glm::dvec3 position_m, glm::dvec3 look_at_m) {
    Scene scene = scene_of(position_m, look_at_m);
    scene.sea.wind_speed_mps = 14.0;
    scene.effects.foam_decay_s = 2.0;
    scene.effects.foam_drift = 0.02;
    return scene;
}
TEST(PreviewsPicture, IsTheCpusOfLivingFoam) {
    compare_frame("of living foam", living_scene({3e4, -60.0, 6.0}, {3e4, 0.0, 0.0}), {320, 180});
}
TEST(PreviewsPicture, IsTheCpusOfLivingFoamFromAPlane) {
    compare_frame("of living foam from a plane", living_scene({1e6, -1e6, 400.0}, {1e6, -1e6 + 1500.0, 0.0}),
                  {320, 180});
}

double mean_foam(const Picture& picture) {
    double sum = 0.0, pixels = 0.0;
    for (std::size_t i = 0; i < picture.layers.size(); ++i) {
        sum += picture.sea[i] * static_cast<double>(picture.layers[i].foam.y);
        pixels += picture.sea[i];
    }
    return sum / pixels;
}
// The tiles that a window or a viewport asks for by the grid hold what the pixels between its points read, from the ground
// up; and a history that is gone on with has what one from nothing has.
TEST(PreviewsPicture, OfLivingFoamByItsGridIsThatByItsPixels) {
    gpu::need_context();
    Scene scene = living_scene({0.0, -60.0, 6.0}, {0.0, 0.0, 0.0});
    scene.camera.resolution = {160, 90};
    const OffscreenPlan planned = plan_offscreen(scene, 5);
    const Sky sky = make_sky(scene);
    const Picture exact = render_offscreen(planned, sky).picture;
    const auto sea = std::make_shared<const Sea<float>>(planned.plan);
    SeaRenderer renderer;
    renderer.set_sky(sky, make_water(scene));
    PackedFrame packed(sea, 0);
    Frame<float> frame(sea);
    frame.set(scene.shot.time_s(5));
    packed.pack(frame);
    renderer.upload(packed);
    const DrawOptions options{
        .lighting = render_options(scene).lighting,
        .foam = make_foam(scene, make_foam_picture(scene), active_foam(scene, sea->residual_coverage())),
        .layers = true};
    const auto drawn = [&] {
        renderer.draw(view_at(scene.camera, 5), planned.mesh, options);
        return renderer.read_layers();
    };
    // Before there is any, foam is where waves break.
    EXPECT_LT(mean_foam(drawn()), 0.7 * mean_foam(exact));
    FoamWorker worker(sea);
    const auto grid = std::make_shared<const ProjectedGrid>(planned.mesh.points);
    std::shared_ptr<const PackedFoam> foam;
    for (const int n : {4, 5}) {
        worker.ask(scene.shot.time_s(n), {grid});
        while (!(foam = worker.take())) {
            ASSERT_EQ(worker.error(), "");
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
    }
    renderer.upload_foam(foam);
    const Difference difference = compare(exact, drawn());
    std::printf("    median %.1e, 99th percentile %.1e\n", difference.median, difference.last_percent);
    EXPECT_EQ(difference.median, 0.0);
    // Where waves turn pixels towards the eye, so far that finer cells would show more, the grid has asked for coarser ones.
    EXPECT_LE(difference.last_percent, 2e-2);
}

// A scene's sea at one second, ready to draw.
struct Stage {
    explicit Stage(const Scene& scene)
        : view(view_at(scene.camera, 1)),
          mesh(open_sea(projected_grid(view, projected_grid_options(*prepare(scene))))) {
        const auto sea = std::make_shared<const Sea<float>>(picture_plan(scene, std::array{1}));
        Frame<float> frame(sea);
        frame.set(1.0);
        PackedFrame packed(sea, 0);
        packed.pack(frame);
        renderer.set_sky(make_sky(scene), make_water(scene));
        renderer.upload(packed);
    }
    Picture drawn(const DrawOptions& options) {
        renderer.draw(view, mesh, options);
        return renderer.read_layers();
    }

    View view;
    SeaMesh mesh;
    SeaRenderer renderer;
};

// A term that is off is black; the others don't change.
TEST(PreviewsPicture, OfATermThatIsOffHasNoneOfIt) {
    gpu::need_context();
    Scene scene = scene_of({0.0, -60.0, 4.0}, {0.0, 0.0, 0.0});
    scene.camera.resolution = {64, 36};
    Stage stage(scene);
    DrawOptions options{.lighting = {}, .layers = true};
    const Picture all = stage.drawn(options);
    options.lighting.sun = options.lighting.whitecaps = false;
    const Picture some = stage.drawn(options);
    double sun = 0.0, foam = 0.0;
    for (std::size_t i = 0; i < all.layers.size(); ++i) {
        if (!all.sea[i]) continue;
        sun += static_cast<double>(all.layers[i].sun.y);
        foam += static_cast<double>(all.layers[i].foam.y);
        EXPECT_EQ(some.layers[i].sun, glm::vec3(0.0f));
        EXPECT_EQ(some.layers[i].foam, glm::vec3(0.0f));
        // Without foam the others regain its share of the pixel.
        EXPECT_GE(some.layers[i].sky.y, all.layers[i].sky.y);
    }
    EXPECT_GT(sun, 0.0);
    EXPECT_GT(foam, 0.0);
}

// Without layers the single picture is their sum.
TEST(PreviewsPicture, WithoutLayersIsTheirSum) {
    gpu::need_context();
    Scene scene = scene_of({0.0, -60.0, 4.0}, {0.0, 0.0, 0.0});
    scene.camera.resolution = {64, 36};
    Stage stage(scene);
    const Picture layers = stage.drawn({.lighting = {}, .layers = true});
    const Picture sum = stage.drawn({.lighting = {}});
    for (std::size_t i = 0; i < layers.layers.size(); ++i) {
        const glm::vec3 expected = radiance_of(layers.layers[i]);
        for (int c = 0; c < 3; ++c)  // rounding of three additions
            ASSERT_NEAR(radiance_of(sum.layers[i])[c], expected[c], 4e-7f * expected[c]);
    }
}

// Pictures without light: the grid's edges, and the state of each pixel's filter.
TEST(PreviewsPicture, OfWiresAndFalseColoursShowsWhatTheySay) {
    gpu::need_context();
    Scene scene = scene_of({0.0, -60.0, 8.0}, {0.0, 0.0, 0.0});
    scene.sea.wind_speed_mps = 15.0;
    scene.camera.resolution = {160, 90};
    Stage stage(scene);
    const auto with = [&](FalseColour colour) {
        return stage.drawn({.lighting = {}, .false_colour = colour});
    };
    const Picture light = stage.drawn({.lighting = {}, .layers = true}),
                  wires = stage.drawn({.lighting = {}, .wireframe = true}),
                  levels = with(FalseColour::FilterLevel), unresolved = with(FalseColour::UnresolvedVariance),
                  coverage = with(FalseColour::Coverage);
    int on_wires = 0, sea_pixels = 0, foam = 0, bare = 0;
    for (std::size_t i = 0; i < light.layers.size(); ++i) {
        const glm::vec3 wire = radiance_of(wires.layers[i]);
        EXPECT_TRUE(wire == glm::vec3(0.0f) || wire == glm::vec3(1.0f));
        on_wires += wire.x > 0.0f;
        sea_pixels += light.sea[i];
        for (const Picture* picture : {&levels, &unresolved, &coverage}) {
            EXPECT_EQ(picture->sea[i], light.sea[i]);
            if (light.sea[i] == 0) {
                EXPECT_EQ(radiance_of(picture->layers[i]), glm::vec3(0.0f)) << "black sky";
            }
        }
        // Foam is where there is coverage, and nowhere else; a pixel between the pattern's filaments may have none.
        EXPECT_LE(light.layers[i].foam.x > 0.0f, coverage.layers[i].sea.x > 0.0f) << i;
        foam += coverage.layers[i].sea.x > 0.1f;
        bare += coverage.layers[i].sea.x > 0.1f && !(light.layers[i].foam.x > 0.0f);
    }
    EXPECT_LT(bare, foam / 10);
    // Cells of 8 pixels with one diagonal: three edges per cell, some 3 · 8 of its 64 pixels, and more far
    // away.
    EXPECT_GT(on_wires, sea_pixels / 5);
    EXPECT_LT(on_wires, sea_pixels);
    EXPECT_GT(foam, 0);
    // Farther pixels hide more: levels go from blue to red, and the unresolved variance grows, but for what a near crest compresses.
    const auto row = [&](const Picture& picture, int y) {
        glm::vec3 sum(0.0f);
        for (int x = 0; x < 160; ++x)
            sum += radiance_of(picture.layers[static_cast<std::size_t>(y * 160 + x)]);
        return sum / 160.0f;
    };
    int horizon = 0;
    while (light.sea[static_cast<std::size_t>(horizon * 160)] == 0) ++horizon;
    const glm::vec3 far_level = row(levels, horizon + 1), near_level = row(levels, 89);
    EXPECT_GT(far_level.x, 0.5f);
    EXPECT_GT(near_level.z, 0.5f);
    float near_unresolved = 0.0f;
    for (int y = 60; y < 90; ++y) near_unresolved += row(unresolved, y).x / 30.0f;
    EXPECT_GT(row(unresolved, horizon + 1).x, 1.2f * near_unresolved);
}

TEST(PackedFrame, RefusesWhatIsNotAPicturesOwn) {
    Scene scene = scene_of({0.0, -60.0, 4.0}, {0.0, 0.0, 0.0});
    scene.waves.cascades = {{100.0, 32}};
    const auto sea = std::make_shared<const Sea<float>>(picture_plan(scene, std::array{1}));
    const auto other = std::make_shared<const Sea<float>>(picture_plan(scene, std::array{1}));
    PackedFrame packed(sea, 0);
    Frame<float> without_time(sea), of_another(other);
    of_another.set(0.0);
    EXPECT_THROW(packed.pack(without_time), std::invalid_argument);
    EXPECT_THROW(packed.pack(of_another), std::invalid_argument);
    Scene patch = scene;
    const auto baked = std::make_shared<const Sea<float>>(plan_bake(patch));
    EXPECT_THROW(PackedFrame(baked, 0), std::invalid_argument);  // its mesh is a lattice
}

}  // namespace
}  // namespace pelagic
