#include "tracer.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/exponential.hpp>
#include <glm/geometric.hpp>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>

#include "core/base/random.h"
#include "core/lighting/background.h"
#include "core/scene/shot_text.h"
#include "core/surface/earth.h"
#include "core/surface/projected_grid.h"
#include "core/surface/view.h"
#include "plugin/render/batch.h"
#include "plugin/render/sea_light.h"
#include "plugin/render/under_water.h"

namespace pelagic::trace {
namespace {

constexpr float kPi_f = std::numbers::pi_v<float>;
constexpr float kWaterIndex = 1.34f;  // as core/lighting/special.glsl

struct CloseSea {
    void operator()(pelagic_sea* sea) const { pelagic_close(sea); }
};
struct ReleaseFrame {
    void operator()(pelagic_frame* frame) const { pelagic_frame_release(frame); }
};
using FrameHandle = std::unique_ptr<pelagic_frame, ReleaseFrame>;

void check(pelagic_status status, const pelagic_error& error) {
    if (status != PELAGIC_OK) throw std::runtime_error(error.message);
}

// The sea of the scene for rays, at a time. Its cells are those of a mesh of two pixels.
struct RaySea {
    FrameHandle frame;
    double finest_cell_m = 0.0;
};
RaySea ray_sea(const Scene& scene, double finest_cell_m, double time_s) {
    const std::string text = shot_text(scene);
    pelagic_source source = PELAGIC_INIT(pelagic_source);
    source.text = text.c_str();
    source.text_length = text.size();
    pelagic_open_options options = PELAGIC_INIT(pelagic_open_options);
    options.finest_cell_m = options.finest_pixel_m = finest_cell_m;
    pelagic_sea* opened = nullptr;
    pelagic_error error;
    check(pelagic_open(&source, &options, &opened, &error), error);
    const std::unique_ptr<pelagic_sea, CloseSea> sea(opened);
    pelagic_info info = PELAGIC_INIT(pelagic_info);
    check(pelagic_get_info(sea.get(), &info, &error), error);
    pelagic_frame* frame = nullptr;
    check(pelagic_frame_create(sea.get(), time_s, time_s, &frame, &error), error);
    return {FrameHandle(frame), info.finest_cell_m};
}

template <class Work>
void in_parallel(std::size_t count, const Work& work) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, kShadeGrain), [&](const auto& range) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) work(i);
    });
}

// Of the exact, unpolarised term, from air into water.
float fresnel(float cosine) {
    const float c = std::clamp(cosine, 0.0f, 1.0f), g = std::sqrt(kWaterIndex * kWaterIndex + c * c - 1.0f);
    const float across = (g - c) / (g + c), along = (c * (g + c) - 1.0f) / (c * (g - c) + 1.0f);
    return 0.5f * across * across * (1.0f + along * along);
}

glm::vec3 world_normal(glm::vec3 level, glm::vec3 up) {
    return glm::vec3(from_level(glm::dvec3(level), glm::dvec3(up)));
}

// A ray that adds to the light of a sample.
struct SecondRay {
    RayQuery ray;
    std::size_t sample = 0;
    glm::vec3 weight{0.0f};
    bool replaces_sky = false;  // the sky in its direction is there already
};

}  // namespace

class Tracer::Impl {
  public:
    Impl(const Scene& scene, const TraceOptions& options, Sky sky, int frame)
        : options_(options),
          scene_(of_samples(scene, options.picture.samples)),
          frame_(frame),
          view_(view_at(scene_.camera, frame)),
          plan_(picture_plan(scene_, std::array{frame}, options.picture)),
          grid_options_(projected_grid_options(*plan_.from)),
          light_(plan_, options.picture.lighting, std::move(sky), {}) {
        if (plan_.knobs.double_precision)
            throw std::invalid_argument(
                "quality.level: rays find the sea in single precision; accepted: all but reference");
        const double time_s = scene_.shot.time_s(frame);
        light_.set(time_s);
        refuse_under_water(light_.frame(), scene_, frame, grid_options_);
        light_.prepare_foam(time_s, projected_grid(view_, grid_options_), {});
        air_ = light_.air_before(view_.position_m.z);
        air_below_ = light_.air_before(0.0);
        unlit_ = light_.sky();
        unlit_.sun_radiance = unlit_.sun_irradiance = glm::vec3(0.0f);

        ProjectedGridOptions cells = grid_options_;
        cells.cell_px = kCell_px * options.picture.samples;
        RaySea rays = ray_sea(scene_, projected_grid_needs(view_, cells).finest_cell_m, time_s);
        EmbreeSea::Options of_sea{.finest_cell_m = rays.finest_cell_m,
                                  .on_earth = grid_options_.curvature_per_m != 0.0};
        of_sea.origin_m[0] = view_.position_m.x;
        of_sea.origin_m[1] = view_.position_m.y;
        ray_frame_ = std::move(rays.frame);
        traced_.emplace(ray_frame_.get(), of_sea, options.object, options.placement);
    }

