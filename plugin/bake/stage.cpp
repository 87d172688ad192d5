#include "plugin/bake/stage.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <variant>

#include "core/plan/hidden_slopes.h"
#include "core/scene/keys.h"
#include "core/scene/names.h"
#include "core/surface/view.h"
#include "plugin/usd/camera.h"
#include "plugin/usd/text.h"

namespace pelagic {
namespace {

// UsdPreviewSurface's roughness: α² = 2σ² with σ² = mss/2 along each axis, roughness = √α.
double preview_roughness(double mss) {
    return std::min(std::sqrt(std::sqrt(std::max(mss, 0.0))), 1.0);
}

// What the finest cells of the shot's first frame hide: the stage has one material for all frames, which must
// not depend on which of them are baked.
double roughness(const Plan& plan) {
    const std::array first{plan.from->scene.shot.first_frame};
    return preview_roughness(hidden_mean_square_slope(plan.from->spectrum, plan.filter,
                                                      plan.surface->needs(first).finest_pixel_m));
}

// A key in the stage's metadata: truths, integers, numbers and points as such, the rest as a shot file writes
// it.
usd::CustomValue custom_value(const DescribedKey& key) {
    if (const auto* truth = std::get_if<bool>(&key.value)) return *truth;
    if (const auto* integer = std::get_if<std::int64_t>(&key.value)) return *integer;
    if (const auto* point = std::get_if<std::vector<double>>(&key.value)) return *point;
    return std::visit([](const auto& value) { return usd::CustomValue(value); }, key.number_or_text());
}

usd::Camera camera_of(const Scene& scene) {
    return {
        .fps = scene.shot.fps,
        .first_frame = scene.shot.first_frame,
        .last_frame = scene.shot.last_frame,
        .pose_at =
            [&scene](int frame) {
                const View view = view_at(scene.camera, frame);
                return usd::CameraPose{view.position_m, view.right, view.up, -view.forward, view.fov_deg()};
            },
        .resolution = scene.camera.resolution};
}

usd::Stage stage_of(const Plan& plan, const OutputPart& mesh) {
    const Scene& scene = plan.from->scene;
    const Shot& shot = scene.shot;
    const ProductSet& products = mesh.query().products;
    usd::Stage stage;
    stage.name = shot.name;
    stage.first_frame = shot.first_frame;
    stage.last_frame = shot.last_frame;
    stage.fps = shot.fps;
    stage.attributes = {.normals = products[index(Product::Normal)],
                        .velocities = products[index(Product::Velocity)],
                        .slope_variance = products[index(Product::SlopeVariance)],
                        .whitecap_coverage = products[index(Product::Coverage)],
                        .faces = !plan.surface->is_constant(),
                        .origin = !plan.surface->is_constant()};
    stage.frame_extension = stage.topology_extension = std::string(word_of(scene.output.mesh));
    stage.material.roughness = roughness(plan);
    stage.has_camera = true;
    // Its upper edge sets half a degree after its centre has.
    if (constexpr double kDiscRadius_deg = 0.27; scene.light.sun_elevation_deg > -kDiscRadius_deg)
        stage.sun = usd::Sun{.elevation_deg = scene.light.sun_elevation_deg,
                             .azimuth_deg = scene.light.sun_azimuth_deg};
    stage.sky = usd::Sky{};
    stage.custom_data = {
        {"version", std::string(PELAGIC_VERSION)},
        {"fingerprint", mesh.fingerprint()},
        {"significant_height_m", 4.0 * std::sqrt(plan.from->spectrum.m0())},
    };
    for (const DescribedKey& key : described(scene, feeds(Feed::Clock, Feed::Waves, Feed::Foam)))
        stage.custom_data.push_back({key.identifier(), custom_value(key)});
    return stage;
}

}  // namespace

void write_stage(const Plan& plan, const OutputPart& mesh, const FileSink& sink) {
    const std::string& name = plan.from->scene.shot.name;
    sink({.path = usd::camera_file(name), .fingerprint = {}, .content = [&](const usd::Sink& take) {
              usd::write_camera_crate(camera_of(plan.from->scene), take);
          }});
    sink({.path = usd::root_file(name), .fingerprint = {}, .content = [&](const usd::Sink& take) {
              take(usd::root_text(stage_of(plan, mesh)));
          }});
}

}  // namespace pelagic
