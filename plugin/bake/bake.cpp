#include "plugin/bake/bake.h"

#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <string_view>
#include <system_error>
#include <utility>

#include "core/base/text.h"
#include "core/plan/plan.h"
#include "core/spectrum/possible.h"
#include "plugin/bake/check.h"
#include "plugin/bake/foreign.h"
#include "plugin/bake/output_part.h"
#include "plugin/bake/record.h"
#include "plugin/bake/sequence.h"
#include "plugin/bake/stage.h"
#include "plugin/files/files.h"
#include "plugin/machine/memory.h"
#include "plugin/usd/layers.h"
#include "plugin/vdb/vdb.h"

namespace pelagic {
namespace {

struct Cancelled {};

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void refuse_invalid(const Scene& scene, const std::vector<int>& frames) {
    std::string problems;
    for (const Problem& problem : problems_of(scene))
        problems += (problems.empty() ? "" : "\n") + text_of(problem);
    if (!problems.empty()) throw std::invalid_argument(problems);
    for (std::size_t i = 0; i < frames.size(); ++i)
        if (frames[i] < scene.shot.first_frame || frames[i] > scene.shot.last_frame ||
            (i > 0 && frames[i] <= frames[i - 1]))
            throw std::invalid_argument("frame " + std::to_string(frames[i]) +
                                        ": frames must rise and lie within the shot's range");
}

// The stage's sky must not replace the picture that it is made of.
void refuse_own_sky(const Scene& scene, const std::filesystem::path& out) {
    if (scene.output.mesh == MeshFormat::None || scene.light.sky == Light{}.sky) return;
    const std::filesystem::path ours = out / usd::sky_file(scene.shot.name);
    std::error_code error;
    if (std::filesystem::equivalent(ours, scene.light.sky, error))
        throw std::invalid_argument(
            "light.sky = \"" + scene.light.sky +
            "\" is the file that this bake writes its stage's sky to: give the picture "
            "another name, or bake into another folder");
}

using Parts = std::vector<std::unique_ptr<OutputPart>>;

// The folders that the files lie in, checked before hours are spent.
void prepare_folders(const std::filesystem::path& out, const Parts& parts) {
    std::set<std::filesystem::path> folders{out};
    for (const auto& part : parts) folders.insert((out / part->pattern().prefix).parent_path());
    for (const auto& folder : folders) {
        files::ensure_folder(folder);
        files::remove_stale_temporaries(folder);
    }
    // A killed bake of another shot may have left some in folders that this one doesn't use.
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator(out, ignored))
        if (entry.is_directory(ignored)) files::remove_stale_temporaries(entry.path());
}

// What is to be done of one frame.
struct FrameJob {
    int frame = 0;
    std::vector<bool> wanted;  // by part: whose files are made
    FrameRecord kept;          // the files of the other parts
    // Every file is as it would be made, but the record lists files that the shot no longer has.
    bool is_whole = false;