    TracedPicture render(const std::function<void(double)>& progress);

  private:
    static constexpr double kCell_px = 2.0;
    static constexpr std::uint32_t kDirections = 4;  // from which light on the object is looked for, a sample
    static constexpr float kWide = 0.3f;             // how much such rays widen in a metre,
    static constexpr float kMirrored = 0.02f;        // and those that the sea mirrors, at least
    static constexpr std::uint64_t kSeed = 0x7261797365610001u;

    void trace_rows(int first_row, int rows);
    void light_background();
    void find_places();
    void light_sea();
    void light_object();
    std::optional<glm::vec3> facet(std::size_t i, glm::vec3 to_eye) const;
    void mirror_and_refract();
    void trace_second_rays();
    void light_second_sea(std::span<const RayQuery> rays, std::span<const RayAnswer> met,
                          std::span<const std::size_t> sea, std::span<glm::vec3> light);
    void through_air();
    glm::dvec2 pixel_at(std::size_t sample) const;
    void average(int first_row, int rows, TracedPicture& to) const;
    PixelFootprint<double> pixel_of(std::size_t sample, const PixelFootprint<double>& at_rest,
                                    const glm::dvec3& normal) const;
    std::array<std::uint32_t, 4> random(std::size_t sample, std::uint32_t what) const;
    RayQuery from_place(const RayQuery& before, const RayAnswer& met, glm::vec3 towards) const;
    std::vector<std::uint8_t> in_shadow(std::span<const RayQuery> rays, std::span<const RayAnswer> met) const;
    glm::vec3 sun_on(const RayAnswer& object, bool in_shadow) const;
    glm::vec3 sky_on(const RayAnswer& object) const;
    glm::vec3 sky_towards(glm::vec3 direction) const;

    TraceOptions options_;
    Scene scene_;  // of samples
    int frame_;
    View view_;
    Plan plan_;
    ProjectedGridOptions grid_options_;
    SeaLight<float> light_;
    Air air_, air_below_;
    Sky unlit_;  // without the sun
    FrameHandle ray_frame_;
    std::optional<TracedScene> traced_;

    // Of the rows at hand, by sample.
    int first_row_ = 0;
    std::vector<RayQuery> rays_;
    std::vector<RayAnswer> answers_;
    std::vector<SeaRadiance> radiance_;
    std::vector<glm::vec3> added_;  // before the air dims it
    std::vector<std::size_t> on_sea_, on_object_;
    SeenSea<float> seen_;  // by entry of on_sea_
    std::vector<SeaRadiance> lit_;
    std::vector<SecondRay> second_;
};

// ---- What a batch shows

TracedPicture Tracer::Impl::render(const std::function<void(double)>& progress) {
    const int n = options_.picture.samples;
    TracedPicture done;
    done.picture.resolution = scene_.camera.resolution / n;
    const auto pixels = static_cast<std::size_t>(done.picture.resolution.x) * done.picture.resolution.y;
    done.picture.layers.assign(pixels, SeaRadiance{});
    done.picture.sea.assign(pixels, 0);
    done.object.assign(pixels, 0);
    const int step = rows_of_batch(view_.resolution.x, n);
    for (int row = 0; row < view_.resolution.y; row += step) {
        const int rows = std::min(step, view_.resolution.y - row);
        trace_rows(row, rows);
        light_background();
        find_places();
        light_sea();
        light_object();
        if (options_.traced) trace_second_rays();
        through_air();
        average(row, rows, done);
        if (progress) progress(static_cast<double>(row + rows) / view_.resolution.y);
    }
    return done;
}

