#include "core/evaluate/hulls.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <tuple>
#include <utility>

#include "core/plan/hulls.h"

namespace pelagic {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();
constexpr double kMostFoam = 0.9;  // by eye, as Hulls::kFull_mps

}  // namespace

Hulls::Hulls(const Scene& scene) : scene_(scene) {
    for (const std::size_t i : hulls_of(scene)) {
        const SceneObject& object = scene.objects[i];
        Placed& hull = hulls_.emplace_back();
        hull.object = i;
        hull.hull = hull_of(*object.mesh);
        hull.scale = object.scale;
        hull.foam = object.foam;
        hull.foam_m = contact_foam_m(object, *hull.hull);
    }
}

template <class T>
void Hulls::place(const Frame<T>& state, std::optional<int> query, double frame, RestHeight rest_m) {
    const double step_s = scene_.shot.time_scale / scene_.shot.fps;
    rest_m_ = std::move(rest_m);
    for (Placed& placed : hulls_) {
        const SceneObject& object = scene_.objects[placed.object];
        const auto at = [&](double beside) {
            const ObjectPose pose = place_object(state, scene_, object,
                                                 {.query = query.value_or(0),
                                                  .frame = frame + beside,
                                                  .rest_m = rest_m_,
                                                  .late_s = beside * step_s})
                                        .pose;
            return std::pair(pose.scale * pose.turn, pose.place_m);
        };
        std::tie(placed.axes, placed.place_m) = at(0.0);
        placed.axes_per_s = glm::dmat3(0.0);
        placed.place_mps = glm::dvec3(0.0);
        if (placed.foam > 0.0 && step_s > 0.0) {
            constexpr double kBeside = 0.25;  // frames
            const auto [axes_before, before] = at(-kBeside);
            const auto [axes_behind, behind] = at(kBeside);
            const double per_s = 1.0 / (2.0 * kBeside * step_s);
            placed.axes_per_s = (axes_behind - axes_before) * per_s;
            placed.place_mps = (behind - before) * per_s;
        }
        bound(placed);
    }
}
template void Hulls::place(const Frame<float>&, std::optional<int>, double, RestHeight);
template void Hulls::place(const Frame<double>&, std::optional<int>, double, RestHeight);

void Hulls::place(std::span<const Moved> bodies) {
    rest_m_ = {};
    for (Placed& placed : hulls_) {
        static_cast<Moved&>(placed) = bodies[placed.object];
        bound(placed);
    }
}

void Hulls::bound(Placed& placed) const {
    const ObjectMesh& mesh = *scene_.objects[placed.object].mesh;
    const glm::dvec3 least = mesh.least_m(), most = mesh.most_m();
    const glm::dvec3 beside(placed.hull->margin_m(), placed.hull->margin_m(), 0.0);
    placed.into = glm::inverse(placed.axes);
    placed.centre_m = placed.place_m + placed.axes * (0.5 * (least + most));
    placed.radius_m = placed.scale * glm::length(0.5 * (most - least) + beside);
}

double Hulls::Placed::distance(const glm::dvec3& place) const {
    return is_near(place, 0.0) ? scale * hull->distance_m(local(place)) : kFar;
}

double Hulls::distance_m(const glm::dvec3& place_m) const {
    double nearest_m = kFar;
    for (const Placed& placed : hulls_) nearest_m = std::min(nearest_m, placed.distance(place_m));
    return nearest_m;
}

double Hulls::depth_m(const glm::dvec3& place_m, double bound_m) const {
    double nearest_m = bound_m;
    for (const Placed& placed : hulls_) {
        if (!placed.is_near(place_m, 0.0)) continue;
        const glm::dvec3 local = placed.local(place_m);
        const double side_m = placed.scale * placed.hull->distance_m(local),
                     above_m = placed.scale * placed.hull->above_bottom_m(local);
        // Inside it is nearer to the side or to the bottom; below the bottom, or beside the hull, one of them is the way.
        const double own_m = side_m < 0.0    ? -std::min(-side_m, above_m > 0.0 ? above_m : 0.0)
                             : above_m < 0.0 ? std::min(side_m, -above_m)
                                             : side_m;
        nearest_m = std::min(nearest_m, own_m);
    }
    return std::max(nearest_m, -bound_m);
}

bool Hulls::are_near(const glm::dvec2& least_m, const glm::dvec2& most_m, double distance_m) const {
    return std::ranges::any_of(hulls_, [&](const Placed& placed) {
        const glm::dvec2 centre(placed.centre_m);
        return glm::length(centre - glm::clamp(centre, least_m, most_m)) <= placed.radius_m + distance_m;
    });
}

float Hulls::wet_share(double distance_m, double cell_m) {
    if (!(cell_m > 0.0)) return distance_m < 0.0 ? 0.0f : 1.0f;
    return static_cast<float>(std::clamp(0.5 + distance_m / cell_m, 0.0, 1.0));
}

