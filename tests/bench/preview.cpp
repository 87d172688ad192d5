// The preview's frames: of four cascades and of wave trains, from a deck, on a GPU or, slowly, by Mesa.
#include <epoxy/gl.h>

#include <array>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/lighting/object.h"
#include "plugin/format/shot/object_file.h"
#include "plugin/host/preview/drawn_objects.h"
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
        const Sky sky = make_sky(scene);
        const WaterBody water = make_water(scene);
        renderer_.set_sky(sky, water);
        renderer_.upload(packed);
        renderer_.set_objects(drawn_objects(frame, scene, {.frame = 1.0}),
                              object_surroundings(options_.lighting, sky, water, 0.0));
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

// Each triangle in four, so that the body is as it was.
std::shared_ptr<const ObjectMesh> split(const ObjectMesh& mesh) {
    ObjectMeshData data = mesh.data();
    const std::vector<std::uint32_t> triangles = std::exchange(data.triangles, {});
    const std::vector<glm::vec3> normals = std::exchange(data.normals, {});
    const auto material = std::exchange(data.material, {});
    for (std::size_t i = 0; i < triangles.size(); i += 3) {
        std::array<std::uint32_t, 6> points{triangles[i], triangles[i + 1], triangles[i + 2]};
        std::array<glm::vec3, 6> across{normals[i], normals[i + 1], normals[i + 2]};
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t next = (k + 1) % 3;
            points[3 + k] = static_cast<std::uint32_t>(data.points_m.size());
            data.points_m.push_back(0.5f * (data.points_m[points[k]] + data.points_m[points[next]]));
            across[3 + k] = glm::normalize(across[k] + 0.999f * across[next]);
        }
        for (const std::size_t k : {0u, 3u, 5u, 3u, 1u, 4u, 5u, 4u, 2u, 3u, 4u, 5u}) {
            data.triangles.push_back(points[k]);
            data.normals.push_back(across[k]);
        }
        data.material.insert(data.material.end(), 4, material[i / 3]);
    }
    return std::make_shared<const ObjectMesh>(std::move(data));
}

void with_a_ship() {
    Scene scene;
    scene.quality.level = QualityLevel::Preview;
    scene.camera.position_m = {0.0, -40.0, 6.0};
    scene.camera.look_at_m = {0.0, 0.0, 2.0};
    scene.camera.resolution = {640, 360};
    Drawn without(scene);
    SceneObject ship;
    ship.name = "trawler";
    ship.mesh = split(*split(*load_object(PELAGIC_SOURCE_DIR "/examples/data/trawler.obj")));
    ship.heading_deg = 30.0;
    scene.objects = {ship};
    Drawn with(scene);
    std::vector<Timed> timed{{"without", [&] { without.draw(); }}, {"with", [&] { with.draw(); }}};
    interleave(timed, with.device().find("llvmpipe") != std::string::npos ? 3 : 50);
    const double ratio = timed[1].median() / timed[0].median();
    std::printf("The default sea with a ship of %zu triangles over it without: %.2f, target 1.4: %s   %s\n",
                ship.mesh->data().triangles.size() / 3, ratio, verdict(ratio <= 1.4), with.device().c_str());
}

}  // namespace
}  // namespace pelagic::bench

int main() {
    const pelagic::OffscreenContext context;
    pelagic::bench::with_a_ship();
    pelagic::bench::frame_times();
}
