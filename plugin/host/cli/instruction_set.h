// --instruction-set: machines of a farm that differ, and files that don't.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace pelagic::cli {

// Adds the option, which rejects what is no set. `set` must outlive the parsing; it stays empty for the widest that the CPU has.
void add_instruction_set(CLI::App& command, std::string& set, const char* help);

// Uses the set, if one is given. Before anything is computed. Throws WrongUsage where this CPU lacks it.
void apply_instruction_set(const std::string& set);

// Starts the program anew where the arguments ask for a set below AVX2 and the C library has fused products in its mathematics, which it
// chooses when a process starts; of verbs that make files. Throws WrongUsage where that can't be done.
void restart_for_instruction_set(int argc, const char* const* argv);

}  // namespace pelagic::cli
