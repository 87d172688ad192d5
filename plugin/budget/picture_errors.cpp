#include "plugin/budget/picture_errors.h"

#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>

#include "core/plan/memory.h"
#include "core/scene/budget.h"
#include "core/scene/number_keys.h"
#include "core/surface/rest_surface.h"
#include "plugin/light/light.h"
#include "plugin/machine/memory.h"

namespace pelagic {
namespace {

// The small picture that a shot is measured on.
constexpr int kProbeWidth = 96;
constexpr int kReferenceSamples = 8;
constexpr double kReferenceCell_px = 0.5;

}  // namespace

std::vector<int> frames_to_measure(const Scene& scene) {
    constexpr int kFrames = 3;
    if (!scene.camera.keys.empty()) return representative_frames(scene, kFrames);
    return {scene.shot.first_frame + (scene.shot.last_frame - scene.shot.first_frame) / 2};
}

double MeasuredErrors::at(int samples) const {
    std::size_t i = 1;
    while (i + 1 < kMeasuredSamples.size() && kMeasuredSamples[i] < samples) ++i;
    const double from = kMeasuredSamples[i - 1], to = kMeasuredSamples[i];
    const double t = std::log(samples / from) / std::log(to / from);
    constexpr double kLeast = 1e-9;
    return std::exp(std::lerp(std::log(std::max(by_samples[i - 1], kLeast)),
                              std::log(std::max(by_samples[i], kLeast)), t));
}

MeasuredErrors measured_errors(const Scene& scene, std::size_t max_memory_bytes, const BuildWatch& watch) {
    Scene small = scene;
    small.effects.foam_decay_s =
        0.0;  // the foam's past takes most of the time, and hardly changes how pictures err
    const double shape = static_cast<double>(scene.camera.resolution.y) / scene.camera.resolution.x;
    const double width = kProbeWidth * std::min(1.0, 1.0 / shape);
    small.camera.resolution = {std::max(1, static_cast<int>(std::lround(width))),
                               std::max(1, static_cast<int>(std::lround(width * shape)))};
    const std::vector<int> frames = frames_to_measure(scene);
    const Sky sky = make_sky(scene_at(scene, frames.front()));
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
            Picture made = picture(frame, kPictureCell_px, kMeasuredSamples[i], SkyQuality::Nine, 0.75);
            errors.by_samples[i] = std::max(errors.by_samples[i], relative_error(made, reference).most);
            if (i == 0) one = std::move(made);
        }
        const Picture integral = picture(frame, kPictureCell_px, 1, SkyQuality::Integral, 1.0);
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
    // Of a few pixels more samples may be measured to err by more: fewer then count as no better.
    for (std::size_t i = kMeasuredSamples.size() - 1; i > 0; --i)
        errors.by_samples[i - 1] = std::max(errors.by_samples[i - 1], errors.by_samples[i]);
    return errors;
}

RelativeError relative_error(const Picture& picture, const Picture& reference) {
    std::vector<double> off;
    double sum = 0.0;
    for (std::size_t i = 0; i < reference.layers.size(); ++i) {
        if (!picture.sea[i] || !reference.sea[i]) continue;
        const glm::dvec3 seen(light_of(picture, i)), exact(light_of(reference, i));
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

}  // namespace pelagic