double Hulls::Placed::foam_at(const glm::dvec3& place, double distance_m, const glm::dvec3& water_mps,
                              double cell_m) const {
    const double width_m = std::max(foam_m, cell_m);
    const double share = std::clamp(distance_m / width_m, 0.0, 1.0);
    const glm::dvec3 in = local(place);
    const glm::dvec2 outward = hull->outward(in);
    if (outward == glm::dvec2(0.0)) return 0.0;
    const glm::dvec3 normal = glm::normalize(axes * glm::dvec3(outward, 0.0));
    const glm::dvec3 hull_mps = place_mps + axes_per_s * in;
    const double speed = std::abs(glm::dot(water_mps - hull_mps, normal));
    return foam * kMostFoam * (foam_m / width_m) * (1.0 - share * share * (3.0 - 2.0 * share)) *
           std::min(speed / kFull_mps, 1.0);
}

template <class T>
void Hulls::meet(const Frame<T>& state, std::optional<int> query, const Points<T>& points, double cell_m,
                 const Known& known, const Met& met) const {
    const std::span<const glm::vec3> positions_m = known.positions_m, velocities_mps = known.velocities_mps;
    std::ranges::fill(met.wet, 1.0f);
    std::ranges::fill(met.foam, 0.0f);
    if (empty() || points.count == 0) return;
    const auto cell = [&](std::size_t i) {
        return points.cell_m ? static_cast<double>(points.cell_m[i]) : cell_m;
    };
    const auto rest_at = [&](std::size_t i) {
        return rest_m_ ? rest_m_(points.origin_m + glm::dvec2(points.rest_m[i])) : 0.0;
    };
    // Of places at rest the water may be elsewhere, and the hull higher or lower.
    const Extent& extent = state.sea().plan().from->extent;
    const double slack_m = positions_m.empty() ? std::hypot(extent.reach_m, extent.height_m) : 0.0;
    std::vector<char> is_near(points.count);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points.count, 4096), [&](const auto& range) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
            const glm::dvec3 at = glm::dvec3(points.origin_m, 0.0) +
                                  (positions_m.empty() ? glm::dvec3(glm::dvec2(points.rest_m[i]), rest_at(i))
                                                       : glm::dvec3(positions_m[i]));
            is_near[i] = std::ranges::any_of(
                hulls_, [&](const Placed& placed) { return placed.is_near(at, slack_m); });
        }
    });
    std::vector<std::size_t> near;
    for (std::size_t i = 0; i < points.count; ++i)
        if (is_near[i]) near.push_back(i);
    if (near.empty()) return;
    std::vector<glm::vec<2, T>> rest_m;
    for (const std::size_t i : near) rest_m.push_back(points.rest_m[i]);
    // By hull, since each has footprints of its own.
    for (const Placed& placed : hulls_) {
        const bool has_foam = placed.foam > 0.0 && !met.foam.empty();
        const bool asks_speed = has_foam && velocities_mps.empty();
        std::vector<glm::vec<3, T>> position_m(positions_m.empty() ? near.size() : 0),
            velocity_mps(asks_speed ? near.size() : 0);
        if (!position_m.empty() || asks_speed) {
            const T level_m = static_cast<T>(contact_level_m(placed.foam_m));
            Points<T> asked{.origin_m = points.origin_m, .count = near.size(), .rest_m = {rest_m.data()}};
            asked.cell_m = {&level_m, 0};
            Results<T> results;
            if (!position_m.empty()) results.set(Product::Position, {position_m.data()});
            if (asks_speed) results.set(Product::Velocity, {velocity_mps.data()});
            evaluate(state, query.value(), asked, results);
        }
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, near.size(), 256), [&](const auto& range) {
            for (std::size_t k = range.begin(); k < range.end(); ++k) {
                const std::size_t i = near[k];
                glm::dvec3 place(points.origin_m, position_m.empty() ? 0.0 : rest_at(i));
                place += position_m.empty() ? glm::dvec3(positions_m[i]) : glm::dvec3(position_m[k]);
                const double distance_m = placed.distance(place);
                if (!(distance_m < kFar)) continue;
                if (!met.wet.empty()) met.wet[i] = std::min(met.wet[i], wet_share(distance_m, cell(i)));
                // A little way in as well, so that what is cut at the outline has foam up to it.
                if (!has_foam || distance_m < -2.0 * cell(i) - placed.foam_m) continue;
                const glm::dvec3 water_mps =
                    asks_speed ? glm::dvec3(velocity_mps[k]) : glm::dvec3(velocities_mps[i]);
                const double foam = placed.foam_at(place, distance_m, water_mps, cell(i));
                met.foam[i] =
                    static_cast<float>(1.0 - (1.0 - static_cast<double>(met.foam[i])) * (1.0 - foam));
            }
        });
    }
}
template void Hulls::meet(const Frame<float>&, std::optional<int>, const Points<float>&, double, const Known&,
                          const Met&) const;
template void Hulls::meet(const Frame<double>&, std::optional<int>, const Points<double>&, double,
                          const Known&, const Met&) const;

