#include "plugin/render/render.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>

#include "core/base/number.h"
#include "core/base/precision.h"
#include "core/evaluate/values.h"
#include "core/lighting/background.h"
#include "core/lighting/water.h"
#include "core/plan/quality.h"
#include "core/surface/projected_grid.h"
#include "core/surface/rungs.h"
#include "core/surface/view.h"
#include "plugin/light/light.h"
#include "plugin/render/raster.h"
#include "plugin/render/under_water.h"

namespace pelagic {
namespace {

#include "core/evaluate/pixel.inl"

// Samples that are computed at once: enough to keep all threads busy, little enough to stay near the caches.
constexpr int kBatch = 1 << 16;
constexpr std::size_t kShadeGrain = 256;  // samples a task shades

// Rows of samples that are computed at once: whole bands of the rasteriser that are whole rows of the picture.
int rows_of_batch(int sample_width, int samples) {
    const int rows_at_once = Rasteriser::kBandRows * samples;
    return std::max(1, kBatch / (rows_at_once * sample_width)) * rows_at_once;
}

// [bytes/pixel] of a picture; of its two files, where layers that are packed take half of their halves; and of what
// encode_exr() and encode_png() hold beside them.
constexpr std::size_t kPictureBytes = sizeof(SeaRadiance) + 1;
constexpr std::size_t kFileBytes = 15 * 2 / 2 + 2;
constexpr std::size_t kEncodingBytes = sizeof(glm::vec3) + 3;

// What a batch of samples holds, by sample of the batch or by sample that shows the sea.
template <class T>
struct Batch {
    std::vector<std::uint32_t> triangles;  // by sample
    std::vector<SeaRadiance> radiance;     // by sample
    std::vector<std::size_t> sea;          // which samples show the sea, rising
    std::vector<glm::vec<2, T>> rest;      // from here on by entry of `sea`
    std::vector<T> pixel_m;
    std::vector<glm::vec<2, T>> pixel_axis_m;
    std::vector<glm::vec3> to_eye;
    Values answers;
    std::vector<SeaPoint> points;
    std::vector<SeaRadiance> lit;
};

}  // namespace

class Renderer::Impl {
  public:
    virtual ~Impl() = default;
    virtual bool render(int frame, Picture& picture, const RenderWatch& watch) = 0;
    virtual bool check_cameras(std::span<const int> frames, const RenderWatch& watch) = 0;
    virtual const Plan& plan() const = 0;
    virtual const Sky& sky() const = 0;
};

namespace {

// Samples are pixels of a larger picture with cells as large as before.
Scene of_samples(const Scene& scene, int samples) {
    Scene sampled = scene;
    sampled.camera.resolution *= samples;
    sampled.surface.cell_px *= samples;
    return sampled;
}

// Of a scene of samples, in the plan's precision; Impl is Renderer's own.
template <class T, class Impl>
class RendererOf final : public Impl {
  public:
    RendererOf(const Plan& plan, const RenderOptions& options, Sky sky, const BuildWatch& watch)
        : scene_(plan.from->scene),
          options_(options),
          sky_(std::move(sky)),
          water_(make_water(scene_)),
          sea_(std::make_shared<const Sea<T>>(plan, watch)),
          frame_(sea_),
          grid_options_(projected_grid_options(*plan.from)) {}

    const Plan& plan() const override { return sea_->plan(); }
    const Sky& sky() const override { return sky_; }

    bool render(int frame, Picture& picture, const RenderWatch& watch) override {
        frame_.set(scene_.shot.time_s(frame));
        refuse_under_water(frame_, scene_, frame, grid_options_);
        view_ = view_at(scene_.camera, frame);
        lay_out_grid();
        picture.resolution = scene_.camera.resolution / options_.samples;
        const auto pixels = static_cast<std::size_t>(picture.resolution.x) * picture.resolution.y;
        picture.layers.resize(pixels);
        picture.sea.resize(pixels);
        const int step = rows_of_batch(view_.resolution.x, options_.samples);
        for (int row = 0; row < view_.resolution.y; row += step) {
            const int rows = std::min(step, view_.resolution.y - row);
            draw(row, rows);
            light_sky(row);
            light_sea(row);
            average(row, rows, picture);
            if (watch.progress) watch.progress(static_cast<double>(row + rows) / view_.resolution.y);
            if (watch.cancel && watch.cancel->load(std::memory_order_relaxed)) return false;
        }
        return true;
    }

