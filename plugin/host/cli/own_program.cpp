#include "plugin/host/cli/own_program.h"

#include <errno.h>

#include <string_view>
#include <system_error>

namespace pelagic::cli {
namespace {

// The system calls a loader that was started by its name the program; our name is then what starts it.
bool is_loader(const std::filesystem::path& program) {
    return std::string_view(program.filename().c_str()).starts_with("ld-");
}

}  // namespace

std::filesystem::path own_program() {
    const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe");
    return is_loader(self) ? std::filesystem::absolute(program_invocation_name) : self;
}

std::filesystem::path own_program_to_restart() {
    const std::filesystem::path self = "/proc/self/exe";
    std::error_code ignored;
    return is_loader(std::filesystem::read_symlink(self, ignored)) ? own_program() : self;
}

}  // namespace pelagic::cli
