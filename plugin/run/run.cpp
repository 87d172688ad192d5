#include "plugin/run/run.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "core/base/instruction_set.h"
#include "core/base/text.h"
#include "plugin/files/files.h"
#include "plugin/run/check.h"
#include "plugin/run/foreign.h"
#include "plugin/run/fragments.h"
#include "plugin/run/record.h"
#include "plugin/run/seals.h"
#include "plugin/run/work.h"

namespace pelagic {
namespace {

using Clock = std::chrono::steady_clock;
using Parts = std::span<const RunPart>;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

bool is_in(const Shot& shot, int frame) {
    return frame >= shot.first_frame && frame <= shot.last_frame;
}

// Those that are asked for: the whole shot's, where none are named.
std::vector<int> frames_of(const Shot& shot, std::vector<int> frames) {
    for (std::size_t i = 0; i < frames.size(); ++i)
        if (!is_in(shot, frames[i]) || (i > 0 && frames[i] <= frames[i - 1]))
            throw std::invalid_argument("frame " + std::to_string(frames[i]) +
                                        ": frames must rise and lie within the shot's range");
    if (frames.empty())
        for (std::int64_t frame = shot.first_frame; frame <= shot.last_frame; ++frame)
            frames.push_back(static_cast<int>(frame));
    return frames;
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
bool is_stale(int frame, const FrameRecord& recorded, Parts parts) {
    return std::any_of(parts.begin(), parts.end(), [&](const RunPart& part) {
        const auto found = recorded.files.find(part.file(frame));
        return found == recorded.files.end() || found->second.fingerprint != part.fingerprint(frame);
    });
}

// `is_whole`: by path, of the files that were looked at.
std::optional<FrameJob> job_of(int frame, Parts parts, const FrameRecord* recorded,
                               const std::map<std::string, bool>& is_whole) {
    FrameJob job{.frame = frame, .wanted = std::vector<bool>(parts.size(), true), .kept = {}};
    if (!recorded) return job;
    bool all_whole = true;
    for (std::size_t p = 0; p < parts.size(); ++p) {
        const std::string file = parts[p].file(frame);
        const auto found = is_whole.find(file);
        if (found != is_whole.end() && found->second) {
            job.wanted[p] = false;
            job.kept.files[file] = recorded->files.at(file);
        } else {
            all_whole = false;
        }
    }
    const bool same_files = recorded->files.size() == parts.size();
    if (!all_whole || recorded->fingerprint != parts.front().fingerprint(frame)) return job;
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
                                      Parts parts) {
    std::vector<FileCheck> checks;
    for (const int frame : frames) {
        const auto entry = recorded.find(frame);
        if (entry == recorded.end()) continue;
        for (const RunPart& part : parts) {
            const auto file = entry->second.files.find(part.file(frame));
            if (file != entry->second.files.end() && file->second.fingerprint == part.fingerprint(frame))
                checks.push_back({.path = file->first, .recorded = file->second});
        }
    }
    return checks;
}

// What a record would say of the shot's pictures, which say themselves what they were made of. Throws BuildCancelled.
std::map<int, FrameRecord> sealed_frames(const std::filesystem::path& folder, const Shot& shot, Parts parts,
                                         const std::atomic<bool>* cancel) {
    std::map<int, FrameRecord> frames;
    for (const int frame : frames_in(folder, parts.front())) {
        stop_if(cancel);
        if (!is_in(shot, frame)) continue;
        FrameRecord& entry = frames[frame];
        entry.fingerprint = parts.front().fingerprint(frame);
        entry.instruction_set = instruction_set();
        for (const RunPart& part : parts) {
            const std::filesystem::path file = folder / part.file(frame);
            if (!seems_whole(file, entry.fingerprint)) continue;
            entry.files[part.file(frame)] = {.bytes = files::file_size(file).value_or(0),
                                             .fingerprint = entry.fingerprint};
            if (!says_instruction_set(file, instruction_set())) entry.instruction_set.clear();
        }
    }
    return frames;
}

// The frames that files of no frame name: all of the shot, or of a very long one those that are asked for or recorded.
std::vector<int> named_frames(const Shot& shot, const std::vector<int>& asked,
                              const std::set<int>& recorded) {
    if (names_all_frames(shot.first_frame, shot.last_frame)) return frames_of(shot, {});
    std::set<int> named(asked.begin(), asked.end());
    for (const int frame : recorded)
        if (is_in(shot, frame)) named.insert(frame);
    return {named.begin(), named.end()};
}

// Adds the files that were kept to the frame's record, what made the others, and the mean coverage, the mesh's height and the spray, each from
// the first output that has it.
void complete(FrameRecord& record, const FrameJob& job, Parts parts) {
    if (record.instruction_set.empty()) record.instruction_set = instruction_set();
    record.files.insert(job.kept.files.begin(), job.kept.files.end());
    for (const RunPart& part : parts) {
        const FileRecord& file = record.files.at(part.file(job.frame));
        if (!record.coverage) record.coverage = file.coverage;
        if (!record.mesh_significant_height_m) record.mesh_significant_height_m = file.significant_height_m;
        if (!record.spray) record.spray = file.spray;
    }
}

// The frames that the record holds as they were written (of a long record those that are asked for), and the numbers of all; what is
// wrong with it goes to the report, an altered entry of a frame that isn't asked for to the stale ones. Throws files::FileError where something is in the record's place
// that isn't one and can't be replaced.
std::map<int, FrameRecord> recorded_frames(RunReport& report, const Shot& shot, std::span<const int> asked,
                                           std::set<int>& numbers, const std::atomic<bool>* cancel) {
    std::map<int, FrameRecord> frames;
    const RecordsReading reading = read_some(
        report.record, asked, [&](int frame, FrameRecord record) { frames[frame] = std::move(record); },
        numbers, cancel);
    if (reading.is_blocked)
        throw files::FileError("the record '" + line_text(report.record.string()) + "' " + reading.problem +
                                   ": move it away or choose another folder",
                               report.record, std::make_error_code(std::errc::file_exists));
    const std::string name = report.record.filename().string();
    if (!reading.problem.empty() && !reading.is_missing)
        report.damaged.push_back(name + ' ' + reading.problem);
    report.damaged.insert(report.damaged.end(), reading.damaged.begin(), reading.damaged.end());
    for (const int frame : reading.altered) {
        if (std::binary_search(asked.begin(), asked.end(), frame))
            report.damaged.push_back(name + " was altered in what it says about frame " +
                                     std::to_string(frame));
        else if (is_in(shot, frame))
            report.stale.push_back(frame);
    }
    return frames;
}

class Run {
  public:
    Run(const RunWork& work, const RunOptions& options)
        : work_(work), options_(options), frames_(frames_of(work.shot, options.frames)) {
        progress_.total = report_.total = static_cast<int>(frames_.size());
        if (work_.has_record) report_.record = options_.out / (work_.shot.name + ".json");
    }

    RunReport run() {
        const Clock::time_point start = Clock::now();
        try {
            if (work_.has_record) record_.expect_version(read_shot_part(report_.record).version);
            tell(RunStage::Planning);
            parts_ = work_.plan(frames_);
            find();
            if (work_.has_record || !jobs_.empty()) make();
            report_.foreign = work_.has_record
                                  ? foreign_files(options_.out, work_.shot, parts_, static_files_)
                                  : foreign_pictures(options_.out, work_.shot, parts_);
        } catch (const BuildCancelled&) {
            report_.cancelled = true;
        }
        report_.seconds = seconds_since(start);
        return std::move(report_);
    }

  private:
    // change: what else is told from now on; may be empty.
    void tell(RunStage stage, double share = 0.0, const std::function<void()>& change = {}) {
        const std::lock_guard lock(telling_);
        progress_.stage = stage;
        progress_.share = share;
        if (change) change();
        if (options_.progress) options_.progress(progress_);
    }
    BuildWatch watch(RunStage stage) {
        return {.progress = [this, stage](double share) { tell(stage, share); }, .cancel = options_.cancel};
    }

    void find() {
        const Shot& shot = work_.shot;
        std::set<int> numbers;
        const std::map<int, FrameRecord> recorded =
            work_.has_record ? recorded_frames(report_, shot, frames_, numbers, options_.cancel)
                             : sealed_frames(options_.out, shot, parts_, options_.cancel);
        named_ = named_frames(shot, frames_, numbers);
        std::vector<FileCheck> checks = files_to_check(frames_, recorded, parts_);
        if (options_.trust_times)
            check_times(options_.out, checks, report_.record);
        else
            check_files(options_.out, checks, watch(RunStage::Checking));
        std::map<std::string, bool> whole;
        for (const FileCheck& check : checks) {
            whole[check.path] = check.problem.empty();
            if (!check.problem.empty() && !check.is_missing && !check.is_sealed())
                report_.damaged.push_back(check.path + ' ' + check.problem);
        }
        for (const int frame : frames_) {
            const auto found = recorded.find(frame);
            const FrameRecord* entry = found == recorded.end() ? nullptr : &found->second;
            auto job = job_of(frame, parts_, entry, whole);
            const bool has_some = entry && (!job || job->is_whole || !job->kept.files.empty());
            if (has_some && entry->instruction_set != instruction_set()) {
                const bool is_whole = !job || job->is_whole;
                // A frame is one set's: what lacks a file is made as a whole.
                if (options_.same_instruction_set || !is_whole) job = job_of(frame, parts_, nullptr, whole);
                if (options_.same_instruction_set || is_whole)
                    report_.of_other_sets[entry->instruction_set].push_back(frame);
            }
            if (job) (job->is_whole ? mended_ : jobs_).push_back(std::move(*job));
        }
        for (const auto& [frame, entry] : recorded)
            if (is_in(shot, frame) && !std::binary_search(frames_.begin(), frames_.end(), frame) &&
                is_stale(frame, entry, parts_))
                report_.stale.push_back(frame);
        std::sort(report_.stale.begin(), report_.stale.end());
        progress_.kept = report_.kept = static_cast<int>(frames_.size() - jobs_.size());
    }

    void make() {
        tell(RunStage::Building);
        stop_if(options_.cancel);
        std::vector<int> frames;
        for (const FrameJob& job : jobs_) frames.push_back(job.frame);
        sequence_ = work_.build(frames, [this](RunStage stage) { return watch(stage); });
        tell(RunStage::Frames);
        if (work_.has_record) begin_record();
        begun_ = Clock::now();
        for (int place = 0; place < work_.in_flight; ++place) slots_.push_back(sequence_->make_slot());
        try {
            report_.times =
                run_pipeline(static_cast<int>(jobs_.size()), work_.in_flight,
                             {.compute = [this](int item, int at) { compute(jobs_[item], *slots_[at]); },
                              .encode = [this](int, int at) { encode(*slots_[at]); },
                              .write = [this](int item, int at) { write(jobs_[item], *slots_[at]); },
                              .written = [this](int item) { count(jobs_[item]); }});
        } catch (...) {
            // What was finished stays recorded; if even that can't be done, the first reason is the one to
            // tell.
            try {
                if (work_.has_record) {
                    record_.save(report_.record);
                    record_.finish(report_.record, waiting_);
                }
            } catch (...) {
            }
            throw;
        }
        if (!work_.has_record) return;
        record_.finish(report_.record, waiting_, [this](const auto& recorded) {
            named_ = frames_of(work_.shot, {});
            write_static(recorded);
        });
        report_.unlocked = record_.unlocked();
    }

    // The shot's part, the files that belong to no frame, and the entries of whole frames that list other files as well.
    void begin_record() {
        sequence_->describe(record_);
        record_.set_chosen(options_.chosen, options_.chosen_before);
        record_.mark_stale(
            [this](int frame, const FrameRecord& recorded) { return is_stale(frame, recorded, parts_); });
        for (const FrameJob& job : mended_) {
            FrameRecord mended = job.kept;
            complete(mended, job, parts_);
            record_.set(job.frame, mended);
        }
        record_.begin(
            report_.record, waiting_, [this](const auto& recorded) { write_static(recorded); },
            !jobs_.empty());
    }

    // recorded: the files of no frame that are there.
    void write_static(const std::map<std::string, FileRecord>& recorded) {
        static_files_ = {report_.record.filename().string()};
        sequence_->write_static(named_, [&](const FileJob& file) {
            stop_if(options_.cancel);
            static_files_.push_back(file.path);
            record_.set(file.path, is_kept(file, recorded) ? recorded.at(file.path) : written(file));
        });
    }
    bool is_kept(const FileJob& file, const std::map<std::string, FileRecord>& recorded) const {
        const auto there = recorded.find(file.path);
        if (file.fingerprint.empty() || there == recorded.end() ||
            there->second.fingerprint != file.fingerprint)
            return false;
        FileCheck check{.path = file.path, .recorded = there->second};
        const BuildWatch watch{.cancel = options_.cancel};
        CheckProgress progress(watch, check.recorded.bytes);
        check_file(options_.out, check, progress);
        return check.problem.empty();
    }
    FileRecord written(const FileJob& file) const {
        const files::FileState state = files::write_if_different(options_.out / file.path, file.content);
        return {.bytes = state.bytes, .checksum = state.checksum, .fingerprint = file.fingerprint};
    }

    void compute(const FrameJob& job, RunSlot& slot) {
        stop_if(options_.cancel);
        slot.wanted = job.wanted;
        sequence_->compute(job.frame, slot, [&](double share) {
            if (share > 0.0) tell(RunStage::Frames, share, [&] { progress_.at = job.frame; });
        });
        report_.executed_transforms = sequence_->executed_transforms();
    }

    void encode(RunSlot& slot) const {
        if (work_.has_record) stop_if(options_.cancel);
        sequence_->encode(slot);
    }

    void write(const FrameJob& job, RunSlot& slot) {
        if (work_.has_record) record_.refuse_other_version(report_.record);
        FrameRecord& whole = slot.record;
        sequence_->write(slot, [&](const FileJob& file) {
            if (work_.has_record) stop_if(options_.cancel);
            const files::FileState written = files::write_atomically(options_.out / file.path, file.content);
            FileRecord& recorded = whole.files[file.path];
            recorded.bytes = written.bytes;
            recorded.checksum = written.checksum;
        });
        if (!work_.has_record) return;
        complete(whole, job, parts_);
        record_.set(job.frame, whole);
        // What is recorded grows with the run: writing it takes at most a twentieth of the time. Frames that a
        // killed process had not recorded yet are made again.
        const double now_s = seconds_since(begun_);
        if (now_s - last_save_s_ < 20.0 * save_cost_s_) return;
        record_.save(report_.record);
        last_save_s_ = seconds_since(begun_);
        save_cost_s_ = last_save_s_ - now_s;
    }

    void count(const FrameJob& job) {
        tell(RunStage::Frames, 0.0, [&] {
            progress_.frame = job.frame;
            ++(job.makes_files() ? report_.done : report_.kept);
            progress_.done = report_.done;
            progress_.kept = report_.kept;
            progress_.seconds = seconds_since(begun_);
        });
    }

    const RunWork& work_;
    const RunOptions& options_;
    const std::vector<int> frames_;  // asked for
    RunReport report_;
    std::mutex telling_;
    RunProgress progress_;
    std::vector<RunPart> parts_;
    std::vector<FrameJob> jobs_, mended_;  // frames to make, and records to mend
    std::vector<int> named_;               // frames that the files of no frame name
    std::unique_ptr<Sequence> sequence_;
    std::vector<std::unique_ptr<RunSlot>> slots_;
    Record record_;
    std::vector<std::string> static_files_;
    // A frame's lock is soon free again; whoever holds it for longer is named, and needn't be awaited.
    const files::LockWatch waiting_ = [this](double) {
        stop_if(options_.cancel);
        tell(RunStage::Waiting);
    };
    Clock::time_point begun_;  // the first frame
    double last_save_s_ = 0.0, save_cost_s_ = 0.0;
};

}  // namespace

RunReport run(const RunWork& work, const RunOptions& options) {
    return Run(work, options).run();
}

void prepare_folders(const std::filesystem::path& out, std::span<const RunPart> parts) {
    std::set<std::filesystem::path> folders{out};
    for (const RunPart& part : parts) folders.insert((out / part.prefix).parent_path());
    for (const auto& folder : folders) {
        files::ensure_folder(folder);
        files::remove_stale_temporaries(folder);
    }
    // A killed run of another shot may have left some in folders that this one doesn't use.
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator(out, ignored))
        if (entry.is_directory(ignored)) files::remove_stale_temporaries(entry.path());
}

std::string time_text(const RunReport& report) {
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
