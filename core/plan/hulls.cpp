#include "core/plan/hulls.h"

#include <algorithm>

#include "core/plan/plan.h"
#include "core/scene/hull.h"
#include "core/scene/object_pose.h"
#include "core/scene/text.h"
#include "core/surface/footprint_levels.h"

namespace pelagic {

static constexpr const char* kHullsQuery = "hulls";

double contact_level_m(double foam_m) {
    constexpr double kFinest_m = 0.05;  // finer water tells a hull nothing that is seen
    return first_level_m(std::max(foam_m, kFinest_m));
}

namespace {

void add_floating_levels(const SceneObject& object, std::set<double>& levels_m) {
    if (!object.floats || !object.mesh || answers_by_mass(object)) return;  // the latter asks no grid
    const double below_m = level_below_m(floating_cell_m(object));
    levels_m.insert({below_m, 2.0 * below_m});
}

}  // namespace

std::optional<Query> hulls_query(const std::set<double>& footprints_m) {
    if (footprints_m.empty()) return std::nullopt;
    Query query;
    query.name = kHullsQuery;
    query.products = products(Product::Position, Product::Velocity);
    query.cell_m = query.pixel_m = {footprints_m.begin(), footprints_m.end()};
    query.is_view = true;  // which wave trains there are is for others to say
    return query;
}

std::optional<Query> hulls_query(const Scene& scene, bool has_places) {
    std::set<double> levels_m;
    for (const std::size_t i : hulls_of(scene)) {
        const SceneObject& object = scene.objects[i];
        if (!has_places) levels_m.insert(contact_level_m(contact_foam_m(object, *hull_of(*object.mesh))));
        add_floating_levels(object, levels_m);
    }
    return hulls_query(levels_m);
}

std::optional<Query> hulls_query_of_picture(const Scene& scene) {
    std::set<double> levels_m;
    for (const std::size_t i : hulls_of(scene))
        if (const SceneObject& object = scene.objects[i]; object.foam > 0.0)
            levels_m.insert(contact_level_m(contact_foam_m(object, *hull_of(*object.mesh))));
    for (const SceneObject& object : scene.objects) add_floating_levels(object, levels_m);
    return hulls_query(levels_m);
}

std::optional<int> hulls_query(const Plan& plan) {
    for (std::size_t i = 0; i < plan.queries.size(); ++i)
        if (plan.queries[i].query.name == kHullsQuery) return static_cast<int>(i);
    return std::nullopt;
}

bool knows_hulls(const Plan& plan) {
    const Scene& scene = plan.from->scene;
    const std::vector<std::size_t> hulls = hulls_of(scene);
    return !hulls.empty() && (hulls_query(plan) || std::ranges::none_of(hulls, [&](std::size_t i) {
                                  return scene.objects[i].floats && !answers_by_mass(scene.objects[i]);
                              }));
}

std::string hulls_text(const Plan& plan) {
    return "hulls, oversampling " + number_text(plan.knobs.oversampling) + " spline of " +
           std::to_string(plan.knobs.spline_taps);
}

bool may_meet_hulls(const PlannedOutput& output) {
    switch (output.row->kind) {
        case OutputKind::Mesh:
        case OutputKind::Volume:
        case OutputKind::Drops:
            return true;
        case OutputKind::Map:
            return output.map == MapKind::Whitecaps;
        case OutputKind::Tile:
        case OutputKind::Sky:
            return false;
    }
    return false;
}

}  // namespace pelagic