    bool check_cameras(std::span<const int> frames, const RenderWatch& watch) override {
        for (std::size_t i = 0; i < frames.size(); ++i) {
            if (!is_among_waves(view_at(scene_.camera, frames[i]), grid_options_)) continue;
            frame_.set(scene_.shot.time_s(frames[i]));
            refuse_under_water(frame_, scene_, frames[i], grid_options_);
            if (watch.progress)
                watch.progress(static_cast<double>(i + 1) / static_cast<double>(frames.size()));
            if (watch.cancel && watch.cancel->load(std::memory_order_relaxed)) return false;
        }
        return true;
    }

  private:
    void lay_out_grid() {
        grid_ = projected_grid(view_, grid_options_);
        first_pixel_m_ = T(0);
        if (plan().queries[kQuery].query.pixel_m.size() > 1) {
            const ProjectedGridNeeds own = projected_grid_needs(view_, grid_options_);
            keep_to_rungs(grid_, own);
            first_pixel_m_ = static_cast<T>(first_rung_m(own.finest_pixel_m));
        }
        const std::size_t count = grid_.rest_m.size();
        rest_.assign(grid_.rest_m.begin(), grid_.rest_m.end());
        cell_m_.assign(grid_.cell_m.begin(), grid_.cell_m.end());
        cell_axis_m_.assign(grid_.cell_axis_m.begin(), grid_.cell_axis_m.end());
        position_.resize(count);
        normal_.resize(count);
        Results<T> results;
        results.set(Product::Position, {position_.data()});
        results.set(Product::Normal, {normal_.data()});  // as smooth as the cells: how the pixels lie on them
        evaluate(frame_, kQuery,
                 Points<T>{.origin_m = grid_.origin_m,
                           .count = count,
                           .rest_m = {rest_.data()},
                           .cell_m = {cell_m_.data()},
                           .pixel_m = {cell_m_.data()},
                           .cell_axis_m = {cell_axis_m_.data()},
                           .pixel_axis_m = {cell_axis_m_.data()}},
                 results);
        constexpr double kFirst_m = 1e-6;  // in double precision as good as the eye itself
        const glm::dmat4 clip_from = view_.clip_from(glm::dvec3(grid_.origin_m, 0.0), kFirst_m);
        clip_.resize(count);
        for (std::size_t i = 0; i < count; ++i) clip_[i] = clip_from * glm::dvec4(position_[i], 1.0);
        const ProjectedGridSize size{grid_.columns, grid_.rows};
        if (size != triangles_size_) triangles_ = projected_grid_triangles(size);
        triangles_size_ = size;
        raster_.set(clip_, triangles_, view_.resolution);
    }

    // Which triangle each sample of the rows shows.
    void draw(int first_row, int rows) {
        const auto width = static_cast<std::size_t>(view_.resolution.x);
        batch_.triangles.resize(width * rows);
        batch_.radiance.assign(width * rows, SeaRadiance{});
        const int first_band = first_row / Rasteriser::kBandRows;
        const int bands = (rows + Rasteriser::kBandRows - 1) / Rasteriser::kBandRows;
        tbb::parallel_for(0, bands, [&](int band) {
            const std::size_t begin = width * band * Rasteriser::kBandRows;
            const std::size_t size = std::min(width * Rasteriser::kBandRows, batch_.triangles.size() - begin);
            raster_.draw(first_band + band, std::span(batch_.triangles).subspan(begin, size));
        });
        batch_.sea.clear();
        for (std::size_t i = 0; i < batch_.triangles.size(); ++i)
            if (batch_.triangles[i] != Rasteriser::kNone) batch_.sea.push_back(i);
    }

    // The picture point of a sample of the batch.
    glm::dvec2 centre(int first_row, std::size_t sample) const {
        const auto width = static_cast<std::size_t>(view_.resolution.x);
        return {static_cast<double>(sample % width) + 0.5,
                static_cast<double>(sample / width) + first_row + 0.5};
    }

    template <class Work>
    static void in_parallel(std::size_t count, const Work& work) {
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, kShadeGrain),
                          [&](const tbb::blocked_range<std::size_t>& range) {
                              for (std::size_t i = range.begin(); i < range.end(); ++i) work(i);
                          });
    }

