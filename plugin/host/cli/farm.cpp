// pelagic farm SHOT.toml
#include "plugin/host/cli/farm.h"

#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iostream>
#include <memory>
#include <span>
#include <stdexcept>
#include <string_view>
#include <system_error>

#include "core/base/text.h"
#include "core/plan/fingerprint.h"
#include "core/plan/memory.h"
#include "core/plan/plan.h"
#include "core/scene/budget.h"
#include "core/scene/text.h"
#include "plugin/bake/bake.h"
#include "plugin/files/files.h"
#include "plugin/format/shot/shot.h"
#include "plugin/host/cli/account.h"
#include "plugin/host/cli/exit_status.h"
#include "plugin/host/cli/guarded_run.h"
#include "plugin/host/cli/help.h"
#include "plugin/host/cli/json_output.h"
#include "plugin/host/cli/own_program.h"
#include "plugin/host/cli/render_order.h"
#include "plugin/host/cli/text.h"
#include "plugin/host/cli/verb.h"
#include "plugin/light/light.h"
#include "plugin/machine/memory.h"
#include "plugin/render/batch.h"
#include "plugin/run/part.h"

namespace pelagic::cli {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostTasks = 1000;  // Slurm's default MaxArraySize takes no more

struct FarmArguments : RenderArguments {
    std::string verb = "bake", status;
    std::optional<int> tasks;
    double minutes = 10.0;
    bool submit = false;
    std::vector<std::string> sbatch;
    std::vector<std::string> passed;  // to each task, as words of a shell
};

// What a task asks the queue for.
struct TaskNeed {
    int threads = 1;
    FrameAccount frame;
    std::size_t memory_bytes = 0;
    std::function<MemoryNeed(std::span<const int> frames)>
        of_frames{};  // what they need, as the task itself counts it
};

// A path in a line of #SBATCH, where Slurm takes % for itself, and strips a \, which no path here has.
std::string sbatch_path(const fs::path& path, std::string_view pattern = {}) {
    std::string word = "\"";
    for (const char c : path.string()) {
        if (c == '"') word += '\\';
        if (c == '%') word += '%';
        word += c;
    }
    return word + std::string(pattern) + '"';
}

std::vector<std::vector<int>> split(const std::vector<int>& frames, std::size_t tasks) {
    std::vector<std::vector<int>> parts(tasks);
    for (std::size_t i = 0; i < tasks; ++i)
        parts[i].assign(frames.begin() + static_cast<std::ptrdiff_t>(i * frames.size() / tasks),
                        frames.begin() + static_cast<std::ptrdiff_t>((i + 1) * frames.size() / tasks));
    return parts;
}

// A core for each part of the memory that farms have beside one; then the frame again, on so many.
template <class Account>
TaskNeed need_of(int asked_threads, const Account& account) {
    constexpr std::size_t kBytesOfACore = std::size_t{4} << 30;
    constexpr std::size_t kMostCores = 64;
    // The program itself, its libraries, and what no plan counts.
    constexpr std::size_t kBeside = std::size_t{256} << 20;
    const auto of = [&](int threads) {
        TaskNeed need{.threads = threads, .frame = account(threads)};
        need.memory_bytes = need.frame.memory_bytes + need.frame.memory_bytes / 5 + kBeside;
        return need;
    };
    if (asked_threads > 0) return of(asked_threads);
    const std::size_t cores = of(1).memory_bytes / kBytesOfACore + 1;
    return of(static_cast<int>(std::min(cores, kMostCores)));
}

// 0001-0064; of frames with gaps with a number that is theirs: 0001-0064.3f2a9c1b.
std::string range_of(const std::vector<int>& frames) {
    const std::string range =
        FilePattern{"", "-"}.file(frames.front()) + FilePattern{"", ""}.file(frames.back());
    const auto span = std::int64_t{frames.back()} - frames.front() + 1;
    if (static_cast<std::int64_t>(frames.size()) == span) return range;
    return range + '.' + Fingerprint().add(frames_text(frames)).text().substr(0, 8);
}

std::size_t tasks_for(const FarmArguments& arguments, std::size_t frames, double seconds_a_frame) {
    constexpr double kBesideComputing = 1.5;  // encoding and writing, about
    double tasks = arguments.tasks.value_or(0);
    if (!arguments.tasks)
        tasks = std::ceil(static_cast<double>(frames) * kBesideComputing * seconds_a_frame /
                          (60.0 * arguments.minutes));
    return std::min({static_cast<std::size_t>(std::clamp(tasks, 1.0, static_cast<double>(kMostTasks))),
                     frames, kMostTasks});
}

// A value with a space in it is one word.
std::string sbatch_option(const std::string& option) {
    const std::size_t value = option.find('=') + 1;
    if (value == 0 || option.find_first_of(" \t", value) == std::string::npos ||
        option.find_first_of("\"'", value) != std::string::npos || option.find(" -") != std::string::npos)
        return option;
    return option.substr(0, value) + '"' + option.substr(value) + '"';
}

bool is_of_the_array(const std::string& option) {
    return option.starts_with("--array") || option.starts_with("-a");
}

// own: lines of the one script. What the user asks for comes last: of two lines of one option Slurm takes the second.
std::string header(const FarmArguments& arguments, bool is_array, const std::string& name, int threads,
                   std::size_t memory_bytes, const std::string& own) {
    std::string text = "#!/bin/bash\n#SBATCH --job-name=" + sbatch_path(name) +
                       "\n#SBATCH --nodes=1 --ntasks=1\n#SBATCH --cpus-per-task=" + std::to_string(threads) +
                       "\n#SBATCH --mem=" + std::to_string((memory_bytes >> 20) + 1) +
                       "M\n#SBATCH --requeue\n#SBATCH --open-mode=append\n" + own;
    for (const std::string& option : arguments.sbatch)
        if (is_array || !is_of_the_array(option)) text += "#SBATCH " + sbatch_option(option) + '\n';
    return text;
}

// Each task's own script: bash FILE N makes task N wherever it is called.
std::string array_script(const FarmArguments& arguments, const FarmJob& job, const std::string& name,
                         const TaskNeed& need, const fs::path& program, const fs::path& out, double seconds) {
    constexpr double kLeast_s = 3600.0, kTimes = 10.0;  // of what the plan says, which is of another machine
    const fs::path folder = out / "farm";
    const std::string last = std::to_string(job.tasks.size() - 1);
    std::string text =
        header(arguments, true, job.of.name + ' ' + job.verb, need.threads, need.memory_bytes,
               "#SBATCH --time=" + std::to_string(std::lround(std::max(kLeast_s, kTimes * seconds) / 60.0)) +
                   "\n#SBATCH --array=0-" + last +
                   "\n#SBATCH --output=" + sbatch_path(folder / name, ".%a.slurm") + '\n');
    text += "# By pelagic farm. Without Slurm: bash THIS N makes task N, 0 to " + last + ".\nframes=(";
    for (const FarmTask& task : job.tasks) text += "\n    " + task.frames;
    text += "\n)\nlogs=(";
    for (const FarmTask& task : job.tasks) text += "\n    " + shell_word(task.log);
    text +=
        "\n)\nn=${1:-${SLURM_ARRAY_TASK_ID:-}}\n"
        "if ! [[ $n =~ ^[0-9]{1,4}$ ]] || ((10#$n > " +
        last +
        ")); then\n"
        "    echo \"bash $0 N: N is '$n'; accepted: the number of a task, 0 to " +
        last +
        "\" >&2\n"
        "    exit 2\n"
        "fi\n"
        "n=$((10#$n))\n"
        "# A job of another version, begun again, would make what its --chosen and frames no longer are. A network's folder may show the new one late.\n"
        "is_ours() { grep -qF '\"id\": \"" +
        job.id + "\"' " + shell_word((folder / (name + ".json")).string()) +
        " 2>/dev/null; }\n"
        "if [ -d " +
        shell_word(out.string()) +
        " ] && ! is_ours; then\n"
        "    [ -n \"${SLURM_ARRAY_JOB_ID:-}\" ] && sleep 70\n"
        "    is_ours\n"
        "    case $? in\n"
        "        0) ;;\n"
        "        1) echo 'this job was shared out anew since, in another version: its tasks are no longer wanted' >&2; exit 2 ;;\n"
        "        *) echo 'what lies beside this script, its job, cannot be read' >&2; exit 75 ;;\n"
        "    esac\n"
        "fi\n"
        "cd " +
        shell_word(out.string()) +
        " || { echo 'Where the folder was moved to, share the shot out again.' >&2; exit 75; }\nlog=" +
        shell_word(folder.string()) +
        "/${logs[n]}\nexec >>\"$log\" 2>&1 || exit 75\n"
        "id=${SLURM_ARRAY_JOB_ID:-$(hostname -s)-$$}_$n\n"
        "echo \"" +
        kFarmBegun +
        "$id on ${SLURMD_NODENAME:-$(hostname -s)}, $(date '+%F %T')\"\n"
        "# Told to stop, the program ends with whole files, and then this. A second signal ends it at once: one that\n"
        "# the queue has sent to both isn't handed on. TERM for all: what a script has beside it ignores INT.\n"
        "stop() {\n"
        "    caught=1\n"
        "    if ((told++)) || ! { sleep 0.3; tac \"$log\" | sed '/^" +
        kFarmBegun +
        "/q' | grep -q '^pelagic: stop'; }; then\n"
        "        kill -TERM $program 2>/dev/null\n"
        "    fi\n"
        "}\n" +
        shell_word(program.string()) + ' ' + job.verb + ' ' + shell_word(job.shot) + " --out " +
        shell_word(out.string()) + " --frames \"${frames[n]}\" --threads \"${SLURM_CPUS_PER_TASK:-" +
        std::to_string(need.threads) + "}\"";
    for (const std::string& word : arguments.passed) text += ' ' + word;
    text +=
        " &\n"
        "program=$!\n"
        "trap stop TERM INT HUP\n"
        "caught=1\n"
        "while [ \"$caught\" ]; do # a signal ends the waiting\n"
        "    caught=\n"
        "    wait $program\n"
        "    status=$?\n"
        "done\n"
        "trap : TERM INT HUP\n"
        "# Before the word that it has ended: from then on nobody looks whether it runs.\n"
        "if [[ $status = 75 || $status = 137 ]] && [ -n \"${SLURM_ARRAY_JOB_ID:-}\" ] && [ \"${SLURM_RESTART_COUNT:-0}\" -lt 3 ]; then\n"
        "    echo \"" +
        std::string(kFarmEnded) +
        "$id with status $status, and is begun again\"\n"
        "    scontrol requeue \"${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID\" && sleep 60\n"
        "else\n"
        "    echo \"" +
        kFarmEnded +
        "$id with status $status, $(date '+%F %T')\"\n"
        "fi\n"
        "exit $status\n";
    return text;
}

// Whether what this job was to make is there and whole, whatever else is being made in the folder.
std::string verify_script(const FarmArguments& arguments, const FarmJob& job, const std::string& name,
                          const fs::path& program, const fs::path& out) {
    constexpr std::size_t kMemory = std::size_t{1} << 30;
    return header(arguments, false, job.of.name + " verify", 1, kMemory,
                  "#SBATCH --output=" + sbatch_path(out / "farm" / name, ".verify.log") + '\n') +
           "# By pelagic farm: the last job, after all tasks of " + name + ".sh.\nsaid=$(" +
           shell_word(program.string()) + " verify " + shell_word(out.string()) +
           " --threads \"${SLURM_CPUS_PER_TASK:-1}\")\nstatus=$?\n"
           "printf '%s\\n' \"$said\"\n"
           "# Pictures that aren't there, verify doesn't know, nor by which set frames were to be made; frames of others, and that weren't asked\n"
           "# for, it misses.\n"
           "grep -E '^(missing|damaged|foreign|interrupted): ' <<<\"$said\" | grep -qv \" lacks frames that aren't baked: \"\n"
           "[ $status$? = 31 ] && status=0 && echo 'nothing is damaged; of the frames that are missing or stale above, those of this job:'\n" +
           shell_word(program.string()) + " farm --status " +
           shell_word((out / "farm" / (name + ".json")).string()) +
           "\nthere=$?\n((status)) || status=$there\nexit $status\n";
}

// The job's number.
std::string submitted(const std::string& options, const fs::path& script) {
    const std::string command = "sbatch --parsable " + options + ' ' + shell_word(script.string());
    std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), [](FILE*) { return 0; });
    if (!pipe) throw std::system_error(errno, std::generic_category(), "sbatch can't be called");
    std::string said;
    std::array<char, 256> piece{};
    while (std::fgets(piece.data(), static_cast<int>(piece.size()), pipe.get())) said += piece.data();
    const int status = pclose(pipe.release());
    while (said.ends_with('\n')) said.pop_back();
    if (status != 0)
        throw TryAgain("sbatch refuses " + line_text(script.string()) +
                       "; what it says of that stands above");
    // The last line: a site's sbatch may say more before. What follows ; is the cluster's name.
    std::string job = said.substr(said.rfind('\n') + 1);
    job = job.substr(0, job.find(';'));
    if (job.empty() || job.find_first_not_of("0123456789") != std::string::npos)
        throw std::runtime_error("sbatch gives no number of a job: " + quoted_text(said));
    return job;
}