void Tracer::Impl::trace_rows(int first_row, int rows) {
    first_row_ = first_row;
    const auto width = static_cast<std::size_t>(view_.resolution.x), count = width * rows;
    rays_.resize(count);
    answers_.resize(count);
    radiance_.assign(count, SeaRadiance{});
    added_.assign(count, glm::vec3(0.0f));
    second_.clear();
    in_parallel(count, [&](std::size_t i) {
        const glm::dvec3 direction = view_.direction(pixel_at(i));
        const double cosine = glm::dot(direction, view_.forward);
        rays_[i] = {.from = glm::vec3(0.0f, 0.0f, static_cast<float>(view_.position_m.z)),
                    .towards = glm::vec3(direction),
                    .width = {.spread = static_cast<float>(view_.pixel_tangent() * cosine)}};
    });
    traced_->trace(rays_, answers_);
    on_sea_.clear();
    on_object_.clear();
    for (std::size_t i = 0; i < count; ++i)
        if (answers_[i].met != Met::Nothing)
            (answers_[i].met == Met::Sea ? on_sea_ : on_object_).push_back(i);
}

// The middle of a sample, in samples from the picture's top left corner.
glm::dvec2 Tracer::Impl::pixel_at(std::size_t sample) const {
    const auto width = static_cast<std::size_t>(view_.resolution.x);
    return {static_cast<double>(sample % width) + 0.5,
            static_cast<double>(sample / width) + first_row_ + 0.5};
}

void Tracer::Impl::light_background() {
    in_parallel(rays_.size(), [&](std::size_t i) {
        if (answers_[i].met != Met::Nothing) return;
        const auto cosine = static_cast<float>(glm::dot(glm::dvec3(rays_[i].towards), view_.forward));
        radiance_[i] = light_.behind(air_, rays_[i].towards,
                                     pixel_angle(static_cast<float>(view_.pixel_tangent()), cosine));
    });
}

// As the rasteriser has it on a triangle of its mesh, whose plane shows the waves that a cell of the mesh does.
PixelFootprint<double> Tracer::Impl::pixel_of(std::size_t sample, const PixelFootprint<double>& at_rest,
                                              const glm::dvec3& normal) const {
    const glm::dvec2 from_middle = pixel_at(sample) - 0.5 * glm::dvec2(view_.resolution);
    const double tangent = view_.pixel_tangent();
    const glm::dvec3 ray = view_.forward + tangent * (from_middle.x * view_.right - from_middle.y * view_.up);
    const double facing = glm::dot(normal, ray), least = -1e-6;
    return footprint_on_mesh(at_rest, view_.right.x, view_.right.y, view_.up.x, view_.up.y, ray.x, ray.y,
                             glm::dot(normal, view_.right) / std::min(facing, least),
                             glm::dot(normal, view_.up) / std::min(facing, least));
}

void Tracer::Impl::find_places() {
    seen_.origin_m = glm::dvec2(view_.position_m);
    seen_.resize(on_sea_.size());
    in_parallel(on_sea_.size(), [&](std::size_t i) {
        const std::size_t sample = on_sea_[i];
        const RayAnswer& answer = answers_[sample];
        seen_.rest[i] = answer.rest_m;
        seen_.up[i] = glm::vec3(earth_up(glm::dvec2(answer.rest_m), grid_options_.curvature_per_m));
        seen_.to_eye[i] = -rays_[sample].towards;
        seen_.distance_m[i] = answer.distance_m;
        seen_.pixel_m[i] =
            static_cast<float>(view_.pixel_tangent() * grid_options_.cell_px * answer.distance_m);
        seen_.pixel_axis_m[i] = glm::vec2(0.0f);
    });
    std::vector<glm::vec3> plane(on_sea_.size());
    Results<float> results;
    results.set(Product::Normal, {plane.data()});
    evaluate(light_.frame(), SeaLight<float>::kQuery, seen_.points(), results);
    in_parallel(on_sea_.size(), [&](std::size_t i) {
        const auto at_rest = pixel_at_rest(view_, grid_options_, glm::dvec2(seen_.rest[i]));
        const PixelFootprint<double> pixel =
            pixel_of(on_sea_[i], at_rest, glm::dvec3(world_normal(plane[i], seen_.up[i])));
        seen_.pixel_m[i] = static_cast<float>(pixel.width);
        seen_.pixel_axis_m[i] = glm::vec2(glm::dvec2(pixel.axis_x, pixel.axis_y));
    });
}

