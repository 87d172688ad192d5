#include "plugin/budget/calibration.h"

#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "core/base/instruction_set.h"
#include "core/base/text.h"
#include "core/plan/fingerprint.h"
#include "core/scene/text.h"
#include "plugin/bake/sequence.h"
#include "plugin/files/files.h"
#include "plugin/files/read.h"
#include "plugin/light/light.h"
#include "plugin/render/render.h"

namespace pelagic {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kGroups = kWorkGroups.size();
// The group of each Work.
constexpr std::array<std::size_t, kWorkCount> kGroupOf{0, 0, 1, 2, 3, 2, 4, 5, 6, 5, 5, 5, 5};

// A small sea or picture whose frames are timed one after another.
struct Probe {
    WorkDone work;
    std::function<void()> next_frame;
};

Probe bake_probe(Scene scene) {
    scene.shot.last_frame = 1000;
    scene.output.maps.clear();
    const Plan plan = plan_bake(scene);
    const std::shared_ptr<Sequence> sequence = make_sequence(plan);
    return {work_of(plan), [sequence, slot = std::make_shared<FrameSlot>(), frame = 0]() mutable {
                sequence->compute(++frame, *slot);
            }};
}

Probe picture_probe(WaveModel model, SkyQuality sky, glm::ivec2 size, double foam_decay_s) {
    Scene scene;
    scene.shot.last_frame = 1000;
    scene.sea.wind_speed_mps = 14.0;
    scene.waves.model = model;
    scene.waves.trains = 12;  // with them the light takes most
    scene.effects.foam_decay_s = foam_decay_s;
    scene.camera.resolution = size;
    scene.surface.cell_px = 2.0;
    RenderOptions options = render_options(scene);
    options.samples = 1;
    options.lighting.sky_quality = sky;
    const std::array frames{scene.shot.first_frame};
    const Plan plan = picture_plan(scene, frames, options);
    const auto renderer = std::make_shared<Renderer>(scene, options, make_sky(scene), frames);
    return {picture_work(plan, frames, options),
            [renderer, picture = std::make_shared<Picture>(), frame = 0]() mutable {
                renderer->render(++frame, *picture);
            }};
}

Scene small_sea(QualityLevel level, int quads) {
    Scene scene;
    scene.quality.level = level;
    scene.effects.foam_decay_s = 0.0;
    scene.surface.size_m = 60.0;
    scene.surface.resolution = quads;
    return scene;
}

// Each has much of one group, and together they have all.
constexpr std::array kProbes = std::to_array<Probe (*)()>({
    [] { return bake_probe(small_sea(QualityLevel::Draft, 96)); },
    [] { return bake_probe(small_sea(QualityLevel::Final, 96)); },
    [] { return bake_probe(small_sea(QualityLevel::Final, 24)); },
    [] {
        Scene scene = small_sea(QualityLevel::Final, 192);
        scene.waves.cascades = {{100.0, 64, {}}};
        return bake_probe(scene);
    },
    [] {
        Scene scene = small_sea(QualityLevel::Final, 128);
        scene.waves.model = WaveModel::Trochoid;
        scene.waves.trains = 300;
        scene.waves.shortest_m = 2.0;
        return bake_probe(scene);
    },
    [] {
        Scene scene = small_sea(QualityLevel::Final, 96);
        scene.sea.wind_speed_mps = 18.0;
        scene.waves.cascades = {{200.0, 64, {}}};
        scene.effects.foam_decay_s = 4.0;
        scene.surface.size_m = 200.0;
        return bake_probe(scene);
    },
    [] {
        return picture_probe(WaveModel::Trochoid, SkyQuality::Nine, {64, 36}, 0.0);
    },
    [] {
        return picture_probe(WaveModel::Fft, SkyQuality::Nine, {48, 27}, 0.0);
    },
    [] {
        return picture_probe(WaveModel::Fft, SkyQuality::Nine, {48, 27}, 4.0);
    },
    [] {
        return picture_probe(WaveModel::Trochoid, SkyQuality::Integral, {16, 9}, 0.0);
    },
});

double least_ms(const Probe& probe, const BuildWatch& watch, double (*now_ms)()) {
    constexpr double kLeast_ms = 300.0;
    constexpr int kFewest = 5;
    constexpr int kPause_ms = 4;  // who has slept isn't interrupted soon by other programs
    const double begin = now_ms();
    probe.next_frame();  // goes through the foam's past, and allocates
    double least = 0.0;
    for (int i = 0; i < kFewest || now_ms() - begin < kLeast_ms; ++i) {
        stop_if(watch.cancel);
        std::this_thread::sleep_for(std::chrono::milliseconds(kPause_ms));
        const double start = now_ms();
        probe.next_frame();
        const double ms = now_ms() - start;
        least = i == 0 ? ms : std::min(least, ms);
    }
    return least;
}

// The groups' times that come nearest to what the probes took. shares: of each probe, the groups' recorded times over what it took,
// which is `mean` times the recorded time on average: every group is pulled a little towards that, so that no noise sends one far off.
std::array<double, kGroups> fitted(const std::vector<std::array<double, kGroups>>& shares, double mean) {
    constexpr double kPull = 0.003;
    std::array<double, kGroups> times{};
    times.fill(mean);
    for (int round = 0; round < 1000; ++round)
        for (std::size_t g = 0; g < kGroups; ++g) {
            double above = kPull / mean, below = kPull / (mean * mean);
            for (std::size_t p = 0; p < shares.size(); ++p) {
                double rest = 1.0;
                for (std::size_t other = 0; other < kGroups; ++other)
                    if (other != g) rest -= shares[p][other] * times[other];
                above += rest * shares[p][g];
                below += shares[p][g] * shares[p][g];
            }
            times[g] = std::max(above / below, 0.05 * mean);
        }
    return times;
}

std::string cpu_name() {
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);)
        if (line.starts_with("model name") && line.find(": ") != std::string::npos)
            return line_text(line.substr(line.find(": ") + 2));
    return "unknown";
}

