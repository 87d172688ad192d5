// The camera's layer. See camera.h; the format is in crate_file.h.
#include <cmath>
#include <stdexcept>

#include "plugin/usd/camera.h"
#include "plugin/usd/crate_file.h"

namespace pelagic::usd {

namespace {

// The pose changes only between these frames: up to `first` and from `last` on the camera stands still.
struct MovingFrames {
    std::int64_t first = 0;
    std::int64_t last = 0;
    double first_fov_deg = 0.0;  // of the shot's first frame
    bool zooms = false;          // the field of view changes, too
    std::uint64_t count() const { return first < last ? static_cast<std::uint64_t>(last - first) + 1 : 0; }
};

// Checks every pose of the shot too: a pose must be refused before anything is written.
MovingFrames moving_frames(const Camera& camera) {
    MovingFrames moving;
    CameraPose before;
    for (std::int64_t frame = camera.first_frame; frame <= camera.last_frame; ++frame) {
        const CameraPose pose = camera.pose_at(static_cast<int>(frame));
        check(pose, static_cast<int>(frame));
        if (frame == camera.first_frame) moving.first_fov_deg = pose.fov_deg;
        if (frame > camera.first_frame && pose != before) {
            if (moving.count() == 0) moving.first = frame - 1;
            moving.last = frame;
            moving.zooms = moving.zooms || pose.fov_deg != before.fov_deg;
        }
        before = pose;
    }
    return moving;
}

// One frame's values in the file.
struct Sample {
    glm::dvec3 translate;
    glm::dvec3 rotate_xyz_deg;
};
static_assert(sizeof(Sample) == 6 * sizeof(double), "samples lie in the file without a gap");

class Sampler {
  public:
    explicit Sampler(const Camera& camera) : camera_(camera) {}

    // Frames must come in order: each frame's angles are the nearest to those of the frame before.
    Sample at(std::int64_t frame) {
        const CameraPose pose = camera_.pose_at(static_cast<int>(frame));
        angles_deg_ = rotate_xyz_deg(pose, angles_deg_);
        return {pose.position_m, angles_deg_};
    }

  private:
    const Camera& camera_;
    glm::dvec3 angles_deg_{0.0};
};

void check(const Camera& camera) {
    check_rate(camera.fps);
    if (camera.last_frame < camera.first_frame) {
        throw std::invalid_argument("USD: the camera's last frame must not come before its first");
    }
    if (!camera.pose_at) throw std::invalid_argument("USD: the camera has no poses");
    const glm::dvec2 clipping_m = camera.clipping_m;
    if (!(clipping_m.x > 0.0 && clipping_m.y > clipping_m.x && std::isfinite(clipping_m.y))) {
        throw std::invalid_argument("USD: the camera's near distance must be above 0 and below the far one");
    }
}

// The crate refers to `camera` until it is written.
Crate camera_layer(const Camera& camera) {
    check(camera);
    const MovingFrames moving = moving_frames(camera);
    const FilmBack film = film_back(moving.first_fov_deg, camera.resolution);

    Crate crate;
    Crate::Fields layer;
    if (!camera.fingerprint.empty()) {
        const CrateValue ours = crate.dictionary("fingerprint", crate.string(camera.fingerprint));
        layer.push_back({"customLayerData", crate.dictionary("pelagic", ours)});
    }
    layer.insert(layer.end(), {{"startTimeCode", crate.real(camera.first_frame)},
                               {"endTimeCode", crate.real(camera.last_frame)}});
    crate.add_layer(kCameraName, camera.fps, layer);

    const auto real32 = [&](double number) {
        return Crate::Fields{{"default", crate.real32(static_cast<float>(number))}};
    };
    Crate::Fields translate, rotate, focal_length = real32(film.focal_length);
    if (moving.count() > 0) {
        const CrateValue times = crate.times(static_cast<double>(moving.first), moving.count());
        const std::uint64_t samples =
            crate.produced(moving.count() * sizeof(Sample), [&camera, moving](const Sink& sink) {
                PieceWriter writer(sink);
                Sampler sampler(camera);
                for (std::int64_t frame = moving.first; frame <= moving.last; ++frame)
                    writer.put(sampler.at(frame));
                writer.flush();
            });
        const auto samples_of = [&](std::function<CrateValue(std::uint64_t)> sample) {
            return Crate::Fields{
                {"timeSamples", crate.time_samples(times, moving.count(), std::move(sample))}};
        };
        const auto stored_from = [](std::uint64_t first) {
            return Crate::Stored{.type = ValueType::Vec3d, .first = first, .stride = sizeof(Sample)};
        };
        translate = samples_of(stored_from(samples));
        rotate = samples_of(stored_from(samples + sizeof(glm::dvec3)));
        if (moving.zooms)
            focal_length = samples_of([&camera, moving](std::uint64_t index) {
                const auto frame = static_cast<int>(moving.first + static_cast<std::int64_t>(index));
                const FilmBack then = film_back(camera.pose_at(frame).fov_deg, camera.resolution);
                return Crate::real32(static_cast<float>(then.focal_length));
            });
    } else {
        const Sample still = Sampler(camera).at(camera.first_frame);
        translate = {{"default", crate.stored(ValueType::Vec3d, still.translate)}};
        rotate = {{"default", crate.stored(ValueType::Vec3d, still.rotate_xyz_deg)}};
    }

    constexpr std::string_view kTranslate = "xformOp:translate", kRotate = "xformOp:rotateXYZ";
    // The first operation is the last to act on a point.
    constexpr std::string_view kOrder[] = {kTranslate, kRotate};
    const CrateValue clipping = crate.stored(ValueType::Vec2f, glm::vec2(camera.clipping_m));
    const CrateValue order = crate.token_array(kOrder);
    const std::vector<Crate::Attribute> attributes{
        {.name = "clippingRange", .type = "float2", .more = {{"default", clipping}}},
        {.name = "focalLength", .type = "float", .more = focal_length},
        {.name = "horizontalAperture", .type = "float", .more = real32(film.horizontal_aperture)},
        {.name = "projection", .type = "token", .more = {{"default", crate.token("perspective")}}},
        {.name = "verticalAperture", .type = "float", .more = real32(film.vertical_aperture)},
        {.name = kRotate, .type = "double3", .more = rotate},
        {.name = kTranslate, .type = "double3", .more = translate},
        {.name = "xformOpOrder",
         .type = "token[]",
         .variability = Variability::Uniform,
         .more = {{"default", order}}}};
    crate.add_prim(kCameraName,
                   {{"specifier", crate.specifier(Specifier::Def)}, {"typeName", crate.token("Camera")}},
                   attributes);
    crate.finish();
    return crate;
}

}  // namespace

void write_camera_crate(const Camera& camera, const Sink& sink) {
    camera_layer(camera).write(sink);
}

std::string camera_crate(const Camera& camera) {
    return gathered(camera_layer(camera));
}

}  // namespace pelagic::usd