void Tracer::Impl::light_sea() {
    if (on_sea_.empty()) return;
    lit_.resize(on_sea_.size());
    light_.answer(seen_);
    light_.light(seen_, light_.sky(), air_, lit_);
    if (options_.traced) {
        std::vector<RayQuery> rays;
        std::vector<RayAnswer> met;
        for (const std::size_t sample : on_sea_) {
            rays.push_back(rays_[sample]);
            met.push_back(answers_[sample]);
        }
        const std::vector<std::uint8_t> dark = in_shadow(rays, met);
        if (std::find(dark.begin(), dark.end(), 1) != dark.end()) {
            std::vector<SeaRadiance> unlit(on_sea_.size());
            light_.light(seen_, unlit_, air_, unlit);
            for (std::size_t i = 0; i < dark.size(); ++i)
                if (dark[i]) lit_[i] = unlit[i];
        }
        mirror_and_refract();
    }
    for (std::size_t i = 0; i < on_sea_.size(); ++i) radiance_[on_sea_[i]] = lit_[i];
}

void Tracer::Impl::light_object() {
    if (on_object_.empty()) return;
    std::vector<RayQuery> rays;
    std::vector<RayAnswer> met;
    for (const std::size_t sample : on_object_) {
        rays.push_back(rays_[sample]);
        met.push_back(answers_[sample]);
    }
    const std::vector<std::uint8_t> dark =
        options_.traced ? in_shadow(rays, met) : std::vector<std::uint8_t>(met.size(), 0);
    for (std::size_t i = 0; i < met.size(); ++i) {
        const std::size_t sample = on_object_[i];
        added_[sample] = sun_on(met[i], dark[i] != 0);
        if (!options_.traced) {
            added_[sample] += sky_on(met[i]);
            continue;
        }
        // What lights it from the side of its normal: directions by their cosine, each quarter of the square has one.
        const glm::vec3 normal = met[i].normal;
        const glm::vec3 x = glm::normalize(glm::cross(
            normal, std::abs(normal.z) < 0.9f ? glm::vec3(0.0f, 0.0f, 1.0f) : glm::vec3(1.0f, 0.0f, 0.0f)));
        const glm::vec3 y = glm::cross(normal, x);
        for (std::uint32_t k = 0; k < kDirections; ++k) {
            const auto bits = philox(random(sample, 100 + k), kSeed);
            const auto unit = [&](int j) { return static_cast<float>(bits[j] >> 8) * 0x1p-24f; };
            const float height2 = (static_cast<float>(k / 2) + unit(0)) / 2.0f;
            const float angle = kPi_f * (static_cast<float>(k % 2) + unit(1));
            const glm::vec3 towards =
                std::sqrt(1.0f - height2) * (std::cos(angle) * x + std::sin(angle) * y) +
                std::sqrt(height2) * normal;
            SecondRay ray{.ray = from_place(rays[i], met[i], towards),
                          .sample = sample,
                          .weight = met[i].albedo / static_cast<float>(kDirections)};
            ray.ray.width.spread = kWide;
            second_.push_back(ray);
        }
    }
}

// ---- Rays from where others ended

// Off the surface: the sea's places are known to half a footprint.
RayQuery Tracer::Impl::from_place(const RayQuery& before, const RayAnswer& met, glm::vec3 towards) const {
    const float width_m = before.width.footprint_m + before.width.spread * met.distance_m;
    const float rises = std::max(std::abs(glm::dot(towards, met.normal)), 0.05f);
    return {.from = before.from + met.distance_m * before.towards,
            .towards = towards,
            .nearest_m = met.met == Met::Sea ? width_m / rises : 1e-3f + 1e-5f * met.distance_m,
            .width = {.footprint_m = width_m, .spread = before.width.spread}};
}