// Numbers that change with the model: its times are measured over the recorded ones, by these probes.
std::string model_name() {
    std::string text = std::to_string(kProbes.size());
    for (const double rate : recorded_rates()) text += ' ' + number_text(rate);
    return Fingerprint().add(text).text();
}

// One for each machine, version and model that share the folder.
std::string file_name(const Calibration& of) {
    return "calibration-" + std::to_string(of.threads) + '-' + of.instruction_set + '-' +
           Fingerprint().add(of.version + of.cpu + model_name()).text().substr(0, 8) + ".json";
}

Json to_json(const Calibration& of) {
    Json json{{"pelagic", of.version},
              {"model", model_name()},
              {"cpu", of.cpu},
              {"threads", of.threads},
              {"instruction_set", of.instruction_set}};
    for (std::size_t g = 0; g < kGroups; ++g) json["times"][kWorkGroups[g].name] = of.times[g];
    return json;
}

}  // namespace

Rates Calibration::rates() const {
    Rates rates = recorded_rates();
    for (std::size_t i = 0; i < kWorkCount; ++i) rates[i] *= times[kGroupOf[i]];
    return rates;
}

Calibration as_recorded() {
    Calibration machine{.version = PELAGIC_VERSION,
                        .cpu = cpu_name(),
                        .instruction_set = instruction_set(),
                        .threads = oneapi::tbb::this_task_arena::max_concurrency()};
    machine.times.fill(1.0);
    return machine;
}

double wall_ms() {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

Calibration measure_machine(const BuildWatch& watch, double (*now_ms)()) {
    std::vector<std::array<double, kGroups>> shares;
    double mean = 0.0;
    for (const auto& make : kProbes) {
        stop_if(watch.cancel);
        if (watch.progress) watch.progress(static_cast<double>(shares.size()) / kProbes.size());
        const Probe probe = make();
        const double recorded_ms = cost_ms(probe.work), ms = least_ms(probe, watch, now_ms);
        mean += ms / recorded_ms / kProbes.size();
        auto& share = shares.emplace_back();
        for (std::size_t i = 0; i < kWorkCount; ++i)
            share[kGroupOf[i]] += recorded_rates()[i] * probe.work[i] / ms;
    }
    Calibration measured = as_recorded();
    measured.times = fitted(shares, mean);
    return measured;
}

std::optional<Calibration> kept_calibration(const std::filesystem::path& folder) {
    Calibration kept = as_recorded();
    std::string text;
    if (!files::read_pieces(folder / file_name(kept), [&](std::string_view piece) { text += piece; }).empty())
        return {};
    const Json json = Json::parse(text, nullptr, false);
    try {
        for (std::size_t g = 0; g < kGroups; ++g) {
            kept.times[g] = json.at("times").at(kWorkGroups[g].name).get<double>();
            if (!(kept.times[g] > 0.0 && std::isfinite(kept.times[g]))) return {};
        }
        if (json != to_json(kept)) return {};  // of another machine, or version
    } catch (const Json::exception&) {
        return {};
    }
    return kept;
}

Calibration calibration(const std::filesystem::path& folder, const BuildWatch& watch) {
    static std::mutex mutex;
    static std::map<std::string, Calibration> remembered;  // by file
    const std::lock_guard lock(mutex);
    const std::string file = (folder / file_name(as_recorded())).string();
    if (const auto known = remembered.find(file); known != remembered.end()) return known->second;
    std::optional<Calibration> found;
    if (!folder.empty()) found = kept_calibration(folder);
    if (!found) keep(found.emplace(measure_machine(watch)), folder);
    return remembered[file] = *found;
}

std::filesystem::path keep(const Calibration& measured, const std::filesystem::path& folder) {
    if (folder.empty()) return {};
    const std::filesystem::path file = folder / file_name(measured);
    try {
        files::ensure_folder(folder);
        files::write_atomically(file, to_json(measured).dump(2) + '\n');
    } catch (const files::FileError&) {
        return {};
    }
    return file;
}

std::filesystem::path cache_folder() {
    const char* cache = std::getenv("XDG_CACHE_HOME");
    if (cache && *cache == '/') return std::filesystem::path(cache) / "pelagic";
    const char* home = std::getenv("HOME");
    return home && *home == '/' ? std::filesystem::path(home) / ".cache" / "pelagic"
                                : std::filesystem::path();
}

}  // namespace pelagic
