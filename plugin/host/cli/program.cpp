// The command line as a whole. See program.h.
#include "plugin/host/cli/program.h"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <exception>
#include <iostream>
#include <memory>
#include <new>
#include <sstream>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "core/scene/names.h"
#include "core/scene/text.h"
#include "plugin/files/files.h"
#include "plugin/format/shot/shot.h"
#include "plugin/host/cli/exit_status.h"
#include "plugin/host/cli/guarded_run.h"
#include "plugin/host/cli/help.h"
#include "plugin/host/cli/instruction_set.h"
#include "plugin/host/cli/json_output.h"
#include "plugin/host/cli/text.h"
#include "plugin/host/cli/verb.h"

namespace pelagic::cli {
namespace {

// "; did you mean --frames?", or "".
std::string suggestion(std::string_view word, const std::vector<std::string>& candidates) {
    const std::string near = nearest(word, candidates);
    return near.empty() ? std::string() : "; did you mean " + near + '?';
}

// The options of a command: "--out", …
std::vector<std::string> options_of(const CLI::App& command) {
    std::vector<std::string> names;
    for (const CLI::Option* option : command.get_options()) {
        for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    }
    return names;
}

// What is wrong if the first argument should be a verb and isn't one; otherwise empty.
std::string refuse_verb(int argc, const char* const* argv, const std::vector<Verb>& verbs) {
    if (argc < 2 || argv[1][0] == '-') return {};
    std::vector<std::string> names;
    for (const Verb& verb : verbs) names.push_back(verb.command->get_name());
    if (std::find(names.begin(), names.end(), argv[1]) != names.end()) return {};
    std::string problem = "'";
    problem += argv[1];
    return problem + "' is not a verb" + suggestion(argv[1], names) + " (verbs: " + listed(names) + ')';
}

// The error for arguments that CLI11 couldn't place: an unknown option, with the nearest known one, or an
// extra argument.
std::string refuse_extras(const std::vector<std::string>& extras, const CLI::App& command) {
    const auto option = std::find_if(extras.begin(), extras.end(),
                                     [](const std::string& extra) { return extra.starts_with('-'); });
    std::string problem = "'";
    if (option == extras.end()) return problem + extras.front() + "' is one argument too many";
    return problem + *option + "' is not an option" +
           suggestion(option->substr(0, option->find('=')), options_of(command));
}

constexpr std::size_t kMostOfProblem = 1000;  // [bytes]

int usage_error(const std::string& problem, const std::string& command) {
    // Arguments are in it, whatever they are.
    std::cerr << "pelagic: " << line_text(shortened(problem, kMostOfProblem)) << "\nSee: " << command
              << " --help\n";
    return kWrongUsage;
}

int report(const CLI::ParseError& error, CLI::App& program, const std::vector<Verb>& verbs) {
    if (error.get_exit_code() == 0) return program.exit(error);  // --help, --version
    const auto parsed =
        std::find_if(verbs.begin(), verbs.end(), [](const Verb& verb) { return verb.command->parsed(); });
    CLI::App& command = parsed == verbs.end() ? program : *parsed->command;
    const std::string name = parsed == verbs.end() ? "pelagic" : "pelagic " + command.get_name();
    const std::vector<std::string> extras = program.remaining(true);
    if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr ||
        (parsed == verbs.end() && !extras.empty()))
        return usage_error(refuse_extras(extras, command), name);
    return usage_error(parsed == verbs.end() ? "a verb is missing" : error.what(), name);
}

// Lists each verb with the first line of its description.
class Formatter : public CLI::Formatter {
  public:
    std::string make_subcommand(const CLI::App* verb) const override {
        const std::string description = verb->get_description();
        std::ostringstream out;
        CLI::detail::format_help(out, verb->get_name(), description.substr(0, description.find('\n')),
                                 column_width_);
        return out.str();
    }
};

int run(int argc, const char* const* argv) {
    CLI::App program(help::kProgram, "pelagic");
    program.set_help_flag("-h,--help", help::kHelp);  // inherited by the verbs
    program.set_version_flag("--version", help::version_text(), help::kVersion);
    program.footer(help::kProgramFooter);
    program.require_subcommand(1);
    const auto formatter = std::make_shared<Formatter>();
    formatter->label("SUBCOMMAND", "VERB");
    formatter->column_width(22);
    program.formatter(formatter);  // inherited by the verbs
    const std::vector<Verb> verbs{add_bake(program),    add_render(program),   add_preview(program),
                                  add_explain(program), add_accuracy(program), add_verify(program),
                                  add_farm(program),    add_validate(program), add_keys(program),
                                  add_presets(program), add_calibrate(program)};

    if (argc < 2) return usage_error("a verb is missing", "pelagic");
    for (const Verb& verb : verbs) verb.command->group(help::kVerbs);
    if (const std::string problem = refuse_verb(argc, argv, verbs); !problem.empty())
        return usage_error(problem, "pelagic");
    try {
        program.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return report(error, program, verbs);
    }
    for (const Verb& verb : verbs) {
        if (!verb.command->parsed()) continue;
        try {
            return verb.run();
        } catch (const WrongUsage& error) {
            return usage_error(error.what(), "pelagic " + verb.command->get_name());
        }
    }
    return kWrongUsage;
}

int failed(std::string_view message, int status) {
    std::cerr << message << '\n';
    return status;
}

// A closed standard stream's number must not become an output file's, which messages would then be written into.
// Opened the wrong way round, so that using it is an error, as if it were closed.
void hold_standard_streams() {
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
        if (fcntl(stream, F_GETFD) < 0 && errno == EBADF)
            // The lowest free number is this one: those below are open by now.
            if (open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY) < 0) return;
}

