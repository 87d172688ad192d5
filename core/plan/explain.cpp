// The plan as a page for people.

#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "core/base/constants.h"
#include "core/plan/effects.h"
#include "core/plan/fingerprint.h"
#include "core/plan/grid_layout.h"
#include "core/plan/memory.h"
#include "core/plan/mode_lattice.h"
#include "core/plan/plan.h"
#include "core/plan/products.h"
#include "core/plan/random_tiling.h"
#include "core/plan/unresolved_slopes.h"
#include "core/plan/weather.h"
#include "core/scene/names.h"
#include "core/spectrum/viscous_cutoff.h"

namespace pelagic {
namespace {

// printf into a string: the columns of the page are easier to read so than through stream manipulators.
template <class... Args>
std::string format(const char* pattern, Args... args) {
    const int length = std::snprintf(nullptr, 0, pattern, args...);
    std::string text(static_cast<std::size_t>(length), '\0');
    std::snprintf(text.data(), text.size() + 1, pattern, args...);
    return text;
}

const char* field_name(Field field) {
    static constexpr const char* kNames[kFieldCount] = {"height",     "Dx",         "Dy",        "slope x",
                                                        "slope y",    "Dxx",        "Dyy",       "Dxy",
                                                        "velocity x", "velocity y", "velocity z"};
    return kNames[index(field)];
}

std::string field_list(FieldSet set) {
    std::string text;
    for (std::size_t f = 0; f < kFieldCount; ++f)
        if (set[f]) text += (text.empty() ? "" : ", ") + std::string(field_name(static_cast<Field>(f)));
    return text.empty() ? "no field" : text;
}

// A sky asks nothing.
std::vector<PlannedQuery> asked_of_the_sea(const Plan& plan) {
    std::vector<PlannedQuery> queries = plan.queries;
    for (const PlannedOutput& output : plan.outputs)
        if (output.row->kind == OutputKind::Sky) queries.erase(queries.begin() + output.query);
    return queries;
}

std::string footprint_text(const std::vector<double>& footprints_m, double n_min) {
    std::string text = footprints_m.front() > 0.0
                           ? format("waves from %.4g m up", n_min * footprints_m.front())
                           : std::string("nothing filtered");
    if (footprints_m.size() > 1) text += format(" … %.4g m", n_min * footprints_m.back());
    return text;
}

// The second wave model: which trains there are, and which of them each output adds up.
std::string trains_text(const Plan& plan) {
    const TrainsPlan& trains = *plan.trains;
    const auto shown = [&](double footprint_m) {
        int count = 0;
        for (int i = 0; i < trains.count; ++i)
            count += plan.filter.weight(kTwoPi / trains.wavelengths_m[i], footprint_m) > 0.0;
        return count;
    };
    std::string page = format(
        "  %d, of waves from %.4g m down to %.4g m; %s\n"
        "  summed at each point: nothing is transformed, no grid is held\n",
        trains.count, trains.longest_m, trains.shortest_m,
        bytes_text(trains.sea_bytes(plan.knobs.double_precision)).c_str());
    if (trains.coast_cells.x > 0)
        page += format(
            "  %d of them feel the floor, marched once over %d x %d cells, %s of those bytes; nine reads a point and train\n",
            trains.coast_trains, trains.coast_cells.x, trains.coast_cells.y,
            bytes_text(trains.coast_bytes(plan.knobs.double_precision)).c_str());
    for (const PlannedQuery& planned : asked_of_the_sea(plan)) {
        const Query& query = planned.query;
        page += "  " + query.name + ": ";
        const FieldSet needed = fields_of(query.products) & ~plan.dropped;
        const int pixel = shown(query.pixel_m.front());
        if (query.only_cascade) {
            page += "none, it is a cascade's own\n";
            continue;
        }
        if (needed.none())
            page += "none is summed";
        else if (const int cell = shown(query.cell_m.front()); cell == pixel)
            page += format("the %d longest are summed", cell);
        else
            page +=
                format("the %d longest are summed in positions, the %d longest in derivatives", cell, pixel);
        page += format("; %d are below the pixel: kept as variance\n", trains.count - pixel);
    }
    return page;
}

// Whether masks are another without the effect. Where vessels are, ripples are calmed that don't break.
bool shapes_masks(Effect effect, const Scene& scene) {
    return effect == Effect::Masks || effect == Effect::Coast || effect == Effect::Wakes ||
           (effect == Effect::Whitecaps && !scene.waves.vessels.empty());
}

// What a frame would do and hold less without the effect; of a plan that is no bake, of the same queries.
std::string cost_text(const Plan& plan, const EffectRow& row) {
    const auto from = std::make_shared<PreparedScene>(*plan.from);
    row.turn_off(from->scene);
    if (!is_on(Effect::SecondOrder, from->scene)) from->second_order = {};
    if (shapes_masks(row.effect, plan.from->scene)) from->masks = masks_of(from->scene, from->spectrum);
    if (!from->weather)
        from->extent = extent_of(from->scene, from->spectrum, from->second_order, from->masks);
    std::vector<Query> queries;
    for (const PlannedQuery& planned : plan.queries)
        queries.push_back(with_effects(from->scene, planned.query));
    // No effect shapes the surface, but for how far the waves go.
    const Plan without = plan.surface
                             ? plan_bake(from, representative_frames(from->scene, 64),
                                         from->extent == plan.from->extent ? &plan : nullptr)
                             : make_plan(from, queries, {.knobs = plan.knobs, .filter = plan.filter});
    const auto held = [](const Plan& of) {
        return static_cast<double>(of.sea_bytes() + of.frame_bytes() + of.output_bytes() + of.effect_bytes());
    };
    const int transforms = plan.transforms_per_frame() - without.transforms_per_frame();
    const double bytes = held(plan) - held(without);
    if (transforms == 0 && bytes == 0.0) return "no transform and no memory";
    return std::to_string(transforms) + " transforms, " + (bytes < 0.0 ? "-" : "") +
           bytes_text(static_cast<std::size_t>(std::abs(bytes)));
}

}  // namespace

std::string explain(const Plan& plan) {
    const Scene& scene = plan.from->scene;
    const DirectionalSpectrum& spectrum = plan.from->spectrum;
    std::string page = format("Sea, with the defaults of edition %d\n", scene.shot.edition);
    const auto add_sea = [&](const SeaState& sea, const DirectionalSpectrum& of) {
        page += format("wind %g m/s towards %g°, spectrum %s, Hs %.3g m", sea.wind_speed_mps,
                       sea.wind_direction_deg, std::string(word_of(sea.spectrum)).c_str(),
                       4.0 * std::sqrt(of.m0()));
        if (sea.rain_mm_h > 0.0) page += format(", rain %g mm/h", sea.rain_mm_h);
        if (!of.is_calm()) page += format(", peak wavelength %.4g m", kTwoPi / of.peak_wavenumber());
    };
    if (const Weather* weather = plan.from->weather.get()) {
        page += format(
            "  changes from key to key, by variance and with the same phases, %s in the sea's time; planned for the mean of its "
            "keys",
            weather->is_smooth ? "smooth" : "linear");
        for (const Weather::Key& key : weather->keys) {
            page += format("\n  frame %d: ", key.frame);
            add_sea(key.sea->scene.sea, key.sea->spectrum);
        }
    } else {
        page += "  ";
        add_sea(scene.sea, spectrum);
    }
    page += format("\n  capillary-gravity dispersion, viscous cutoff at %g rad/m\n", kViscousWavenumber);

    page += "\nOutputs\n";
    for (const PlannedQuery& planned : asked_of_the_sea(plan)) {
        page += "  " + planned.query.name + ": " + footprint_text(planned.query.pixel_m, plan.filter.n_min) +
                "\n";
        for (const ProductRow& row : kProductTable) {
            if (!planned.query.products[index(row.product)]) continue;
            // Breaking has a displacement gradient of its own, also where nothing is displaced.
            const FieldSet needed = row.is_of_breaking ? row.needs : row.needs & ~plan.dropped;
            page += format("    %-18s ← %s (%s)\n", row.name, field_list(needed).c_str(), row.why);
            if (row.product == Product::SlopeVariance)
                page += format("    %-18s   %.3g times that at rest, by area of sea\n", "",
                               unresolved_slope_gain(spectrum, plan.filter, planned.query.pixel_m.front(),
                                                     plan.choppiness));
        }
    }
    if (plan.queries.empty()) page += "  none: no mesh, no maps and no volumes are asked for\n";
    for (const PlannedOutput& output : plan.outputs)
        if (output.has_surface) page += "  the mesh is " + plan.surface->describe() + "\n";
    if (scene.output.mesh != MeshFormat::None) {
        for (const AttributeRow& row : attribute_table()) {
            bool asked = false;
            for (const MeshAttribute attribute : scene.output.attributes) asked |= attribute == row.attribute;
            if (!asked)
                page += format("    %-18s   not computed: not in output.attributes\n",
                               std::string(word_of(row.attribute)).c_str());
        }
    }

    page += "\nEffects, and what a frame of the bake would do and hold less without each\n";
    for (const EffectRow& row : effect_table()) {
        const bool is_on = row.is_on(scene);
        const std::string about = is_on && row.about ? row.about(plan) : "";
        page += format("  %s%s: %s%s%s\n", is_on ? "" : "no ", row.name,
                       (is_on ? cost_text(plan, row) : row.why_off(scene)).c_str(), about.empty() ? "" : "; ",
                       about.c_str());
    }

    if (plan.trains && plan.trains->count > 0) page += "\nWave trains\n" + trains_text(plan);
    if (plan.trains && plan.trains->hero_trains > 0)
        page += format("\nHero waves\n  %zu, of %d trains of their own, summed at each point\n",
                       plan.from->scene.waves.heroes.size(), plan.trains->hero_trains);

    page += "\nCascades and their transforms\n";
    if (plan.cascades.empty())
        page += "  none: the trains are the whole sea\n";
    else if (scene.waves.tiling == Tiling::Random)
        page += format(
            "  each of copies at random offsets, blended: %.2f reads a point on average, 1 within a copy\n",
            (1.0 + kBlendRamp) * (1.0 + kBlendRamp));
    else
        page += format("  periodic tiles: the largest repeats after %.4g m\n", plan.cascades.front().size_m);
    std::size_t cascade_number = 0;
    for (const CascadePlan& cascade : plan.cascades) {
        page += format("  %zu  %.6g m, resolution %d, ", cascade_number, cascade.size_m, cascade.resolution);
        if (cascade.vessel)
            page += "a vessel's, ";
        else if (!scene.waves.cascades.empty())
            if (const auto own = scene.waves.cascades[cascade_number].choppiness)
                page += format("choppiness %g, ", *own);
        ++cascade_number;
        const double longest_m = cascade.k_lower > 0.0 ? kTwoPi / cascade.k_lower : cascade.size_m;
        const double shortest_m = std::isfinite(cascade.k_upper)
                                      ? kTwoPi / cascade.k_upper
                                      : cascade.size_m / (cascade.resolution / 2 - 1);
        page += shortest_m < longest_m ? format("waves of %.4g m down to %.4g m\n", longest_m, shortest_m)
                                       : std::string("too coarse for any wave of its band\n");
        if (cascade.grids.empty()) {
            page += "     nothing runs: " + cascade.why_empty + "\n";
            continue;
        }
        const std::size_t modes = lattice_modes(cascade.amplitude_radius());
        page +=
            format("     %zu modes, %s\n", modes,
                   bytes_text(modes * sea_bytes_per_mode(plan.knobs.double_precision, plan.has_gradients()))
                       .c_str());
        for (const Grid& grid : cascade.grids) {
            const std::size_t bytes =
                grid.fields.count() * grid_bytes(grid.resolution, plan.knobs.double_precision);
            page +=
                format("     %d × %d, %zu real transforms of %ld lines in all, %s, read %s:", grid.resolution,
                       grid.resolution, grid.fields.count(), grid.lines(), bytes_text(bytes).c_str(),
                       grid.sampling == Sampling::Nodes
                           ? "at its nodes"
                           : (plan.knobs.spline_taps == 6 ? "by quintic spline" : "by cubic spline"));
            for (std::size_t f = 0; f < kFieldCount; ++f)
                if (grid.fields[f]) page += std::string(" ") + field_name(static_cast<Field>(f));
            page += "\n";
        }
    }
    page += format(
        "\nEach frame: %d real transforms (%ld lines of complex numbers). Held: %s for the sea, %s for a "
        "frame, %s for points and results.\n",
        plan.transforms_per_frame(), plan.lines_per_frame(), bytes_text(plan.sea_bytes()).c_str(),
        bytes_text(plan.frame_bytes()).c_str(), bytes_text(plan.output_bytes()).c_str());
    page += format(
        "Quality %s: %s precision, %d-tap splines, %.3g × oversampled; what only pictures' light reads, %.3g × at "
        "least.\n",
        std::string(word_of(scene.quality.level)).c_str(), plan.knobs.double_precision ? "double" : "single",
        plan.knobs.spline_taps, plan.knobs.oversampling, plan.knobs.light_oversampling);
    for (const PlannedOutput& output : plan.outputs)
        page += "Fingerprint of the " + plan.queries[output.query].query.name + " " +
                output_fingerprint(plan, output) + "\n";
    return page;
}

}  // namespace pelagic
