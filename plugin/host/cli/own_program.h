// How this program is started again.
#pragma once

#include <filesystem>

namespace pelagic::cli {

// Its file, by its whole path; in the tarball, where a loader of its own runs it (packages/tarball.py), what starts that. Throws
// std::filesystem::filesystem_error where /proc isn't there.
std::filesystem::path own_program();

// For this process to become it anew: /proc/self/exe, which is the same program even where its file was replaced since; where a
// loader runs it, own_program().
std::filesystem::path own_program_to_restart();

}  // namespace pelagic::cli
