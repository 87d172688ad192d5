// Builds a sea that plays from a scene. See live.h.
#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "core/plan/hulls.h"
#include "core/plan/plan.h"
#include "core/plan/weather.h"
#include "core/scene/budget.h"
#include "core/scene/canonical.h"
#include "core/scene/text.h"
#include "core/spectrum/possible.h"
#include "core/waves/folding.h"
#include "plugin/host/gpu/packed_foam.h"
#include "plugin/host/gpu/sea_layout.h"
#include "plugin/host/preview/drawn_objects.h"
#include "plugin/host/preview/live.h"
#include "plugin/host/preview/sea_textures.h"
#include "plugin/machine/memory.h"
#include "plugin/render/seen_drops.h"

namespace pelagic {
namespace {

// The sea, a frame of it, three packed ones, two on their way to the driver, and the textures, which are the driver's
// in software and a graphics card's otherwise.
MemoryNeed live_memory(const Plan& plan) {
    MemoryNeed need;
    machine::add_program(need);
    machine::add_sky(need);
    add_sea(need, plan, tbb::this_task_arena::max_concurrency());
    if (plan.from->weather) {  // a sea that changes is another in each frame that waits
        Plan one = plan;
        one.from = plan.from->weather->keys.front().sea;
        need.add("the sea at the times of frames on their way", 3 * one.sea_bytes(),
                 "give fewer keys, or smaller cascades");
    }
    std::size_t packed = 0;
    for (const SeaLayout::Plane& plane : SeaLayout::planes_of(plan, 0))
        packed += static_cast<std::size_t>(plane.size.x) * static_cast<std::size_t>(plane.size.y) *
                  static_cast<std::size_t>(plane.channels) * sizeof(float);
    need.add("the frame's grids as textures", 6 * packed,
             "lower the resolutions in waves.cascades, or quality.level");
    if (const std::size_t coast = SeaLayout::coast_sizes_of(plan).bytes(); coast > 0)
        need.add("the coast as textures", 2 * coast, "lower waves.trains");
    if (render_options(plan.from->scene).lighting.spray) add_seen_drops(need, plan);
    if (const Scene& scene = plan.from->scene; !scene.objects.empty())
        need.add("the objects", DrawnObjects::bytes(scene), "give simpler meshes");
    // A history, three packed ones and the driver's.
    if (plan.foam)
        need.add("the foam as textures", 4 * PackedFoam::bytes_for(*plan.foam, plan.foam_history_bytes()),
                 "lower effects.foam_decay_s");
    return need;
}

bool fits(const Plan& plan, const LiveLimits& limits) {
    for (const SeaLayout::Plane& plane : SeaLayout::planes_of(plan, 0))
        if (std::max(plane.size.x, plane.size.y) > limits.texture) return false;
    return live_memory(plan).bytes() <= limits.memory.bytes;
}

}  // namespace

std::shared_ptr<const LiveBuild> build_live(const Scene& scene, const LiveLimits& limits,
                                            const BuildWatch& watch) {
    std::string problems;
    for (const Problem& problem : problems_of(scene))
        problems += (problems.empty() ? "" : "\n") + text_of(problem);
    if (!problems.empty()) throw std::invalid_argument(problems);
    const auto start = std::chrono::steady_clock::now();
    const auto prepared = prepare(without_budget(scene));  // a budget is of meshes and of rendered pictures
    LiveBuild made;
    made.scene = scene;
    const auto plan_from = [&](double finest_m) {
        const Query query = view_query(*prepared, {.finest_cell_m = finest_m, .finest_pixel_m = finest_m});
        std::vector<Query> queries{query};
        if (auto hulls = hulls_query_of_picture(prepared->scene)) queries.push_back(std::move(*hulls));
        return make_plan(prepared, queries, {.double_precision = false});
    };
    for (const std::string& warning : sea_warnings(*prepared))
        made.note += (made.note.empty() ? "" : "\n") + warning;
    Plan plan = plan_from(0.0);
    if (const SeaLayout::CoastSizes coast = SeaLayout::coast_sizes_of(plan); coast.side() > limits.texture)
        throw std::invalid_argument(too_large_coast(coast, limits.texture));
    const Plan whole = plan;
    std::string left_out;
    // Level by level of the pixels' footprints, of which the first lets everything pass.
    for (const double level_m : whole.queries.front().query.pixel_m) {
        if (fits(plan, limits)) break;
        if (level_m == 0.0) continue;
        plan = plan_from(level_m);
        const std::size_t needed = live_memory(whole).bytes();
        left_out =
            (needed > limits.memory.bytes ? "the sea needs about " + bytes_text(needed) + ", and " +
                                                limits.memory.whose + " " + bytes_text(limits.memory.bytes)
                                          : "the sea's grids need larger textures than the driver's, " +
                                                std::to_string(limits.texture) + " a side") +
            "; waves below " + number_text(plan.filter.n_min * level_m) +
            " m are left out of the picture. To see them, lower the resolutions in waves.cascades, or "
            "quality.level";
    }
    if (!left_out.empty()) made.note = left_out + (made.note.empty() ? "" : "\n") + made.note;
    if (!fits(plan, limits)) require_memory(live_memory(plan), limits.memory, "this sea");
    made.sea = std::make_shared<const SeaOverTime<float>>(std::move(plan), watch);
    made.drawn = std::make_shared<const DrawnSea>(*prepared, false);
    made.build_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return std::make_shared<const LiveBuild>(std::move(made));
}

bool same_sea(const Scene& a, const Scene& b) {
    const KeyPartSet sea = key_parts(KeyPart::Waves, KeyPart::Clock, KeyPart::Foam, KeyPart::Gusts,
                                     KeyPart::Quality, KeyPart::Spray);
    return canonical(a, sea) == canonical(b, sea) && has_bubbles(a) == has_bubbles(b);
}

}  // namespace pelagic
