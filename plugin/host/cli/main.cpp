// The program "pelagic".
#include <unistd.h>

#include <cstdlib>

#include "plugin/host/cli/exit_status.h"
#include "plugin/host/cli/program.h"
#include "plugin/machine/memory.h"

int main(int argc, char** argv) {
    pelagic::machine::settle_threads();
    int status = pelagic::cli::kTryAgain;
    if (pelagic::machine::run_on_large_stack([&] { status = pelagic::cli::run_program(argc, argv); }))
        return status;
    constexpr char kNoStack[] =
        "pelagic: there is no stack to work on; raise the limit on stacks or memory (ulimit -s, ulimit -v)\n";
    [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, kNoStack, sizeof kNoStack - 1);
    return status;
}