void submit(const fs::path& array, const fs::path& verify) {
    const std::string job = submitted("", array);
    std::cout << "submitted: array " << job << std::endl;  // it is there, whatever becomes of the second
    tell_json({{"event", "submitted"}, {"array", job}});
    const std::string last = submitted("--dependency=afterany:" + job, verify);
    std::cout << "submitted: verify " << last << ", after it\n";
    tell_json({{"event", "submitted"}, {"array", job}, {"verify", last}});
}

// What is settled once for all tasks, and what a task then needs.
TaskNeed settle_job(FarmArguments& arguments, const RunOptions& options, const Scene& asked,
                    FixedSettings fixed, const PictureOrder& order, std::vector<std::string>& made_of,
                    Session& session) {
    RunOptions whole = options;
    whole.frames.clear();  // settled for the whole shot
    whole.cancel = nullptr;
    const auto chosen = [&](const Settled& settled) {
        if (!settled.chosen().empty()) arguments.passed.push_back("--chosen=" + shell_word(settled.chosen()));
    };
    const auto frames = static_cast<int>(options.frames.size());
    const int threads = arguments.threads.empty() ? 0 : session.threads.count();
    if (arguments.verb == "bake") {
        const Settled settled = settled_for(whole, asked, Purpose::Mesh, session);
        chosen(settled);
        check_bake(settled.scene, options.out);
        const auto plan = std::make_shared<const Plan>(plan_bake(settled.scene));
        made_of = frames_made_of(*plan, options.frames);
        TaskNeed need =
            need_of(threads, [&](int on) { return bake_account(*plan, frames, on, rates_on(on)); });
        need.of_frames = [plan, on = need.threads](std::span<const int> of) {
            return bake_memory(*plan, of.size(), on);
        };
        return need;
    }
    PictureOrder pictures = order;
    const Settled settled = settled_for(whole, order.scene, Purpose::Pictures, session, fixed);
    settled.apply(pictures);
    chosen(settled);
    check_render(pictures.scene, pictures.options);
    const PictureFingerprint of_frame = picture_fingerprint(pictures);
    for (const int frame : options.frames) made_of.push_back(of_frame.of(frame));
    TaskNeed need = need_of(threads, [&](int on) {
        return picture_account(without_budget(pictures.scene), pictures.options, on, rates_on(on));
    });
    need.of_frames = [pictures, on = need.threads](std::span<const int> of) {
        return render_memory(pictures.scene, pictures.options, of,
                             std::min(static_cast<int>(of.size()), kPicturesInFlight), on);
    };
    return need;
}

