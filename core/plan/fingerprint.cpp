#include "core/plan/fingerprint.h"

#include "core/plan/hulls.h"
#include "core/plan/products.h"
#include "core/plan/weather.h"
#include "core/scene/canonical.h"
#include "core/scene/hull.h"
#include "core/scene/number_keys.h"
#include "core/scene/text.h"

namespace pelagic {
namespace {

void add_vector(std::string& text, const glm::dvec3& v) {
    for (int i = 0; i < 3; ++i) text += ' ' + number_text(v[i]);
}

}  // namespace

Fingerprint& Fingerprint::add(std::string_view text) {
    for (const char c : text) hash_.add(static_cast<unsigned char>(c));
    hash_.add(0);  // keeps two texts apart from one that is both
    return *this;
}

std::string plan_text(const Plan& plan, int query_index) {
    const PlannedQuery& planned = plan.queries.at(query_index);
    const Query& query = planned.query;
    // What breaks now and the foam's age were no products of their own: files that have them have coverage.
    const bool has_foam = (query.products & foam_products()).any();
    ProductSet shown = query.products & ~foam_products();
    shown[index(Product::Coverage)] = has_foam;
    constexpr std::size_t kLater = kProductCount - index(Product::Coverage) - 1;
    std::string text = "precision " + std::string(plan.knobs.double_precision ? "double" : "single") +
                       " filter " + number_text(plan.filter.n_min) + ' ' + number_text(plan.filter.n_max) +
                       "\nproducts " + shown.to_string().substr(kLater) + " dropped " +
                       plan.dropped.to_string() + '\n';
    for (const ProductRow& row : kProductTable)  // those that came later
        if (row.product > Product::FoamAge && query.products[index(row.product)])
            text += row.identifier + std::string("\n");
    if (has_foam) text += "third " + std::to_string(plan.knobs.third_moment) + '\n';
    // The history has grids of its own, which aren't in this plan. To be raised where they give other bits.
    if (plan.foam && query.asks_for_past())
        text += "history 2, oversampling " + number_text(plan.knobs.oversampling) + '\n';
    // Until the law did, the cube of the wind said how much each place has.
    if (has_foam && plan.gusts && !query.only_cascade) text += "gusts by the law\n";
    const std::string spline = " spline of " + std::to_string(plan.knobs.spline_taps) + '\n';
    if (plan.trains && plan.trains->count > 0 && !query.only_cascade)
        text += "trains " + std::to_string(plan.trains->count) + ' ' + number_text(plan.trains->longest_m) +
                ' ' + number_text(plan.trains->shortest_m) + '\n';
    // To be raised where the same heroes give other bits.
    if (plan.trains && plan.trains->hero_trains > 0 && !query.only_cascade) text += "heroes 2\n";
    // To be raised where the same depths give other bits: both, where coast_foam() or kRoller does.
    if (plan.trains && plan.trains->coast_cells.x > 0 && !query.only_cascade)
        text += "coast 1, " + std::to_string(plan.trains->coast_trains) + " of " +
                std::to_string(plan.trains->coast_cells.x) + " x " +
                std::to_string(plan.trains->coast_cells.y) + '\n';
    if (plan.masks && plan.masks->surf && !query.only_cascade)
        text += "coast of tiles 1, " + std::to_string(plan.masks->surf->count.x) + " x " +
                std::to_string(plan.masks->surf->count.y) + '\n';
    if (query.lattice)
        text += "lattice " + number_text(query.lattice->first_m) + ' ' +
                number_text(query.lattice->spacing_m) + " points " + std::to_string(query.points) + '\n';
    if (query.only_cascade) text += "cascade " + std::to_string(*query.only_cascade) + '\n';
    if (query.is_view) {
        text += "view, oversampling " + number_text(plan.knobs.oversampling) +
                (query.is_picture ? ", of light " + number_text(plan.knobs.light_oversampling) : "") + spline;
    } else {
        text += "footprints";
        for (const auto* footprints_m : {&query.cell_m, &query.pixel_m})
            for (const double footprint_m : *footprints_m) text += ' ' + number_text(footprint_m);
        text += '\n';
    }
    const std::vector<int> levels = summed_levels(plan, planned);
    for (const CascadePlan& cascade : plan.cascades) {
        // A finer last cascade has more modes, of which no level of this query resolves any.
        text += "tile " + number_text(cascade.size_m) + " from " + number_text(cascade.k_lower) + '\n';
        if (cascade.vessel) text += "wake 6\n";  // to be raised where the same path gives other bits
        if (const auto& second = cascade.second_order; second && second->reach > second->radius)
            text += "pairs to " + std::to_string(second->reach) + '\n';
        if (query.is_view) continue;
        for (const int level : levels) {
            const int g = cascade.grid_of_level[level];
            if (g < 0) continue;
            const Grid& grid = cascade.grids[g];
            text += " grid " + std::to_string(grid.resolution) + ' ' + std::to_string(grid.radius) +
                    (grid.sampling == Sampling::Nodes ? " nodes\n" : spline);
        }
    }
    return text;
}

// What a mesh that a view shapes owes to it. The number is raised where the same view gives other points.
std::string pose_text(const View& view) {
    std::string text = "pose 2";
    for (const glm::dvec3& v : {view.position_m, view.right, view.up, view.forward}) add_vector(text, v);
    return text + ' ' + number_text(view.tan_half_width) + ' ' + std::to_string(view.resolution.x) + ' ' +
           std::to_string(view.resolution.y) + ' ' + number_text(view.shift.x) + ' ' +
           number_text(view.shift.y);
}

std::string weather_plan_text(const Plan& plan, bool by_extent) {
    if (!plan.from->weather) return {};
    std::string text = "weather, breaking " + number_text(plan.breaking.footprint_m);
    for (const CascadePlan& cascade : plan.cascades)
        if (const auto& second = cascade.second_order)
            for (const double value :
                 {1.0 * second->radius, second->difference, second->sum, second->shallow})
                text += ' ' + number_text(value);
    if (plan.gusts || plan.foam)  // they drift with one wind
        text += " wind " + number_text(plan.from->scene.sea.wind_speed_mps) + ' ' +
                number_text(plan.from->scene.sea.wind_direction_deg);
    if (plan.foam) text += " bubbles " + number_text(plan.foam->bubbles_m);
    if (plan.trains)  // their lengths and directions are those of the mean
        for (const Weather::Key& key : plan.from->weather->keys) text += weather_text(*plan.from, key.time_s);
    if (by_extent) {
        const Extent& extent = plan.from->extent;
        text += " extent " + number_text(extent.height_m) + ' ' + number_text(extent.reach_m);
        for (const double deviation_m : extent.unresolved.deviation_m) text += ' ' + number_text(deviation_m);
    }
    return text;
}

std::string weather_time_text(const Plan& plan, int query, double t_s) {
    if (!plan.from->weather) return {};
    if (!plan.foam || !plan.queries.at(query).query.asks_for_past()) return weather_text(*plan.from, t_s);
    // Of the lattice of times, with those that an interval is known by.
    constexpr double kBeside = 5.0;
    const double beside_s = kBeside * plan.foam->step_s;
    return weather_text(*plan.from, t_s, plan.foam->window_s + beside_s, beside_s);
}

std::string output_fingerprint(const Plan& plan, const PlannedOutput& output) {
    const Scene& scene = plan.from->scene;
    Fingerprint hash;
    hash.add(plan.queries[output.query].query.name).add("revision " + std::to_string(output.row->revision));
    if (output.row->kind == OutputKind::Sky)  // nothing of the sea is in it
        return hash.add(canonical(scene, output.key_parts)).text();
    hash.add(canonical(plan.from->weather ? without_keyed(scene) : scene, output.key_parts))
        .add(plan_text(plan, output.query));
    if (plan.from->weather) {
        const bool is_of_camera = output.has_surface && !plan.surface->is_constant();
        hash.add(weather_plan_text(plan, is_of_camera || output.volume));
    }
    if (output.meets_hulls) {
        const bool has_foam = output.row->kind == OutputKind::Mesh || output.row->kind == OutputKind::Map;
        hash.add(hulls_text(scene, has_foam)).add(hulls_text(plan));
    }
    return hash.text();
}

std::string frame_fingerprint(const Plan& plan, const PlannedOutput& output, const std::string& whole,
                              int frame) {
    Fingerprint hash;
    hash.add(whole).add("frame " + std::to_string(frame));
    // Which time of a loop a frame shows isn't in any key.
    const Shot& shot = plan.from->scene.shot;
    if (shot.loop_s > 0.0) hash.add("time " + number_text(shot.time_s(frame)));
    if (plan.from->weather) hash.add(weather_time_text(plan, output.query, shot.time_s(frame)));
    if (output.has_surface)
        if (const auto view = plan.surface->shaped_by(frame)) hash.add(pose_text(*view));
    return hash.text();
}

}  // namespace pelagic
