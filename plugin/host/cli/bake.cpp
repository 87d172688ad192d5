// pelagic bake SHOT.toml
#include "plugin/bake/bake.h"

#include <algorithm>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "core/base/text.h"
#include "core/plan/plan.h"
#include "core/scene/budget.h"
#include "plugin/format/shot/shot.h"
#include "plugin/host/cli/guarded_run.h"
#include "plugin/host/cli/help.h"
#include "plugin/host/cli/json_output.h"
#include "plugin/host/cli/memory.h"
#include "plugin/host/cli/text.h"
#include "plugin/host/cli/verb.h"
#include "plugin/host/cli/warnings.h"
#include "plugin/light/light.h"

namespace pelagic::cli {
namespace {

void print_damaged(const std::vector<std::string>& damaged, const std::string& out) {
    constexpr std::size_t kMost = 10;
    for (std::size_t i = 0; i < std::min(damaged.size(), kMost); ++i)
        std::cerr << "pelagic: in " << out << ' ' << damaged[i] << "; made again\n";
    if (damaged.size() > kMost)
        std::cerr << "pelagic: and so " << damaged.size() - kMost << " more; made again\n";
}

void print_done(const RunReport& report, const std::string& out) {
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
    const std::vector<MemoryPart> parts = need.parts();
    const auto most =
        std::ranges::find_if(parts, [](const MemoryPart& part) { return !part.remedy.empty(); });
    return "out of memory; this bake holds " + memory_text(need) +
           (most == parts.end() ? std::string() : "; to need less, " + most->remedy) +
           "; files already written are whole";
}

int run(const RunArguments& arguments) {
    const Scene asked = load_shot(arguments.shot, check_scene);
    Scene scene = without_budget(asked);
    return run_frames(arguments, run_options(arguments, scene.shot),
                      {.name = "bake",
                       .stopping = "stopping after the current file",
                       .share_is = "the foam's past",
                       .out_of_memory = [&](int threads) { return out_of_memory(scene, threads); },
                       .work =
                           [&](RunOptions options, Session& session) {
                               print_warnings(arguments.shot, scene);
                               const Settled settled = settled_for(options, asked, Purpose::Mesh, session);
                               scene = settled.scene;
                               settled.apply(options);
                               return bake(scene, options);
                           },
                       .report = print_done});
}

}  // namespace

Verb add_bake(CLI::App& program) {
    CLI::App* command = program.add_subcommand("bake", help::kBake)->footer(help::kBakeFooter);
    auto arguments = std::make_shared<RunArguments>();
    command->add_option("SHOT.toml", arguments->shot, help::kShot)->required()->type_name("");
    add_run_options(*command, *arguments, help::kTrustTimes);
    add_json(*command);
    return {command, [arguments] { return run(*arguments); }};
}

}  // namespace pelagic::cli
