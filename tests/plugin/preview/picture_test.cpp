// Whole frames: the preview's picture against the CPU's (plugin/render), pixel by pixel, before tone mapping.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "plugin/preview/offscreen.h"
#include "plugin/render/render.h"
#include "tests/plugin/preview/gpu.h"

namespace pelagic {
namespace {

struct Difference {
    double median = 0.0, last_percent = 0.0, silhouettes = 0.0;
};

// Relative differences of the whole radiance over pixels that show the same, sea or sky, as all of their
// neighbours in both pictures.
Difference compare(const Picture& a, const Picture& b) {
    const int width = a.resolution.x, height = a.resolution.y;
    std::vector<double> differences;
    for (int y = 1; y + 1 < height; ++y)
        for (int x = 1; x + 1 < width; ++x) {
            const auto at = [&](int i, int j) { return static_cast<std::size_t>((y + j) * width + x + i); };
            bool alike = true;
            for (int j = -1; j <= 1; ++j)
                for (int i = -1; i <= 1; ++i)
                    alike = alike && a.sea[at(i, j)] == a.sea[at(0, 0)] && b.sea[at(i, j)] == a.sea[at(0, 0)];
            if (!alike) continue;
            const glm::vec3 first = radiance_of(a.layers[at(0, 0)]), second = radiance_of(b.layers[at(0, 0)]);
            double worst = 0.0;
            for (int c = 0; c < 3; ++c)
                worst = std::max(worst, static_cast<double>(std::abs(first[c] - second[c])) /
                                            std::max(static_cast<double>(std::abs(first[c])), 1e-6));
            differences.push_back(std::isfinite(worst) ? worst : 1e30);
        }
    Difference difference;
    if (differences.empty()) return difference;
    std::sort(differences.begin(), differences.end());
    difference.median = differences[differences.size() / 2];
    difference.last_percent = differences[differences.size() * 99 / 100];
    difference.silhouettes = 1.0 - static_cast<double>(differences.size()) / (width - 2) / (height - 2);
    return difference;
}

void compare_frame(const char* name, Scene scene) {
    gpu::need_context();
    scene.camera.resolution = {640, 360};
    RenderOptions options = render_options(scene);
    options.samples = 1;
    const Sky sky = make_sky(scene);
    Picture cpu;
    Renderer(scene, options, sky).render(5, cpu);
    const OffscreenPicture gpu = render_offscreen(scene, sky, 5);
    ASSERT_EQ(gpu.picture.resolution, cpu.resolution);
    const Difference difference = compare(cpu, gpu.picture);
    std::printf("    %s: median %.1e, 99th percentile %.1e, at silhouettes %.1f %% of the pixels\n", name,
                difference.median, difference.last_percent, 100.0 * difference.silhouettes);
    // The picture has sea and sky, and each of its terms.
    const auto sea_pixels = std::count(cpu.sea.begin(), cpu.sea.end(), 1);
    EXPECT_GT(sea_pixels, 640 * 360 / 4);
    EXPECT_LT(difference.silhouettes, 0.25);
    EXPECT_GT(difference.median, 0.0);  // two programs, not one twice
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
TEST(PreviewsPicture, IsTheCpusOfTrains) {
    Scene scene = scene_of({0.0, -60.0, 12.0}, {0.0, 0.0, 2.0});
    scene.waves.model = WaveModel::Trochoid;
    scene.waves.cascades.clear();
    compare_frame("of trains", scene);
}

// A term that is off is black, and the others are as they were.
TEST(PreviewsPicture, OfATermThatIsOffHasNoneOfIt) {
    gpu::need_context();
    Scene scene = scene_of({0.0, -60.0, 4.0}, {0.0, 0.0, 0.0});
    scene.camera.resolution = {64, 36};
    const auto sea = std::make_shared<const Sea<float>>(scene, picture_plan(scene));
    Frame<float> frame(sea);
    frame.set(1.0);
    PackedFrame packed(sea, 0);
    packed.pack(frame);
    SeaRenderer renderer;
    const Sky sky = make_sky(scene);
    renderer.set_sky(sky, make_water(scene));
    renderer.upload(packed);
    const View view = view_at(scene.camera, 1);
    const ProjectedGrid grid = projected_grid(view, projected_grid_options(scene));
    DrawOptions options{.lighting = {}, .layers = true};
    renderer.draw(view, grid, options);
    const Picture all = renderer.read_layers();
    options.lighting.sun = options.lighting.whitecaps = false;
    renderer.draw(view, grid, options);
    const Picture some = renderer.read_layers();
    double sun = 0.0, foam = 0.0;
    for (std::size_t i = 0; i < all.layers.size(); ++i) {
        if (!all.sea[i]) continue;
        sun += static_cast<double>(all.layers[i].sun.y);
        foam += static_cast<double>(all.layers[i].foam.y);
        EXPECT_EQ(some.layers[i].sun, glm::vec3(0.0f));
        EXPECT_EQ(some.layers[i].foam, glm::vec3(0.0f));
        // Foam gives its share of the pixel back.
        EXPECT_GE(some.layers[i].sky.y, all.layers[i].sky.y);
    }
    EXPECT_GT(sun, 0.0);
    EXPECT_GT(foam, 0.0);
}

// Without layers the one picture is their sum.
TEST(PreviewsPicture, WithoutLayersIsTheirSum) {
    gpu::need_context();
    Scene scene = scene_of({0.0, -60.0, 4.0}, {0.0, 0.0, 0.0});
    scene.camera.resolution = {64, 36};
    const auto sea = std::make_shared<const Sea<float>>(scene, picture_plan(scene));
    Frame<float> frame(sea);
    frame.set(1.0);
    PackedFrame packed(sea, 0);
    packed.pack(frame);
    SeaRenderer renderer;
    renderer.set_sky(make_sky(scene), make_water(scene));
    renderer.upload(packed);
    const View view = view_at(scene.camera, 1);
    const ProjectedGrid grid = projected_grid(view, projected_grid_options(scene));
    renderer.draw(view, grid, {.lighting = {}, .layers = true});
    const Picture layers = renderer.read_layers();
    renderer.draw(view, grid, {.lighting = {}});
    const Picture sum = renderer.read_layers();
    for (std::size_t i = 0; i < layers.layers.size(); ++i) {
        const glm::vec3 expected = radiance_of(layers.layers[i]);
        for (int c = 0; c < 3; ++c)  // rounding of three additions
            ASSERT_NEAR(radiance_of(sum.layers[i])[c], expected[c], 4e-7f * expected[c]);
    }
}

TEST(PackedFrame, RefusesWhatIsNotAPicturesOwn) {
    Scene scene = scene_of({0.0, -60.0, 4.0}, {0.0, 0.0, 0.0});
    scene.waves.cascades = {{100.0, 32}};
    const auto sea = std::make_shared<const Sea<float>>(scene, picture_plan(scene));
    const auto other = std::make_shared<const Sea<float>>(scene, picture_plan(scene));
    PackedFrame packed(sea, 0);
    Frame<float> without_time(sea), of_another(other);
    of_another.set(0.0);
    EXPECT_THROW(packed.pack(without_time), std::invalid_argument);
    EXPECT_THROW(packed.pack(of_another), std::invalid_argument);
    Scene patch = scene;
    const auto baked = std::make_shared<const Sea<float>>(patch, make_plan(patch));
    EXPECT_THROW(PackedFrame(baked, 0), std::invalid_argument);  // its mesh is a lattice
}

}  // namespace
}  // namespace pelagic
