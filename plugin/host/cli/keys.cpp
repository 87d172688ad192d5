// pelagic keys
#include <iostream>

#include "plugin/format/shot/shot.h"
#include "plugin/host/cli/exit_status.h"
#include "plugin/host/cli/help.h"
#include "plugin/host/cli/verb.h"

namespace pelagic::cli {

Verb add_keys(CLI::App& program) {
    CLI::App* command = program.add_subcommand("keys", help::kKeys)->footer(help::kKeysFooter);
    return {command, [] {
                std::cout << describe_keys() << std::flush;
                return kDone;
            }};
}

}  // namespace pelagic::cli