// Whether something is between the places that rays met and the middle of the sun.
std::vector<std::uint8_t> Tracer::Impl::in_shadow(std::span<const RayQuery> rays,
                                                  std::span<const RayAnswer> met) const {
    const glm::vec3 to_sun = light_.sky().sun_direction;
    std::vector<std::uint8_t> dark(met.size(), 0);
    if (light_.sky().sun_radiance == glm::vec3(0.0f)) return dark;
    std::vector<RayQuery> up(met.size());
    in_parallel(met.size(), [&](std::size_t i) { up[i] = from_place(rays[i], met[i], to_sun); });
    traced_->occluded(up, dark);
    return dark;
}

// The sun's light on the object, and the sky's where nothing hides any of it: half of it on an upright side.
glm::vec3 Tracer::Impl::sun_on(const RayAnswer& object, bool in_shadow) const {
    const Sky& sky = light_.sky();
    const float facing = glm::dot(object.normal, sky.sun_direction);
    if (in_shadow || !(facing > 0.0f)) return glm::vec3(0.0f);
    // Irradiance over π: the disc's solid angle is π r².
    return object.albedo * sky.sun_radiance * (sky.sun_angular_radius * sky.sun_angular_radius * facing);
}
glm::vec3 Tracer::Impl::sky_on(const RayAnswer& object) const {
    return object.albedo * light_.sky().sky_irradiance * ((0.5f + 0.5f * object.normal.z) / kPi_f);
}

glm::vec3 Tracer::Impl::sky_towards(glm::vec3 direction) const {
    return options_.picture.lighting.sky ? background(light_.sky(), direction, kWide).sky : glm::vec3(0.0f);
}

std::array<std::uint32_t, 4> Tracer::Impl::random(std::size_t sample, std::uint32_t what) const {
    const std::size_t in_picture = sample + static_cast<std::size_t>(first_row_) * view_.resolution.x;
    return {static_cast<std::uint32_t>(in_picture), static_cast<std::uint32_t>(in_picture >> 32),
            static_cast<std::uint32_t>(frame_), what};
}

// A facet of the sea that the eye sees, of hidden waves as of those that are shown, in the axes of the level there; nullopt where
// chance finds none.
std::optional<glm::vec3> Tracer::Impl::facet(std::size_t i, glm::vec3 to_eye) const {
    const glm::vec3 normal = light_.answers().vectors(Product::Normal)[i];
    const glm::vec3 variance = light_.answers().vectors(Product::SlopeVariance)[i];
    if (!(normal.z > 0.05f)) return std::nullopt;
    const glm::vec2 mean = -glm::vec2(normal) / normal.z;
    const float x = std::sqrt(std::max(variance.x, 0.0f)), mixed = x > 0.0f ? variance.z / x : 0.0f;
    const float y = std::sqrt(std::max(variance.y - mixed * mixed, 0.0f));
    const float most = to_eye.z - glm::dot(mean, glm::vec2(to_eye)) +
                       3.0f * std::sqrt(std::max(variance.x + variance.y, 0.0f));
    for (std::uint32_t tries = 0; tries < 8; ++tries) {
        const auto normals = normal_pair(random(on_sea_[i], 2 * tries), kSeed);
        const glm::vec2 hidden(x * static_cast<float>(normals[0]),
                               mixed * static_cast<float>(normals[0]) + y * static_cast<float>(normals[1]));
        const glm::vec2 slope = mean + hidden;
        // Seen in proportion to its area towards the eye.
        const float area = to_eye.z - glm::dot(slope, glm::vec2(to_eye));
        const float chance =
            static_cast<float>(philox(random(on_sea_[i], 2 * tries + 1), kSeed)[0] >> 8) * 0x1p-24f;
        if (area > chance * most) return glm::normalize(glm::vec3(-slope, 1.0f));
    }
    return std::nullopt;
}

