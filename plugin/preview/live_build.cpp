// Builds a sea that plays from a scene. See live.h.
#include <chrono>
#include <stdexcept>

#include "core/plan/plan.h"
#include "core/scene/canonical.h"
#include "core/scene/validate.h"
#include "plugin/preview/live.h"

namespace pelagic {
std::shared_ptr<const LiveBuild> build_live(const Scene& scene) {
    std::string problems;
    for (const Problem& problem : validate(scene))
        problems += (problems.empty() ? "" : "\n") + text_of(problem);
    if (!problems.empty()) throw std::invalid_argument(problems);
    const auto start = std::chrono::steady_clock::now();
    const auto prepared = prepare(scene);
    LiveBuild made;
    made.scene = scene;
    made.sea = std::make_shared<const Sea<float>>(
        make_plan(prepared, {view_query(*prepared)}, {.double_precision = false}));
    made.grid = projected_grid_options(*prepared);
    made.build_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return std::make_shared<const LiveBuild>(std::move(made));
}

bool same_sea(const Scene& a, const Scene& b) {
    const FeedSet sea = feeds(Feed::Waves, Feed::Clock, Feed::Foam, Feed::Quality);
    return canonical(a, sea) == canonical(b, sea);
}

}  // namespace pelagic