// Nodes are of the hull: so of each the water that is there now is looked for, which rests elsewhere.
template <class T>
std::vector<Hulls::Beside> Hulls::beside(const Frame<T>& state, std::optional<int> query) const {
    std::vector<Beside> all(scene_.objects.size());
    for (const Placed& placed : hulls_) {
        if (!(placed.foam > 0.0) || !query) continue;
        Beside& made = all[placed.object];
        made.foam = placed.foam * kMostFoam;
        made.foam_m = placed.foam_m;
        // Half as far as the shortest waves that are known: between nodes their water's velocity is nearly straight.
        constexpr double kOfWidth = 0.5;
        const double least_m = contact_level_m(placed.foam_m);
        const glm::dvec3 least = scene_.objects[placed.object].mesh->least_m(),
                         most = scene_.objects[placed.object].mesh->most_m();
        made.step_m = kOfWidth * std::max(placed.foam_m, least_m) / placed.scale;
        const glm::dvec2 margin(placed.hull->margin_m());
        made.first_m = glm::dvec2(least) - margin;
        made.count = glm::ivec2(glm::ceil((glm::dvec2(most - least) + 2.0 * margin) / made.step_m)) + 1;
        made.way_mps.assign(static_cast<std::size_t>(made.count.x) * made.count.y, glm::vec3(0.0f));
        const auto node = [&](std::size_t i) {
            const auto columns = static_cast<std::size_t>(made.count.x);
            return made.first_m + made.step_m * glm::dvec2(i % columns, i / columns);
        };
        std::vector<std::size_t> near;
        std::vector<glm::dvec2> rest_m;
        for (std::size_t i = 0; i < made.way_mps.size(); ++i) {
            // At whatever height the water is there.
            const glm::dvec2 at = node(i);
            const double reach_m = placed.hull->margin_m();
            bool is_near = false;
            for (int level = 0; level < Hull::kLevels && !is_near; level += 4)
                is_near =
                    std::abs(placed.hull->distance_m(glm::dvec3(
                        at, placed.hull->lowest_m() + (level + 0.5) * placed.hull->level_m()))) <= reach_m;
            if (!is_near) continue;
            near.push_back(i);
            rest_m.emplace_back(placed.place_m + placed.axes * glm::dvec3(at, 0.0));
        }
        if (near.empty()) continue;
        const glm::dvec2 origin_m(placed.place_m);
        std::vector<glm::vec<2, T>> asked_m(near.size());
        std::vector<glm::vec<3, T>> position_m(near.size()), velocity_mps(near.size());
        const T level_m = static_cast<T>(least_m);
        const auto place_of = [&](std::size_t k) {
            glm::dvec3 place(position_m[k]);
            if (rest_m_) place.z += rest_m_(rest_m[k]);
            return place + glm::dvec3(origin_m, 0.0);
        };
        constexpr int kSteps = 4;  // each leaves as much of the error as the water is stretched
        for (int step = 0;; ++step) {
            for (std::size_t k = 0; k < near.size(); ++k) asked_m[k] = rest_m[k] - origin_m;
            Points<T> points{.origin_m = origin_m, .count = near.size(), .rest_m = {asked_m.data()}};
            points.cell_m = {&level_m, 0};
            Results<T> results;
            results.set(Product::Position, {position_m.data()});
            if (step == kSteps) results.set(Product::Velocity, {velocity_mps.data()});
            evaluate(state, *query, points, results);
            if (step == kSteps) break;
            for (std::size_t k = 0; k < near.size(); ++k) {
                const glm::dvec2 off = glm::dvec2(placed.local(place_of(k))) - node(near[k]);
                rest_m[k] -= glm::dvec2(placed.axes * glm::dvec3(off, 0.0));
            }
        }
        for (std::size_t k = 0; k < near.size(); ++k)
            made.way_mps[near[k]] = glm::vec3(glm::dvec3(velocity_mps[k]) - placed.place_mps -
                                              placed.axes_per_s * placed.local(place_of(k)));
    }
    return all;
}
template std::vector<Hulls::Beside> Hulls::beside(const Frame<float>&, std::optional<int>) const;
template std::vector<Hulls::Beside> Hulls::beside(const Frame<double>&, std::optional<int>) const;

void add_contact_foam(std::span<const float> foam, Values& values) {
    std::vector<float>& coverage = values.numbers(Product::Coverage);
    std::vector<float>& breaking = values.numbers(Product::Breaking);
    std::vector<float>& age_s = values.numbers(Product::FoamAge);
    for (std::size_t i = 0; i < foam.size(); ++i) {
        if (!(foam[i] > 0.0f)) continue;
        const auto with = [&](float share) { return 1.0f - (1.0f - share) * (1.0f - foam[i]); };
        if (i < coverage.size()) {
            const float before = coverage[i];
            coverage[i] = with(before);
            if (i < age_s.size() && coverage[i] > 0.0f) age_s[i] *= before / coverage[i];
        }
        if (i < breaking.size()) breaking[i] = with(breaking[i]);
    }
}

}  // namespace pelagic