    bool makes_files() const { return std::find(wanted.begin(), wanted.end(), true) != wanted.end(); }
};

// Whether one of the frame's files was made of something else than it would be now.
bool is_stale(int frame, const FrameRecord& recorded, const Parts& parts) {
    return std::any_of(parts.begin(), parts.end(), [&](const auto& part) {
        const auto found = recorded.files.find(part->file(frame));
        return found == recorded.files.end() || found->second.fingerprint != part->fingerprint(frame);
    });
}

// `is_whole`: by path, of the files that were looked at.
std::optional<FrameJob> job_of(int frame, const Parts& parts, const FrameRecord* recorded,
                               const std::map<std::string, bool>& is_whole) {
    FrameJob job{.frame = frame, .wanted = std::vector<bool>(parts.size(), true), .kept = {}};
    if (!recorded) return job;
    bool all_whole = true;
    for (std::size_t p = 0; p < parts.size(); ++p) {
        const std::string file = parts[p]->file(frame);
        const auto found = is_whole.find(file);
        if (found != is_whole.end() && found->second) {
            job.wanted[p] = false;
            job.kept.files[file] = recorded->files.at(file);
        } else {
            all_whole = false;
        }
    }
    const bool same_files = recorded->files.size() == parts.size();
    if (!all_whole || recorded->fingerprint != statistics_fingerprint(parts, frame)) return job;
    if (same_files) return {};
    FrameRecord whole = *recorded;
    whole.files = std::move(job.kept.files);
    whole.coverage.reset();
    whole.mesh_significant_height_m.reset();
    whole.spray.reset();
    job.kept = std::move(whole);
    job.is_whole = true;
    return job;
}

// The recorded files of the frames that were made of what they would be made of now.
std::vector<FileCheck> files_to_check(std::span<const int> frames, const std::map<int, FrameRecord>& recorded,
                                      const Parts& parts) {
    std::vector<FileCheck> checks;
    for (const int frame : frames) {
        const auto entry = recorded.find(frame);
        if (entry == recorded.end()) continue;
        for (const auto& part : parts) {
            const auto file = entry->second.files.find(part->file(frame));
            if (file != entry->second.files.end() && file->second.fingerprint == part->fingerprint(frame))
                checks.push_back({.path = file->first, .recorded = file->second});
        }
    }
    return checks;
}

// The frames whose volumes the stage names: all of the shot, or of a very long one those that are asked for or recorded.
std::vector<int> staged_frames(const Shot& shot, const std::vector<int>& asked,
                               const std::map<int, FrameRecord>& recorded) {
    constexpr std::int64_t kMost = 8192;  // a line for each, some 70 bytes
    std::vector<int> frames;
    if (std::int64_t{shot.last_frame} - shot.first_frame < kMost) {
        for (std::int64_t frame = shot.first_frame; frame <= shot.last_frame; ++frame)
            frames.push_back(static_cast<int>(frame));
        return frames;
    }
    std::set<int> named(asked.begin(), asked.end());
    for (const auto& [frame, entry] : recorded)
        if (frame >= shot.first_frame && frame <= shot.last_frame) named.insert(frame);
    return {named.begin(), named.end()};
}

// Adds the files that were kept to the frame's record, and the mean coverage, the mesh's height and the spray, each from
// the first output that has it.
void complete(FrameRecord& record, const FrameJob& job, const Parts& parts) {
    record.files.insert(job.kept.files.begin(), job.kept.files.end());
    for (const auto& part : parts) {
        const FileRecord& file = record.files.at(part->file(job.frame));
        if (!record.coverage) record.coverage = file.coverage;
        if (!record.mesh_significant_height_m) record.mesh_significant_height_m = file.significant_height_m;
        if (!record.spray) record.spray = file.spray;
    }
}

// The frames that the record holds as they were written; what is wrong with it goes to the report, an altered entry of
// a frame that isn't asked for to the stale ones. Throws files::FileError where something is in the record's place
// that isn't one and can't be replaced.
std::map<int, FrameRecord> recorded_frames(BakeReport& report, const Shot& shot, std::span<const int> asked,
                                           const RecordWatch& watch) {
    std::map<int, FrameRecord> frames;
    const RecordReading reading = read_record(
        report.record, [&](int frame, FrameRecord record) { frames[frame] = std::move(record); }, watch);
    if (reading.is_blocked)
        throw files::FileError("the record '" + line_text(report.record.string()) + "' " + reading.problem +
                                   ": move it away or choose another folder",
                               report.record, std::make_error_code(std::errc::file_exists));
    const std::string name = report.record.filename().string();
    if (!reading.problem.empty() && !reading.is_missing)
        report.damaged.push_back(name + ' ' + reading.problem);
    for (const int frame : reading.altered) {
        if (std::binary_search(asked.begin(), asked.end(), frame))
            report.damaged.push_back(name + " was altered in what it says about frame " +
                                     std::to_string(frame));
        else if (frame >= shot.first_frame && frame <= shot.last_frame)
            report.stale.push_back(frame);
    }
    return frames;
}

}  // namespace

