// Sweeps of pictures through the shot's camera.
#include <initializer_list>
#include <string>
#include <utility>

#include "core/plan/effects.h"
#include "core/plan/taps.h"
#include "core/scene/text.h"
#include "plugin/accuracy/picture_trials.h"
#include "plugin/accuracy/rows.h"

namespace pelagic::rows {
namespace {

constexpr int kReferenceSamples = 8;

Knobs knobs_of_shot(const Scene& shot) {
    return make_plan(shot, {}).knobs;
}

struct LightSetting {
    const char* name;
    SkyQuality sky_quality;
    FresnelFit fresnel;
};

// Against the integral of the exact term.
Trials of_light(const Scene& shot, std::initializer_list<LightSetting> lights) {
    const Scene scene = with_small_pictures(shot);
    const RenderOptions own = render_options(scene);
    RenderOptions exact = own;
    exact.samples = 1;
    exact.lighting.sky_quality = SkyQuality::Integral;
    exact.lighting.fresnel = FresnelFit::Exact;
    std::vector<PictureSetting> settings;
    for (const LightSetting& light : lights) {
        RenderOptions options = exact;
        options.lighting.sky_quality = light.sky_quality;
        options.lighting.fresnel = light.fresnel;
        settings.push_back(
            {light.name,
             own.lighting.sky_quality == light.sky_quality && own.lighting.fresnel == light.fresnel, scene,
             options});
    }
    return against(scene, exact, std::move(settings));
}

}  // namespace

Trials sky_lookups(const Scene& shot) {
    return of_light(shot, {{"one", SkyQuality::One, FresnelFit::Exact},
                           {"nine", SkyQuality::Nine, FresnelFit::Exact},
                           {"integral", SkyQuality::Integral, FresnelFit::Exact}});
}

Trials fresnel_terms(const Scene& shot) {
    return of_light(shot, {{"one lookup, Eq. 26 of Schlick's term", SkyQuality::One, FresnelFit::Paper},
                           {"one lookup, fit of the exact term", SkyQuality::One, FresnelFit::Exact},
                           {"nine, Schlick's term", SkyQuality::Nine, FresnelFit::Paper},
                           {"nine, exact term", SkyQuality::Nine, FresnelFit::Exact},
                           {"integral, Schlick's term", SkyQuality::Integral, FresnelFit::Paper},
                           {"integral, exact term", SkyQuality::Integral, FresnelFit::Exact}});
}

Trials samples(const Scene& shot) {
    const Scene scene = with_small_pictures(shot);
    const RenderOptions own = render_options(scene);
    RenderOptions exact = own;
    exact.samples = kReferenceSamples;
    std::vector<PictureSetting> settings;
    for (const int n : {1, 2, 3, 4, 6}) {
        RenderOptions options = own;
        options.samples = n;
        settings.push_back({std::to_string(n) + " × " + std::to_string(n), own.samples == n, scene, options});
    }
    return against(scene, exact, std::move(settings));
}

Trials grid_cells(const Scene& shot) {
    const Scene scene = with_small_pictures(shot);
    RenderOptions options = render_options(scene);
    options.samples = 1;
    Scene exact = scene;
    exact.surface.cell_px = 0.5;
    std::vector<PictureSetting> settings;
    for (const double cell_px : {1.0, 2.0, 4.0, 8.0, 16.0, 32.0}) {
        Scene at = scene;
        at.surface.cell_px = cell_px;
        settings.push_back({number_text(cell_px) + " px", scene.surface.cell_px == cell_px, at, options});
    }
    return against(exact, options, std::move(settings));
}

Trials footprint_filter(const Scene& shot) {
    const Scene scene = with_small_pictures(shot);
    RenderOptions exact = render_options(scene);
    exact.samples = kReferenceSamples;
    std::vector<PictureSetting> settings;
    for (const FootprintFilter filter :
         {FootprintFilter{0.5, 1.25}, FootprintFilter{1.0, 2.5}, FootprintFilter{1.5, 3.0},
          FootprintFilter{2.0, 4.0}, FootprintFilter{3.0, 6.0}, FootprintFilter{4.0, 8.0}}) {
        RenderOptions options = exact;
        options.samples = 1;
        options.filter = filter;
        settings.push_back({number_text(filter.n_min) + " … " + number_text(filter.n_max) + " samples a wave",
                            filter == FootprintFilter{}, scene, options});
    }
    return against(scene, exact, std::move(settings));
}

Trials picture_interpolation(const Scene& shot) {
    const Scene scene = with_small_pictures(shot);
    const Knobs own = knobs_of_shot(scene);
    RenderOptions exact = render_options(scene);
    exact.samples = 1;
    exact.knobs =
        Knobs{.spline_taps = 6, .oversampling = 4.0, .light_oversampling = 4.0, .double_precision = true};
    std::vector<PictureSetting> settings;
    for (const auto& [taps, name] : {std::pair{4, "cubic"}, std::pair{6, "quintic"}})
        for (const double oversampling : {1.0, 1.25, 1.4, 1.5, 2.0}) {
            RenderOptions options = exact;
            options.knobs =
                Knobs{.spline_taps = taps, .oversampling = 2.0, .light_oversampling = oversampling};
            settings.push_back({std::string(name) + ", " + number_text(oversampling) + " nodes a sample",
                                *options.knobs == own, scene, options});
        }
    return against(scene, exact, std::move(settings));
}

Trials foam_structure(const Scene& shot) {
    const Scene scene = with_small_pictures(shot);
    const RenderOptions own = render_options(scene);
    if (!own.lighting.whitecaps) return {{}, "has nothing to sweep: the shot has no whitecaps"};
    RenderOptions exact = own;
    exact.samples = kReferenceSamples;
    std::vector<PictureSetting> settings;
    for (const double structure : {0.0, scene.effects.foam_structure}) {
        Scene at = scene;
        at.effects.foam_structure = structure;
        for (const int n : {1, 2}) {
            RenderOptions options = own;
            options.samples = n;
            settings.push_back({(structure > 0.0 ? "structure, " : "smooth, ") + std::to_string(n) + " × " +
                                    std::to_string(n),
                                structure == scene.effects.foam_structure && n == own.samples, at, options});
        }
        if (!is_on(Effect::FoamStructure, scene)) break;
    }
    return against(scene, exact, std::move(settings));
}

namespace {

// A part of the light, and the picture without it.
Trials with_and_without(const Scene& shot, bool LightingChoice::*part) {
    const Scene scene = with_small_pictures(shot);
    RenderOptions with = render_options(scene);
    with.samples = 1;
    RenderOptions without = with;
    without.lighting.*part = false;
    return against(scene, with, {{"with", true, scene, with}, {"without", false, scene, without}});
}

}  // namespace

Trials air(const Scene& shot) {
    return with_and_without(shot, &LightingChoice::air);
}

Trials second_reflection(const Scene& shot) {
    return with_and_without(shot, &LightingChoice::second_reflection);
}

Trials masking(const Scene& shot) {
    const Scene scene = with_small_pictures(shot);
    const RenderOptions own = render_options(scene);
    RenderOptions one = own;
    one.samples = 1;
    // Cells as fine as pixels leave nothing unresolved that pixels resolve.
    Scene exact = scene;
    exact.surface.cell_px = 0.5;
    std::vector<PictureSetting> settings;
    for (const double cell_px : {4.0, 16.0})
        for (const bool is_masked : {true, false}) {
            Scene at = scene;
            at.surface.cell_px = cell_px;
            RenderOptions options = one;
            options.lighting.mesh_masking = is_masked;
            settings.push_back({std::string(is_masked ? "two scales" : "one scale") + ", cells of " +
                                    number_text(cell_px) + " px",
                                false, at, options});
        }
    return against(exact, one, std::move(settings));
}

Trials ellipses(const Scene& shot) {
    const Scene scene = with_small_pictures(shot);
    RenderOptions exact = render_options(scene);
    exact.samples = kReferenceSamples;
    const Knobs own = knobs_of_shot(scene);
    std::vector<PictureSetting> settings;
    for (const double longest : {1.0, 2.0, 4.0, kLongestEllipse}) {
        RenderOptions options = exact;
        options.samples = 1;
        options.knobs = own;
        options.knobs->longest_ellipse = longest;
        settings.push_back({longest > 1.0 ? "up to 1 : " + number_text(longest) : std::string("circles"),
                            longest == own.longest_ellipse, scene, options});
    }
    return against(scene, exact, std::move(settings));
}

Trials foam_times(const Scene& shot) {
    const Scene scene = with_small_pictures(shot);
    const RenderOptions own = render_options(scene);
    if (!is_on(Effect::LivingFoam, scene)) return {{}, "has nothing to sweep: the shot's foam doesn't live"};
    const Knobs knobs = knobs_of_shot(scene);
    RenderOptions exact = own;
    exact.samples = 1;
    exact.knobs = knobs;
    exact.knobs->foam_steps_a_period = 4.0 * knobs.foam_steps_a_period;
    std::vector<PictureSetting> settings;
    for (const double steps : {0.5, 1.0, 2.0, 4.0, 8.0}) {
        RenderOptions options = exact;
        options.knobs->foam_steps_a_period = steps;
        settings.push_back(
            {number_text(steps) + " a period", steps == knobs.foam_steps_a_period, scene, options});
    }
    return against(scene, exact, std::move(settings));
}

}  // namespace pelagic::rows
