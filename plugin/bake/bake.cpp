#include "plugin/bake/bake.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <map>

#include "core/scene/validate.h"
#include "plugin/bake/record.h"
#include "plugin/bake/sequence.h"
#include "plugin/files/files.h"

namespace pelagic {
namespace {

struct Cancelled {};

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void refuse_invalid(const Scene& scene, const std::vector<int>& frames) {
    std::string problems;
    for (const Problem& problem : validate(scene))
        problems += (problems.empty() ? "" : "\n") + text_of(problem);
    if (!problems.empty()) throw std::invalid_argument(problems);
    for (std::size_t i = 0; i < frames.size(); ++i)
        if (frames[i] < scene.shot.first_frame || frames[i] > scene.shot.last_frame ||
            (i > 0 && frames[i] <= frames[i - 1]))
            throw std::invalid_argument("frame " + std::to_string(frames[i]) +
                                        ": frames must rise and lie within the shot's range");
}

// The folders that the plan's files lie in, checked before hours are spent.
void prepare_folders(const std::filesystem::path& out, const Scene& scene) {
    std::vector<std::filesystem::path> folders{out};
    if (scene.output.mesh != MeshFormat::None) folders.push_back(out / "mesh");
    if (!scene.output.maps.empty()) folders.push_back(out / "maps");
    if (!scene.output.maps.empty() && scene.output.cascade_tiles) folders.push_back(out / "tiles");
    for (const auto& folder : folders) {
        files::ensure_folder(folder);
        files::remove_stale_temporaries(folder);
    }
}

}  // namespace

BakeReport bake(const Scene& scene, const BakeOptions& options) {
    refuse_invalid(scene, options.frames);
    std::vector<int> frames = options.frames;
    for (int frame = scene.shot.first_frame; options.frames.empty() && frame <= scene.shot.last_frame;
         ++frame)
        frames.push_back(frame);

    BakeProgress progress;
    progress.total = static_cast<int>(frames.size());
    const auto report_progress = [&](BakeStage stage) {
        progress.stage = stage;
        if (options.progress) options.progress(progress);
    };
    const auto stop_if_cancelled = [&] {
        if (options.cancel && options.cancel->load(std::memory_order_relaxed)) throw Cancelled();
    };

    report_progress(BakeStage::Planning);
    const Plan plan = make_plan(scene);
    const std::string fingerprint = plan.fingerprint_text();
    prepare_folders(options.out, scene);

    BakeReport report;
    report.total = progress.total;
    report.record = options.out / (scene.shot.name + ".json");
    std::vector<int> missing;
    {
        const std::map<int, FrameRecord> recorded = recorded_frames(report.record);
        for (const int frame : frames)
            if (const auto found = recorded.find(frame);
                found == recorded.end() || !is_whole(found->second, fingerprint, options.out))
                missing.push_back(frame);
        for (const auto& [frame, entry] : recorded)
            if (entry.fingerprint != fingerprint && frame >= scene.shot.first_frame &&
                frame <= scene.shot.last_frame && !std::binary_search(frames.begin(), frames.end(), frame))
                report.stale.push_back(frame);
    }
    progress.kept = report.kept = static_cast<int>(frames.size() - missing.size());

    report_progress(BakeStage::Building);
    const auto start = std::chrono::steady_clock::now();
    const auto write = [&](const std::string& path, const FileContent& content) {
        stop_if_cancelled();
        return files::write_atomically(options.out / path, content);
    };
    try {
        stop_if_cancelled();
        const std::unique_ptr<Sequence> sequence = make_sequence(scene, plan);
        report_progress(BakeStage::Frames);
        Record record;
        record.describe(scene, plan, sequence->total(), sequence->whitecap_threshold());
        sequence->write_static(write);
        if (scene.output.mesh != MeshFormat::None) report.root = options.out / (scene.shot.name + ".usda");
        if (!scene.output.maps.empty()) report.maps = options.out / "maps";
        record.save(report.record);
        const auto first_frame = std::chrono::steady_clock::now();
        std::array<FrameSlot, kFramesInFlight> slots;
        double last_save_s = 0.0, save_cost_s = 0.0;
        PipelineStages stages;
        stages.compute = [&](int item, int place) {
            stop_if_cancelled();
            sequence->compute(missing[item], slots[place]);
            report.executed_transforms = sequence->executed_transforms();
        };
        stages.encode = [&](int, int place) {
            stop_if_cancelled();
            sequence->encode(slots[place]);
        };
        stages.write = [&](int item, int place) {
            sequence->write(slots[place], write);
            record.set(missing[item], slots[place].record);
            // The record grows with the shot: writing it takes at most a twentieth of the time. Frames that a
            // killed process had not recorded yet are baked again.
            const double now_s = seconds_since(first_frame);
            if (now_s - last_save_s >= 20.0 * save_cost_s) {
                record.save(report.record);
                last_save_s = seconds_since(first_frame);
                save_cost_s = last_save_s - now_s;
            }
        };
        stages.written = [&](int item) {
            progress.frame = missing[item];
            progress.done = ++report.done;
            progress.seconds = seconds_since(first_frame);
            report_progress(BakeStage::Frames);
        };
        try {
            report.times = run_pipeline(static_cast<int>(missing.size()), kFramesInFlight, stages);
        } catch (...) {
            // What was finished stays recorded; if even that can't be done, the first reason is the one to
            // tell.
            try {
                record.save(report.record);
            } catch (...) {
            }
            throw;
        }
        record.save(report.record);
    } catch (const Cancelled&) {
        report.cancelled = true;
    }
    report.seconds = seconds_since(start);
    return report;
}

std::string time_text(const BakeReport& report) {
    const PipelineTimes& times = report.times;
    if (times.wall_s <= 0.0 || report.done == 0) return {};
    const auto percent = [&](double busy_s) {
        return std::to_string(std::lround(100.0 * busy_s / times.wall_s)) + " %";
    };
    std::string bottleneck = times.compute_busy_s >= times.encode_busy_s ? "computing" : "encoding";
    double busiest_s = std::max(times.compute_busy_s, times.encode_busy_s);
    if (times.waiting_for_write_s > times.waiting_for_encode_s) {
        bottleneck = "the disk";
        busiest_s = times.write_busy_s;
    }
    // Stages share the cores: one that is busy for less is not what the others wait for.
    constexpr double kMostOfTheTime = 0.6;
    if (busiest_s < kMostOfTheTime * times.wall_s) bottleneck = "no stage alone";
    return "compute " + percent(times.compute_busy_s) + ", encode " + percent(times.encode_busy_s) +
           ", write " + percent(times.write_busy_s) + " of the time busy; " + bottleneck +
           " was the bottleneck";
}

}  // namespace pelagic
