// pelagic preview SHOT.toml, in a program that was built without the preview.
#include <iostream>

#include "plugin/host/cli/exit_status.h"
#include "plugin/host/cli/help.h"
#include "plugin/host/cli/verb.h"

namespace pelagic::cli {

Verb add_preview(CLI::App& program) {
    CLI::App* command = program.add_subcommand("preview", help::kNoPreview);
    command->allow_extras();  // whatever it is asked for, the answer is the same
    return {command, [] {
                std::cerr << "pelagic: " << help::kNoPreview << '\n';
                return kWrongUsage;
            }};
}

}  // namespace pelagic::cli
