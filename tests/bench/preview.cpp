// The preview's frames: of four cascades and of wave trains, from a deck, on a GPU or, slowly, by Mesa.
#include <epoxy/gl.h>

#include <array>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "plugin/host/preview/offscreen.h"
#include "plugin/light/light.h"
#include "plugin/render/render.h"
#include "tests/bench/timing.h"

namespace pelagic::bench {
namespace {

// A scene's sea on the GPU, drawn again and again.
class Drawn {
  public:
    explicit Drawn(const Scene& scene)
        : sea_(std::make_shared<const Sea<float>>(picture_plan(scene, std::array{1}))),
          view_(view_at(scene.camera, 1)),
          mesh_(open_sea(projected_grid(view_, projected_grid_options(*prepare(scene))))) {
        options_.lighting = render_options(scene).lighting;
        options_.foam = make_foam(scene, nullptr);
        Frame<float> frame(sea_);
        frame.set(1.0);
        PackedFrame packed(sea_, 0);
        packed.pack(frame);
        renderer_.set_sky(make_sky(scene), make_water(scene));
        renderer_.upload(packed);
    }
    void draw() {
        renderer_.draw(view_, mesh_, options_);
        glFinish();
    }
    std::string device() const { return renderer_.device(); }

  private:
    std::shared_ptr<const Sea<float>> sea_;
    View view_;
    SeaMesh mesh_;
    DrawOptions options_;
    SeaRenderer renderer_;
};

void frame_times() {
    std::printf("The preview's frames, from a deck\n");
    Scene cascades, trains;
    cascades.waves.cascades = {{160.0, 256}, {37.7, 256}, {8.9, 256}, {2.1, 256}};
    trains.waves.model = WaveModel::Trochoid;
    for (const auto& [name, of] : {std::pair{"four 256^2 cascades", cascades}, {"wave trains", trains}})
        for (const glm::ivec2 size : {glm::ivec2(1280, 720), glm::ivec2(1920, 1080)}) {
            Scene scene = of;
            scene.quality.level = QualityLevel::Preview;
            scene.camera.position_m = {0.0, -60.0, 4.0};
            scene.camera.look_at_m = {0.0, 0.0, 0.0};
            scene.camera.resolution = size;
            Drawn drawn(scene);
            const bool is_software = drawn.device().find("llvmpipe") != std::string::npos;
            std::vector<Timed> timed{{name, [&] { drawn.draw(); }}};
            interleave(timed, is_software ? 5 : 50);
            std::printf("  %-20s %4d x %4d   %.2f ms   %s\n", name, size.x, size.y, timed[0].median(),
                        drawn.device().c_str());
        }
}

}  // namespace
}  // namespace pelagic::bench

int main() {
    const pelagic::OffscreenContext context;
    pelagic::bench::frame_times();
}
