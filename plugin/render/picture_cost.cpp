#include "plugin/render/picture_cost.h"

#include <algorithm>
#include <glm/vec2.hpp>

#include "core/surface/view.h"
#include "plugin/render/spray_map.h"

namespace pelagic {
namespace {

// [ms] of each LightWork.
constexpr LightWorkDone kMs{1800.0, 27000.0, 50.0, 0.0, 0.0};

double& at(LightWorkDone& work, LightWork what) {
    return work[static_cast<std::size_t>(what)];
}

double water_share(const Camera& camera, int frame) {
    constexpr int kLines = 64;
    const View view = view_at(camera, frame);
    int water = 0;
    for (int y = 0; y < kLines; ++y)
        for (int x = 0; x < kLines; ++x)
            water += view.direction((glm::dvec2(x, y) + 0.5) / static_cast<double>(kLines) *
                                    glm::dvec2(view.resolution))
                         .z < 0.0;
    return static_cast<double>(water) / (kLines * kLines);
}

// The sea's own at each moment; of the foam's past all of it once, and then what is between the first moment and the last.
WorkDone at_moments(WorkDone work, const Plan& plan, const RenderOptions& options, std::size_t moments) {
    constexpr auto kFoam = static_cast<std::size_t>(Work::Foam);
    for (std::size_t i = 0; i < kWorkCount; ++i)
        if (i != kFoam) work[i] *= static_cast<double>(moments);
    if (plan.foam) {
        const Shot& shot = plan.from->scene.shot;
        const double open_s = options.shutter_frames * shot.time_scale / shot.fps;
        work[kFoam] *= 1.0 + open_s / plan.foam->step_s / plan.foam->intervals();
    }
    return work;
}

}  // namespace

PictureWork picture_work(const Plan& plan, std::span<const int> frames, const RenderOptions& options) {
    const Camera& camera = plan.from->scene.camera;
    const std::size_t moments = moments_of(frames.front(), options).size();
    PictureWork work{.sea = at_moments(work_of(plan), plan, options, moments),
                     .double_precision = plan.knobs.double_precision};
    double water = 0.0;
    for (const int frame : frames) water = std::max(water, water_share(camera, frame));
    const double samples = 1e-6 * camera.resolution.x * camera.resolution.y;
    const bool is_integral = options.lighting.sky_quality == SkyQuality::Integral;
    at(work.light, is_integral ? LightWork::SeaByIntegral : LightWork::SeaByLookups) = water * samples;
    at(work.light, LightWork::Sky) = (1.0 - water) * samples;
    if (options.lighting.spray) {
        const SprayMapSize map = spray_map_size(camera.resolution.x);
        at(work.light, LightWork::SprayTexels) = 1e-6 * map.columns * map.rows * static_cast<double>(moments);
        at(work.light, LightWork::SpraySamples) = samples;
    }
    return work;
}

double picture_ms(const PictureWork& work) {
    double ms = cost_ms(work.sea, work.double_precision);
    for (std::size_t i = 0; i < kLightWorkCount; ++i) ms += kMs[i] * work.light[i];
    return ms;
}

}  // namespace pelagic
