// pelagic farm --status DIR
#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <system_error>
#include <tuple>
#include <utility>
#include <vector>

#include "core/base/text.h"
#include "plugin/files/files.h"
#include "plugin/host/cli/exit_status.h"
#include "plugin/host/cli/farm.h"
#include "plugin/host/cli/guarded_run.h"
#include "plugin/host/cli/json_output.h"
#include "plugin/host/cli/text.h"
#include "plugin/render/picture_files.h"
#include "plugin/run/fragments.h"
#include "plugin/run/seals.h"

namespace pelagic::cli {
namespace {

namespace fs = std::filesystem;

FarmJob read_job(const fs::path& file) {
    try {
        std::ifstream stream(file);
        const auto json = nlohmann::json::parse(stream);
        FarmJob job{.verb = json.at("verb"), .shot = json.at("shot")};
        job.of.name = json.at("name");
        job.of.first_frame = json.at("frame_range").at(0);
        job.of.last_frame = json.at("frame_range").at(1);
        job.instruction_set = json.value("instruction_set", "");
        job.is_deep = json.value("deep", false);
        for (const auto& task : json.at("tasks"))
            job.tasks.push_back({.frames = task.at("frames"),
                                 .made_of = task.value("made_of", std::vector<std::string>()),
                                 .log = task.at("log"),
                                 .slurm = task.at("slurm")});
        for (const FarmTask& task : job.tasks) parse_frames(task.frames, job.of);
        return job;
    } catch (const std::exception&) {
        throw WrongUsage(line_text(file.string()) +
                         " is no job of pelagic farm's, or damaged: share the shot out again");
    }
}

// Of the jobs of a folder, which was shared out last for a frame: versions by shot, verb and frame.
using Wanted = std::map<std::tuple<std::string, std::string, int>, std::string>;

template <class Use>
void for_frames(const FarmJob& job, const Use& use) {
    for (const FarmTask& task : job.tasks) {
        std::size_t i = 0;
        for (const int frame : parse_frames(task.frames, job.of)) {
            use(frame, i < task.made_of.size() ? task.made_of[i] : std::string());
            ++i;
        }
    }
}

bool is_picture_there(const FarmJob& job, const fs::path& out, int frame, const std::string& wanted) {
    std::vector<std::string> files{picture_file(job.of, frame, "exr"), picture_file(job.of, frame, "png")};
    if (job.is_deep) files.push_back(deep_file(job.of, frame));
    return std::ranges::all_of(files, [&](const std::string& name) {
        const fs::path file = out / name;
        return (wanted.empty() ? fs::exists(file) : seems_whole(file, wanted)) &&
               (job.instruction_set.empty() || says_instruction_set(file, job.instruction_set));
    });
}

// Of the version of the shot that was shared out, by the record and its fragments, or by what pictures say of themselves: verify reads the files.
std::set<int> frames_there(const FarmJob& job, const fs::path& out) {
    std::set<int> there;
    std::map<int, std::string> asked;  // of what it is made, by frame
    for_frames(job, [&](int frame, const std::string& made_of) { asked[frame] = made_of; });
    if (job.verb == "bake") {
        read_records(out / (job.of.name + ".json"), [&](int number, const FrameRecord& frame) {
            const auto wanted = asked.find(number);
            if (wanted != asked.end() && !frame.is_stale &&
                (wanted->second.empty() || wanted->second == made_of(frame.files)) &&
                (job.instruction_set.empty() || frame.instruction_set == job.instruction_set))
                there.insert(number);
        });
        return there;
    }
    for (const auto& [frame, wanted] : asked)
        if (is_picture_there(job, out, frame, wanted)) there.insert(frame);
    return there;
}

// What its log says of a task.
struct Log {
    std::string last;                    // who has begun last
    std::optional<std::string> running;  // who has begun and not ended
    std::string host;
    std::string message;        // the last one since it began
    std::optional<int> status;  // with which the last one ended
    double silent_s = 0.0;      // since its last word
};

// Rather than progress, a note, or where help is.
bool is_message(const std::string& line) {
    return line.find(": ") != std::string::npos && line.find(": note: ") == std::string::npos &&
           !line.ends_with(" %") && !line.starts_with("frame ") && !line.starts_with("building ") &&
           !line.starts_with("note: ") && !line.starts_with("See: ");
}

Log read_log(const fs::path& file) {
    Log log;
    std::ifstream stream(file);
    std::map<std::string, std::string> begun;  // host, by who
    std::set<std::string> former;              // who had begun when the job was shared out anew
    for (std::string line; std::getline(stream, line);) {
        std::string_view rest = line;
        const auto word = [&] {
            const std::size_t end = std::min(rest.find_first_of(" ,"), rest.size());
            const std::string taken(rest.substr(0, end));
            rest.remove_prefix(std::min(rest.size(), end + 1));
            return taken;
        };
        if (line.starts_with(kFarmBegun)) {
            rest.remove_prefix(std::string_view(kFarmBegun).size());
            const std::string id = word();
            word();  // "on"
            begun[id] = log.host = word();
            former.erase(id);
            log.last = id;
            log.message.clear();
            log.status.reset();
        } else if (line.starts_with(kFarmEnded)) {
            rest.remove_prefix(std::string_view(kFarmEnded).size());
            const std::string id = word();
            begun.erase(id);
            if (former.contains(id)) continue;
            word(), word();  // "with status"
            int status = 0;
            const std::string number = word();
            if (std::from_chars(number.data(), number.data() + number.size(), status).ec == std::errc())
                log.status = status;
        } else if (line == kFarmShared) {
            log = {};
            for (const auto& [id, host] : begun) former.insert(id);
        } else if (is_message(line)) {
            log.message = line;
        }
    }
    if (!begun.empty()) {
        const auto at = begun.contains(log.last) ? begun.find(log.last) : begun.begin();
        log.running = at->first;
        log.host = at->second;
    }
    std::error_code error;
    const auto heard = fs::last_write_time(file, error);
    if (!error)
        log.silent_s = std::chrono::duration<double>(fs::file_time_type::clock::now() - heard).count();
    return log;
}

std::string last_line(const fs::path& file) {
    std::ifstream stream(file);
    std::string last;
    for (std::string line; std::getline(stream, line);)
        if (!line.empty()) last = line;
    return last;
}

// The tasks that Slurm knows of, ARRAY_NUMBER, with their states.
using Queue = std::map<std::string, std::string>;
// Nothing where it doesn't answer.
std::optional<Queue> queued() {
    FILE* pipe = popen("timeout 10 squeue -h -r -o '%F_%K %T' 2>/dev/null", "r");
    if (!pipe) return {};
    Queue states;
    std::array<char, 256> line{};
    while (std::fgets(line.data(), static_cast<int>(line.size()), pipe)) {
        std::string_view text = line.data();
        while (text.ends_with('\n')) text.remove_suffix(1);
        const std::size_t space = text.find(' ');
        if (space != std::string_view::npos)
            states[std::string(text.substr(0, space))] = text.substr(space + 1);
    }
    if (pclose(pipe) != 0) return {};
    return states;
}

// Whether a task that said that it has begun surely doesn't run any more: by Slurm, or as a process of this machine (HOST-PROCESS_NUMBER).
bool is_gone(const std::string& id, const std::optional<Queue>& queue) {
    if (id.find_first_not_of("0123456789_") == std::string::npos) {
        if (!queue) return false;
        const auto at = queue->find(id);
        return at == queue->end();  // squeue lists what hasn't ended: suspended and configuring, too
    }
    std::array<char, 256> host{};
    gethostname(host.data(), host.size() - 1);
    std::string here = host.data();
    here = here.substr(0, here.find('.')) + '-';
    if (!id.starts_with(here)) return false;
    int process = 0;
    std::from_chars(id.data() + here.size(), id.data() + id.size(), process);
    return process > 0 && kill(process, 0) != 0 && errno == ESRCH;
}

constexpr int kKilledFrom = 128;

std::string reason_of(const Log& log) {
    if (!log.status || *log.status <= kKilledFrom) return log.message;
    const int number = *log.status - kKilledFrom;
    return "stopped by signal " + std::to_string(number) +
           (number == SIGKILL ? ", which is mostly a lack of memory" : "");
}

struct Counted {
    int frames = 0, whole = 0;
    int refused = 0;  // tasks (status 2) whose frames are whole, of before
};

// Without the frames that another job was to make of another version since; where all are, nothing, unless it is the one that is asked for.
Counted print_job(const fs::path& file, const FarmJob& job, bool is_asked_for, const Wanted& wanted,
                  const std::optional<Queue>& queue) {
    std::set<int> ours;
    for_frames(job, [&](int frame, const std::string& made_of) {
        if (wanted.at({job.of.name, job.verb, frame}) == made_of) ours.insert(frame);
    });
    if (ours.empty() && !is_asked_for) return {};
    if (ours.empty()) {
        std::cout << line_text(job.of.name) << ", " << job.verb
                  << ": superseded, other jobs of these frames were shared out since" << std::endl;
        tell_json(
            {{"event", "result"}, {"verb", "farm"}, {"name", job.of.name}, {"of", job.verb}, {"frames", 0}});
        return {.refused = 1};
    }
    const fs::path out = file.parent_path().parent_path();
    // Before the frames: those of a task that has ended are there.
    std::vector<Log> logs;
    for (const FarmTask& task : job.tasks) logs.push_back(read_log(out / "farm" / task.log));
    const std::set<int> there = frames_there(job, out);
    std::vector<int> whole, missing;
    std::string running, failed;
    nlohmann::ordered_json told{
        {"event", "result"}, {"verb", "farm"}, {"name", job.of.name}, {"of", job.verb}};
    told["running"] = told["failed"] = nlohmann::ordered_json::array();
    Counted counted;
    const std::string script = line_text(shell_word(fs::path(file).replace_extension(".sh").string()));
    for (std::size_t number = 0; number < job.tasks.size(); ++number) {
        const FarmTask& task = job.tasks[number];
        std::vector<int> lacking;
        bool has_some = false;
        for (const int frame : parse_frames(task.frames, job.of)) {
            if (!ours.contains(frame)) continue;
            has_some = true;
            ++counted.frames;
            (there.contains(frame) ? whole : lacking).push_back(frame);
        }
        Log& log = logs[number];
        // Lost, and another one has ended since.
        if (log.running && log.status && is_gone(*log.running, queue)) log.running.reset();
        if (!has_some) continue;
        const bool is_refused = log.status == kWrongUsage && !log.running;
        if (lacking.empty() && !is_refused) continue;
        const std::string frames = lacking.empty() ? task.frames : frames_text(lacking);
        std::string message = reason_of(log);
        // Slurm's word counts: on a full disk a task's own last words may be lost.
        if (const auto at = queue ? queue->find(log.running.value_or(log.last)) : Queue::const_iterator();
            queue && at != queue->end() && at->second == "PENDING") {
            running += "\n  " + frames + ": waits in the queue" +
                       (message.empty() ? "" : ", after: " + line_text(message));
            told["running"].push_back({{"frames", frames}, {"message", message}});
            continue;
        }
        if (log.running && !is_gone(*log.running, queue)) {
            running += "\n  " + frames + ": on " + line_text(log.host) + ", last heard of " +
                       duration_text(log.silent_s) + " ago";
            told["running"].push_back({{"frames", frames}, {"host", log.host}, {"silent_s", log.silent_s}});
            continue;
        }
        if (log.running) {
            message = "lost, on " + log.host;
            if (const std::string said = last_line(out / "farm" / task.slurm); !said.empty())
                message += ": " + said;
        } else if (!log.status) {
            missing.insert(missing.end(), lacking.begin(), lacking.end());
            continue;
        } else if (*log.status == kDone) {
            message = "made, and not there any more, or of another version of the shot or instruction set";
        } else if (lacking.empty()) {
            ++counted.refused;
            message += "; what is there was made before";
        }
        failed += "\n  " + frames + ": " + line_text(message);
        if (log.status) failed += " (status " + std::to_string(*log.status) + ')';
        failed += is_refused ? "; the same again gives the same: mend that, and then" : "; again:";
        failed += " bash " + script + ' ' + std::to_string(number);
        told["failed"].push_back({{"task", number}, {"frames", frames}, {"message", message}});
        if (log.status) told["failed"].back()["status"] = *log.status;
    }
    counted.whole = static_cast<int>(whole.size());
    std::cout << line_text(job.of.name) << ", " << job.verb << ": " << counted.whole << " of "
              << count_text(counted.frames, "frame", "frames") << " whole, in "
              << count_text(static_cast<long>(job.tasks.size()), "task", "tasks") << '\n';
    if (!whole.empty()) std::cout << "whole: " << frames_text(whole) << '\n';
    if (!running.empty()) std::cout << "running:" << running << '\n';
    if (!failed.empty()) std::cout << "failed:" << failed << '\n';
    if (!missing.empty()) std::cout << "missing, not begun: " << frames_text(missing) << '\n';
    std::cout << std::flush;
    told["frames"] = counted.frames;
    told["whole"] = frames_text(whole);
    told["missing"] = frames_text(missing);
    tell_json(told);
    return counted;
}

}  // namespace

int print_farm_status(const fs::path& path) {
    std::error_code error;
    const bool is_job = path.extension() == ".json" && !fs::is_directory(path, error);
    const fs::path folder = is_job ? fs::absolute(path).parent_path() : path / "farm";
    if (fs::directory_iterator readable(is_job ? folder : path, error); error)
        throw WrongUsage("cannot read the folder '" + line_text((is_job ? folder : path).string()) +
                         "': " + error.message() + ": name one that pelagic farm wrote into");
    // By when they were shared out.
    std::vector<std::pair<fs::file_time_type, fs::path>> files;
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
        if (std::error_code gone; entry->path().extension() == ".json" && entry->is_regular_file(gone)) {
            const auto written = entry->last_write_time(gone);
            if (!gone) files.emplace_back(written, entry->path());
        }
    std::ranges::sort(files);
    std::map<fs::path, FarmJob> jobs;
    Wanted wanted;
    for (const auto& [written, file] : files) {
        FarmJob job;
        try {
            job = read_job(file);
        } catch (const WrongUsage&) {
            const bool is_another = is_job && file.filename() != path.filename();
            if (is_another || !fs::exists(file)) continue;
            throw;
        }
        for_frames(job, [&](int frame, const std::string& made_of) {
            wanted[{job.of.name, job.verb, frame}] = made_of;
        });
        jobs[file] = std::move(job);
    }
    if (is_job) std::erase_if(jobs, [&](const auto& job) { return job.first.filename() != path.filename(); });
    if (jobs.empty())
        throw WrongUsage(
            "--status " + quoted_text(path.string()) +
            ": pelagic farm has written no job into this folder; pelagic verify looks at what is in it");
    const auto queue = queued();
    int status = kDone;
    for (const auto& [file, job] : jobs) {
        const Counted counted = print_job(file, job, is_job, wanted, queue);
        if (counted.whole < counted.frames || counted.refused > 0) status = kNotWhole;
    }
    return status;
}

}  // namespace pelagic::cli
