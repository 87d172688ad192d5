// What there is to pay before the first frame: plan, sea and a frame's buffers, at one thread.
// The sea is built beside the plain way that the tests measure it against (tests/core/waves/reference_sea.h:
// each cell by the exact quadrature, one mode after the other), in turn, least of the repeats.
#include <tbb/global_control.h>
#include <array>

#include <chrono>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "core/plan/mode_lattice.h"
#include "core/waves/frame.h"
#include "core/waves/sea.h"
#include "plugin/format/shot/shot.h"
#include "plugin/light/light.h"
#include "plugin/render/render.h"
#include "tests/bench/timing.h"
#include "tests/core/waves/reference_sea.h"

namespace pelagic::bench {
namespace {

// Query of a whole cascade on its own nodes.
Query own_tile(double size_m, int n) {
    Query query;
    query.name = "cascade";
    query.products = products(Product::Position, Product::Normal, Product::SlopeVariance, Product::Breaking);
    query.points = static_cast<std::size_t>(n) * n;
    query.lattice = Lattice{-0.5 * size_m, size_m / n};
    query.only_cascade = 0;
    return query;
}

struct Case {
    const char* name;
    Plan plan;
};

void sea_row(const Case& c, int repeats, int reference_repeats) {
    std::vector<Timed> built{{"sea", [&] { Sea<float>{c.plan}; }}};
    std::vector<Timed> plain{{"reference", [&] { oracle::reference_sea(c.plan); }}};
    interleave(built, repeats);
    for (int i = 0; i < reference_repeats; ++i) {
        const auto start = std::chrono::steady_clock::now();
        plain[0].work();
        plain[0].ms.push_back(
            std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
    }
    std::size_t modes = 0;
    for (const CascadePlan& cascade : c.plan.cascades) modes += lattice_modes(cascade.mode_radius);
    const double ratio = plain[0].least() / built[0].least();
    std::printf("  %-22s %9zu %12.1f %12.2f %9.0f  10: %s\n", c.name, modes, plain[0].least(),
                built[0].least(), ratio, verdict(ratio >= 10.0));
}

Scene shot(const char* path) {
    return load_shot(std::string(PELAGIC_SOURCE_DIR "/examples/") + path, check_scene);
}

// A picture's set-up against the picture, as `pelagic render` makes it, with one sample a pixel. The light is
// made once and no part of either.
void picture_row(const char* path) {
    Scene scene = shot(path);
    scene.camera.resolution = {1280, 720};
    RenderOptions options = render_options(scene);
    options.samples = 1;
    const Plan plan = picture_plan(scene, std::array{1});
    const auto sea = std::make_shared<const Sea<float>>(plan);
    std::vector<int> frames;
    for (int frame = scene.shot.first_frame; frame <= scene.shot.last_frame; ++frame) frames.push_back(frame);
    Renderer renderer(scene, options, make_sky(scene), frames);
    Picture picture;
    int frame = scene.shot.first_frame;
    std::vector<Timed> timed{
        {"plan", [&] { picture_plan(scene, std::array{1}); }},
        {"sea", [&] { Sea<float>{plan}; }},
        {"buffers", [&] { Frame<float>{sea}; }},
        {"picture", [&] { renderer.render(frame++, picture); }},
    };
    interleave(timed, 4);
    const double all = timed[0].least() + timed[1].least() + timed[2].least();
    const double ratio = all / timed[3].least();
    std::printf("  %-22s %8.1f %8.1f %8.1f %10.1f %9.2f  0.5: %s\n", path, timed[0].least(), timed[1].least(),
                timed[2].least(), timed[3].least(), ratio, verdict(ratio <= 0.5));
}

}  // namespace
}  // namespace pelagic::bench

int main() {
    using namespace pelagic;
    using namespace pelagic::bench;
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);

    std::printf("Building a sea, 1 thread, ms, least of the repeats\n  %-22s %9s %12s %12s %9s\n", "",
                "modes", "reference", "built", "ratio");
    Scene cascade;
    cascade.waves.cascades = {{.size_m = 400.0, .resolution = 1024}};
    sea_row({"the default sea", plan_bake(Scene{})}, 15, 3);
    sea_row({"pictures/noon", picture_plan(shot("pictures/noon.toml"), std::array{1})}, 5, 1);
    sea_row({"one 1024^2 cascade", make_plan(cascade, {own_tile(400.0, 1024)})}, 7, 1);
    sea_row({"buoy-hour", plan_bake(shot("buoy-hour.toml"))}, 15, 3);

    std::printf("\nBefore the first picture of 1280 x 720, 1 thread, ms\n  %-22s %8s %8s %8s %10s %9s\n", "",
                "plan", "sea", "buffers", "picture", "ratio");
    picture_row("pictures/noon.toml");
    return 0;
}
