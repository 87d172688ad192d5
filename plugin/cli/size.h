// --size: a picture's width and height.
#pragma once

#include <CLI/CLI.hpp>
#include <glm/vec2.hpp>
#include <string>

namespace pelagic::cli {

// Adds the option, which refuses what is no size. `size` must outlive the parsing; it stays empty where none
// is asked for.
CLI::Option* add_size(CLI::App& command, std::string& size, const char* help);

// As add_size() leaves it; 0 × 0 for an empty one.
glm::ivec2 size_of(const std::string& size);

}  // namespace pelagic::cli
