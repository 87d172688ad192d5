// The same views by rays (examples/trace) and by `pelagic render`, with its own cells and with finer ones: how their luminances differ, where rays only decide what hides
// what, and where they also find what is mirrored. bench_trace [WIDTH [SAMPLES]]
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>

#include "examples/trace/tracer.h"
#include "plugin/format/shot/shot.h"
#include "plugin/light/light.h"
#include "tests/examples/compare.h"

namespace pelagic {
namespace {

using test::at_share;
using test::differences;

constexpr int kAway_px = 2;

double seconds_of(const std::function<void()>& work) {
    const auto before = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - before).count();
}

struct Case {
    const char* name;
    Scene scene;
    trace::Placement object;
};

void print(const char* what, const std::vector<float>& of) {
    std::size_t more = 0;
    for (const float one : of) more += one > 0.1f;
    std::printf("  %-34s %7zu %8.2f %8.2f %8.2f %9.1f\n", what, of.size(), 100.0 * at_share(of, 0.5),
                100.0 * at_share(of, 0.9), 100.0 * at_share(of, 0.99),
                100.0 * static_cast<double>(more) / static_cast<double>(std::max<std::size_t>(of.size(), 1)));
}

void compare(const Case& of, const trace::FloatingObject& boat, int samples) {
    const int frame = of.scene.shot.first_frame;
    const Sky sky = make_sky(of.scene);
    RenderOptions options = render_options(of.scene);
    options.samples = samples;
    Picture rendered, finely;
    const auto render = [&](const Scene& scene, Picture& to) {
        return seconds_of([&] {
            const std::array frames{frame};
            Renderer(scene, options, sky, frames).render(frame, to);
        });
    };
    Scene fine = of.scene;
    fine.surface.cell_px = 1.0;
    const double render_s = render(of.scene, rendered);
    render(fine, finely);
    trace::TracedPicture visible, traced;
    const auto trace = [&](bool mirrors, trace::TracedPicture& to) {
        return seconds_of([&] {
            to = trace::Tracer(
                     of.scene,
                     {.picture = options, .traced = mirrors, .object = &boat, .placement = of.object}, sky,
                     frame)
                     .render();
        });
    };
    const double visible_s = trace(false, visible), traced_s = trace(true, traced);
    const glm::ivec2 size = rendered.resolution;
    std::printf(
        "%s, %d x %d, %d x %d samples: rendered in %.1f s, by rays %.1f s, with mirrored rays %.1f s\n",
        of.name, size.x, size.y, options.samples, options.samples, render_s, visible_s, traced_s);
    std::printf("  %-34s %7s %8s %8s %8s %9s\n", "difference in luminance [%]", "pixels", "median", "90 %",
                "99 %", "over 10 %");
    const auto away = [&](std::size_t i) { return test::is_away_from(visible.object, size, i, kAway_px); };
    const auto is_sea = [&](std::size_t i) { return away(i) && rendered.sea[i] && visible.picture.sea[i]; };
    print("what hides what: sea", differences(visible.picture, rendered, is_sea));
    print("the same, with sky", differences(visible.picture, rendered, away));
    print("mesh of 1-pixel cells: sea", differences(visible.picture, finely, is_sea));
    print("the same, with sky", differences(visible.picture, finely, away));
    print("mirrored and shadows: sea", differences(traced.picture, rendered, is_sea));
    // From the horizon down to the picture's lower edge.
    std::size_t top = 0;
    while (top < rendered.sea.size() && !rendered.sea[top]) ++top;
    const int horizon = static_cast<int>(top) / size.x, part = std::max((size.y - horizon) / 3, 1);
    for (int i = 0; i < 3; ++i) {
        const auto in_part = [&](std::size_t at) {
            return is_sea(at) && std::min((static_cast<int>(at) / size.x - horizon) / part, 2) == i;
        };
        print(i == 0   ? "  its third by the horizon"
              : i == 1 ? "  in the middle"
                       : "  by the lower edge",
              differences(traced.picture, rendered, in_part));
    }
    const auto by_boat = [&](std::size_t i) {
        return is_sea(i) && !test::is_away_from(visible.object, size, i, size.x / 30);
    };
    print("  round the boat", differences(traced.picture, rendered, by_boat));
    const auto mean = [&](const Picture& picture) {
        double sum = 0.0;
        for (std::size_t i = 0; i < picture.layers.size(); ++i)
            if (is_sea(i)) sum += test::luminance_of(picture.layers[i]);
        return sum;
    };
    std::printf("  mean over the sea, over the rendered one's: visibility %.3f, traced %.3f\n\n",
                mean(visible.picture) / mean(rendered), mean(traced.picture) / mean(rendered));
}

}  // namespace
}  // namespace pelagic

int main(int argc, char** argv) {
    using namespace pelagic;
    const int width = argc > 1 ? std::atoi(argv[1]) : 640, samples = argc > 2 ? std::atoi(argv[2]) : 1;
    const std::string root = PELAGIC_SOURCE_DIR;
    const auto load = [&](const char* shot) {
        Scene scene = load_shot(root + shot, check_scene);
        scene.camera.resolution = {width, width * 9 / 16};
        return scene;
    };
    const trace::FloatingObject boat = trace::read_obj(root + "/examples/trace/boat.obj");
    compare(
        {"the first shot", load("/examples/first-shot.toml"), {.at_m = {-17.5, -62.0}, .heading_rad = 2.6}},
        boat, samples);
    Scene storm = load("/examples/pictures/storm.toml");
    storm.camera.position_m.z = 10.0;
    storm.effects.spray = false;
    compare({"a storm from 10 m", storm, {.at_m = {2.0, -28.0}, .heading_rad = 2.4}}, boat, samples);
}
