// Whole frames: the preview's picture against the CPU's (plugin/render), by pixel, before tone mapping.
#include <gtest/gtest.h>
#include <array>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <glm/common.hpp>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "core/scene/number_keys.h"
#include "plugin/host/gpu/foam_worker.h"
#include "plugin/host/preview/offscreen.h"
#include "plugin/light/light.h"
#include "plugin/render/render.h"
#include "plugin/render/seen_drops.h"
#include "tests/plugin/host/preview/compare.h"
#include "tests/plugin/host/preview/gpu.h"

namespace pelagic {
namespace {

struct BothPictures {
    Picture cpu, gpu;
};

BothPictures compare_frame(const char* name, Scene scene, glm::ivec2 size = {192, 108}) {
    gpu::need_context();
    scene.camera.resolution = size;
    RenderOptions options = render_options(scene);
    options.samples = 1;
    const Sky sky = make_sky(scene);
    Picture cpu;
    Renderer(scene, options, sky, std::array{5}).render(5, cpu);
    OffscreenPicture gpu = render_offscreen(plan_offscreen(scene, 5), sky);
    EXPECT_EQ(gpu.picture.resolution, cpu.resolution);
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
    return {std::move(cpu), std::move(gpu.picture)};
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
TEST(PreviewsPicture, IsTheCpusFromBelow) {
    Scene scene = scene_of({0.0, 0.0, -9.0}, {0.0, 10.0, -4.0});
    scene.camera.fov_deg = 90.0;
    compare_frame("from below", scene);
    scene.sea.depth_m = 15.0;
    compare_frame("from below, over a floor", scene);
}
// Towards the sun, in the shafts of its light.
TEST(PreviewsPicture, IsTheCpusInShafts) {
    Scene scene = scene_of({0.0, 0.0, -4.0}, {1.5, 6.0, -1.5});
    scene.sea.wind_speed_mps = 4.0;
    scene.sea.fetch_m = 20e3;
    scene.light.sun_azimuth_deg = 20.0;
    scene.camera.fov_deg = 80.0;
    const auto [cpu, gpu] = compare_frame("in shafts", scene);
    scene.water.caustics = 0.0;
    scene.camera.resolution = cpu.resolution;
    const OffscreenPicture even = render_offscreen(plan_offscreen(scene, 5), make_sky(scene));
    std::size_t other = 0;
    for (std::size_t i = 0; i < cpu.layers.size(); ++i)
        other += std::abs(gpu.layers[i].sea.y / even.picture.layers[i].sea.y - 1.0f) > 0.02f;
    EXPECT_GT(other, cpu.layers.size() / 4);
}
TEST(PreviewsPicture, IsTheCpusHalfUnder) {
    Scene scene = scene_of({0.0, 0.0, -0.04}, {0.0, 10.0, -2.0});
    scene.camera.fov_deg = 90.0;
    scene.sea.wind_speed_mps = 3.0;
    scene.sea.depth_m = 8.0;
    scene.surface.earth_curvature = false;
    const auto [cpu, gpu] = compare_frame("half under", scene);
    // Water alone has no sky in it.
    const auto below = std::ranges::count_if(cpu.layers, [](const SeaRadiance& of) {
        return of.sky == glm::vec3(0.0f) && of.air == glm::vec3(0.0f);
    });
    const auto pixels = static_cast<std::ptrdiff_t>(cpu.layers.size());
    EXPECT_GT(below, pixels / 12);
    EXPECT_LT(below, pixels * 11 / 12);
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

// Through the slopes of the waves, lit through them.
TEST(PreviewsPicture, IsTheCpusOfAFloor) {
    Scene scene = scene_of({0.0, 0.0, 2.5}, {8.0, 3.0, 0.0});
    scene.sea.wind_speed_mps = 3.0;
    scene.sea.depth_m = 2.5;
    scene.sea.depth_file = std::string(PELAGIC_SOURCE_DIR) + "/examples/data/atoll.exr";
    scene.water.floor_pattern = std::string(PELAGIC_SOURCE_DIR) + "/examples/data/tiles.exr";
    compare_frame("a floor", scene);
}
TEST(PreviewsPicture, IsTheCpusOfCopiesAtRandomOffsets) {
    Scene scene = scene_of({3e4, -60.0, 12.0}, {3e4, 0.0, 0.0});
    scene.waves.tiling = Tiling::Random;
    compare_frame("of copies", scene);
}
// A mesh that is no whole grid, and one with heights and normals of its own: no other test has their vertices and shaders.
TEST(PreviewsPicture, IsTheCpusOfAPatchInNothing) {
    Scene scene = scene_of({0.0, -26.0, 9.0}, {0.0, 0.0, 0.0});
    scene.surface.size_m = 30.0;
    scene.surface.beyond = Beyond::Nothing;
    compare_frame("of a patch in nothing", scene);
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
    compare_frame("of a cage in the sea", scene);
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
    compare_frame("of spray", sprayed_scene({0.0, -60.0, 12.0}, {0.0, 0.0, 8.0}));
}
TEST(PreviewsPicture, IsTheCpusOfSprayFromAPlane) {
    compare_frame("of spray from a plane", sprayed_scene({1e6, -1e6, 400.0}, {1e6, -1e6 + 1500.0, 0.0}));
}

// In each pixel: whether drops hide something of what is behind them.
std::vector<bool> are_behind_drops(const Scene& scene, int frame) {
    const View view = view_at(scene.camera, frame);
    const auto sea =
        std::make_shared<const Sea<float>>(picture_plan(scene, std::array{frame}, render_options(scene)));
    std::vector<SprayDrop> drops;
    SprayDrops<float>(*sea, kDropsSquare_m).at(scene.shot.time_s(frame), glm::dvec2(view.position_m), drops);
    const Spray unlit;
    const double curvature_per_m = projected_grid_options(*sea->plan().from).curvature_per_m;
    std::vector<bool> behind(static_cast<std::size_t>(view.resolution.x * view.resolution.y));
    for (const SeenDrop& drop :
         seen_drops(drops, {.view = view, .curvature_per_m = curvature_per_m, .spray = unlit}))
        for (int y = 0; y < view.resolution.y; ++y) {
            if (std::abs(y + 0.5 - drop.at_px.y) > drop.radius_px) continue;
            for (int x = 0; x < view.resolution.x; ++x)
                if (drop.hides({x + 0.5, y + 0.5}, 1e30f) > 0.02f)
                    behind[static_cast<std::size_t>(y * view.resolution.x + x)] = true;
        }
    return behind;
}
// Before the sky, before the sea, cut by it, and one before the other: in each layer.
TEST(PreviewsPicture, IsTheCpusOfDropsOfSpray) {
    Scene scene = scene_of({0.0, -60.0, 5.0}, {0.0, 0.0, 3.0});
    scene.sea.wind_speed_mps = 18.0;
    scene.effects.spray = scene.effects.spray_drops = true;
    scene.waves.cascades = {{150.0, 128}, {31.0, 64}};
    scene.effects.foam_decay_s = 0.0;  // its past takes long
    scene.camera.resolution = {200, 112};
    const BothPictures both = compare_frame("of drops", scene, scene.camera.resolution);
    const std::vector<bool> behind = are_behind_drops(scene, 5);
    double sum = 0.0, pixels = 0.0;
    for (std::size_t i = 0; i < behind.size(); ++i) {
        if (!behind[i] || both.cpu.sea[i] != both.gpu.sea[i]) continue;
        const SeaRadiance &a = both.cpu.layers[i], &b = both.gpu.layers[i];
        glm::vec3 apart(0.0f);
        for (glm::vec3 SeaRadiance::*layer :
             {&SeaRadiance::sun, &SeaRadiance::sky, &SeaRadiance::sea, &SeaRadiance::foam, &SeaRadiance::air})
            apart += glm::abs(a.*layer - b.*layer);
        sum += static_cast<double>((apart / radiance_of(a)).y);
        pixels += 1.0;
    }
    std::printf("    behind drops: %.0f pixels, mean difference %.1e\n", pixels, sum / pixels);
    EXPECT_GT(pixels, 1000.0);
    // On a GPU the sea itself differs by more (1.9e-4 in the median on an H200, and 4.1e-4 in this mean).
    EXPECT_LE(sum / pixels, gpu::is_software() ? 1e-4 : 1e-3);
}

// What waves that broke before have left, near and far, in both hosts alike.
Scene living_scene(glm::dvec3 position_m, glm::dvec3 look_at_m) {
    Scene scene = scene_of(position_m, look_at_m);
    scene.sea.wind_speed_mps = 14.0;
    scene.effects.foam_decay_s = 2.0;
    scene.effects.foam_drift = 0.02;
    return scene;
}
double mean_foam(const Picture& picture) {
    double sum = 0.0, pixels = 0.0;
    for (std::size_t i = 0; i < picture.layers.size(); ++i) {
        sum += picture.sea[i] * static_cast<double>(picture.layers[i].foam.y);
        pixels += picture.sea[i];
    }
    return sum / pixels;
}
TEST(PreviewsPicture, IsTheCpusOfLivingFoam) {
    const BothPictures both =
        compare_frame("of living foam", living_scene({3e4, -60.0, 6.0}, {3e4, 0.0, 0.0}));
    std::printf("    foam in all %.6f of the CPU's\n", mean_foam(both.gpu) / mean_foam(both.cpu));
    EXPECT_NEAR(mean_foam(both.gpu) / mean_foam(both.cpu), 1.0, 5e-4);
}
TEST(PreviewsPicture, IsTheCpusOfLivingFoamFromAPlane) {
    compare_frame("of living foam from a plane", living_scene({1e6, -1e6, 400.0}, {1e6, -1e6 + 1500.0, 0.0}));
}

// examples/trawler.toml, smaller: the wake of a turn, with its strip of foam and calm.
TEST(PreviewsPicture, IsTheCpusOfAWake) {
    Scene scene;
    scene.sea.wind_speed_mps = 4.0;
    scene.sea.wind_direction_deg = 200.0;
    scene.sea.fetch_m = 8e3;
    scene.waves.vessels = {{.path = "-1600 -215 -225, -900 -95 -175, -400 -25 -120, 1 8 -42, 200 8 0",
                            .length_m = 26.0,
                            .beam_m = 7.5,
                            .draught_m = 3.0}};
    scene.camera.position_m = {-105.0, -285.0, 80.0};
    scene.camera.look_at_m = {-14.0, -78.0, 0.0};
    scene.camera.fov_deg = 46.0;
    scene.light.sun_elevation_deg = 13.0;
    scene.light.sun_azimuth_deg = 122.0;
    scene.quality.level = QualityLevel::Preview;
    const auto [cpu, gpu] = compare_frame("of a wake", scene);
    EXPECT_NEAR(mean_foam(gpu) / mean_foam(cpu), 1.0, 1e-3);
    scene.waves.vessels.clear();
    scene.camera.resolution = cpu.resolution;
    const OffscreenPicture bare = render_offscreen(plan_offscreen(scene, 5), make_sky(scene));
    EXPECT_GT(compare(gpu, bare.picture).last_percent, 0.1);
    EXPECT_GT(mean_foam(gpu), 2.0 * mean_foam(bare.picture));
}

Scene changing_scene() {
    Scene scene = living_scene({0.0, -60.0, 6.0}, {0.0, 0.0, 0.0});
    scene.keyed = {{.path = "sea.wind_speed_mps", .keys = {.keys = {{1, 7.0}, {9, 16.0}}}}};
    return scene;
}

TEST(PreviewsPicture, IsTheCpusOfASeaThatChanges) {
    compare_frame("of a sea that changes", changing_scene());
}
// The window keeps textures and foam from one time to the next, and takes the tables of each.
TEST(PreviewsPicture, OfASeaThatChangesHasTheTablesOfItsTime) {
    gpu::need_context();
    Scene scene = changing_scene();
    scene.effects.foam_decay_s = 0.0;
    scene.camera.resolution = {160, 90};
    const OffscreenPlan planned = plan_offscreen(scene, 5);
    const Sky sky = make_sky(scene);
    const Picture alone = render_offscreen(planned, sky).picture;
    Frame<float> frame(std::make_shared<const SeaOverTime<float>>(planned.plan));
    SeaRenderer renderer;
    for (const int n : {1, 5}) {
        frame.set(scene.shot.time_s(n));
        PackedFrame packed(frame.shared_sea(), 0);
        packed.pack(frame);
        renderer.upload(packed);
    }
    const Scene now = scene_at(scene, 5);
    renderer.set_sky(sky, make_water(now, frame.sea().plan().from->spectrum));
    renderer.draw(view_at(now.camera, 5), planned.mesh,
                  {.lighting = render_options(now).lighting,
                   .foam = make_foam(now, make_foam_picture(now)),
                   .layers = true});
    const Difference difference = compare(alone, renderer.read_layers());
    EXPECT_EQ(difference.last_percent, 0.0);
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
    FoamWorker worker(std::make_shared<const SeaOverTime<float>>(sea));
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

// The nearer of two dense drops over the other, with and without layers, and what shows the sea still says so.
TEST(PreviewsPicture, OfDropsHasTheNearestInFront) {
    gpu::need_context();
    Scene scene = scene_of({0.0, -60.0, 4.0}, {0.0, 0.0, 0.0});
    scene.camera.resolution = {64, 36};
    Stage stage(scene);
    DrawOptions options{.lighting = {}, .layers = true};
    options.lighting.spray = true;
    const Picture bare = stage.drawn(options);
    // Spray that is drops alone, under a sky that is bright above.
    Spray spray{.columns = 2, .rows = 2, .above = glm::vec3(1.0f)};
    spray.texels.resize(4);
    const glm::dvec3 eye = stage.view.position_m, forward = stage.view.forward, up = stage.view.up;
    const std::vector<SprayDrop> drops{
        {.position_m = eye + 3.0 * forward - 0.3 * up, .width_m = 1.0, .section_m2 = 3.0},
        {.position_m = eye + 4.5 * forward + 0.3 * up, .width_m = 1.0, .section_m2 = 3.0}};
    const Air air = make_sky(scene).air->seen_from(stage.view.position_m.z);
    const std::vector<SeenDrop> seen =
        seen_drops(drops, {.view = stage.view,
                           .curvature_per_m = stage.mesh.points.curvature_per_m,
                           .air = &air,
                           .spray = spray});
    ASSERT_EQ(seen.size(), 2u);
    EXPECT_GT(seen[0].radiance.y, 1.1f * seen[1].radiance.y);  // so that the order counts
    stage.renderer.set_spray(spray, std::make_shared<std::vector<SprayDrop>>(drops));
    for (const bool layers : {true, false}) {
        options.layers = layers;
        const Picture picture = stage.drawn(options);
        for (std::size_t i = 0; i < bare.layers.size(); ++i) {
            const glm::dvec2 place(static_cast<double>(i % 64) + 0.5, static_cast<double>(i / 64) + 0.5);
            glm::vec3 expected = radiance_of(bare.layers[i]);
            for (const SeenDrop& drop : seen)
                expected += drop.hides(place, 1e30f) * (drop.radiance - expected);
            for (int c = 0; c < 3; ++c)  // the shader has places in single precision
                ASSERT_NEAR(radiance_of(picture.layers[i])[c], expected[c], 1e-4f * expected[c]) << i;
            ASSERT_EQ(picture.sea[i], bare.sea[i]);
        }
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