int run(FarmArguments arguments) {
    if (!arguments.status.empty()) return print_farm_status(arguments.status);
    if (arguments.shot.empty()) throw WrongUsage("SHOT.toml is required, or --status DIR");
    const bool is_bake = arguments.verb == "bake";
    FixedSettings fixed;
    PictureOrder order;
    if (!is_bake) order = order_of(arguments, fixed);
    const Scene scene = is_bake ? load_shot(arguments.shot, check_scene) : order.scene;
    RunOptions options = run_options(arguments, scene.shot);
    if (options.frames.empty())
        for (std::int64_t frame = scene.shot.first_frame; frame <= scene.shot.last_frame; ++frame)
            options.frames.push_back(static_cast<int>(frame));
    // Before a script that is there is overwritten.
    if (arguments.submit && std::system("command -v sbatch >/dev/null 2>&1") != 0)
        throw WrongUsage(
            "--submit: there is no sbatch here; without --submit the scripts are written, to be submitted where there is one");
    const fs::path out = fs::absolute(options.out).lexically_normal();
    const auto has_line = [](const std::string& text) { return text.find('\n') != std::string::npos; };
    if (has_line(out.string()) || std::ranges::any_of(arguments.sbatch, has_line))
        throw WrongUsage("a script of Slurm's takes no line's end in a path or an option");
    if (out.string().find('\\') != std::string::npos)
        throw WrongUsage("--out " + quoted_text(out.string()) +
                         ": Slurm takes no \\ in the path of a task's output; accepted: a path without");
    return guarded_run({.shot = arguments.shot, .threads = arguments.threads}, [&](Session& session) {
        std::vector<std::string> made_of;
        const TaskNeed need = session.threads.execute(
            [&] { return settle_job(arguments, options, scene, fixed, order, made_of, session); });
        session.progress.clear();
        FarmJob job{.verb = arguments.verb,
                    .shot = fs::absolute(arguments.shot).lexically_normal().string(),
                    .of = scene.shot,
                    .instruction_set = arguments.instruction_set,
                    .is_deep = arguments.deep};
        nlohmann::ordered_json told{
            {"verb", job.verb},
            {"shot", job.shot},
            {"name", job.of.name},
            {"frame_range", {job.of.first_frame, job.of.last_frame}},
            {"threads", need.threads},
            {"task_memory_bytes", need.memory_bytes},
            {"frame", json_of(need.frame)},
            {"instruction_set", job.instruction_set},
            {"deep", job.is_deep},
            {"tasks", nlohmann::ordered_json::array()},
        };
        const std::size_t tasks = tasks_for(arguments, options.frames.size(), need.frame.seconds);
        const bool is_part = static_cast<std::int64_t>(options.frames.size()) <=
                             std::int64_t{scene.shot.last_frame} - scene.shot.first_frame;
        std::string name = job.of.name + '.' + job.verb;
        // Each part has scripts of its own: another one may be at work.
        if (is_part) name += '.' + range_of(options.frames);
        const std::vector<std::vector<int>> parts = split(options.frames, tasks);
        if (options.max_memory_bytes > 0)
            require_memory(need.of_frames(parts.back()), machine::memory_limit_or(options.max_memory_bytes),
                           "a task");
        auto its = made_of.begin();
        for (const std::vector<int>& part : parts) {
            std::string frames = frames_text(part);
            std::erase(frames, ' ');
            const std::string log = name + '.' + range_of(part) + ".log";
            job.tasks.push_back({.frames = frames,
                                 .made_of = {its, its + static_cast<std::ptrdiff_t>(part.size())},
                                 .log = log,
                                 .slurm = name + '.' + std::to_string(job.tasks.size()) + ".slurm"});
            told["tasks"].push_back({{"task", job.tasks.size() - 1},
                                     {"frames", frames},
                                     {"made_of", job.tasks.back().made_of},
                                     {"log", log},
                                     {"slurm", job.tasks.back().slurm}});
            its += static_cast<std::ptrdiff_t>(part.size());
        }
        Fingerprint of_all;
        of_all.add(job.instruction_set).add(frames_text(options.frames));
        for (const std::string& frame : made_of) of_all.add(frame);
        told["id"] = job.id = of_all.text();
        const fs::path folder = out / "farm", array = folder / (name + ".sh"),
                       last = folder / (name + ".verify.sh");
        const fs::path program = own_program();
        files::ensure_folder(folder);
        const double seconds = need.frame.seconds * std::ceil(static_cast<double>(options.frames.size()) /
                                                              static_cast<double>(tasks));
        // What ended before says nothing of this job.
        for (const FarmTask& task : job.tasks)
            if (const fs::path log = folder / task.log; fs::exists(log)) {
                const fs::file_time_type heard = fs::last_write_time(log);
                std::ofstream(log, std::ios::app) << kFarmShared << '\n';
                fs::last_write_time(log, heard);
            }
        // Before the scripts, which look for their id in it.
        files::write_atomically(folder / (name + ".json"),
                                told.dump(2, ' ', true, nlohmann::json::error_handler_t::replace) + '\n');
        files::write_atomically(array, array_script(arguments, job, name, need, program, out, seconds));
        files::write_atomically(last, verify_script(arguments, job, name, program, out));
        std::cout << count_text(static_cast<long>(options.frames.size()), "frame", "frames") << " in "
                  << count_text(static_cast<long>(tasks), "task", "tasks") << " of "
                  << count_text(need.threads, "core", "cores") << " and " << bytes_text(need.memory_bytes)
                  << "; by the plan about " << rough_text(need.frame.seconds) << " s a frame and "
                  << (seconds < 1.0 ? "less than a second" : duration_text(seconds)) << " a task\n"
                  << "array:  " << line_text(array.string()) << "\nverify: " << line_text(last.string())
                  << '\n';
        for (auto& task : told["tasks"]) task.erase("made_of");
        told["event"] = "result";
        told["array"] = array.string();
        told["verify"] = last.string();
        tell_json(told);
        if (arguments.submit)
            submit(array, last);
        else
            std::cout << "submit: job=$(sbatch --parsable " << line_text(shell_word(array.string()))
                      << ") && sbatch --dependency=afterany:$job " << line_text(shell_word(last.string()))
                      << '\n';
        std::cout << std::flush;
        return int{kDone};
    });
}

}  // namespace

