// Formats numbers for messages.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace pelagic::cli {

std::string duration_text(double seconds);  // "3.2 s", "4 min 05 s", "2 h 07 min"
std::string bytes_text(std::size_t bytes);  // "34 MiB", "1.2 GiB"
std::string count_text(long count, const char* singular, const char* plural);  // "1 frame", "3 frames"
std::string listed(const std::vector<std::string>& words);                     // "draft, final"

}  // namespace pelagic::cli
