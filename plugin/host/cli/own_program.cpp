#include "plugin/host/cli/own_program.h"

#include <errno.h>

#include <string_view>

namespace pelagic::cli {

std::filesystem::path own_program() {
    const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe");
    // The system calls a loader that was started by its name the program; our name is then what starts it, by its whole path.
    if (std::string_view(self.filename().c_str()).starts_with("ld-linux")) return program_invocation_name;
    return self;
}

}  // namespace pelagic::cli
