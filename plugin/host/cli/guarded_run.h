// What verbs do alike around their work: threads, progress, stop signals, and what is said where it fails.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>

#include "plugin/budget/budget.h"
#include "plugin/host/cli/progress.h"
#include "plugin/host/cli/stop.h"
#include "plugin/host/cli/threads.h"
#include "plugin/run/run.h"

namespace pelagic::cli {

// Arguments that the verb's syntax allows and the verb doesn't. run_program() says what is wrong.
struct WrongUsage : std::runtime_error {
    using runtime_error::runtime_error;
};
// What `parse` returns; WrongUsage for its std::invalid_argument.
template <class Parse>
auto asked(const Parse& parse) {
    try {
        return parse();
    } catch (const std::invalid_argument& error) {
        throw WrongUsage(error.what());
    }
}

// What work is done with.
struct Session {
    StopSignals* stop;  // null: signals end the program at once, as they would any other
    Progress& progress;
    Threads& threads;
};

struct Guard {
    std::string shot;     // the file that refusals name; empty: none
    std::string threads;  // the text of --threads
    // What a first signal stops, in words; empty: signals end the program at once, as they would any other.
    std::string stopping{};
    // What is said, after the program's name, of a lack of memory that only the system saw, on so many threads; empty: what
    // run_program() says.
    std::function<std::string(int threads)> out_of_memory{};
    std::function<std::string()> stopped{};  // what is whole, where the work throws BuildCancelled
};

// The exit status: the work's own, or that of what it throws, after a message. Other exceptions pass through.
int guarded_run(const Guard& guard, const std::function<int(Session&)>& work);

// The arguments of verbs that write frames into a folder.
struct RunArguments {
    std::string shot;
    std::optional<std::string> out, frames;
    std::string threads, max_memory, instruction_set;
    std::string chosen;
    bool trust_times = false;
};
void add_run_options(CLI::App& command, RunArguments& arguments, const char* trust_times);
// Throws WrongUsage.
RunOptions run_options(const RunArguments& arguments, const Shot& shot);

// settle_for(), which says what it chose.
Settled settled_for(const RunOptions& options, const Scene& scene, Purpose purpose, Session& session,
                    const FixedSettings& fixed = {});

// What such a verb does, beside that.
struct FrameVerb {
    std::string name;      // as programs read it
    std::string stopping;  // as Guard's
    std::string share_is;  // what a frame's share is of (RunProgress::share), for people
    std::function<std::string(int threads)> out_of_memory;                 // as Guard's
    std::function<RunReport(const RunOptions& options, Session&)> work;    // on the session's threads
    std::function<void(const RunReport&, const std::string& out)> report;  // what was done, in words
};
// guarded_run() of it.
int run_frames(const RunArguments& arguments, RunOptions options, const FrameVerb& verb);

}  // namespace pelagic::cli
