#include "plugin/host/cli/guarded_run.h"

#include <iostream>
#include <new>

#include "core/base/build_watch.h"
#include "core/base/instruction_set.h"
#include "core/base/text.h"
#include "core/plan/memory.h"
#include "plugin/format/shot/shot.h"
#include "plugin/host/cli/exit_status.h"
#include "plugin/host/cli/help.h"
#include "plugin/host/cli/instruction_set.h"
#include "plugin/host/cli/json_output.h"
#include "plugin/host/cli/memory.h"
#include "plugin/host/cli/text.h"

namespace pelagic::cli {
namespace {

void print_other_sets(const RunReport& report, const RunOptions& options, const std::string& out) {
    for (const auto& [set, frames] : report.of_other_sets)
        if (!set.empty() || options.same_instruction_set)
            std::cerr << "pelagic: note: in " << out << ' '
                      << (set.empty() ? "another instruction set" : line_text(set)) << " had made the frames "
                      << frames_text(frames)
                      << (options.same_instruction_set
                              ? "; made again by "
                              : ": kept; for equal bits by one set, give --instruction-set, as ")
                      << instruction_set() << std::endl;
}

}  // namespace

int guarded_run(const Guard& guard, const std::function<int(Session&)>& work) {
    std::optional<StopSignals> stop;  // from here on nobody's closing of a log ends the work
    if (!guard.stopping.empty()) stop.emplace(guard.stopping);
    Threads threads(guard.threads);
    try {
        Progress progress;  // which has gone before a message comes
        Session session{stop ? &*stop : nullptr, progress, threads};
        return work(session);
    } catch (const std::bad_alloc&) {
        if (!guard.out_of_memory) throw;
        std::cerr << "pelagic: " << guard.out_of_memory(threads.count()) << '\n';
        return kTryAgain;
    } catch (const NotEnoughMemory& error) {
        if (guard.shot.empty()) throw;
        return refuse_memory(guard.shot, error);
    } catch (const std::invalid_argument& error) {
        // load_shot() has looked at every value with its line: what is refused here is what it can't see.
        if (guard.shot.empty()) throw;
        std::cerr << placed(guard.shot, error.what()) << '\n';
        return status_of(error);
    } catch (const BuildCancelled&) {
        if (!stop || !guard.stopped) throw;
        std::cerr << "pelagic: stopped; " << guard.stopped() << '\n';
        return kSignal + stop->number();
    }
}

void add_run_options(CLI::App& command, RunArguments& arguments, const char* trust_times) {
    command.add_option("--out", arguments.out, help::kOut)->type_name("DIR");
    command.add_option("--frames", arguments.frames, help::kFrames)->type_name("FRAMES");
    command.add_flag("--trust-times", arguments.trust_times, trust_times);
    command.add_option("--chosen", arguments.chosen, help::kChosen)->type_name("TEXT");
    add_threads(command, arguments.threads, help::kThreads);
    add_max_memory(command, arguments.max_memory, help::kMaxMemory);
    add_instruction_set(command, arguments.instruction_set, help::kInstructionSet);
}

RunOptions run_options(const RunArguments& arguments, const Shot& shot) {
    RunOptions options;
    if (arguments.frames) options.frames = asked([&] { return parse_frames(*arguments.frames, shot); });
    if (arguments.out && arguments.out->empty())
        throw WrongUsage("--out \"\": that is no folder; accepted: a path, or no --out for ./" + shot.name);
    options.out = arguments.out.value_or(shot.name);
    options.max_memory_bytes = memory_of(arguments.max_memory);
    options.trust_times = arguments.trust_times;
    options.settled = arguments.chosen;
    options.same_instruction_set = !arguments.instruction_set.empty();
    return options;
}

Settled settled_for(const RunOptions& options, const Scene& scene, Purpose purpose, Session& session,
                    const FixedSettings& fixed) {
    const BuildWatch watch{.progress = [&](double done) { session.progress.show_measuring(done); },
                           .cancel = options.cancel};
    Settled settled =
        settle_for(options, scene, purpose,
                   {.fixed = fixed, .max_memory_bytes = options.max_memory_bytes, .watch = watch},
                   purpose == Purpose::Pictures ? "--samples and --sky-quality" : "");
    session.progress.clear();
    if (!settled.text.empty()) std::cout << settled.text << std::endl;
    if (!settled.note.empty())
        std::cerr << "pelagic: in " << line_text(options.out.string()) << ' ' << settled.note << std::endl;
    return settled;
}

int run_frames(const RunArguments& arguments, RunOptions options, const FrameVerb& verb) {
    apply_instruction_set(arguments.instruction_set);
    RunReport report;
    const std::string out = line_text(options.out.string());
    const auto stopped = [&] {
        return std::to_string(report.done + report.kept) + " of the " +
               count_text(report.total, "frame", "frames") + " asked for are whole in " + out +
               "; run the same command again to continue";
    };
    return guarded_run({.shot = arguments.shot,
                        .threads = arguments.threads,
                        .stopping = verb.stopping,
                        .out_of_memory = verb.out_of_memory,
                        .stopped = stopped},
                       [&](Session& session) {
                           options.cancel = &session.stop->cancelled();
                           options.progress = [&](const RunProgress& now) {
                               if (now.stage == RunStage::Frames) session.stop->files_begin();
                               session.progress.show(now, verb.share_is);
                           };
                           report = session.threads.execute([&] { return verb.work(options, session); });
                           if (report.cancelled) throw BuildCancelled();
                           session.progress.clear();
                           print_other_sets(report, options, out);
                           verb.report(report, out);
                           tell_json({{"event", "result"},
                                      {"verb", verb.name},
                                      {"done", report.done},
                                      {"kept", report.kept},
                                      {"total", report.total},
                                      {"seconds", report.seconds},
                                      {"record", report.record.string()},
                                      {"damaged", report.damaged},
                                      {"foreign", report.foreign},
                                      {"stale", report.stale},
                                      {"of_other_sets", report.of_other_sets}});
                           return int{kDone};
                       });
}

}  // namespace pelagic::cli
