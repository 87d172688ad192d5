#include "plugin/bake/bake.h"

#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

#include "core/scene/keys.h"
#include "core/spectrum/possible.h"
#include "plugin/bake/output_part.h"
#include "plugin/bake/sequence.h"
#include "plugin/bake/stage.h"
#include "plugin/format/usd/layers.h"
#include "plugin/format/vdb/vdb.h"
#include "plugin/light/light.h"
#include "plugin/machine/memory.h"
#include "plugin/run/record.h"
#include "plugin/run/work.h"

namespace pelagic {
namespace {

void refuse_invalid(const Scene& scene) {
    std::vector<Problem> all = problems_of(scene);
    if (all.empty()) all = unbaked_keys(scene);
    std::string problems;
    for (const Problem& problem : all) problems += (problems.empty() ? "" : "\n") + text_of(problem);
    if (!problems.empty()) throw std::invalid_argument(problems);
}

// The stage's sky must not replace the picture that it is made of.
void refuse_own_sky(const Scene& scene, const std::filesystem::path& out) {
    if (scene.output.mesh == MeshFormat::None || !has_sky_picture(scene)) return;
    const std::filesystem::path ours = out / usd::sky_file(scene.shot.name);
    std::error_code error;
    const std::filesystem::path picture = scene.light.sky;
    const std::string name = picture.filename().string();
    const bool is_of_a_frame =
        name.starts_with(scene.shot.name + ".sky.") && name.ends_with(".exr") &&
        std::filesystem::equivalent(out, picture.has_parent_path() ? picture.parent_path() : ".", error);
    if (is_of_a_frame || std::filesystem::equivalent(ours, picture, error))
        throw std::invalid_argument(
            "light.sky = \"" + scene.light.sky +
            "\" is the file that this bake writes its stage's sky to: give the picture "
            "another name, or bake into another folder");
}

Plan planned(const Scene& scene, std::span<const int> frames, const RunOptions& options) {
    Plan plan = plan_bake(prepare(scene), frames);
    if (plan.outputs.empty())
        throw std::invalid_argument(
            "the shot asks for no output: accepted: output.mesh, output.maps, output.volumes, output.drops");
    if (!scene.output.volumes.empty())
        vdb::load();  // before anything is known to be enough, since it takes its part
    require_memory(bake_memory(plan, frames.size(), tbb::this_task_arena::max_concurrency()),
                   machine::memory_limit_or(options.max_memory_bytes), "this bake");
    if (scene.output.mesh != MeshFormat::None) prepare_light(scene, options.out);
    return plan;
}

}  // namespace

// The stage has one material, the record one foam and a map of the floor one light for all frames.
std::vector<Problem> unbaked_keys(const Scene& scene) {
    const auto asks = [&](MapKind map) {
        return std::ranges::find(scene.output.maps, map) != scene.output.maps.end();
    };
    std::vector<Problem> problems;
    for (const KeyedNumber& number : scene.keyed) {
        const Key& key = key_of(number.path);
        const bool is_foam = number.path.starts_with("effects.foam_"),
                   is_camera = number.path.starts_with("camera.");
        const bool is_plankton = number.path == "water.chlorophyll_mg_m3";
        const char* what =
            is_foam || (is_plankton && scene.output.mesh != MeshFormat::None)
                ? "changes over the shot, and what a bake says of water and foam is one for all frames"
            : !is_camera && asks(MapKind::Floor)
                ? "changes over the shot, and a map of the floor has one light for all frames"
                : nullptr;
        if (what)
            problems.push_back({number.path, value_text(key, number.keys), what,
                                "a number in bakes; pelagic render shows it with keys"});
    }
    return problems;
}

void check_bake(const Scene& scene, const std::filesystem::path& out) {
    refuse_invalid(scene);
    refuse_own_sky(scene, out);
}

std::vector<std::string> frames_made_of(const Plan& plan, std::span<const int> frames) {
    const std::vector<std::unique_ptr<OutputPart>> parts = make_parts(plan);
    std::vector<std::string> all;
    for (const int frame : frames) {
        std::map<std::string, FileRecord> files;
        for (const auto& part : parts) files[part->file(frame)].fingerprint = part->fingerprint(frame);
        all.push_back(made_of(files));
    }
    return all;
}

RunReport bake(const Scene& scene, const RunOptions& options) {
    check_bake(scene, options.out);
    std::optional<Plan> plan;
    std::vector<std::unique_ptr<OutputPart>> outputs;
    RunReport report =
        run({.shot = scene.shot,
             .has_record = true,
             .in_flight = kFramesInFlight,
             .plan =
                 [&](std::span<const int> frames) {
                     plan = planned(scene, frames, options);
                     outputs = make_parts(*plan);
                     std::vector<RunPart> parts;
                     for (const auto& output : outputs)
                         parts.push_back({output->pattern(),
                                          [&part = *output](int frame) { return part.fingerprint(frame); }});
                     prepare_folders(options.out, parts);  // before hours are spent
                     return parts;
                 },
             .build = [&](std::span<const int>,
                          const auto& watch) { return make_sequence(*plan, watch(RunStage::Building)); }},
            options);
    if (scene.output.mesh != MeshFormat::None) report.root = options.out / (scene.shot.name + ".usda");
    if (!scene.output.maps.empty()) report.maps = options.out / "maps";
    if (!scene.output.volumes.empty()) report.volumes = options.out / "volumes";
    return report;
}

}  // namespace pelagic
