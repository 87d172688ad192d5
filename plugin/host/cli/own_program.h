// How this program is started again.
#pragma once

#include <filesystem>

namespace pelagic::cli {

// Its file; in the tarball, where a loader of its own runs it (packages/tarball.py), what starts that. Throws
// std::filesystem::filesystem_error where /proc isn't there.
std::filesystem::path own_program();

}  // namespace pelagic::cli