// The system refuses a thread, wherever it is asked for: also in the libraries' own threads, from which no
// exception comes back.
constexpr const char* kNoThread =
    "pelagic: the system refuses another thread; ask for fewer with --threads, or raise the limit on processes or "
    "memory (ulimit -u, ulimit -v); files already written are whole";

[[noreturn]] void end_at_once() {
    static std::atomic_flag is_ending;  // several threads may come here
    while (is_ending.test_and_set()) pause();
    const char* message =
        "pelagic: an error that nothing handles; this is a bug in the program, please report it";
    int status = kUnknown;
    try {
        if (const std::exception_ptr error = std::current_exception()) std::rethrow_exception(error);
    } catch (const std::bad_alloc&) {
        message = "pelagic: out of memory; files already written are whole";
        status = kTryAgain;
    } catch (const std::exception& error) {
        status = status_of(error);
        if (is_about_threads(error)) message = kNoThread;
    } catch (...) {
    }
    for (const char* part : {message, "\n"})
        if (write(STDERR_FILENO, part, std::strlen(part)) < 0) break;
    _exit(status);
}

// Whether whoever reads our output has gone, as head does when it has enough.
bool is_reader_gone() {
    pollfd output{.fd = STDOUT_FILENO, .events = POLLOUT, .revents = 0};
    return poll(&output, 1, 0) == 1 && (output.revents & POLLERR) != 0;
}

// What was printed must have arrived.
int flushed(int status) {
    if (std::cout.flush()) return status;
    if (is_reader_gone()) raise(SIGPIPE);  // ends the program without a word, as it ends other tools
    std::cerr << "pelagic: standard output can't be written to: is it closed, or its disk full?\n";
    return status == kDone ? kTryAgain : status;
}

// run(), and what it throws, as messages.
int said_run(int argc, const char* const* argv) {
    try {
        restart_for_instruction_set(argc, argv);
        return run(argc, argv);
    } catch (const ShotError& error) {
        return failed(error.what(),
                      status_of(error));  // each line begins with the file, as compilers' messages do
    } catch (const std::bad_alloc&) {
        return failed(
            "pelagic: out of memory; lower the resolution (pelagic explain shows what takes how much)",
            kTryAgain);
    } catch (const std::exception& error) {
        return failed(is_about_threads(error) ? kNoThread : std::string("pelagic: ") + error.what(),
                      status_of(error));
    } catch (...) {
        return failed("pelagic: an error without a message; this is a bug in the program, please report it",
                      kUnknown);
    }
}

}  // namespace

int run_program(int argc, const char* const* argv) noexcept {
    try {
        hold_standard_streams();
        std::set_terminate(end_at_once);
        // A file beyond the limit (ulimit -f) is an error with a message, also where it is a log.
        std::signal(SIGXFSZ, SIG_IGN);
        if (!asks_for_json(argc, argv)) return flushed(said_run(argc, argv));
        int status = kUnknown;
        {
            JsonOutput json;
            status = said_run(argc, argv);
            json.end(status);
        }
        return flushed(status);
    } catch (...) {
        return kUnknown;
    }
}

}  // namespace pelagic::cli
