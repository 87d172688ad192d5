#include "plugin/host/cli/instruction_set.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <string_view>
#include <system_error>

#include "core/base/instruction_set.h"
#include "core/scene/text.h"
#include "plugin/host/cli/guarded_run.h"
#include "plugin/host/cli/own_program.h"
#include "plugin/host/cli/text.h"

namespace pelagic::cli {
namespace {

constexpr std::string_view kOption = "--instruction-set";

// A farm's tasks may run on other CPUs than the one that writes their script.
const std::vector<std::string>& known_sets() {
#if defined(__x86_64__)
    static const std::vector<std::string> sets{"sse4", "avx2", "avx512"};
#else
    static const std::vector<std::string> sets = instruction_sets();
#endif
    return sets;
}

std::string refuse_set(const std::string& text) {
    if (std::find(known_sets().begin(), known_sets().end(), text) != known_sets().end()) return {};
    return text + " is no instruction set; accepted: " + listed(known_sets()) +
           ", or no --instruction-set for the widest that this CPU has";
}

std::string_view asked_set(int argc, const char* const* argv) {
    for (int i = 1; i < argc; ++i) {
        const std::string_view argument = argv[i];
        if (argument == kOption && i + 1 < argc) return argv[i + 1];
        if (argument.starts_with(kOption) && argument.substr(kOption.size()).starts_with('='))
            return argument.substr(kOption.size() + 1);
    }
    return {};
}

}  // namespace

void add_instruction_set(CLI::App& command, std::string& set, const char* help) {
    command.add_option(std::string(kOption), set, help)
        ->type_name("SET")
        ->check(CLI::Validator(refuse_set, ""));
}

void apply_instruction_set(const std::string& set) {
    if (set.empty()) return;
    asked([&] {
        use_instruction_set(set);
        return set;
    });
}

void restart_for_instruction_set([[maybe_unused]] int argc, [[maybe_unused]] const char* const* argv) {
#if defined(__x86_64__) && defined(__GLIBC__)
    const bool makes_files =
        argc > 1 && (argv[1] == std::string_view("bake") || argv[1] == std::string_view("render"));
    if (!makes_files || asked_set(argc, argv) != "sse4" ||
        !(__builtin_cpu_supports("fma") || __builtin_cpu_supports("fma4")))
        return;
    // What glibc's mathematics ask the CPU for, each taken away.
    constexpr std::string_view kWithout = "glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4";
    const char* const before = std::getenv("GLIBC_TUNABLES");
    std::string tunables = before ? before : "";
    if (tunables.ends_with(kWithout)) return;
    if (!tunables.empty()) tunables += ':';
    tunables += kWithout;
    const std::string program = own_program_to_restart().string();
    if (setenv("GLIBC_TUNABLES", tunables.c_str(), 1) == 0)
        execv(program.c_str(), const_cast<char* const*>(argv));
    throw WrongUsage("--instruction-set sse4: the program can't be started anew (" + program + ": " +
                     std::generic_category().message(errno) + ")");
#endif
}

}  // namespace pelagic::cli
