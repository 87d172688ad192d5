// The numbers of plugin/budget/cost.cpp, fitted anew: frames of the examples' meshes at all levels, and small pictures of them, timed;
// then the least relative error with costs that aren't negative. Or how far off the model is on this machine, calibrated for so many
// threads and no vectors beyond those, over eight examples.
//   bench_cost_model
//   bench_cost_model shots [THREADS [sse4 | avx2]]
#include "plugin/budget/cost.h"

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <memory>
#include <numeric>
#include <string>
#include <thread>
#include <vector>

#include "core/base/instruction_set.h"
#include "core/plan/plan.h"
#include "core/scene/names.h"
#include "plugin/bake/sequence.h"
#include "plugin/budget/calibration.h"
#include "plugin/format/shot/shot.h"
#include "plugin/light/light.h"
#include "plugin/render/batch.h"
#include "plugin/render/render.h"

namespace pelagic {
namespace {

struct Timed {
    std::string what;
    std::vector<double> work;
    double ms;
    double known_ms = 0.0;  // of the ms: of what isn't fitted
};

std::vector<double> as_row(const WorkDone& work) {
    return {work.begin(), work.end()};
}

// Costs ≥ 0 of each kind of work that bring Σ (cost · work/ms − 1)² down, one after another.
std::vector<double> fitted(const std::vector<Timed>& rows) {
    std::vector<double> cost(rows.front().work.size(), 0.0);
    for (int round = 0; round < 20000; ++round)
        for (std::size_t i = 0; i < cost.size(); ++i) {
            double above = 0.0, below = 0.0;
            for (const Timed& row : rows) {
                double rest = 1.0 - row.known_ms / row.ms;
                for (std::size_t j = 0; j < cost.size(); ++j)
                    if (j != i) rest -= cost[j] * row.work[j] / row.ms;
                above += rest * row.work[i] / row.ms;
                below += row.work[i] / row.ms * row.work[i] / row.ms;
            }
            if (below > 0.0) cost[i] = std::max(0.0, above / below);
        }
    return cost;
}

void print(const char* title, const std::vector<Timed>& rows, const std::vector<double>& cost) {
    std::printf("%s:", title);
    for (const double each : cost) std::printf(" %.4g", each);
    std::vector<double> ratios;
    for (const Timed& row : rows) {
        double ms = row.known_ms;
        for (std::size_t i = 0; i < cost.size(); ++i) ms += cost[i] * row.work[i];
        ratios.push_back(ms / row.ms);
        std::printf("\n  %-44s %9.3f ms, said %9.3f", row.what.c_str(), row.ms, ms);
    }
    std::sort(ratios.begin(), ratios.end());
    std::printf("\n  said over taken: %.2f … %.2f, in the middle %.2f\n\n", ratios.front(), ratios.back(),
                ratios[ratios.size() / 2]);
}

constexpr std::array kExamples{"first-shot",  "glassy-swell", "north-sea-storm",
                               "shallow-bay", "trade-wind",   "wave-trains"};

Scene example(const char* name) {
    return load_shot(std::string(PELAGIC_SOURCE_DIR "/examples/") + name + ".toml", check_scene);
}

// A frame of a bake, one after another, so that the foam's past grows as in a run: the least of some.
double frame_of_bake_ms(const Scene& scene) {
    const Plan plan = plan_bake(scene);
    const std::unique_ptr<Sequence> sequence = make_sequence(plan);
    FrameSlot slot;
    double least = 0.0;
    for (int frame = scene.shot.first_frame; frame <= scene.shot.first_frame + 5; ++frame) {
        const auto start = std::chrono::steady_clock::now();
        sequence->compute(frame, slot);
        const double ms =
            std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
        least = frame == scene.shot.first_frame + 1 ? ms : std::min(least, ms);
    }
    return least;
}

std::vector<Timed> meshes() {
    std::vector<Timed> rows;
    for (const char* name : kExamples)
        for (const QualityLevel level : {QualityLevel::Draft, QualityLevel::Preview, QualityLevel::Final})
            for (const int quads : {48, 192, 512})
                for (const bool has_foam : {false, true}) {
                    Scene scene = example(name);
                    scene.quality.level = level;
                    scene.surface.resolution = quads;
                    scene.output.maps.clear();
                    scene.output.cascade_tiles = false;
                    if (!has_foam) scene.effects.foam_decay_s = 0.0;
                    rows.push_back({std::string(name) + ", " + std::string(word_of(level)) + ", " +
                                        std::to_string(quads) + (has_foam ? ", foam that lives" : ""),
                                    as_row(work_of(plan_bake(scene))), frame_of_bake_ms(scene)});
                }
    return rows;
}

struct PictureCase {
    const char* name;
    SkyQuality sky = SkyQuality::Nine;
    int samples = 1;
    double shutter_frames = 0.0;
    bool spray = false;
};

// A picture of a run, in the middle of some: foam goes on from the one before, and not at each by a whole interval.
double picture_taken_ms(const Scene& scene, const RenderOptions& options, const Sky& sky) {
    constexpr std::size_t kFrames = 6;
    std::array<int, kFrames + 1> frames{};
    std::iota(frames.begin(), frames.end(), scene.shot.first_frame);
    Renderer renderer(scene, options, sky, frames);
    Picture picture;
    std::vector<double> ms;
    for (const int frame : frames) {
        const auto start = std::chrono::steady_clock::now();
        renderer.render(frame, picture);
        ms.push_back(
            std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
    }
    std::sort(ms.begin() + 1, ms.end());
    return ms[1 + kFrames / 2];
}

std::vector<Timed> pictures() {
    constexpr std::array kCases = std::to_array<PictureCase>({
        {"nine"},
        {"nine, 3 x 3", SkyQuality::Nine, 3},
        {"integral", SkyQuality::Integral},
        {"shutter, 2 x 2", SkyQuality::Nine, 2, 0.5},
        {"shutter, 3 x 3", SkyQuality::Nine, 3, 0.5},
        {"spray", SkyQuality::Nine, 1, 0.0, true},
        {"spray, 3 x 3", SkyQuality::Nine, 3, 0.0, true},
        {"spray, shutter, 2 x 2", SkyQuality::Nine, 2, 0.5, true},
    });
    std::vector<Timed> rows;
    for (const char* name : kExamples) {
        Scene scene = example(name);
        scene.camera.resolution = {160, 90};
        scene.surface.cell_px = 2.0;
        const Sky sky = make_sky(scene);
        for (const PictureCase& each : kCases) {
            scene.effects.spray = each.spray;
            RenderOptions options = render_options(scene);
            if (each.spray && !options.lighting.spray) continue;  // nothing breaks
            options.samples = each.samples;
            options.lighting.sky_quality = each.sky;
            options.shutter_frames = each.shutter_frames;
            const std::array frames{scene.shot.first_frame};
            const Plan plan = picture_plan(of_samples(scene, each.samples), frames, options);
            rows.push_back({std::string(name) + ", " + each.name, as_row(picture_work(plan, frames, options)),
                            picture_taken_ms(scene, options, sky)});
        }
    }
    return rows;
}

// Of one thread the CPU's time: other programs don't count.
double cpu_ms() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

double least_ms(const std::function<void(int frame)>& make, const Shot& shot, double (*now_ms)()) {
    constexpr double kLeast_ms = 500.0;
    const double begin = now_ms();
    double least = 0.0;
    for (int frame = shot.first_frame; frame <= shot.last_frame; ++frame) {
        std::this_thread::sleep_for(std::chrono::milliseconds(4));  // as calibrations do
        const double start = now_ms();
        make(frame);
        const double ms = now_ms() - start;
        if (frame == shot.first_frame) continue;  // all of the foam's past
        least = frame == shot.first_frame + 1 ? ms : std::min(least, ms);
        if (frame > shot.first_frame + 5 && now_ms() - begin > kLeast_ms) break;
    }
    return least;
}

void say(const char* name, const char* what, const WorkDone& work, const Rates& rates, double took_ms,
         double& worst) {
    const double said_ms = cost_ms(work, rates);
    std::printf("%-16s %-8s %9.2f %9.2f %6.2f\n", name, what, said_ms, took_ms, said_ms / took_ms);
    worst = std::max(worst, std::max(said_ms / took_ms, took_ms / said_ms) - 1.0);
}

void shots() {
    double (*const now_ms)() = oneapi::tbb::this_task_arena::max_concurrency() == 1 ? cpu_ms : wall_ms;
    const Calibration measured = measure_machine({}, now_ms);
    std::printf("%d threads, %s:", measured.threads, measured.instruction_set.c_str());
    for (std::size_t g = 0; g < kWorkGroups.size(); ++g)
        std::printf(" %s %.2f", kWorkGroups[g].name, measured.times[g]);
    std::printf("\n%-16s %-8s %9s %9s %6s\n", "shot", "", "said, ms", "took, ms", "ratio");
    double worst_mesh = 0.0, worst_picture = 0.0;
    for (const char* name : {"first-shot", "glassy-swell", "north-sea-storm", "shallow-bay", "trade-wind",
                             "wave-trains", "buoy-hour", "seamless-loop"}) {
        Scene scene = example(name);
        scene.shot.last_frame = scene.shot.first_frame + 200;
        scene.shot.loop_s = 0.0;
        scene.output.maps.clear();
        scene.output.volumes.clear();
        scene.output.cascade_tiles = false;
        scene.surface.resolution = 128;
        const Plan plan = plan_bake(scene);
        const std::unique_ptr<Sequence> sequence = make_sequence(plan);
        FrameSlot slot;
        say(name, "mesh", work_of(plan), measured.rates(),
            least_ms([&](int frame) { sequence->compute(frame, slot); }, scene.shot, now_ms), worst_mesh);
        scene.camera.resolution = {64, 36};
        scene.surface.cell_px = 2.0;
        RenderOptions options = render_options(scene);
        options.samples = 1;
        const std::array frames{scene.shot.first_frame};
        const Plan pictures = picture_plan(of_samples(scene, options.samples), frames, options);
        Renderer renderer(scene, options, make_sky(scene), frames);
        Picture picture;
        say(name, "picture", picture_work(pictures, frames, options), measured.rates(),
            least_ms([&](int frame) { renderer.render(frame, picture); }, scene.shot, now_ms), worst_picture);
    }
    std::printf("off by at most %.0f %% for meshes, %.0f %% for pictures\n", 100.0 * worst_mesh,
                100.0 * worst_picture);
}

}  // namespace
}  // namespace pelagic

int main(int argc, char** argv) {
    using namespace pelagic;
    if (argc > 1 && std::string(argv[1]) == "shots") {
        if (argc > 3) use_instruction_set(argv[3]);
        const int threads = argc > 2 ? std::atoi(argv[2]) : oneapi::tbb::this_task_arena::max_concurrency();
        const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism,
                                                static_cast<std::size_t>(threads));
        oneapi::tbb::task_arena(threads).execute(shots);
        return 0;
    }
    const std::vector<Timed> of_meshes = meshes();
    const std::vector<double> cost = fitted(of_meshes);  // none of the light

    print("frames of bakes [ms]", of_meshes, cost);
    // Of pictures, the sea costs what it costs in bakes, but for the foam.
    constexpr auto kFoam = static_cast<std::size_t>(Work::Foam);
    std::vector<Timed> of_pictures = pictures();
    for (Timed& row : of_pictures) {
        for (std::size_t i = 0; i < kFoam; ++i) row.known_ms += cost[i] * row.work[i];
        row.work.erase(row.work.begin(), row.work.begin() + kFoam);
    }
    print(
        "pictures [ms], the sea as in bakes: foam; samples with nine, with the integral, of sky; texels and samples of spray; texels of the floor's light",
        of_pictures, fitted(of_pictures));
}