    void light_sky(int first_row) {
        const LightingChoice& lighting = options_.lighting;
        if (!lighting.sky && !lighting.sun) return;
        in_parallel(batch_.triangles.size(), [&](std::size_t i) {
            if (batch_.triangles[i] != Rasteriser::kNone) return;
            const glm::dvec3 direction = view_.direction(centre(first_row, i));
            const auto cos_off_axis = static_cast<float>(glm::dot(direction, view_.forward));
            const Background behind =
                background(sky_, glm::vec3(direction),
                           pixel_angle(static_cast<float>(view_.pixel_tangent()), cos_off_axis));
            if (lighting.sky) batch_.radiance[i].sky += behind.sky;
            if (lighting.sun) batch_.radiance[i].sky += behind.sun;
        });
    }

    void light_sea(int first_row) {
        const std::size_t count = batch_.sea.size();
        if (count == 0) return;
        find_places(first_row);
        ProductSet wanted = plan().queries[kQuery].query.products;
        wanted.reset(index(Product::Position));  // the triangles have them
        runner_.run(frame_, kQuery,
                    Points<T>{.origin_m = grid_.origin_m,
                              .count = count,
                              .rest_m = {batch_.rest.data()},
                              .pixel_m = {batch_.pixel_m.data()},
                              .pixel_axis_m = {batch_.pixel_axis_m.data()}},
                    wanted, batch_.answers);
        const std::vector<glm::vec3>& normal = batch_.answers.vectors(Product::Normal);
        const std::vector<glm::vec3>& slope_variance = batch_.answers.vectors(Product::SlopeVariance);
        const std::vector<float>& coverage = batch_.answers.numbers(Product::Coverage);
        batch_.points.resize(count);
        batch_.lit.resize(count);
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, kShadeGrain),
                          [&](const tbb::blocked_range<std::size_t>& range) {
                              for (std::size_t i = range.begin(); i < range.end(); ++i)
                                  batch_.points[i] = {.to_eye = batch_.to_eye[i],
                                                      .normal = normal[i],
                                                      .slope_variance = slope_variance[i],
                                                      .coverage = coverage.empty() ? 0.0f : coverage[i]};
                              const auto points =
                                  std::span(batch_.points).subspan(range.begin(), range.size());
                              const auto lit = std::span(batch_.lit).subspan(range.begin(), range.size());
                              shade_sea(options_.lighting, sky_, water_, points, lit);
                              for (std::size_t i = range.begin(); i < range.end(); ++i)
                                  batch_.radiance[batch_.sea[i]] = batch_.lit[i];
                          });
    }

    // The place at rest that each sample of the sea shows, its footprint and the way to the eye.
    void find_places(int first_row) {
        const std::size_t count = batch_.sea.size();
        batch_.rest.resize(count);
        batch_.pixel_m.resize(count);
        batch_.pixel_axis_m.resize(count);
        batch_.to_eye.resize(count);
        const glm::dvec3 eye = view_.position_m - glm::dvec3(grid_.origin_m, 0.0);
        in_parallel(count, [&](std::size_t i) {
            const std::uint32_t triangle = batch_.triangles[batch_.sea[i]];
            const glm::dvec3 weights = raster_.weights(triangle, centre(first_row, batch_.sea[i]));
            glm::dvec2 rest(0.0);
            glm::dvec3 position(0.0), normal(0.0);
            double pixel_m = 0.0;
            for (int corner = 0; corner < 3; ++corner) {
                const std::uint32_t vertex = triangles_[3 * std::size_t{triangle} + corner];
                rest += weights[corner] * glm::dvec2(rest_[vertex]);
                position += weights[corner] * glm::dvec3(position_[vertex]);
                pixel_m += weights[corner] * static_cast<double>(grid_.pixel_m[vertex]);
                normal += weights[corner] * glm::dvec3(normal_[vertex]);
            }
            batch_.rest[i] = glm::vec<2, T>(rest);
            const glm::dvec3 way = eye - position;
            const double distance = glm::length(way);
            // At the eye itself, which the near plane keeps from happening, up is as good as any.
            batch_.to_eye[i] = distance > 0.0 ? glm::vec3(way / distance) : glm::vec3(0.0f, 0.0f, 1.0f);
            const glm::dvec3 to_eye(batch_.to_eye[i]), tilt = normal / std::max(glm::length(normal), 1e-9);
            const auto axis = pixel_axis(pixel_m, tilt.x, tilt.y, tilt.z, to_eye.x, to_eye.y, to_eye.z);
            batch_.pixel_axis_m[i] = glm::vec<2, T>(axis.x_m, axis.y_m);
            // Rounding must not reach the rung below the frame's first.
            batch_.pixel_m[i] = std::max(static_cast<T>(pixel_m), first_pixel_m_);
        });
    }

    // The batch's samples into the picture's pixels.
    void average(int first_row, int rows, Picture& picture) const {
        const int n = options_.samples;
        const auto sample_width = static_cast<std::size_t>(view_.resolution.x);
        const auto width = static_cast<std::size_t>(picture.resolution.x);
        const float share = 1.0f / static_cast<float>(n * n);
        tbb::parallel_for(0, rows / n, [&](int row) {
            const std::size_t to = width * (first_row / n + row);
            for (std::size_t x = 0; x < width; ++x) {
                SeaRadiance sum;
                for (int y = 0; y < n; ++y)
                    for (int i = 0; i < n; ++i) {
                        const SeaRadiance& sample = batch_.radiance[sample_width * (row * n + y) + x * n + i];
                        sum.sun += sample.sun;
                        sum.sky += sample.sky;
                        sum.sea += sample.sea;
                        sum.foam += sample.foam;
                    }
                picture.layers[to + x] = {sum.sun * share, sum.sky * share, sum.sea * share,
                                          sum.foam * share};
                const std::size_t middle = sample_width * (row * n + n / 2) + x * n + n / 2;
                picture.sea[to + x] = batch_.triangles[middle] != Rasteriser::kNone;
            }
        });
    }

    static constexpr int kQuery = 0;  // the plan's only one

    Scene scene_;
    RenderOptions options_;
    Sky sky_;
    WaterBody water_;
    std::shared_ptr<const Sea<T>> sea_;
    Frame<T> frame_;
    ProjectedGridOptions grid_options_;
    View view_;
    ProjectedGrid grid_;
    T first_pixel_m_ = T(0);  // the finest rung that the frame reads
    ProjectedGridSize triangles_size_;
    std::vector<std::uint32_t> triangles_;  // vertex indices
    std::vector<glm::vec<2, T>> rest_;      // the grid's own, in T
    std::vector<T> cell_m_;
    std::vector<glm::vec<2, T>> cell_axis_m_;
    std::vector<glm::vec<3, T>> position_, normal_;
    std::vector<glm::dvec4> clip_;
    Rasteriser raster_;
    QueryRunner<T> runner_;
    Batch<T> batch_;
};

}  // namespace

