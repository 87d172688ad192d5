// The camera's layer. See camera.h; the format is in crate_file.h.
#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <memory>
#include <stdexcept>

#include "plugin/format/usd/camera.h"
#include "plugin/format/usd/crate_file.h"

namespace pelagic::usd {

namespace {

static_assert(sizeof(CameraSample) == 6 * sizeof(double), "samples lie in the file without a gap");

// Takes poses of rising frames, each frame's angles the nearest to those of the frame before.
class Sampler {
  public:
    explicit Sampler(const Camera& camera) : camera_(camera) {}

    CameraPose pose_at(std::int64_t frame) const {
        CameraPose pose = camera_.pose_at(static_cast<int>(frame));
        check(pose, static_cast<int>(frame));
        return pose;
    }
    CameraSample sample_of(const CameraPose& pose, const glm::dvec3& before_deg) const {
        return {pose.position_m, rotate_xyz_deg(pose, before_deg)};
    }
    double focal_length(const CameraPose& pose) const {
        return film_back(pose.fov_deg, camera_.resolution, camera_.film_width_mm).focal_length;
    }

    // Puts samples at `last` and, since the one of `before`, wherever lines between them are too far off.
    void put_until(std::int64_t last, std::int64_t before, Course& course) const {
        std::int64_t step = last - before;
        while (before < last) {
            step = std::min(step, last - before);
            while (step > 1 && !is_straight(before, before + step, course.samples.back())) step /= 2;
            before += step;
            put(before, course);
            step *= 2;  // the next one may be longer
        }
    }
    void put(std::int64_t frame, Course& course) const {
        const CameraPose pose = pose_at(frame);
        course.frames.push_back(static_cast<double>(frame));
        course.samples.push_back(
            sample_of(pose, course.samples.empty() ? glm::dvec3(0.0) : course.samples.back().rotate_xyz_deg));
        course.focal_lengths.push_back(static_cast<float>(focal_length(pose)));
    }

  private:
    // Looked at in seven places between.
    bool is_straight(std::int64_t from, std::int64_t to, const CameraSample& start) const {
        constexpr int kParts = 8;
        constexpr double kPlace_m = 2e-4, kTurn_px = 0.02, kFocal = 1e-5;
        const CameraPose first = pose_at(from), last = pose_at(to);
        const CameraSample end = sample_of(last, start.rotate_xyz_deg);
        const double pixel_deg = first.fov_deg / camera_.resolution.x;
        for (int part = 1; part < kParts; ++part) {
            const std::int64_t frame = from + (to - from) * part / kParts;
            const double share = static_cast<double>(frame - from) / static_cast<double>(to - from);
            const CameraPose pose = pose_at(frame);
            const glm::dvec3 turn_deg = glm::mix(start.rotate_xyz_deg, end.rotate_xyz_deg, share);
            const CameraSample there = sample_of(pose, turn_deg);
            const double focal = glm::mix(focal_length(first), focal_length(last), share);
            if (glm::distance(pose.position_m, glm::mix(first.position_m, last.position_m, share)) >
                    kPlace_m ||
                glm::length(there.rotate_xyz_deg - turn_deg) > kTurn_px * pixel_deg ||
                std::abs(focal_length(pose) / focal - 1.0) > kFocal)
                return false;
        }
        return true;
    }

