#include "plugin/render/picture_cost.h"

#include <algorithm>
#include <glm/vec2.hpp>

#include "core/surface/view.h"
#include "plugin/render/spray_map.h"

namespace pelagic {
namespace {

// [ms] of each LightWork.
constexpr LightWorkDone kMs{2400.0, 31000.0, 50.0, 3000.0, 600.0};
// Pictures look at few tiles of foam on many levels, each of which has a sea of its own, and pay more for each than bakes.
constexpr double kFoamOfPictures = 4.0;

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

// Of a plan whose points are those of the camera's grid: with the samples that show the sea, and at so many moments. A point of the
// grid asks for its position alone, which about half of the fields answer. The foam's past is as long with a shutter as without,
// and adding it up again at each moment takes little beside (bench_cost_model has shutters).
WorkDone with_samples(WorkDone work, double points, double samples, double moments) {
    const double points_factor = 0.5 * moments + samples / points;
    for (std::size_t i = 0; i < kWorkCount; ++i) switch (static_cast<Work>(i)) {
            case Work::Frame:
            case Work::Transforms:
            case Work::Modes:
                work[i] *= moments;
                break;
            case Work::Reads:
            case Work::Trains:
            case Work::Answers:
                work[i] *= points_factor;
                break;
            case Work::Foam:
                work[i] *= kFoamOfPictures;
                break;
        }
    return work;
}

}  // namespace

PictureWork picture_work(const Plan& plan, std::span<const int> frames, const RenderOptions& options) {
    const Camera& camera = plan.from->scene.camera;
    const std::size_t moments = moments_of(frames.front(), options).size();
    double water = 0.0;
    for (const int frame : frames) water = std::max(water, water_share(camera, frame));
    const double samples = 1e-6 * camera.resolution.x * camera.resolution.y;
    const double points = 1e-6 * static_cast<double>(plan.queries.front().query.points);
    PictureWork work{
        .sea = with_samples(work_of(plan), points, water * samples, static_cast<double>(moments)),
        .double_precision = plan.knobs.double_precision};
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
