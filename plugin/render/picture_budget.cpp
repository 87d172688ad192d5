#include "plugin/render/picture_budget.h"

#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "core/plan/budget.h"
#include "core/plan/memory.h"
#include "core/scene/text.h"
#include "core/surface/rest_surface.h"
#include "plugin/light/light.h"
#include "plugin/machine/memory.h"
#include "plugin/render/batch.h"
#include "plugin/render/picture_cost.h"

namespace pelagic {
namespace {

// Cells of pictures with a budget [pixels]: finer ones change little, and coarser ones save little.
constexpr double kCell_px = 2.0;

// The small picture that a shot is measured on.
constexpr int kProbeWidth = 96;
constexpr int kReferenceSamples = 8;
constexpr double kReferenceCell_px = 0.5;
constexpr std::array kMeasuredSamples{1, 2, 4, 6};

struct SkyWords {
    SkyQuality quality;
    const char* words;
};
constexpr std::array kSkies = std::to_array<SkyWords>({
    {SkyQuality::Nine, "nine lookups"},
    {SkyQuality::Integral, "the integral"},
});

const char* words_of_sky(SkyQuality quality) {
    return std::find_if(kSkies.begin(), kSkies.end(),
                        [&](const SkyWords& sky) { return sky.quality == quality; })
        ->words;
}

std::vector<int> frames_to_measure(const Scene& scene) {
    constexpr int kFrames = 3;
    if (!scene.camera.keys.empty()) return representative_frames(scene, kFrames);
    return {scene.shot.first_frame + (scene.shot.last_frame - scene.shot.first_frame) / 2};
}

// How a shot's pictures err: by the number of samples (kMeasuredSamples) with nine lookups against eight times eight, and
// by the lookups alone. Percentiles don't add like this, but their root of squares is rarely exceeded.
struct MeasuredErrors {
    std::array<double, kMeasuredSamples.size()> by_samples{};
    double of_nine = 0.0;
    std::size_t bytes = 0;  // that measuring them held

    // Between the numbers that were measured, as a power of them.
    double at(int samples) const {
        std::size_t i = 1;
        while (i + 1 < kMeasuredSamples.size() && kMeasuredSamples[i] < samples) ++i;
        const double from = kMeasuredSamples[i - 1], to = kMeasuredSamples[i];
        const double t = std::log(samples / from) / std::log(to / from);
        constexpr double kLeast = 1e-9;
        return std::exp(std::lerp(std::log(std::max(by_samples[i - 1], kLeast)),
                                  std::log(std::max(by_samples[i], kLeast)), t));
    }
};

// Of first-shot, 160 pixels wide: by which settings are put in order where nothing is measured.
constexpr MeasuredErrors kTypical{{0.33, 0.22, 0.13, 0.09}, 0.07, 0};

MeasuredErrors measured(const Scene& scene, std::size_t max_memory_bytes, const BuildWatch& watch) {
    Scene small = scene;
    small.effects.foam_decay_s =
        0.0;  // the foam's past takes most of the time, and hardly changes how pictures err
    const double shape = static_cast<double>(scene.camera.resolution.y) / scene.camera.resolution.x;
    const double width = kProbeWidth * std::min(1.0, 1.0 / shape);
    small.camera.resolution = {std::max(1, static_cast<int>(std::lround(width))),
                               std::max(1, static_cast<int>(std::lround(width * shape)))};
    const std::vector<int> frames = frames_to_measure(scene);
    const Sky sky = make_sky(scene);
    RenderOptions own = render_options(scene);
    own.knobs = Knobs{.double_precision = true};
    MeasuredErrors errors;
    {
        RenderOptions dearest = own;
        dearest.samples = kReferenceSamples;
        Scene fine = small;
        fine.surface.cell_px = kReferenceCell_px;
        const MemoryNeed need = render_memory(fine, dearest, frames, std::nullopt,
                                              oneapi::tbb::this_task_arena::max_concurrency());
        errors.bytes = need.bytes();
        require_memory(need, machine::memory_limit_or(max_memory_bytes),
                       "measuring this shot for its budget");
    }
    double done = 0.0;
    const double all =
        static_cast<double>(frames.size()) * (5.0 + 4 * 0.75 + 1.0);  // about: weights of a frame's pictures
    const auto picture = [&](int frame, double cell_px, int samples, SkyQuality quality, double weight) {
        small.surface.cell_px = cell_px;
        RenderOptions options = own;
        options.samples = samples;
        options.lighting.sky_quality = quality;
        Picture made;
        Renderer renderer(small, options, sky, std::span(&frame, 1),
                          {.progress = {}, .cancel = watch.cancel});
        renderer.render(frame, made, {.progress = {}, .cancel = watch.cancel});
        done += weight;
        if (watch.progress) watch.progress(std::min(done / all, 1.0));
        return made;
    };
    const auto measure = [&](int frame) {
        const Picture reference = picture(frame, kReferenceCell_px, kReferenceSamples, SkyQuality::Nine, 5.0);
        std::optional<Picture> one;
        for (std::size_t i = 0; i < kMeasuredSamples.size(); ++i) {
            Picture made = picture(frame, kCell_px, kMeasuredSamples[i], SkyQuality::Nine, 0.75);
            errors.by_samples[i] = std::max(errors.by_samples[i], relative_error(made, reference).most);
            if (i == 0) one = std::move(made);
        }
        const Picture integral = picture(frame, kCell_px, 1, SkyQuality::Integral, 1.0);
        errors.of_nine = std::max(errors.of_nine, relative_error(*one, integral).most);
    };
    std::string under_water;  // why the last one that was passed over can't be rendered
    std::size_t measured_frames = 0;
    for (const int frame : frames) {
        try {
            measure(frame);
            ++measured_frames;
        } catch (const std::invalid_argument& error) {
            under_water = error.what();
        }
    }
    if (measured_frames == 0) throw std::invalid_argument(under_water);
    return errors;
}

// The shot's own, with what isn't left to the budget.
RenderOptions fixed_options(const Scene& scene, const FixedSettings& fixed) {
    RenderOptions options = render_options(scene);
    options.samples = fixed.samples.value_or(options.samples);
    options.lighting.sky_quality = fixed.sky_quality.value_or(options.lighting.sky_quality);
    options.shutter_frames = fixed.shutter_frames;
    options.layers = fixed.layers;
    return options;
}

// All that a budget chooses from, from few samples to many.
std::vector<PricedSetting> settings_of(const Scene& scene, const FixedSettings& fixed,
                                       const MeasuredErrors& errors) {
    const std::vector<int> frames = frames_to_measure(scene);
    std::vector<PricedSetting> settings;
    const int fewest = fixed.samples.value_or(kMeasuredSamples.front()),
              most = fixed.samples.value_or(kMeasuredSamples.back());
    for (int samples = fewest; samples <= most; ++samples) {
        RenderOptions options = fixed_options(scene, fixed);
        options.samples = samples;
        try {
            check_render(scene, options);
        } catch (const std::invalid_argument&) {
            if (samples == fewest) throw;
            break;  // more samples a side than a picture has
        }
        const Plan plan = picture_plan(of_samples(scene, samples), frames, options);
        for (const SkyWords& sky : kSkies) {
            if (fixed.sky_quality && *fixed.sky_quality != sky.quality) continue;
            options.lighting.sky_quality = sky.quality;
            const double of_sky = sky.quality == SkyQuality::Integral ? 0.0 : errors.of_nine;
            settings.push_back({options, std::hypot(errors.at(samples), of_sky),
                                picture_ms(picture_work(plan, frames, options))});
        }
    }
    return settings;
}

}  // namespace

RelativeError relative_error(const Picture& picture, const Picture& reference) {
    std::vector<double> off;
    double sum = 0.0;
    for (std::size_t i = 0; i < reference.layers.size(); ++i) {
        if (!picture.sea[i] || !reference.sea[i]) continue;
        const glm::dvec3 seen(radiance_of(picture.layers[i])), exact(radiance_of(reference.layers[i]));
        const double scale = glm::length(exact);
        off.push_back(glm::length(seen - exact) / (scale > 0.0 ? scale : 1.0));
        sum += off.back();
    }
    if (off.empty()) return {};
    const auto at = off.begin() + static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(off.size() - 1));
    std::nth_element(off.begin(), at, off.end());
    return {*at, sum / static_cast<double>(off.size())};
}