// Rays from one facet of each sample of the sea. What the sea's own shading has of mirrored light is the sky's; what a mirrored ray
// meets in its place replaces it. Facets that mirror the ray down into their own wave are left to that shading, too.
void Tracer::Impl::mirror_and_refract() {
    const std::vector<float>& coverage = light_.answers().numbers(Product::Coverage);
    std::vector<std::optional<SecondRay>> mirrored(on_sea_.size());
    std::vector<RayQuery> below(on_sea_.size());
    std::vector<float> enters(on_sea_.size(), 0.0f);
    in_parallel(on_sea_.size(), [&](std::size_t i) {
        const std::size_t sample = on_sea_[i];
        const glm::vec3 up = seen_.up[i], view = seen_.to_eye[i];
        const auto found = facet(i, glm::vec3(to_level(glm::dvec3(view), glm::dvec3(up))));
        below[i].farthest_m = 0.0f;
        if (!found) return;
        const glm::vec3 normal = world_normal(*found, up);
        const float cosine = glm::dot(view, normal), share = fresnel(cosine);
        const float clear = coverage.empty() ? 1.0f : 1.0f - std::clamp(coverage[i], 0.0f, 1.0f);
        const glm::vec3 towards = 2.0f * cosine * normal - view;
        if (glm::dot(towards, answers_[sample].normal) > 0.0f) {
            // One facet's share may be more than the mean that the shading has: no more of the sky is taken away than is there.
            const glm::vec3 most = lit_[i].sky / glm::max(sky_towards(towards), glm::vec3(1e-12f));
            SecondRay ray{.ray = from_place(rays_[sample], answers_[sample], towards),
                          .sample = sample,
                          .weight = glm::min(glm::vec3(clear * share), most),
                          .replaces_sky = true};
            ray.ray.width.spread = std::max(ray.ray.width.spread, kMirrored);
            mirrored[i] = ray;
        }
        below[i] =
            from_place(rays_[sample], answers_[sample], glm::refract(-view, normal, 1.0f / kWaterIndex));
        below[i].nearest_m = 0.0f;
        enters[i] = clear * (1.0f - share);
    });
    for (const auto& ray : mirrored)
        if (ray) second_.push_back(*ray);

    // The bottom is out of sight: under water there is nothing but the object, in front of the light that water scatters.
    std::vector<RayAnswer> met(on_sea_.size());
    traced_->trace_object(below, met);
    const WaterBody& water = light_.water();
    const Sky& sky = light_.sky();
    const glm::vec3 loss_per_m = water.absorption_per_m + 2.0f * water.backscatter_per_m;
    const glm::vec3 down = 0.95f * (sky.sun_irradiance + sky.sky_irradiance);
    const glm::vec3 open = sea_albedo(water).water * (sky.sun_irradiance + sky.sky_irradiance) / kPi_f;
    for (std::size_t i = 0; i < met.size(); ++i) {
        if (met[i].met != Met::Object) continue;
        const glm::vec3 place = below[i].from + met[i].distance_m * below[i].towards;
        const float depth_m = std::max(below[i].from.z - place.z, 0.0f);
        const glm::vec3 left = glm::exp(-loss_per_m * met[i].distance_m);
        const glm::vec3 object = met[i].albedo * down * glm::exp(-loss_per_m * depth_m) *
                                 ((0.6f + 0.4f * met[i].normal.z) / (kPi_f * kWaterIndex * kWaterIndex));
        added_[on_sea_[i]] += enters[i] * left * (object - open);
    }
}

void Tracer::Impl::trace_second_rays() {
    const std::size_t count = second_.size();
    std::vector<RayQuery> rays(count);
    std::vector<RayAnswer> met(count);
    for (std::size_t i = 0; i < count; ++i) rays[i] = second_[i].ray;
    traced_->trace(rays, met);
    std::vector<glm::vec3> light(count, glm::vec3(0.0f));
    std::vector<std::size_t> sea;
    std::vector<std::size_t> object;
    for (std::size_t i = 0; i < count; ++i) {
        if (met[i].met == Met::Nothing)
            light[i] = second_[i].replaces_sky ? glm::vec3(0.0f) : sky_towards(rays[i].towards);
        else
            (met[i].met == Met::Sea ? sea : object).push_back(i);
    }
    light_second_sea(rays, met, sea, light);
    std::vector<RayQuery> to_object;
    std::vector<RayAnswer> of_object;
    for (const std::size_t i : object) {
        to_object.push_back(rays[i]);
        of_object.push_back(met[i]);
    }
    const std::vector<std::uint8_t> dark = in_shadow(to_object, of_object);
    for (std::size_t i = 0; i < object.size(); ++i)
        light[object[i]] = sun_on(of_object[i], dark[i] != 0) + sky_on(of_object[i]);
    for (std::size_t i = 0; i < count; ++i) {
        glm::vec3 more = light[i];
        if (second_[i].replaces_sky && met[i].met != Met::Nothing) more -= sky_towards(rays[i].towards);
        added_[second_[i].sample] += second_[i].weight * more;
    }
}

