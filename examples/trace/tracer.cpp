#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <stdexcept>
#include <string>
#include <utility>

#include "core/base/random.h"
#include "core/lighting/background.h"
#include "core/scene/shot_text.h"
#include "plugin/render/under_water.h"
#include "tracer_impl.h"

namespace pelagic::trace {
namespace {

struct CloseSea {
    void operator()(pelagic_sea* sea) const { pelagic_close(sea); }
};

void check(pelagic_status status, const pelagic_error& error) {
    if (status != PELAGIC_OK) throw std::runtime_error(error.message);
}

Plan plan_of(const Scene& scene, const TraceOptions& options, int frame) {
    Scene open = scene;
    open.surface.kind = SurfaceKind::ProjectedGrid;  // rays meet the open sea, whatever pictures show
    Plan plan = picture_plan(open, std::array{frame}, options.picture);
    if (plan.knobs.double_precision)
        throw std::invalid_argument(
            "quality.level: rays find the sea in single precision; accepted: all but reference");
    return plan;
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

}  // namespace

Tracer::Impl::Impl(const Scene& scene, const TraceOptions& options, Sky sky, int frame)
    : options_(options),
      scene_(of_samples(scene, options.picture.samples)),
      frame_(frame),
      view_(view_at(scene_.camera, frame)),
      plan_(plan_of(scene_, options, frame)),
      grid_options_(projected_grid_options(*plan_.from)),
      light_(plan_, options.picture.lighting, std::move(sky), {}) {
    const double time_s = scene_.shot.time_s(frame);
    light_.set(time_s);
    refuse_under_water(light_.frame(), scene_, frame, grid_options_);
    if (light_.foam_lives()) {  // where about the rays will look
        const ProjectedGrid grid = projected_grid(view_, grid_options_);
        light_.say({.origin_m = grid.origin_m,
                    .count = grid.rest_m.size(),
                    .rest_m = {grid.rest_m.data()},
                    .pixel_m = {grid.pixel_m.data()},
                    .pixel_axis_m = {grid.pixel_axis_m.data()}});
        light_.prepare({});
    }
    air_ = light_.air_before(view_.position_m.z);
    air_below_ = light_.air_before(0.0);
    spray_ = light_.spray_before(view_, grid_options_, options.picture.samples);
    unlit_ = light_.sky();
    unlit_.sun_radiance = unlit_.sun_irradiance = glm::vec3(0.0f);

    ProjectedGridOptions cells = grid_options_;
    cells.cell_px = kCell_px * options.picture.samples;
    RaySea rays = ray_sea(scene, projected_grid_needs(view_, cells).finest_cell_m, time_s);
    EmbreeSea::Options of_sea{.finest_cell_m = rays.finest_cell_m,
                              .on_earth = grid_options_.curvature_per_m != 0.0};
    of_sea.origin_m[0] = view_.position_m.x;
    of_sea.origin_m[1] = view_.position_m.y;
    // As far as the earth's horizon from anywhere, within the world that regions may lie in.
    of_sea.reach_m =
        std::clamp(1e9 - std::max(std::abs(view_.position_m.x), std::abs(view_.position_m.y)), 1.0, 1e7);
    ray_frame_ = std::move(rays.frame);
    traced_.emplace(ray_frame_.get(), of_sea, options.object, options.placement);
}

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
        see_through_spray(spray_, rays_[i].towards, {}, radiance_[i]);
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
    light_.find_crests(seen_.origin_m, seen_.rest, seen_.pixel_m, seen_.pixel_axis_m, seen_.crest);
    light_.answer(seen_);
    light_.light(seen_, light_.sky(), air_, spray_, lit_);
    if (options_.traced) {
        const auto [rays, met] = gathered(rays_, answers_, on_sea_);
        const std::vector<std::uint8_t> dark = in_shadow(rays, met);
        if (std::find(dark.begin(), dark.end(), 1) != dark.end()) {
            std::vector<SeaRadiance> unlit(on_sea_.size());
            light_.light(seen_, unlit_, air_, spray_, unlit);
            for (std::size_t i = 0; i < dark.size(); ++i)
                if (dark[i]) lit_[i] = unlit[i];
        }
        mirror_and_refract(dark);
    }
    for (std::size_t i = 0; i < on_sea_.size(); ++i) radiance_[on_sea_[i]] = lit_[i];
}

void Tracer::Impl::light_object() {
    if (on_object_.empty()) return;
    const auto [rays, met] = gathered(rays_, answers_, on_object_);
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
                if (i == n / 2 * n + n / 2) to.picture.sea[at] = answers_[sample].met == Met::Sea;
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
