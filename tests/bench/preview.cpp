// The preview beside the CPU's renderer: how far their pictures differ, and what wave trains cost seen from
// near and far. On a real GPU, frame times as well.

#include <epoxy/gl.h>
#include <array>

#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "plugin/host/preview/offscreen.h"
#include "plugin/light/light.h"
#include "plugin/render/render.h"
#include "tests/bench/timing.h"
#include "tests/plugin/host/preview/compare.h"

namespace pelagic::bench {
namespace {

Scene cascades() {
    Scene scene;
    scene.waves.cascades = {{160.0, 256}, {37.7, 256}, {8.9, 256}, {2.1, 256}};
    scene.quality.level = QualityLevel::Preview;
    return scene;
}

Scene trains() {
    Scene scene;
    scene.waves.model = WaveModel::Trochoid;
    scene.quality.level = QualityLevel::Preview;
    return scene;
}

void looking(Scene& scene, glm::dvec3 position_m, glm::dvec3 look_at_m) {
    scene.camera.position_m = position_m;
    scene.camera.look_at_m = look_at_m;
}

void pictures() {
    std::printf(
        "Preview against CPU, HDR, 640 x 360, relative difference per pixel away from silhouettes\n"
        "  %-28s %9s %18s\n",
        "", "median", "99th percentile");
    Scene deck = cascades(), plane = cascades(), of_trains = trains();
    looking(deck, {0.0, -60.0, 4.0}, {0.0, 0.0, 0.0});
    looking(plane, {1e6, -1e6, 1500.0}, {1e6, -1e6 + 8000.0, 0.0});
    looking(of_trains, {0.0, -60.0, 12.0}, {0.0, 0.0, 2.0});
    for (auto& [name, scene] : std::vector<std::pair<const char*, Scene>>{
             {"from a deck", deck}, {"from a plane, 1e6 m away", plane}, {"of trains", of_trains}}) {
        scene.camera.resolution = {640, 360};
        RenderOptions options = render_options(scene);
        options.samples = 1;
        const Sky sky = make_sky(scene);
        Picture cpu;
        Renderer(scene, options, sky, std::array{5}).render(5, cpu);
        const Difference difference = compare(cpu, render_offscreen(plan_offscreen(scene, 5), sky).picture);
        std::printf("  %-28s %9.1e %18.1e   <= 1e-3 %s, <= 1e-2 %s\n", name, difference.median,
                    difference.last_percent, verdict(difference.median <= 1e-3),
                    verdict(difference.last_percent <= 1e-2));
    }
}

// A scene's sea on the GPU, drawn again and again.
class Drawn {
  public:
    Drawn(const Scene& scene, const LightingChoice& lighting)
        : sea_(std::make_shared<const Sea<float>>(picture_plan(scene, std::array{1}))),
          view_(view_at(scene.camera, 1)),
          grid_(projected_grid(view_, projected_grid_options(*prepare(scene)))) {
        options_.lighting = lighting;
        options_.foam = make_foam(scene);
        Frame<float> frame(sea_);
        frame.set(1.0);
        PackedFrame packed(sea_, 0);
        packed.pack(frame);
        renderer_.set_sky(make_sky(scene), make_water(scene));
        renderer_.upload(packed);
    }
    void draw() {
        renderer_.draw(view_, grid_, options_);
        glFinish();
    }
    std::string device() const { return renderer_.device(); }

  private:
    std::shared_ptr<const Sea<float>> sea_;
    View view_;
    ProjectedGrid grid_;
    DrawOptions options_;
    SeaRenderer renderer_;
};

// With nine lookups in the sky and, as in the paper, one.
void resolved_trains(SkyQuality quality) {
    std::vector<Timed> timed;
    std::vector<std::unique_ptr<Drawn>> on_gpu;
    std::vector<std::unique_ptr<Renderer>> on_cpu;
    Picture picture;
    constexpr double kHeights_m[] = {4.0, 1000.0, 8000.0};
    for (const double height_m : kHeights_m) {
        Scene scene = trains();
        looking(scene, {0.0, 0.0, height_m}, {0.0, 1000.0, height_m});
        scene.camera.resolution = {1024, 768};
        RenderOptions options = render_options(scene);
        options.samples = 1;
        options.lighting.sky_quality = quality;
        on_gpu.push_back(std::make_unique<Drawn>(scene, options.lighting));
        on_cpu.push_back(std::make_unique<Renderer>(scene, options, make_sky(scene), std::array{1}));
        timed.push_back({"preview", [drawn = on_gpu.back().get()] { drawn->draw(); }});
        timed.push_back(
            {"CPU", [renderer = on_cpu.back().get(), &picture] { renderer->render(1, picture); }});
    }
    interleave(timed, 5);
    std::printf(
        "\nResolved trains: 60 of them, 1024 x 768, horizontal view, a whole frame, %s in the sky; preview "
        "on %s\n"
        "  %-10s %10s %10s %10s   4 m / 8000 m\n",
        quality == SkyQuality::One ? "one lookup" : "nine lookups", on_gpu.front()->device().c_str(), "",
        "4 m", "1000 m", "8000 m");
    for (std::size_t side = 0; side < 2; ++side) {
        const double near = timed[side].median(), far = timed[4 + side].median();
        std::printf("  %-10s %7.1f ms %7.1f ms %7.1f ms   %.2f >= 2.5 %s\n", timed[side].name.c_str(), near,
                    timed[2 + side].median(), far, near / far, verdict(near >= 2.5 * far));
    }
}

void frame_times() {
    std::printf("\nFrames on a GPU, from a deck\n");
    Scene deck = cascades(), of_trains = trains();
    for (auto& [name, scene] :
         std::vector<std::pair<const char*, Scene>>{{"four 256^2 cascades", deck}, {"60 trains", of_trains}})
        for (const glm::ivec2 size : {glm::ivec2(1280, 720), glm::ivec2(1920, 1080)}) {
            looking(scene, {0.0, -60.0, 4.0}, {0.0, 0.0, 0.0});
            scene.camera.resolution = size;
            Drawn drawn(scene, render_options(scene).lighting);
            if (drawn.device().find("llvmpipe") != std::string::npos) {
                std::printf("  %-20s %4d x %4d   (no GPU here: %s)\n", name, size.x, size.y,
                            drawn.device().c_str());
                continue;
            }
            std::vector<Timed> timed{{name, [&] { drawn.draw(); }}};
            interleave(timed, 50);
            std::printf("  %-20s %4d x %4d   %.2f ms   %s\n", name, size.x, size.y, timed[0].median(),
                        drawn.device().c_str());
        }
}

}  // namespace
}  // namespace pelagic::bench

int main() {
    const pelagic::OffscreenContext context;
    pelagic::bench::pictures();
    for (const auto quality : {pelagic::SkyQuality::Nine, pelagic::SkyQuality::One})
        pelagic::bench::resolved_trains(quality);
    pelagic::bench::frame_times();
}