PictureSettings reference_settings(const Scene& scene) {
    PictureSettings reference{without_budget(scene), {}};
    reference.scene.surface.cell_px = kReferenceCell_px;
    reference.options = render_options(reference.scene);
    reference.options.samples = kReferenceSamples;
    reference.options.lighting.sky_quality = SkyQuality::Integral;
    reference.options.lighting.fresnel = FresnelFit::Exact;
    return reference;
}

PictureBudget picture_budget(const Scene& scene, const FixedSettings& fixed, std::size_t max_memory_bytes,
                             const BuildWatch& watch) {
    PictureBudget budget{.scene = without_budget(scene), .options = {}};
    const bool is_known = std::any_of(kSkies.begin(), kSkies.end(), [&](const SkyWords& sky) {
        return !fixed.sky_quality || *fixed.sky_quality == sky.quality;
    });
    if (!has_budget(scene.quality) || !is_known || (fixed.samples && fixed.sky_quality)) {
        budget.options = fixed_options(budget.scene, fixed);
        return budget;
    }
    budget.scene.quality.level = QualityLevel::Final;
    budget.scene.surface.cell_px = kCell_px;
    const auto [max_error, most_ms] = std::pair(scene.quality.max_error, scene.quality.frame_ms);
    const MeasuredErrors errors = max_error ? measured(budget.scene, max_memory_bytes, watch) : kTypical;
    budget.measuring_bytes = errors.bytes;
    const std::vector<PricedSetting> settings = settings_of(budget.scene, fixed, errors);
    std::optional<PricedSetting> best;
    for (const PricedSetting& setting : settings) {
        const bool holds = max_error ? setting.error <= *max_error : setting.ms <= *most_ms;
        if (!holds) continue;
        if (!best || (max_error ? setting.ms < best->ms : setting.error < best->error)) best = setting;
    }
    budget.settings = settings;
    if (!max_error)
        for (PricedSetting& setting : budget.settings)
            setting.error = std::numeric_limits<double>::quiet_NaN();
    budget.holds = best.has_value();
    if (!best)
        best = *std::min_element(settings.begin(), settings.end(),
                                 [&](const PricedSetting& a, const PricedSetting& b) {
                                     return max_error ? a.error < b.error : a.ms < b.ms;
                                 });
    budget.options = best->options;
    budget.error = max_error ? best->error : std::numeric_limits<double>::quiet_NaN();
    budget.ms = best->ms;
    budget.text =
        text_of_budget(scene.quality, budget.holds) + " pictures have " +
        std::to_string(best->options.samples) + " × " + std::to_string(best->options.samples) +
        " samples a pixel and " + words_of_sky(best->options.lighting.sky_quality) + " of the sky" +
        (max_error ? ", an error of " + rough_text(best->error) : std::string()) + " and about " +
        rough_text(best->ms) + " ms a picture" +
        (errors.bytes > 0 ? "; measured on a small picture, which held about " + bytes_text(errors.bytes)
                          : std::string());
    return budget;
}

}  // namespace pelagic
