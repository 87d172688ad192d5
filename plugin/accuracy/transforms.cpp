// Sweep of how the transforms' plans are found.
#include <algorithm>
#include <chrono>
#include <memory>
#include <set>
#include <string>
#include <utility>

#include "core/waves/planning.h"
#include "core/waves/transform.h"
#include "plugin/accuracy/rows.h"
#include "plugin/accuracy/sea_answers.h"

namespace pelagic::rows {
namespace {

// The transforms of the plan's grids are planned; what that takes [s].
double planning_s(const Plan& plan) {
    using Clock = std::chrono::steady_clock;
    std::set<int> lengths;
    for (const CascadePlan& cascade : plan.cascades)
        for (const Grid& grid : cascade.grids) lengths.insert(grid.resolution);
    const auto start = Clock::now();
    for (const int n : lengths) LineTransform<float> planned(n);
    return std::chrono::duration<double>(Clock::now() - start).count();
}

}  // namespace

Trials planning_modes(const Scene& shot) {
    const ProductSet shape = products(Product::Position, Product::Normal);
    const SweepPoints at = sweep_points(shot);
    Query query;
    query.name = "sweep";
    query.products = shape;
    query.points = at.rest_m.size();
    const Plan plan = make_plan(shot, {query}, {.double_precision = false});
    if (plan.cascades.empty())
        return {{}, "has nothing to sweep: the shot's waves are trains alone, which no transform adds up"};
    Knobs knobs = plan.knobs;
    knobs.double_precision = true;
    SeaAnswers exact(shot, shape, 0.0, at, {.knobs = knobs});
    exact.run();
    const auto exact_m = std::make_shared<const std::vector<glm::dvec3>>(exact.vectors(Product::Position));
    const double height_m = std::max(exact.significant_height_m(), 1e-12);
    const auto sea = std::make_shared<const Sea<float>>(plan);
    const auto rest = std::make_shared<const std::vector<glm::vec2>>(at.rest_m.begin(), at.rest_m.end());
    Trials trials;
    for (const auto& [name, planning] :
         {std::pair{"estimated", Planning::Estimate}, std::pair{"recorded", Planning::Recorded},
          std::pair{"measured", Planning::Measure}, std::pair{"patient", Planning::Patient}}) {
        const PlannedBy planned(planning);
        const double took_s = planning_s(plan);
        const auto frame = std::make_shared<Frame<float>>(sea);
        trials.trials.push_back(
            {.setting = name,
             .is_shots = planning == Planning::Recorded,
             .run = [=] { frame->set(at.time_s); },
             .errors =
                 [=] {
                     std::vector<glm::vec3> position(rest->size());
                     Results<float> results;
                     results.set(Product::Position, {position.data()});
                     evaluate(*frame, 0, Points<float>{.count = rest->size(), .rest_m = {rest->data()}},
                              results);
                     return std::vector<double>{
                         rms(std::vector<glm::dvec3>(position.begin(), position.end()), *exact_m) / height_m,
                         took_s};
                 },
             .bytes = 0});
    }
    return trials;
}

}  // namespace pelagic::rows
