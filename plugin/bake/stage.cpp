#include "plugin/bake/stage.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <glm/common.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "core/base/constants.h"
#include "core/lighting/lighting.h"
#include "core/plan/unresolved_slopes.h"
#include "core/plan/weather.h"
#include "core/scene/keys.h"
#include "core/scene/names.h"
#include "core/scene/number_keys.h"
#include "core/surface/view.h"
#include "pelagic/version.h"
#include "plugin/bake/sky_part.h"
#include "plugin/bake/volumes.h"
#include "plugin/files/files.h"
#include "plugin/format/usd/camera.h"
#include "plugin/format/usd/text.h"
#include "plugin/format/usd/volumes.h"
#include "plugin/light/light.h"
#include "plugin/run/part.h"

namespace pelagic {
namespace {

// UsdPreviewSurface's roughness: α² = 2σ² with σ² = mss/2 along each axis, roughness = √α.
double preview_roughness(double mss) {
    return std::min(std::sqrt(std::sqrt(std::max(mss, 0.0))), 1.0);
}

// The slopes that the finest cells of the shot's first frame leave unresolved: the stage has one material for all
// frames, which must not depend on which of them are baked. Of a sea that changes, those of its mean.
double roughness(const Plan& plan) {
    const std::array first{plan.from->scene.shot.first_frame};
    return preview_roughness(unresolved_mean_square_slope(plan.from->spectrum, plan.filter,
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
    std::vector<int> key_frames;
    for (const CameraKey& key : scene.camera.keys) key_frames.push_back(key.frame);
    return {
        .fps = scene.shot.fps,
        .first_frame = scene.shot.first_frame,
        .last_frame = scene.shot.last_frame,
        .key_frames = std::move(key_frames),
        .pose_at =
            [&scene](int frame) {
                const View view = view_at(scene.camera, frame);
                return usd::CameraPose{view.position_m, view.right, view.up, -view.forward, view.fov_deg()};
            },
        .resolution = scene.camera.resolution,
        .film_width_mm = scene.camera.sensor_width_mm,
        .shift = {scene.camera.shift_x, scene.camera.shift_y},
        .f_stop = scene.camera.f_stop,
        .focus_distance_m = scene.camera.focus_distance_m};
}

constexpr double kDegrees = 180.0 / kPi;

// Of an intensity of 0 after sunset, and where a picture of a sky has none.
usd::Sun sun_of(const Sky& sky) {
    const double radius = static_cast<double>(sky.sun_angular_radius);
    const glm::dvec3 irradiance = glm::dvec3(sky.sun_radiance) * (kPi * radius * radius);  // across its rays
    // As colours are shown and edited: from 0 to 1.
    const double brightest = std::max({irradiance.x, irradiance.y, irradiance.z});
    const glm::dvec3 towards(sky.sun_direction);
    return {.elevation_deg = std::atan2(towards.z, std::hypot(towards.x, towards.y)) * kDegrees,
            .azimuth_deg = std::atan2(towards.y, towards.x) * kDegrees,
            .angle_deg = 2.0 * radius * kDegrees,
            .intensity = brightest,
            .color = brightest > 0.0 ? glm::vec3(irradiance / brightest) : glm::vec3(1.0f)};
}

// What a light that rests leaves in a bake.
struct StageLight {
    std::string fingerprint;
    std::string dome;  // the file
    usd::Sun sun;
};

// It takes a tenth of a second and more, longer than the start of a small bake. The last one is kept: hosts bake again and again
// under the same light, and it is made before anything else is done.
std::shared_ptr<const StageLight> light_of(const Scene& scene) {
    static std::mutex mutex;
    static std::shared_ptr<const StageLight> last;
    std::string fingerprint = sky_fingerprint(scene, sky_content(scene));
    {
        const std::lock_guard lock(mutex);
        if (last && last->fingerprint == fingerprint) return last;
    }
    // Without the lock: a thread that waits inside for the others may be given another bake's work.
    const Sky sky = make_sky(scene);
    std::string dome = dome_file(scene, sky, fingerprint);
    const auto light =
        std::make_shared<const StageLight>(StageLight{std::move(fingerprint), std::move(dome), sun_of(sky)});
    const std::lock_guard lock(mutex);
    last = light;
    return light;
}

// Without keys. It needs no sky.
usd::Sun sun_by_day(const Scene& scene) {
    return sun_of(daylight_sun(daylight_of(scene.light)));
}

// A picture of a sky that turns, or changes its gain: as it lies, by the largest gain, which finds all that is wrong with it.
Scene with_picture_alone(const Scene& scene) {
    Scene alone = scene_at(scene, scene.shot.first_frame);
    alone.light.sky_gain = scene.light.sky_gain > 0.0 ? scene.light.sky_gain : 1.0;
    alone.light.sky_rotation_deg = 0.0;
    return alone;
}

// Of these frames, under a light that changes. No sky is made for it: each is its frame's (sky_part.cpp).
std::vector<usd::FrameLight> changing_light(const Scene& scene, std::span<const int> frames) {
    const Scene alone = with_picture_alone(scene);
    const usd::Sun of_picture = has_sky_picture(scene) ? light_of(alone)->sun : usd::Sun{};
    const auto sun_at = [&](const Scene& now) {
        if (!has_sky_picture(scene)) return sun_by_day(now);
        usd::Sun sun = of_picture;
        sun.azimuth_deg += now.light.sky_rotation_deg;
        sun.intensity *= now.light.sky_gain / alone.light.sky_gain;
        return sun;
    };
    std::vector<usd::FrameLight> all;
    std::optional<Scene> lit;
    usd::Sun sun;
    for (const int frame : frames) {
        Scene now = scene_at(scene, frame);
        if (!lit || !same_sky(*lit, now)) {
            const double before_deg = sun.azimuth_deg;
            sun = sun_at(now);
            // Hosts go straight from one angle to the next.
            if (lit) sun.azimuth_deg = before_deg + std::remainder(sun.azimuth_deg - before_deg, 360.0);
            lit = std::move(now);
        }
        all.push_back({frame, sun, {.lat_long_file = "./" + dome_pattern(scene.shot).file(frame)}});
    }
    return all;
}

usd::Material material_of(const Plan& plan, const WaterBody& water) {
    const SeaAlbedo albedo = sea_albedo(water);
    // As decimals: the float 1.34 isn't.
    return {.ior = std::round(static_cast<double>(albedo.water_index) * 1e6) / 1e6,
            .roughness = roughness(plan),
            .color = albedo.water,
            .whitecap_color = albedo.foam,
            .absorption_per_m = water.absorption_per_m,
            .scattering_per_m = 2.0f * water.backscatter_per_m};
}

// The volumes of the shot; none: the plan has none.
std::vector<usd::Volume> volumes_of(const Plan& plan) {
    std::vector<usd::Volume> volumes;
    for (const PlannedOutput& output : plan.outputs) {
        if (!output.volume) continue;
        usd::Volume volume = volume_prim(plan, *output.volume);
        volume.file_prefix = volume_pattern(plan.from->scene, *output.volume).prefix;
        volumes.push_back(std::move(volume));
    }
    return volumes;
}

// Round a surface that stays where it is, at all frames: by expectation, as the sea's own extent (core/plan/extent.h), and with its volumes.
std::optional<usd::Extent> extents_of(const Plan& plan) {
    // How high drops fly nothing says beforehand.
    if (!plan.surface->is_constant() || plan.from->scene.output.drops) return {};
    RestPoints<float> points;
    plan.surface->points_at(plan.from->scene.shot.first_frame, points);
    if (points.rest_m.empty() || points.curvature_per_m != 0.0) return {};
    glm::vec2 low(points.rest_m.front()), high = low;
    for (const glm::vec2& at : points.rest_m) {
        low = glm::min(low, at);
        high = glm::max(high, at);
    }
    float lowest = 0.0f, highest = 0.0f;
    for (const float height_m : points.height_m) {
        lowest = std::min(lowest, height_m);
        highest = std::max(highest, height_m);
    }
    const Extent& sea = plan.from->extent;
    const glm::vec2 origin(points.origin_m);
    const auto reach = static_cast<float>(sea.reach_m), height = static_cast<float>(sea.height_m);
    // A cage's normals point anywhere: so do its waves.
    const float beside = points.normal.empty() ? reach : reach + height;
    const float above = points.normal.empty() ? height : reach + height;
    usd::Extent extent{glm::vec3(origin + low - beside, lowest - above),
                       glm::vec3(origin + high + beside, highest + above)};
    for (const usd::Volume& volume : volumes_of(plan)) {
        extent[0] = glm::min(extent[0], volume.extent[0]);
        extent[1] = glm::max(extent[1], volume.extent[1]);
    }
    return extent;
}

usd::Stage stage_of(const Plan& plan, const OutputPart& mesh, std::vector<usd::FrameLight> light) {
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
                        .foam_history = plan.foam && products[index(Product::Coverage)],
                        .wet = mesh.meets_hulls(),
                        .faces = !plan.surface->has_constant_faces(),
                        .origin = plan.surface->has_origin(),
                        .st_of_corners = plan.surface->has_st_of_corners()};
    stage.points_follow_camera = !plan.surface->is_constant();
    stage.origin_follows_camera = plan.surface->origin_follows_camera();
    stage.frame_extension = stage.topology_extension = std::string(word_of(scene.output.mesh));
    const WaterBody body = make_water(scene_at(scene, shot.first_frame), plan.from->spectrum);
    stage.material = material_of(plan, body);
    stage.has_camera = true;
    stage.has_volumes = !volumes_of(plan).empty();
    stage.has_drops = scene.output.drops;
    stage.extents_hint = extents_of(plan);
    if (changes(scene, "light")) {
        stage.light = std::move(light);
    } else {
        if (light.front().sun.intensity > 0.0) stage.sun = light.front().sun;
        stage.sky = light.front().sky;
    }
    stage.custom_data = {
        {"version", std::string(PELAGIC_VERSION)},
        {"fingerprint", mesh.fingerprint()},
        // The sun's intensity times its colour is its irradiance across its rays: the same unit times steradian.
        {"sky_unit", radiance_unit(scene)},
        {"significant_height_m", 4.0 * std::sqrt(plan.from->spectrum.m0())},
    };
    if (const WaterText water = water_text(body); !water.wavelengths_nm.empty())
        stage.custom_data.insert(stage.custom_data.end(),
                                 {{"water_wavelengths_nm", water.wavelengths_nm},
                                  {"water_absorption_per_m", water.absorption_per_m},
                                  {"water_backscatter_per_m", water.backscatter_per_m}});
    for (const DescribedKey& key :
         described(scene, key_parts(KeyPart::Clock, KeyPart::Waves, KeyPart::Foam, KeyPart::Gusts)))
        stage.custom_data.push_back({key.identifier(), custom_value(key)});
    return stage;
}

}  // namespace

std::size_t camera_layer_bytes(const Scene& scene) {
    std::size_t bytes = 0;
    usd::write_camera_crate(camera_of(scene), [&](std::string_view piece) { bytes += piece.size(); });
    return bytes;
}

void prepare_light(const Scene& scene, const std::filesystem::path& folder) {
    const Scene first = scene_at(scene, scene.shot.first_frame);
    if (has_sky_picture(scene))
        light_of(changes(scene, "light") ? with_picture_alone(scene) : first);
    else if (!changes(scene, "light") &&
             !files::carries(folder / usd::sky_file(scene.shot.name), sky_fingerprint(first, {})))
        light_of(first);
}

void write_stage(const Plan& plan, const OutputPart& mesh, std::span<const int> frames,
                 const FileSink& sink) {
    const Scene& scene = plan.from->scene;
    const std::string& name = scene.shot.name;
    std::vector<usd::FrameLight> light;
    if (changes(scene, "light")) {
        light = changing_light(scene, frames);
    } else {
        const Scene lit = scene_at(scene, scene.shot.first_frame);
        const std::string file = usd::sky_file(name);
        std::shared_ptr<const StageLight> made;
        if (has_sky_picture(scene)) made = light_of(lit);
        sink({.path = file,
              .content =
                  [&](const usd::Sink& take) {
                      if (!made) made = light_of(lit);
                      take(made->dome);
                  },
              .fingerprint = made ? made->fingerprint : sky_fingerprint(lit, {})});
        light = {
            {scene.shot.first_frame, made ? made->sun : sun_by_day(lit), {.lat_long_file = "./" + file}}};
    }
    sink({.path = usd::camera_file(name),
          .content = [&](const usd::Sink& take) { usd::write_camera_crate(camera_of(scene), take); }});
    if (std::vector<usd::Volume> volumes = volumes_of(plan); !volumes.empty()) {
        const usd::VolumeLayer layer{.fps = scene.shot.fps,
                                     .first_frame = scene.shot.first_frame,
                                     .last_frame = scene.shot.last_frame,
                                     .frames = {frames.begin(), frames.end()},
                                     .volumes = std::move(volumes)};
        sink({.path = usd::volumes_file(name),
              .content = [&](const usd::Sink& take) { usd::write_volumes_text(layer, take); }});
    }
    sink({.path = usd::root_file(name),
          .content = [&](const usd::Sink& take) { take(usd::root_text(stage_of(plan, mesh, light))); }});
}

}  // namespace pelagic
