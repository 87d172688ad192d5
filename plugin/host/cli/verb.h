// The verbs of the command line, one file each. add_…() declares a verb's arguments to CLI11. run() does the
// work after parsing: it prints results on stdout and messages on stderr, and returns the exit status.
// run_program() reports its exceptions.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace pelagic::cli {

struct Verb {
    CLI::App* command = nullptr;  // owned by the program's App
    std::function<int()> run;
};

// The program's App must outlive the verbs.
Verb add_bake(CLI::App& program);
Verb add_render(CLI::App& program);
Verb add_preview(CLI::App& program);
Verb add_explain(CLI::App& program);
Verb add_verify(CLI::App& program);
Verb add_validate(CLI::App& program);
Verb add_keys(CLI::App& program);
Verb add_presets(CLI::App& program);
Verb add_accuracy(CLI::App& program);
Verb add_calibrate(CLI::App& program);
Verb add_farm(CLI::App& program);

}  // namespace pelagic::cli