RenderOptions render_options(const Scene& scene) {
    const QualityRow& quality = quality_of(scene.quality.level);
    RenderOptions options;
    options.lighting.whitecaps = !products_gone(scene)[index(Product::Coverage)];
    switch (quality.sky) {
        case SkyLookups::One:
            options.lighting.sky_quality = SkyQuality::One;
            break;
        case SkyLookups::Nine:
            options.lighting.sky_quality = SkyQuality::Nine;
            break;
        case SkyLookups::Integral:
            options.lighting.sky_quality = SkyQuality::Integral;
            break;
    }
    options.lighting.fresnel = quality.fitted_fresnel ? FresnelFit::Exact : FresnelFit::Paper;
    options.samples = quality.samples;
    return options;
}

Plan picture_plan(const Scene& scene, std::span<const int> frames) {
    auto prepared = prepare(scene);
    const ProjectedGridOptions options = projected_grid_options(*prepared);
    std::optional<ProjectedGridNeeds> needs;
    std::optional<View> before;
    for (const int frame : frames) {
        const View view = view_at(scene.camera, frame);
        if (before && *before == view) continue;  // the camera stands still
        const ProjectedGridNeeds own = projected_grid_needs(view, options);
        needs = needs ? together(*needs, own) : own;
        before = view;
    }
    if (!needs) throw std::invalid_argument("a plan of pictures needs at least one frame");
    const Query query = view_query(*prepared, {.products = {},
                                               .finest_cell_m = needs->finest_cell_m,
                                               .finest_pixel_m = needs->finest_pixel_m,
                                               .points = points_of(needs->size)});
    return make_plan(std::move(prepared), {query});
}