    const Camera& camera_;
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

Crate camera_layer(const Camera& camera) {
    check(camera);
    const auto course = std::make_shared<const Course>(course_of(camera));
    const FilmBack film =
        film_back(camera.pose_at(camera.first_frame).fov_deg, camera.resolution, camera.film_width_mm);

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
    // What has samples has the first frame's value as well, for who asks at no time.
    Crate::Fields translate{{"default", crate.stored(ValueType::Vec3d, course->first.translate)}},
        rotate{{"default", crate.stored(ValueType::Vec3d, course->first.rotate_xyz_deg)}},
        focal_length = real32(film.focal_length);
    if (const std::uint64_t count = course->samples.size(); count > 0) {
        const CrateValue times = crate.times(course->frames);
        const std::uint64_t samples =
            crate.produced(count * sizeof(CameraSample), [course](const Sink& sink) {
                PieceWriter writer(sink);
                for (const CameraSample& sample : course->samples) writer.put(sample);
                writer.flush();
            });
        const auto samples_of = [&](std::function<CrateValue(std::uint64_t)> sample) {
            return std::pair{std::string_view("timeSamples"),
                             crate.time_samples(times, count, std::move(sample))};
        };
        const auto stored_from = [](std::uint64_t first) {
            return Crate::Stored{.type = ValueType::Vec3d, .first = first, .stride = sizeof(CameraSample)};
        };
        translate.push_back(samples_of(stored_from(samples)));
        rotate.push_back(samples_of(stored_from(samples + sizeof(glm::dvec3))));
        if (course->zooms)
            focal_length.push_back(samples_of(
                [course](std::uint64_t index) { return Crate::real32(course->focal_lengths[index]); }));
    }

    constexpr std::string_view kTranslate = "xformOp:translate", kRotate = "xformOp:rotateXYZ";
    // The first operation is the last to act on a point.
    constexpr std::string_view kOrder[] = {kTranslate, kRotate};
    const CrateValue clipping = crate.stored(ValueType::Vec2f, glm::vec2(camera.clipping_m));
    const CrateValue order = crate.token_array(kOrder);
    std::vector<Crate::Attribute> attributes{
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
    // What a pinhole in the film's middle doesn't need. In the order of names, as the others.
    const auto add = [&](const char* name, double number, const char* before) {
        const auto at = std::find_if(attributes.begin(), attributes.end(),
                                     [&](const Crate::Attribute& each) { return each.name == before; });
        attributes.insert(at, {.name = name, .type = "float", .more = real32(number)});
    };
    if (camera.f_stop > 0.0) {
        add("fStop", camera.f_stop, "focalLength");
        add("focusDistance", camera.focus_distance_m, "horizontalAperture");
    }
    if (camera.shift.x != 0.0)
        add("horizontalApertureOffset", camera.shift.x * film.horizontal_aperture, "projection");
    if (camera.shift.y != 0.0)
        add("verticalApertureOffset", camera.shift.y * film.horizontal_aperture, kRotate.data());
    crate.add_prim(kCameraName,
                   {{"specifier", crate.specifier(Specifier::Def)}, {"typeName", crate.token("Camera")}},
                   attributes);
    crate.finish();
    return crate;
}

}  // namespace

Course course_of(const Camera& camera) {
    const auto within = [&](int frame) {
        return std::int64_t{std::clamp(frame, camera.first_frame, camera.last_frame)};
    };
    const Sampler sampler(camera);
    Course course;
    course.first = sampler.sample_of(sampler.pose_at(camera.first_frame), glm::dvec3(0.0));
    if (camera.key_frames.empty()) return course;
    const std::int64_t first = within(camera.key_frames.front()), last = within(camera.key_frames.back());
    sampler.put(first, course);
    if (last - first <= kMostFramesEach) {
        for (std::int64_t frame = first + 1; frame <= last; ++frame) sampler.put(frame, course);
    } else {
        std::int64_t before = first;
        for (const int key : camera.key_frames) {
            sampler.put_until(within(key), before, course);
            before = std::max(before, within(key));
        }
    }
    // Before the first change and after the last the camera stands still.
    const auto same = [&](std::size_t a, std::size_t b) {
        return course.samples[a].translate == course.samples[b].translate &&
               course.samples[a].rotate_xyz_deg == course.samples[b].rotate_xyz_deg &&
               course.focal_lengths[a] == course.focal_lengths[b];
    };
    const auto keep = [&](std::size_t begin, std::size_t end) {
        const auto of = [&](auto& list) {
            list.erase(list.begin() + static_cast<std::ptrdiff_t>(end), list.end());
            list.erase(list.begin(), list.begin() + static_cast<std::ptrdiff_t>(begin));
        };
        of(course.frames);
        of(course.samples);
        of(course.focal_lengths);
    };
    std::size_t begin = 0, end = course.frames.size();
    while (end > 1 && same(end - 1, end - 2)) --end;
    while (begin + 1 < end && same(begin, begin + 1)) ++begin;
    keep(begin, end > begin + 1 ? end : begin);
    course.zooms = std::any_of(course.focal_lengths.begin(), course.focal_lengths.end(),
                               [&](float focal) { return focal != course.focal_lengths.front(); });
    return course;
}

void write_camera_crate(const Camera& camera, const Sink& sink) {
    camera_layer(camera).write(sink);
}

std::string camera_crate(const Camera& camera) {
    return gathered(camera_layer(camera));
}

}  // namespace pelagic::usd
