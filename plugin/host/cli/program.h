// The whole command line: parses it, runs the verb, and turns every error into a message.
#pragma once

namespace pelagic::cli {

// The exit status (exit_status.h). Throws nothing.
int run_program(int argc, const char* const* argv) noexcept;

}  // namespace pelagic::cli
