// pelagic explain SHOT.toml
#include <iostream>

#include "core/plan/plan.h"
#include "plugin/cli/exit_status.h"
#include "plugin/cli/help.h"
#include "plugin/cli/verb.h"
#include "plugin/shot/shot.h"

namespace pelagic::cli {

Verb add_explain(CLI::App& program) {
    CLI::App* command = program.add_subcommand("explain", help::kExplain);
    command->group(help::kVerbs);
    command->footer(help::kExplainFooter);
    auto file = std::make_shared<std::string>();
    command->add_option("SHOT.toml", *file, help::kShot)->required()->type_name("");
    return {command, [file] {
                const Scene scene = load_shot(*file);
                std::cout << explain(scene, make_plan(scene)) << std::flush;
                return kDone;
            }};
}

}  // namespace pelagic::cli
