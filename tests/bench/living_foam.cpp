// What foam that lives costs: a run's frames and a frame alone, against the same without it; and what its history holds.
//   living_foam [DECAY_S]      default 4

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <vector>

#include "core/plan/memory.h"
#include "plugin/bake/sequence.h"
#include "plugin/light/light.h"
#include "plugin/render/render.h"

namespace pelagic::bench {
namespace {

double seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

template <class Work>
double time_of(const Work& work) {
    const double start_s = seconds();
    work();
    return seconds() - start_s;
}

double median(std::vector<double> values) {
    std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
    return values[values.size() / 2];
}
double mean(const std::vector<double>& values) {
    double sum = 0.0;
    for (const double value : values) sum += value;
    return sum / static_cast<double>(values.size());
}

void row(const char* what, double ratio, double target) {
    std::printf("  %-52s %6.2f   target %.1f: %s\n", what, ratio, target, ratio <= target ? "met" : "missed");
}

// `make(scene)` gives a function of a frame's number. In turn, so that a busy machine slows all alike.
template <class Make>
void compare(const Scene& plain, const Scene& living, int frames, const Make& make) {
    auto without = make(plain), run = make(living);
    without(1);
    run(1);
    std::vector<double> plain_s, run_s, cold_s;
    for (int frame = 2; frame < frames + 2; ++frame) {
        plain_s.push_back(time_of([&] { without(frame); }));
        run_s.push_back(time_of([&] { run(frame); }));
        if (frame % 4 != 2) continue;
        auto alone = make(living);
        cold_s.push_back(time_of([&] { alone(frame); }));
    }
    // Every few frames a run takes another earlier time: its mean counts.
    row("a run's frame, on the mean", mean(run_s) / mean(plain_s), 1.3);
    row("a frame alone", median(cold_s) / median(plain_s), 4.0);
    std::printf("  %-52s %6.1f ms\n", "without it", 1e3 * median(plain_s));
}

void mesh(Scene scene, double decay_s) {
    scene.surface.resolution = 1024;
    Scene living = scene;
    living.effects.foam_decay_s = decay_s;
    std::printf("\nA mesh of 1024^2 with all attributes, computed and encoded as a crate; history %s\n",
                bytes_text(plan_bake(living).foam_history_bytes()).c_str());
    compare(scene, living, 12, [](const Scene& shot) {
        std::shared_ptr<Sequence> sequence = make_sequence(plan_bake(shot));
        return [sequence, slot = std::make_shared<FrameSlot>()](int frame) {
            sequence->compute(frame, *slot);
            sequence->encode(*slot);
            sequence->write(*slot, [](const FileJob& job) { job.content([](std::string_view) {}); });
        };
    });
}

void picture(Scene scene, double decay_s) {
    Scene living = scene;
    living.effects.foam_decay_s = decay_s;
    const std::vector<int> frames{1};
    const RenderOptions options = render_options(scene);
    std::printf("\nA picture of 1280 x 720; history at most %s\n",
                bytes_text(picture_plan(living, frames, options).foam_history_bytes()).c_str());
    compare(scene, living, 8, [&](const Scene& shot) {
        auto renderer = std::make_shared<Renderer>(shot, options, make_sky(shot), frames);
        return [renderer, into = std::make_shared<Picture>()](int frame) { renderer->render(frame, *into); };
    });
}

}  // namespace
}  // namespace pelagic::bench

int main(int argc, char** argv) {
    using namespace pelagic;
    const double decay_s = argc > 1 ? std::atof(argv[1]) : 4.0;
    Scene scene;
    scene.sea.wind_speed_mps = 14.0;
    scene.effects.foam_decay_s = 0.0;
    std::printf("Foam that lives for %g s; wind 14 m/s\n", decay_s);
    bench::mesh(scene, decay_s);
    bench::picture(scene, decay_s);
}
