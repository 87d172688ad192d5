// --size: a picture's width and height.
#pragma once

#include <CLI/CLI.hpp>
#include <glm/vec2.hpp>
#include <string>

namespace pelagic::cli {

// Adds the option, which rejects invalid sizes. `size` must outlive the parsing; it stays empty if the option
// isn't given.
CLI::Option* add_size(CLI::App& command, std::string& size, const char* help);

// Converts the text; an empty one gives 0 × 0.
glm::ivec2 size_of(const std::string& size);

}  // namespace pelagic::cli