std::string shell_word(const std::string& text) {
    std::string word = "'";
    for (const char c : text) word += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return word + "'";
}

Verb add_farm(CLI::App& program) {
    CLI::App* command = program.add_subcommand("farm", help::kFarm)->footer(help::kFarmFooter);
    auto arguments = std::make_shared<FarmArguments>();
    command->add_option("SHOT.toml", arguments->shot, help::kShot)->type_name("");
    command->add_option("--verb", arguments->verb, help::kFarmVerb)
        ->type_name("VERB")
        ->check(CLI::IsMember({"bake", "render"}).description(""));
    command->add_flag("--submit", arguments->submit, help::kFarmSubmit);
    command->add_option("--status", arguments->status, help::kFarmStatus)->type_name("DIR|JOB");
    command->add_option("--tasks", arguments->tasks, help::kFarmTasks)
        ->type_name("N")
        ->check(CLI::Range(1, static_cast<int>(kMostTasks)).description(""));
    command->add_option("--minutes", arguments->minutes, help::kFarmMinutes)
        ->type_name("MINUTES")
        ->check(CLI::Range(0.1, 1440.0).description(""));
    command->add_option("--sbatch", arguments->sbatch, help::kFarmSbatch)
        ->type_name("OPTION")
        ->allow_extra_args(false);
    add_json(*command);
    const std::size_t own = command->get_options().size();
    add_run_options(*command, *arguments, help::kTrustTimes);
    command->get_option("--out")->description(help::kFarmOut);
    command->get_option("--threads")->description(help::kFarmThreads);
    const std::size_t of_runs = command->get_options().size();
    add_picture_options(*command, *arguments);
    return {command, [arguments, command, own, of_runs] {
                const std::vector<CLI::Option*> options = command->get_options();
                for (std::size_t i = own; i < options.size(); ++i) {
                    const std::string name = "--" + options[i]->get_lnames().front();
                    if (options[i]->count() == 0 || name == "--out" || name == "--frames" ||
                        name == "--threads" || name == "--chosen")
                        continue;
                    if (i >= of_runs && arguments->verb != "render")
                        throw WrongUsage(name + " is of pictures: --verb render makes them");
                    for (std::string value : options[i]->results()) {
                        // Tasks run in the folder of their files.
                        if (name == "--ocio" && value != "env" && fs::exists(value))
                            value = fs::absolute(value).lexically_normal().string();
                        arguments->passed.push_back(options[i]->get_items_expected_max() == 0
                                                        ? name
                                                        : name + '=' + shell_word(value));
                    }
                }
                return run(*arguments);
            }};
}

}  // namespace pelagic::cli
