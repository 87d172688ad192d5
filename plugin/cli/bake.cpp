// pelagic bake SHOT.toml
#include "plugin/bake/bake.h"

#include <algorithm>
#include <iostream>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/base/text.h"
#include "core/plan/plan.h"
#include "plugin/cli/exit_status.h"
#include "plugin/cli/help.h"
#include "plugin/cli/memory.h"
#include "plugin/cli/progress.h"
#include "plugin/cli/stop.h"
#include "plugin/cli/text.h"
#include "plugin/cli/threads.h"
#include "plugin/cli/verb.h"
#include "plugin/cli/warnings.h"
#include "plugin/light/light.h"
#include "plugin/shot/shot.h"

namespace pelagic::cli {
namespace {

struct BakeArguments {
    std::string shot;
    std::optional<std::string> out;
    std::optional<std::string> frames;
    std::string threads, max_memory;
    bool trust_times = false;
};

void print_damaged(const std::vector<std::string>& damaged, const std::string& out) {
    constexpr std::size_t kMost = 10;
    for (std::size_t i = 0; i < std::min(damaged.size(), kMost); ++i)
        std::cerr << "pelagic: in " << out << ' ' << damaged[i] << "; made again\n";
    if (damaged.size() > kMost)
        std::cerr << "pelagic: and so " << damaged.size() - kMost << " more; made again\n";
}

void print_done(const BakeReport& report, const std::string& out) {
    if (!report.root.empty()) std::cout << "stage:  " << line_text(report.root.string()) << '\n';
    if (!report.maps.empty()) std::cout << "maps:   " << line_text(report.maps.string()) << '\n';
    if (!report.volumes.empty()) std::cout << "volumes: " << line_text(report.volumes.string()) << '\n';
    std::cout << "record: " << line_text(report.record.string()) << '\n';
    std::cout << count_text(report.done, "frame", "frames") << " baked";
    if (report.kept > 0) std::cout << ", " << report.kept << " kept as they were";
    if (report.done > 0) std::cout << ", in " << duration_text(report.seconds);
    std::cout << '\n';
    if (const std::string times = time_text(report); !times.empty()) std::cout << times << '\n';
    std::cout << std::flush;
    print_damaged(report.damaged, out);
    if (!report.unlocked.empty())
        std::cerr
            << "pelagic: note: " << out << " can't be locked (" << report.unlocked
            << "); where several bakes write there at the same time, look at the end with pelagic verify\n";
    for (const std::string& line : report.foreign)
        std::cerr << "pelagic: in " << out << " lies " << line << "; nothing was deleted\n";
    if (!report.stale.empty()) {
        std::cerr
            << "pelagic: in " << out << " the frames " << frames_text(report.stale)
            << " are of another version of this shot, or altered in its record, and were not asked for; bake them "
               "again with --frames, or without it for the whole shot\n";
    }
}

// The system gave less than the bake was allowed: what it holds, so that people see what is large.
std::string out_of_memory(const Scene& scene, int threads) {
    const MemoryNeed need = bake_memory(plan_bake(scene), kFramesInFlight, threads);
    return "pelagic: out of memory; this bake holds " + memory_text(need) + "; to need less, " +
           need.parts().front().remedy + "; files already written are whole\n";
}

int stopped(const BakeReport& report, const std::string& out, int signal) {
    std::cerr << "pelagic: stopped; " << report.done + report.kept << " of the "
              << count_text(report.total, "frame", "frames") << " asked for are whole in " << out
              << "; run the same command again to continue\n";
    return kSignal + signal;
}

int run(const BakeArguments& arguments) {
    const Scene scene = load_shot(arguments.shot, check_scene);
    BakeOptions options;
    if (arguments.frames) {
        try {
            options.frames = parse_frames(*arguments.frames, scene.shot);
        } catch (const std::invalid_argument& error) {
            std::cerr << "pelagic: " << error.what() << "\nSee: pelagic bake --help\n";
            return kWrongUsage;
        }
    }
    if (arguments.out && arguments.out->empty()) {
        std::cerr << "pelagic: --out \"\": that is no folder; accepted: a path, or no --out for ./"
                  << scene.shot.name << '\n';
        return kWrongUsage;
    }
    options.out = arguments.out.value_or(scene.shot.name);
    options.max_memory_bytes = memory_of(arguments.max_memory);
    options.trust_times = arguments.trust_times;

    StopSignals stop;  // from here on nobody's closing of a log ends the bake
    print_warnings(arguments.shot, scene);
    Progress progress;
    options.cancel = &stop.cancelled();
    options.progress = [&](const BakeProgress& now) {
        if (now.stage == BakeStage::Frames) stop.files_begin();
        progress.show(now);
    };

    Threads threads(arguments.threads);
    BakeReport report;
    try {
        report = threads.execute([&] { return bake(scene, options); });
    } catch (const std::bad_alloc&) {
        progress.clear();
        std::cerr << out_of_memory(scene, threads.count());
        return kRefused;
    } catch (const NotEnoughMemory& error) {
        progress.clear();
        return refuse_memory(arguments.shot, error);
    } catch (const std::invalid_argument& error) {
        // load_shot() has looked at every value with its line: what is refused here is what it can't see.
        progress.clear();
        std::cerr << placed(arguments.shot, error.what()) << '\n';
        return kRefused;
    }
    progress.clear();
    const std::string out = line_text(options.out.string());
    if (report.cancelled) return stopped(report, out, stop.number());
    print_done(report, out);
    return kDone;
}

}  // namespace

Verb add_bake(CLI::App& program) {
    CLI::App* command = program.add_subcommand("bake", help::kBake);
    command->group(help::kVerbs);
    command->footer(help::kBakeFooter);
    auto arguments = std::make_shared<BakeArguments>();
    command->add_option("SHOT.toml", arguments->shot, help::kShot)->required()->type_name("");
    command->add_option("--out", arguments->out, help::kOut)->type_name("DIR");
    command->add_option("--frames", arguments->frames, help::kFrames)->type_name("FRAMES");
    command->add_flag("--trust-times", arguments->trust_times, help::kTrustTimes);
    add_threads(*command, arguments->threads, help::kThreads);
    add_max_memory(*command, arguments->max_memory, help::kMaxMemory);
    return {command, [arguments] { return run(*arguments); }};
}

}  // namespace pelagic::cli
