// --max-memory: how much memory a verb may take, and what is said where that is too little.
#pragma once

#include <CLI/CLI.hpp>
#include <cstddef>
#include <string>

#include "core/plan/memory.h"

namespace pelagic::cli {

// Adds the option, which rejects what is no size. `memory` must outlive the parsing; it stays empty if the option
// isn't given.
CLI::Option* add_max_memory(CLI::App& command, std::string& memory, const char* help);

// Converts the text, "8G" or "512MiB"; an empty one gives 0.
std::size_t memory_of(const std::string& memory);

// Says why the shot is refused; returns the exit status.
int refuse_memory(const std::string& shot, const NotEnoughMemory& error);

}  // namespace pelagic::cli
