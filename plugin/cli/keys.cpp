// pelagic keys
#include <iostream>

#include "plugin/cli/exit_status.h"
#include "plugin/cli/help.h"
#include "plugin/cli/verb.h"
#include "plugin/shot/shot.h"

namespace pelagic::cli {

Verb add_keys(CLI::App& program) {
    CLI::App* command = program.add_subcommand("keys", help::kKeys);
    command->group(help::kVerbs);
    command->footer(help::kKeysFooter);
    return {command, [] {
                std::cout << describe_keys() << std::flush;
                return kDone;
            }};
}

}  // namespace pelagic::cli