// The sea that second rays meet, through the air above the waves.
void Tracer::Impl::light_second_sea(std::span<const RayQuery> rays, std::span<const RayAnswer> met,
                                    std::span<const std::size_t> sea, std::span<glm::vec3> light) {
    if (sea.empty()) return;
    SeenSea<float> seen;
    seen.origin_m = glm::dvec2(view_.position_m);
    seen.resize(sea.size());
    for (std::size_t i = 0; i < sea.size(); ++i) {
        const RayQuery& ray = rays[sea[i]];
        const RayAnswer& answer = met[sea[i]];
        seen.rest[i] = answer.rest_m;
        seen.up[i] = glm::vec3(earth_up(glm::dvec2(answer.rest_m), grid_options_.curvature_per_m));
        const float width_m = ray.width.footprint_m + ray.width.spread * answer.distance_m;
        const float facing = std::max(std::abs(glm::dot(answer.normal, ray.towards)), 0.1f);
        const float across = std::max(std::hypot(ray.towards.x, ray.towards.y), 1e-6f);
        seen.pixel_m[i] = width_m;
        seen.pixel_axis_m[i] = glm::vec2(ray.towards) * (width_m / (facing * across));
        seen.to_eye[i] = -ray.towards;
        seen.distance_m[i] = answer.distance_m;
    }
    std::vector<SeaRadiance> lit(sea.size());
    light_.answer(seen);
    light_.light(seen, light_.sky(), air_below_, lit);
    // The sun that waves mirror onto the object is left out: few of the rays find it, and those would be white dots.
    for (std::size_t i = 0; i < sea.size(); ++i)
        light[sea[i]] = radiance_of(lit[i]) - (second_[sea[i]].replaces_sky ? glm::vec3(0.0f) : lit[i].sun);
}

// What rays have added, as the eye sees it. The air before the sea has added its own light already.
void Tracer::Impl::through_air() {
    const auto seen_through = [&](std::size_t sample, bool has_air) {
        SeaRadiance more{.sea = added_[sample]};
        const glm::vec3 to_eye = -rays_[sample].towards;
        const float distance_m = answers_[sample].distance_m;
        if (options_.picture.lighting.air)
            see_through(air_, std::span(&to_eye, 1), std::span(&distance_m, 1), std::span(&more, 1));
        radiance_[sample].sea += more.sea;
        if (has_air) radiance_[sample].air += more.air;
    };
    in_parallel(on_object_.size(), [&](std::size_t i) { seen_through(on_object_[i], true); });
    if (options_.traced) in_parallel(on_sea_.size(), [&](std::size_t i) { seen_through(on_sea_[i], false); });
}

void Tracer::Impl::average(int first_row, int rows, TracedPicture& to) const {
    const int n = options_.picture.samples;
    const auto width = static_cast<std::size_t>(view_.resolution.x), pixels = width / n;
    const float share = 1.0f / static_cast<float>(n * n);
    tbb::parallel_for(0, rows / n, [&](int row) {
        for (std::size_t x = 0; x < pixels; ++x) {
            const std::size_t at = pixels * (first_row / n + row) + x;
            SeaRadiance& pixel = to.picture.layers[at];
            for (int i = 0; i < n * n; ++i) {
                const std::size_t sample = width * (row * n + i / n) + x * n + i % n;
                const SeaRadiance& light = radiance_[sample];
                pixel.sun += light.sun * share;
                pixel.sky += light.sky * share;
                pixel.sea += light.sea * share;
                pixel.foam += light.foam * share;
                pixel.air += light.air * share;
                if (answers_[sample].met == Met::Object) to.object[at] = 1;
                if (i == n * n / 2) to.picture.sea[at] = answers_[sample].met == Met::Sea;
            }
        }
    });
}

Tracer::Tracer(const Scene& scene, const TraceOptions& options, Sky sky, int frame) {
    check_render(scene, options.picture);
    impl_ = std::make_unique<Impl>(scene, options, std::move(sky), frame);
}
Tracer::~Tracer() = default;

TracedPicture Tracer::render(const std::function<void(double)>& progress) {
    return impl_->render(progress);
}

}  // namespace pelagic::trace