BakeReport bake(const Scene& scene, const BakeOptions& options) {
    const auto start = std::chrono::steady_clock::now();
    refuse_invalid(scene, options.frames);
    refuse_own_sky(scene, options.out);
    std::vector<int> frames = options.frames;
    for (int frame = scene.shot.first_frame; options.frames.empty() && frame <= scene.shot.last_frame;
         ++frame)
        frames.push_back(frame);

    BakeProgress progress;
    progress.total = static_cast<int>(frames.size());
    std::mutex telling;
    const auto report_progress = [&](BakeStage stage) {
        const std::lock_guard lock(telling);
        progress.stage = stage;
        if (options.progress) options.progress(progress);
    };
    const auto stop_if_cancelled = [&] {
        if (options.cancel && options.cancel->load(std::memory_order_relaxed)) throw Cancelled();
    };

    report_progress(BakeStage::Planning);
    const Plan plan = plan_bake(prepare(scene), frames);
    if (!plan.from->holds_budget) throw std::invalid_argument(plan.from->budget + "; raise the budget");
    if (plan.outputs.empty())
        throw std::invalid_argument(
            "the shot asks for no output: accepted: output.mesh, output.maps, output.volumes");
    if (!scene.output.volumes.empty())
        vdb::load();  // before anything is known to be enough, since it takes its part
    require_memory(bake_memory(plan, frames.size(), tbb::this_task_arena::max_concurrency()),
                   machine::memory_limit_or(options.max_memory_bytes), "this bake");
    if (scene.output.mesh != MeshFormat::None) prepare_light(scene);
    const Parts parts = make_parts(plan);
    prepare_folders(options.out, parts);

    BakeReport report;
    report.total = progress.total;
    report.record = options.out / (scene.shot.name + ".json");
    std::vector<FrameJob> jobs, records;  // frames to bake, and records to mend
    std::vector<int> staged;
    try {
        const std::map<int, FrameRecord> recorded =
            recorded_frames(report, scene.shot, frames, stop_if_cancelled);
        staged = staged_frames(scene.shot, frames, recorded);
        std::vector<FileCheck> checks = files_to_check(frames, recorded, parts);
        if (options.trust_times)
            check_times(options.out, checks, report.record);
        else
            check_files(options.out, checks,
                        {.progress =
                             [&](double checked) {
                                 progress.checked = checked;
                                 report_progress(BakeStage::Checking);
                             },
                         .cancel = options.cancel});
        std::map<std::string, bool> whole;
        for (const FileCheck& check : checks) {
            whole[check.path] = check.problem.empty();
            if (!check.problem.empty() && !check.is_missing)
                report.damaged.push_back(check.path + ' ' + check.problem);
        }
        for (const int frame : frames) {
            const auto found = recorded.find(frame);
            if (auto job = job_of(frame, parts, found == recorded.end() ? nullptr : &found->second, whole))
                (job->is_whole ? records : jobs).push_back(std::move(*job));
        }
        for (const auto& [frame, entry] : recorded)
            if (frame >= scene.shot.first_frame && frame <= scene.shot.last_frame &&
                !std::binary_search(frames.begin(), frames.end(), frame) && is_stale(frame, entry, parts))
                report.stale.push_back(frame);
        std::sort(report.stale.begin(), report.stale.end());
    } catch (const Cancelled&) {
        report.cancelled = true;
    } catch (const CheckCancelled&) {
        report.cancelled = true;
    }
    if (report.cancelled) {
        report.seconds = seconds_since(start);
        return report;
    }
    progress.kept = report.kept = static_cast<int>(frames.size() - jobs.size());

    report_progress(BakeStage::Building);
    Record record;
    std::vector<std::string> static_files{report.record.filename().string()};
    const auto write_static = [&](const FileJob& file) {
        stop_if_cancelled();
        static_files.push_back(file.path);
        record.set(file.path, files::write_if_different(options.out / file.path, file.content));
    };
    // A frame's lock is soon free again; whoever holds it for longer is named, and needn't be awaited.
    const auto waiting = [&](double) {
        stop_if_cancelled();
        report_progress(BakeStage::Waiting);
    };
    const auto save = [&] { record.save(report.record, waiting); };
    const auto finish = [&] {
        record.finish(report.record, waiting);
        report.unlocked = record.unlocked();
    };
    try {
        stop_if_cancelled();
        const BuildWatch watch{.progress =
                                   [&](double built) {
                                       progress.built = built;
                                       report_progress(BakeStage::Building);
                                   },
                               .cancel = options.cancel};
        const std::unique_ptr<Sequence> sequence = make_sequence(plan, watch);
        report_progress(BakeStage::Frames);
        record.describe(plan, sequence->total(), sequence->whitecap_threshold(),
                        sequence->residual_coverage());
        record.mark_stale(
            [&](int frame, const FrameRecord& recorded) { return is_stale(frame, recorded, parts); });
        sequence->write_static(staged, write_static);
        for (const FrameJob& job : records) {
            FrameRecord mended = job.kept;
            complete(mended, job, parts);
            record.set(job.frame, mended);
        }
        if (scene.output.mesh != MeshFormat::None) report.root = options.out / (scene.shot.name + ".usda");
        if (!scene.output.maps.empty()) report.maps = options.out / "maps";
        if (!scene.output.volumes.empty()) report.volumes = options.out / "volumes";
        save();
        const auto first_frame = std::chrono::steady_clock::now();
        std::array<FrameSlot, kFramesInFlight> slots;
        double last_save_s = 0.0, save_cost_s = 0.0;
        PipelineStages stages;
        stages.compute = [&](int item, int place) {
            stop_if_cancelled();
            slots[place].wanted = jobs[item].wanted;
            const auto tell = [&](double foam_past) {
                {
                    const std::lock_guard lock(telling);
                    progress.foam_past = foam_past;
                }
                if (foam_past > 0.0) report_progress(BakeStage::Frames);
            };
            sequence->compute(jobs[item].frame, slots[place], tell);
            tell(0.0);
            report.executed_transforms = sequence->executed_transforms();
        };
        stages.encode = [&](int, int place) {
            stop_if_cancelled();
            sequence->encode(slots[place]);
        };
        stages.write = [&](int item, int place) {
            FrameRecord& whole = slots[place].record;
            sequence->write(slots[place], [&](const FileJob& file) {
                stop_if_cancelled();
                const files::FileState written =
                    files::write_atomically(options.out / file.path, file.content);
                FileRecord& recorded = whole.files.at(file.path);
                recorded.bytes = written.bytes;
                recorded.checksum = written.checksum;
            });
            complete(whole, jobs[item], parts);
            record.set(jobs[item].frame, whole);
            // The record grows with the shot: writing it takes at most a twentieth of the time. Frames that a
            // killed process had not recorded yet are baked again.
            const double now_s = seconds_since(first_frame);
            if (now_s - last_save_s >= 20.0 * save_cost_s) {
                save();
                last_save_s = seconds_since(first_frame);
                save_cost_s = last_save_s - now_s;
            }
        };
        stages.written = [&](int item) {
            {
                const std::lock_guard lock(telling);
                progress.frame = jobs[item].frame;
                ++(jobs[item].makes_files() ? report.done : report.kept);
                progress.done = report.done;
                progress.kept = report.kept;
                progress.seconds = seconds_since(first_frame);
            }
            report_progress(BakeStage::Frames);
        };
        try {
            report.times = run_pipeline(static_cast<int>(jobs.size()), kFramesInFlight, stages);
        } catch (...) {
            // What was finished stays recorded; if even that can't be done, the first reason is the one to
            // tell.
            try {
                save();
            } catch (...) {
            }
            throw;
        }
        finish();
        report.foreign = foreign_files(options.out, scene.shot, parts, static_files);
    } catch (const Cancelled&) {
        report.cancelled = true;
    } catch (const BuildCancelled&) {
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
