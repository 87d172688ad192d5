// The command line as a whole. See program.h.
#include "plugin/cli/program.h"

#include <algorithm>
#include <iostream>
#include <memory>
#include <new>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "core/scene/names.h"
#include "plugin/cli/exit_status.h"
#include "plugin/cli/help.h"
#include "plugin/cli/verb.h"
#include "plugin/files/files.h"
#include "plugin/shot/shot.h"

namespace pelagic::cli {
namespace {

std::string listed(const std::vector<std::string>& words) {
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
    return text;
}

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

int usage_error(const std::string& problem, const std::string& command) {
    std::cerr << "pelagic: " << problem << "\nSee: " << command << " --help\n";
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
    formatter->column_width(20);
    program.formatter(formatter);  // inherited by the verbs
    const std::vector<Verb> verbs{add_bake(program),    add_render(program), add_preview(program),
                                  add_explain(program), add_verify(program), add_validate(program),
                                  add_keys(program)};

    if (argc < 2) return usage_error("a verb is missing", "pelagic");
    if (const std::string problem = refuse_verb(argc, argv, verbs); !problem.empty())
        return usage_error(problem, "pelagic");
    try {
        program.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return report(error, program, verbs);
    }
    for (const Verb& verb : verbs) {
        if (!verb.command->parsed()) continue;
        const int status = verb.run();
        if (std::cout.flush()) return status;
        std::cerr << "pelagic: standard output can't be written to: is its disk full?\n";
        return std::max(status, kRefused);
    }
    return kWrongUsage;
}

int failed(std::string_view message) {
    std::cerr << message << '\n';
    return kRefused;
}

}  // namespace

int run_program(int argc, const char* const* argv) noexcept {
    try {
        return run(argc, argv);
    } catch (const ShotError& error) {
        return failed(error.what());  // each line begins with the file, as compilers' messages do
    } catch (const std::bad_alloc&) {
        return failed(
            "pelagic: out of memory; lower the resolution (pelagic explain shows what takes how much)");
    } catch (const std::exception& error) {
        return failed(std::string("pelagic: ") + error.what());
    } catch (...) {
        return failed("pelagic: an error without a message; this is a bug in the program, please report it");
    }
}

}  // namespace pelagic::cli
