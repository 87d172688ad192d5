// pelagic calibrate
#include <cstdio>
#include <iostream>
#include <memory>
#include <string>

#include "core/base/text.h"
#include "plugin/budget/calibration.h"
#include "plugin/host/cli/exit_status.h"
#include "plugin/host/cli/guarded_run.h"
#include "plugin/host/cli/help.h"
#include "plugin/host/cli/text.h"
#include "plugin/host/cli/verb.h"

namespace pelagic::cli {
namespace {

void print(const Calibration& measured) {
    std::cout << count_text(measured.threads, "thread", "threads") << " of " << line_text(measured.cpu)
              << ", " << measured.instruction_set
              << ". Times over the recorded ones, of two cores with AVX-512:\n";
    for (std::size_t g = 0; g < kWorkGroups.size(); ++g)
        std::printf("  %-11s %5.2f  %s\n", kWorkGroups[g].name, measured.times[g], kWorkGroups[g].of);
    std::fflush(stdout);
}

int run(const std::string& threads) {
    // Nothing is half written: signals end it at once.
    return guarded_run({.shot = {}, .threads = threads}, [](Session& session) {
        const Calibration measured = session.threads.execute([&] {
            return measure_machine(
                {.progress = [&](double done) { session.progress.show_measuring(done); }, .cancel = nullptr});
        });
        session.progress.clear();
        print(measured);
        const std::string file = keep(measured, cache_folder()).string();
        if (file.empty())
            std::cerr
                << "pelagic: note: there is no cache folder that can be written ($XDG_CACHE_HOME, ~/.cache): each "
                   "run with quality.frame_ms will measure this machine again\n";
        else
            std::cout << "kept in " << line_text(file) << std::endl;
        return int{kDone};
    });
}

}  // namespace

Verb add_calibrate(CLI::App& program) {
    CLI::App* command = program.add_subcommand("calibrate", help::kCalibrate)->footer(help::kCalibrateFooter);
    auto threads = std::make_shared<std::string>();
    add_threads(*command, *threads, help::kThreads);
    return {command, [threads] { return run(*threads); }};
}

}  // namespace pelagic::cli