void check_render(const Scene& scene, const RenderOptions& options) {
    if (options.samples < 1 || options.samples > kMostSamples)
        throw std::invalid_argument(std::to_string(options.samples) + " x " +
                                    std::to_string(options.samples) + " samples a pixel: 1 to " +
                                    std::to_string(kMostSamples) + " a side are accepted");
    const glm::ivec2 all = scene.camera.resolution * options.samples;
    if (std::max(all.x, all.y) > Rasteriser::kLargestSide)
        throw std::invalid_argument("a picture of " + std::to_string(all.x) + " x " + std::to_string(all.y) +
                                    " samples: up to " + std::to_string(Rasteriser::kLargestSide) +
                                    " a side are accepted; ask for a smaller picture or fewer samples");
}

namespace {

// [bytes] of a point of the grid: as it is laid out, with the one of the frame before, in T, displaced, on the screen
// and in triangles. Of the rasteriser's pieces of triangles, which are fewer where most lie outside the picture, and
// need more room while their vector grows, as many as there are triangles.
template <class T>
constexpr std::size_t kPointBytes = 2 * (3 * sizeof(glm::vec2) + 2 * sizeof(float)) + 2 * sizeof(double) +
                                    6 * sizeof(std::uint32_t) + 11 * sizeof(T) + sizeof(glm::dvec4) +
                                    2 * (Rasteriser::kPieceBytes + sizeof(std::uint32_t));

// [bytes] of a sample of a batch: Batch<T>, with its answers, in double beside those in single.
template <class T>
constexpr std::size_t kSampleBytes = sizeof(std::uint32_t) + 2 * sizeof(SeaRadiance) + sizeof(std::size_t) +
                                     5 * sizeof(T) + sizeof(glm::vec3) + sizeof(SeaPoint) +
                                     7 * sizeof(float) + (sizeof(T) > sizeof(float) ? 7 * sizeof(T) : 0);

}  // namespace

MemoryNeed render_memory(const Scene& scene, const RenderOptions& options, std::span<const int> frames,
                         std::optional<int> in_flight, int threads) {
    const Scene sampled = of_samples(scene, options.samples);
    const Plan plan = picture_plan(sampled, frames);
    MemoryNeed need;
    add_sea(need, plan, threads);
    with_precision(plan.knobs.double_precision, [&]<class T>(T) {
        need.add("the camera's grid of points", plan.queries[0].query.points * kPointBytes<T>,
                 "raise surface.cell_px, or ask for a smaller picture (--size)");
        const glm::ivec2 samples = sampled.camera.resolution;
        const auto rows =
            static_cast<std::size_t>(std::min(rows_of_batch(samples.x, options.samples), samples.y));
        need.add("the pixels at hand", rows * static_cast<std::size_t>(samples.x) * kSampleBytes<T>,
                 "ask for a smaller picture (--size) or fewer --samples");
    });
    const auto pixels = static_cast<std::size_t>(scene.camera.resolution.x) *
                        static_cast<std::size_t>(scene.camera.resolution.y);
    need.add("pictures",
             pixels * (in_flight ? static_cast<std::size_t>(*in_flight) * (kPictureBytes + kFileBytes) +
                                       kEncodingBytes
                                 : kPictureBytes),
             "ask for a smaller picture (--size)");
    return need;
}

Renderer::Renderer(const Scene& scene, const RenderOptions& options, Sky sky, std::span<const int> frames,
                   const BuildWatch& watch) {
    check_render(scene, options);
    const Plan plan = picture_plan(of_samples(scene, options.samples), frames);
    impl_ = with_precision(plan.knobs.double_precision, [&]<class T>(T) -> std::unique_ptr<Impl> {
        return std::make_unique<RendererOf<T, Impl>>(plan, options, std::move(sky), watch);
    });
}

Renderer::~Renderer() = default;

bool Renderer::render(int frame, Picture& picture, const RenderWatch& watch) {
    return impl_->render(frame, picture, watch);
}
bool Renderer::check_cameras(std::span<const int> frames, const RenderWatch& watch) {
    return impl_->check_cameras(frames, watch);
}
const Plan& Renderer::plan() const {
    return impl_->plan();
}
const Sky& Renderer::sky() const {
    return impl_->sky();
}

}  // namespace pelagic
