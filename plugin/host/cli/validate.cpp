// pelagic validate SHOT.toml …
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <iostream>
#include <string>
#include <vector>

#include "core/plan/plan.h"
#include "core/scene/names.h"
#include "core/scene/text.h"
#include "plugin/bake/bake.h"
#include "plugin/budget/budget.h"
#include "plugin/format/shot/shot.h"
#include "plugin/host/cli/exit_status.h"
#include "plugin/host/cli/help.h"
#include "plugin/host/cli/json_output.h"
#include "plugin/host/cli/text.h"
#include "plugin/host/cli/verb.h"
#include "plugin/host/cli/warnings.h"
#include "plugin/light/light.h"

namespace pelagic::cli {
namespace {

// "48 frames at 24 frames/s, a patch of 256 × 256 quads over 200 m, jonswap at 10 m/s: 12 transforms a frame, 34 MiB"
std::string summary(const Scene& scene, const Plan& plan) {
    const Shot& shot = scene.shot;
    std::string text = count_text(long{shot.last_frame} - shot.first_frame + 1, "frame", "frames") + " at " +
                       number_text(shot.fps) + " frames/s";
    if (scene.output.mesh != MeshFormat::None) text += ", " + plan.surface->describe();
    if (!scene.output.maps.empty())
        text += ", " + count_text(static_cast<long>(scene.output.maps.size()), "map", "maps");
    text += ", ";
    if (scene.sea.measured) {
        text += "buoy " + scene.sea.measured->station + " of " + scene.sea.measured->time;
    } else {
        text += std::string(word_of(scene.sea.spectrum)) + " at ";
        // The member has the largest.
        for (const KeyedNumber& number : scene.keyed)
            if (number.path == "sea.wind_speed_mps")
                text += number_text(std::ranges::min(number.keys.keys, {}, &NumberKeys::Key::value).value) +
                        " … ";
        text += number_text(scene.sea.wind_speed_mps) + " m/s";
    }
    text += ": ";
    if (plan.trains && plan.trains->count > 0)
        text += count_text(plan.trains->count, "wave train, ", "wave trains, ");
    return text + count_text(plan.transforms_per_frame(), "transform", "transforms") + " a frame, " +
           bytes_text(bake_memory(plan, kFramesInFlight, tbb::this_task_arena::max_concurrency()).bytes());
}

}  // namespace

Verb add_validate(CLI::App& program) {
    CLI::App* command = program.add_subcommand("validate", help::kValidate)->footer(help::kValidateFooter);
    auto files = std::make_shared<std::vector<std::string>>();
    command->add_option("SHOT.toml", *files, help::kShots)->required()->type_name("");
    add_json(*command);
    return {
        command, [files] {
            int status = kDone;
            for (const std::string& file : *files) {
                try {
                    const Scene scene = load_shot(file, check_scene);
                    const Settled settled = settle(scene, Purpose::Mesh, with_rates(recorded_rates()));
                    if (!settled.holds) throw ShotError(placed(file, settled.text + "; raise the budget"));
                    const Plan plan = plan_bake(settled.scene);
                    std::cout << line_text(file) << ": fine\n    " << summary(scene, plan) << std::endl;
                    tell_json({{"event", "result"}, {"verb", "validate"}, {"shot", file}, {"valid", true}});
                    print_warnings(file, scene);
                } catch (const ShotError& error) {
                    std::cerr << error.what() << std::endl;
                    tell_json({{"event", "result"}, {"verb", "validate"}, {"shot", file}, {"valid", false}});
                    status = kWrongUsage;
                }
            }
            return status;
        }};
}

}  // namespace pelagic::cli
