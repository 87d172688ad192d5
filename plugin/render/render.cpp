#include "plugin/render/render.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <glm/ext/vector_double1.hpp>
#include <glm/ext/vector_float1.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>
#include <iterator>
#include <limits>
#include <numeric>
#include <optional>
#include <span>
#include <utility>

#include "core/base/precision.h"
#include "core/base/random.h"
#include "core/evaluate/hulls.h"
#include "core/lighting/background.h"
#include "core/lighting/meniscus.h"
#include "core/lighting/object.h"
#include "core/lighting/spray.h"
#include "core/plan/hulls.h"
#include "core/surface/earth.h"
#include "core/surface/footprint_levels.h"
#include "core/surface/pixel_footprint.h"
#include "core/surface/view.h"
#include "plugin/render/batch.h"
#include "plugin/render/cryptomatte.h"
#include "plugin/render/drawn_sea.h"
#include "plugin/render/motion.h"
#include "plugin/render/objects.h"
#include "plugin/render/passes.h"
#include "plugin/render/raster.h"
#include "plugin/render/sea_light.h"
#include "plugin/render/seen_drops.h"
#include "plugin/render/under_water.h"
#include "plugin/render/waterline.h"

namespace pelagic {

class Renderer::Impl {
  public:
    virtual ~Impl() = default;
    virtual void render(int frame, Picture& picture, const BuildWatch& watch) = 0;
    virtual void check_cameras(std::span<const int> frames, const BuildWatch& watch) = 0;
    virtual const Plan& plan() const = 0;
    virtual const Sky& sky() const = 0;
};

namespace {

// Which samples are taken at once: all of them, or of each pixel the one in this column and row; or one of each pixel
// that takes the pass, where place_of() says.
struct SamplesOfPass {
    int stride = 1;  // samples between two that are taken
    glm::dvec2 first{0.0};
    bool is_by_pixel = false;
};

// A row of a window's pixels, from the picture's pixel `first` on.
struct DeepRow : DeepPixels {
    std::size_t first = 0;
};

constexpr float kSprayEndless_m = 1e30f;  // where there is no sea

// Of a scene of samples, in the plan's precision; Impl is Renderer's own.
template <class T, class Impl>
class RendererOf final : public Impl {
  public:
    RendererOf(const Plan& plan, const RenderOptions& options, Sky sky, const BuildWatch& watch)
        : scene_(plan.from->scene),
          options_(options),
          sea_(plan, options.lighting, std::move(sky), watch),
          drawn_(*plan.from, plan.queries[kQuery].query.pixel_m.size() > 1),
          display_(scene_.camera.resolution / options.samples),
          data_(data_window(display_, options)),
          picture_parts_(picture_parts(display_, options)) {
        options_.layers = layers_of(!scene_.objects.empty(), options_.layers);
        if (scene_.objects.empty()) return;
        objects_ = std::make_unique<LitObjects>(scene_);
        if (hulls_query(plan)) hulls_.emplace(scene_);
        for (const SceneObject& object : scene_.objects) mattes_.push_back(matte_id(object.called()));
    }

    const Plan& plan() const override { return sea_.plan(); }
    const Sky& sky() const override { return sea_.sky(); }

    void render(int frame, Picture& picture, const BuildWatch& watch) override {
        const int n = options_.samples;
        clear(picture);
        cancel_ = watch.cancel;
        const bool is_other_light = sea_.light_frame(frame);
        if (is_other_light) air_ = {};
        if (objects_ && (is_other_light || !scene_.keyed.empty() || !are_objects_lit_)) {
            objects_->light(sea_);
            are_objects_lit_ = true;
        }
        const auto [all, parts] = passes_of(scene_.camera, frame, options_);
        const auto passes = static_cast<int>(all.size());
        // In rising time, so that foam's past is gone through once.
        std::vector<int> order(all.size());
        std::iota(order.begin(), order.end(), 0);
        std::stable_sort(order.begin(), order.end(),
                         [&](int a, int b) { return all[a].frame < all[b].frame; });
        double begun = 0.0;  // the share of the part that its foam's past took
        double ended = 0.0;  // the share of the picture, in parts of its passes
        double share = 1.0;  // of the part
        const auto tell = [&](double done) {
            if (watch.progress) watch.progress(ended + share * (begun + (1.0 - begun) * done));
        };
        const auto pixels = [](const PixelWindow& window) {
            return static_cast<double>(window.size().x) * window.size().y;
        };
        for (const int pass : order) {
            // With others the first pass is for what isn't blurred.
            const bool is_own = pass == 0, is_lit = passes == 1 || !is_own;
            sampling_ = passes == 1 ? SamplesOfPass{}
                        : is_own ? SamplesOfPass{n, glm::dvec2(n / 2) + place_in_cell(n, glm::ivec2(n / 2))}
                                 : SamplesOfPass{n, glm::dvec2(0.5 * (n - 1)), true};
            pass_ = all[pass];
            parts_ = parts;
            frame_ = frame;
            const bool is_answered = is_lit || has_data();
            for (const PicturePart& part : picture_parts_) {
                double all_pixels = 0.0, done_pixels = 0.0;
                for (const PixelWindow& window : part.windows) all_pixels += pixels(window);
                share = all_pixels / pixels(data_) / passes;
                begun = 0.0;
                begin(all[pass], part, is_lit, watch);
                if (is_answered && sea_.foam_lives()) {
                    const BuildWatch past{.progress =
                                              [&](double done) {
                                                  begun = 0.5 * done;
                                                  tell(0.0);
                                              },
                                          .cancel = watch.cancel};
                    prepare(part, past);
                }
                for (const PixelWindow& window : part.windows) {
                    aim(window);
                    const auto [height, step] = std::pair(drawn_window().size().y, rows_of_pass());
                    for (int row = 0; row < height; row += step) {
                        const int rows = std::min(step, height - row);
                        draw(row, rows);
                        if (is_lit) light_sky(row);
                        if (is_answered && !batch_.sea.empty()) {
                            find_places(row);
                            sea_.answer(batch_.seen);
                            if (hulls_) sea_.add_foam_of(*hulls_, batch_.seen);
                        }
                        if (is_lit) light_sea(row);
                        if (is_lit) light_water(row);
                        if (is_lit && objects_) light_objects(row);
                        if (is_lit) light_meniscus(row);
                        if (is_lit && !drops_.empty()) draw_drops(row, rows);
                        if (is_lit) average(row, rows, picture);
                        if (is_own) describe(row, rows, frame, picture);
                        tell((done_pixels + pixels(window) * (row + rows) / height) / all_pixels);
                        stop_if(watch.cancel);
                    }
                    done_pixels += pixels(window);
                }
                ended += share;
            }
        }
        std::sort(picture.skyline.begin(), picture.skyline.end(),
                  [](const SkylinePixel& a, const SkylinePixel& b) { return a.pixel < b.pixel; });
        if (objects_) end_objects(picture);
        if (options_.deep) end_deep(picture);
    }

    void check_cameras(std::span<const int> frames, const BuildWatch& watch) override {
        for (std::size_t i = 0; i < frames.size(); ++i)
            for (const PicturePass& pass : passes_of(scene_.camera, frames[i], options_).all) {
                if (drawn_.has_below())
                    refuse_in_floor(scene_, pass.frame, sea_.floor_below(drawn_.rest_m()));
                if (drawn_.has_below() || !may_be_wet(pass.frame)) continue;
                set_time(pass.frame, watch);
                drawn_.refuse_under_water(sea_.frame(), scene_, pass.frame);
                if (watch.progress)
                    watch.progress(static_cast<double>(i + 1) / static_cast<double>(frames.size()));
                stop_if(watch.cancel);
            }
    }

  private:
    bool may_be_wet(double frame) const {
        const View view = view_at(scene_.camera, frame);
        return drawn_.cage_above(view) || drawn_.may_be_under_waves(view);
    }
    bool has_data() const { return data_components(options_.layers) > 0; }
    glm::ivec2 raster_size() const { return view_.resolution / sampling_.stride; }
    // The window in the rasteriser's pixels.
    PixelWindow drawn_window() const {
        const int a_pixel = options_.samples / sampling_.stride;
        return {(window_.low + overscan_px_) * a_pixel, (window_.high + overscan_px_) * a_pixel};
    }
    // From here on batches are of this window, one of the part's.
    void aim(const PixelWindow& window) {
        if (is_aimed_ && window == window_) return;
        window_ = window;
        raster_.set(clip_, mesh_.triangles, raster_size(), has_places(), drawn_window());
        is_aimed_ = true;
    }
    // Of the picture, the pixel in which a row of samples of the batch begins.
    std::size_t first_pixel(const Picture& picture, int row) const {
        const glm::ivec2 at = window_.low - data_.low + glm::ivec2(0, row);
        return static_cast<std::size_t>(picture.resolution.x) * static_cast<std::size_t>(at.y) +
               static_cast<std::size_t>(at.x);
    }

    void clear(Picture& picture) {
        picture.resolution = data_.size();
        unranked_.assign(objects_ ? static_cast<std::size_t>(picture.resolution.y) : 0, {});
        picture.low = data_.low;
        picture.deep.counts.clear();
        picture.deep.samples.clear();
        deep_rows_.clear();
        picture.display.reset();
        if (data_ != PixelWindow{.high = display_}) picture.display = display_;
        const auto pixels = static_cast<std::size_t>(picture.resolution.x) * picture.resolution.y;
        picture.layers.assign(pixels, SeaRadiance{});
        picture.sea.resize(pixels);
        picture.skyline.clear();
        picture.alpha.assign(options_.alpha ? pixels : 0, 0.0f);
        for (const PictureLayerRow& row : kPictureLayers)
            picture.data[index(row.layer)].resize(
                !is_light(row) && options_.layers[index(row.layer)] ? pixels * row.components : 0);
        for (const PictureLayer layer :
             {PictureLayer::Object, PictureLayer::Reflection, PictureLayer::Cryptomatte}) {
            std::vector<float>& of = picture.data[index(layer)];
            const bool is_there = layer == PictureLayer::Cryptomatte ? !of.empty() : objects_ != nullptr;
            of.assign(is_there ? pixels * kPictureLayers[index(layer)].components : 0, 0.0f);
        }
    }

    // Rows that are computed at once.
    int rows_of_pass() const {
        return rows_of_batch(drawn_window().size().x, options_.samples / sampling_.stride);
    }

    // Makes the foam that earlier times have left where the samples look. So the samples' places are found twice,
    // which takes far less than going through the past once for each batch.
    void prepare(const PicturePart& part, const BuildWatch& watch) {
        for (const PixelWindow& window : part.windows) {
            aim(window);
            const auto [height, step] = std::pair(drawn_window().size().y, rows_of_pass());
            for (int row = 0; row < height; row += step) {
                stop_if(watch.cancel);
                draw(row, std::min(step, height - row));
                if (batch_.sea.empty()) continue;
                find_places(row);
                sea_.say(batch_.seen.points());
            }
        }
        sea_.prepare(watch);
    }

    // Passes through a lens alone share the sea.
    void set_time(double frame, const BuildWatch& watch) {
        const double time_s = scene_.shot.time_s(frame);
        if (time_s == set_s_) return;
        set_s_.reset();  // until it is
        sea_.set(time_s, watch.cancel);
        set_s_ = time_s;
    }

    // Of large pictures each step takes tenths of a second.
    void begin(const PicturePass& pass, const PicturePart& part, bool is_lit, const BuildWatch& watch) {
        set_time(pass.frame, watch);
        if (drawn_.has_below())
            refuse_in_floor(scene_, pass.frame, sea_.floor_below(drawn_.rest_m()));
        else
            drawn_.refuse_under_water(sea_.frame(), scene_, pass.frame);
        overscan_px_ = part.overscan_px;
        const glm::ivec2 overscan = overscan_px_ * options_.samples;
        view_ = view_of(scene_.camera, pass, overscan);
        may_be_below_ = drawn_.has_below() && may_be_in_water(view_, drawn_.grid_options().bounds.height_m);
        // Before all of the lens the air is that before its middle.
        const double height_m = view_at(scene_.camera, pass.frame).position_m.z;
        if (air_.empty() || height_m != air_height_m_) air_ = sea_.air_before(height_m);
        air_height_m_ = height_m;
        stop_if(watch.cancel);
        lay_out_mesh(part, watch);
        if (objects_) {
            objects_->place(sea_.frame(), pass.frame,
                            {.origin_m = mesh_.points.origin_m,
                             .curvature_per_m = mesh_.points.curvature_per_m,
                             .rest_m = [&](glm::dvec2 place_m) { return drawn_.rest_m(place_m); },
                             .has_motion = needs_motion(options_.layers)});
        }
        if (hulls_)
            hulls_->place(sea_.frame(), hulls_query(plan()), pass.frame,
                          [&](glm::dvec2 place_m) { return drawn_.rest_m(place_m); });
        if (is_lit && objects_ && objects_->has_caustics()) {
            // Of the middle of the lens, and of no overscan: the same for all parts of a picture.
            FloorLightWanted footprints;
            footprints.view = view_at(scene_.camera, pass.frame);
            set_footprints(footprints, drawn_, {footprints.view, frame_});
            objects_->find_caustics(sea_,
                                    {.eye_m = footprints.view.position_m,
                                     .pixel_tangent = footprints.view.pixel_tangent(),
                                     .finest_m = footprints.finest_m,
                                     .finest_cell_m = footprints.finest_cell_m},
                                    watch.cancel);
        }
        if (is_lit && sea_.water().has_body) {
            // Of the middle of the lens, whose other places see the same maps.
            const SeaView middle{with_overscan(view_at(scene_.camera, pass.frame), overscan), frame_};
            FloorLightWanted wanted;
            wanted.view = middle.view;
            // Places of a lens may differ; made for one of them, the maps are for all.
            wanted.is_below = waterline_ && (scene_.camera.f_stop > 0.0 || waterline_->is_any_under());
            set_footprints(wanted, drawn_, middle);
            sea_.light_floor_before(wanted, drawn_.rest_m(), watch.cancel);
        }
        find_drops(pass, watch);
        stop_if(watch.cancel);
    }

    // The spray, with the drops in it that are seen one by one.
    void find_drops(const PicturePass& pass, const BuildWatch& watch) {
        drops_.clear();
        spray_ = {};
        if (drawn_.is_below(view_)) return;
        const bool are_near = options_.lighting.spray && are_drops_near(scene_, view_);
        spray_ = sea_.spray_before(view_, drawn_.grid_options(), options_.samples, are_near);
        if (!are_near || spray_.empty()) return;
        if (!flying_) flying_.emplace(sea_.frame().sea(), kDropsSquare_m, watch);
        flying_->at(scene_.shot.time_s(pass.frame), glm::dvec2(view_.position_m), in_air_, watch.cancel);
        drops_ = seen_drops(in_air_, {.view = view_,
                                      .curvature_per_m = drawn_.grid_options().curvature_per_m,
                                      .air = options_.lighting.air ? &air_ : nullptr,
                                      .spray = spray_});
    }

    void lay_out_mesh(const PicturePart& part, const BuildWatch& watch) {
        const SeaView seen{view_, frame_};
        drawn_.lay_out(seen, mesh_);
        stop_if(watch.cancel);
        const ProjectedGrid& grid = mesh_.points;
        first_pixel_m_ = drawn_.grid_options().has_levels
                             ? static_cast<T>(first_level_m(drawn_.needs(seen).finest_pixel_m))
                             : T(0);
        const std::size_t count = grid.rest_m.size();
        rest_.assign(grid.rest_m.begin(), grid.rest_m.end());
        cell_m_.assign(grid.cell_m.begin(), grid.cell_m.end());
        cell_axis_m_.assign(grid.cell_axis_m.begin(), grid.cell_axis_m.end());
        position_.resize(count);
        Results<T> results;
        results.set(Product::Position, {position_.data()});
        if (needs_motion(options_.layers)) {
            velocity_.resize(count);
            results.set(Product::Velocity, {velocity_.data()});
        }
        evaluate(sea_.frame(), kQuery,
                 Points<T>{.origin_m = grid.origin_m,
                           .count = count,
                           .rest_m = {rest_.data()},
                           .cell_m = {cell_m_.data()},
                           .cell_axis_m = {cell_axis_m_.data()}},
                 results);
        stop_if(watch.cancel);
        find_mesh_variance();
        stop_if(watch.cancel);
        find_crests();
        stop_if(watch.cancel);
        for (std::size_t i = 0; i < mesh_.height_m.size(); ++i)
            position_[i].z += static_cast<T>(mesh_.height_m[i]);
        constexpr double kFirst_m = 1e-6;  // in double precision as good as the eye itself
        for (glm::vec<3, T>& position : position_)
            position = glm::vec<3, T>(on_earth(glm::dvec3(position), grid.curvature_per_m));
        for (std::size_t i = 0; i < velocity_.size(); ++i)
            velocity_[i] = glm::vec<3, T>(
                from_level(glm::dvec3(velocity_[i]), earth_up(glm::dvec2(rest_[i]), grid.curvature_per_m)));
        const glm::dmat4 clip_from =
            view_.clip_from(glm::dvec3(grid.origin_m, 0.0), may_be_below_ ? kFrontGlass_m : kFirst_m);
        clip_.resize(count);
        // Moves the samples that are taken to the middles of the rasteriser's pixels.
        const glm::dvec2 shift = (static_cast<double>(sampling_.stride - 1) - 2.0 * sampling_.first) /
                                 glm::dvec2(view_.resolution);
        for (std::size_t i = 0; i < count; ++i) {
            clip_[i] = clip_from * glm::dvec4(position_[i], 1.0);
            clip_[i].x += shift.x * clip_[i].w;
            clip_[i].y -= shift.y * clip_[i].w;
        }
        stop_if(watch.cancel);
        is_aimed_ = false;
        aim(part.windows.front());
        stop_if(watch.cancel);
        waterline_.reset();
        if (may_be_below_)
            waterline_.emplace(view_, drawn_.grid_options().bounds.height_m, grid.origin_m,
                               std::span<const glm::vec<3, T>>(position_), mesh_.triangles);
        stop_if(watch.cancel);
    }

    // The slopes that the cells leave unresolved, at rest.
    void find_mesh_variance() {
        const std::size_t count = mesh_.points.rest_m.size();
        mesh_variance_.resize(count);
        std::vector<T> width_m = cell_m_;
        for (T& width : width_m) width = std::max(width, first_pixel_m_);
        Results<T> results;
        results.set(Product::SlopeVarianceAtRest, {mesh_variance_.data()});
        evaluate(sea_.frame(), kQuery,
                 Points<T>{.origin_m = mesh_.points.origin_m,
                           .count = count,
                           .rest_m = {rest_.data()},
                           .pixel_m = {width_m.data()},
                           .pixel_axis_m = {cell_axis_m_.data()}},
                 results);
    }

    // The shape of the long waves, where it shapes the light in the water.
    void find_crests() {
        crest_.clear();
        if (!mesh_.normal.empty()) return;
        std::vector<T> width_m = cell_m_;
        for (T& width : width_m) width = std::max(width, first_pixel_m_);
        sea_.find_crests(mesh_.points.origin_m, rest_, std::move(width_m), cell_axis_m_, crest_);
    }

    // Whether samples lie anywhere but in the middles of the rasteriser's pixels.
    bool has_places() const {
        return sampling_.is_by_pixel || (sampling_.stride == 1 && options_.samples > 1);
    }
    PixelPlace place_of_sample(glm::ivec2 sample) const {
        const glm::dvec2 place = 256.0 * place_in_cell(options_.samples, sample % options_.samples);
        return {.x = static_cast<std::int16_t>(std::lround(place.x)),
                .y = static_cast<std::int16_t>(std::lround(place.y))};
    }

    // Which triangle each sample of the rows shows.
    void draw(int first_row, int rows) {
        const auto width = static_cast<std::size_t>(drawn_window().size().x);
        batch_.triangles.resize(width * rows);
        batch_.radiance.assign(width * rows, SeaRadiance{});
        batch_.places.resize(has_places() ? width * rows : 0);
        const int first_band = first_row / Rasteriser::kBandRows;
        const int bands = (rows + Rasteriser::kBandRows - 1) / Rasteriser::kBandRows;
        tbb::parallel_for(0, bands, [&](int band) {
            const std::size_t begin = width * band * Rasteriser::kBandRows;
            const std::size_t size = std::min(width * Rasteriser::kBandRows, batch_.triangles.size() - begin);
            const std::span places = batch_.places.empty() ? std::span<PixelPlace>{}
                                                           : std::span(batch_.places).subspan(begin, size);
            for (std::size_t i = 0; i < places.size(); ++i) {
                const std::size_t at = begin + i;
                const glm::ivec2 pixel(static_cast<int>(at % width),
                                       first_row + static_cast<int>(at / width));
                places[i] = sampling_.is_by_pixel
                                ? place_of(pass_, parts_, options_.samples, frame_, window_.low + pixel)
                                : place_of_sample(pixel);
            }
            raster_.draw(first_band + band, std::span(batch_.triangles).subspan(begin, size), places);
        });
        find_water(first_row);
        find_objects(first_row);
        batch_.sea.clear();
        for (std::size_t i = 0; i < batch_.triangles.size(); ++i)
            if (batch_.triangles[i] != Rasteriser::kNone) batch_.sea.push_back(i);
    }

    // Which samples look through water, which of these meet no surface, and which look through what climbs the glass: where they do with
    // all of their light, nothing else is seen.
    void find_water(int first_row) {
        batch_.water.clear();
        batch_.climbed.clear();
        const std::size_t count = waterline_ ? batch_.triangles.size() : 0;
        batch_.under.assign(count, 0);
        batch_.glass_m.assign(count, std::numeric_limits<double>::infinity());
        in_parallel(count, [&](std::size_t i) {
            if (!batch_.places.empty() && !batch_.places[i].is_taken()) return;
            batch_.glass_m[i] = waterline_->height_m(seen_at(first_row, i));
            batch_.under[i] = batch_.glass_m[i] < 0.0 || meniscus_share(batch_.glass_m[i]) == 1.0f;
        });
        for (std::size_t i = 0; i < count; ++i) {
            if (batch_.glass_m[i] >= 0.0) {
                if (meniscus_share(batch_.glass_m[i]) > 0.0f) batch_.climbed.push_back(i);
                if (is_under(i)) batch_.triangles[i] = Rasteriser::kNone;
            } else if (batch_.triangles[i] == Rasteriser::kNone) {
                batch_.water.push_back(i);
            }
        }
    }
    // Which samples show a body: one before the sea, or behind water that is drawn within a dry hull.
    void find_objects(int first_row) {
        batch_.body.assign(objects_ ? batch_.triangles.size() : 0, RayHit{});
        in_parallel(batch_.body.size(), [&](std::size_t i) {
            if (!batch_.places.empty() && !batch_.places[i].is_taken()) return;
            if (is_under(i) && batch_.glass_m[i] >= 0.0)
                return;  // all of it looks through what climbs the glass
            const Ray ray = ray_of(first_row, i);
            RayHit hit = objects_->nearest(ray);
            if (batch_.triangles[i] != Rasteriser::kNone) {
                const glm::vec3 place = sea_place(first_row, i);
                const float sea_m = glm::length(place - ray.from);
                if (hit.is_hit() && hit.distance_m >= sea_m) {
                    hit = {};
                    if (!is_under(i) && objects_->is_dry(place)) {
                        hit = objects_->nearest({.from = place, .towards = ray.towards});
                        if (hit.is_hit()) hit.distance_m += sea_m;
                    }
                }
            }
            if (!hit.is_hit()) return;
            batch_.body[i] = hit;
            batch_.triangles[i] = Rasteriser::kNone;
        });
        if (objects_) std::erase_if(batch_.water, [&](std::size_t sample) { return is_object(sample); });
    }
    bool is_object(std::size_t sample) const { return !batch_.body.empty() && batch_.body[sample].is_hit(); }

    // Places before the view's eye as LitObjects has them.
    glm::dvec3 eye_place() const { return view_.position_m - glm::dvec3(mesh_.points.origin_m, 0.0); }
    Ray ray_of(int first_row, std::size_t sample) const {
        const glm::dvec3 towards = view_.direction(seen_at(first_row, sample));
        return {.from = glm::vec3(eye_place()),
                .towards = glm::vec3(towards),
                .spread = sample_tangent() * static_cast<float>(glm::dot(towards, view_.forward))};
    }
    // What a sample covers in the picture's middle: the view has a pixel for each.
    float sample_tangent() const { return static_cast<float>(view_.pixel_tangent()); }
    glm::vec3 sea_place(int first_row, std::size_t sample) const {
        const std::uint32_t triangle = batch_.triangles[sample];
        const glm::dvec3 weights = raster_.weights(triangle, centre(first_row, sample));
        glm::dvec3 place(0.0);
        for (int corner = 0; corner < 3; ++corner)
            place +=
                weights[corner] * glm::dvec3(position_[mesh_.triangles[3 * std::size_t{triangle} + corner]]);
        return glm::vec3(place);
    }
    // Of the display window's pixels, whatever window they are drawn in.
    SampleNumbers numbers_of(int first_row, std::size_t sample) const {
        const auto width = static_cast<std::size_t>(drawn_window().size().x);
        const int a_pixel = options_.samples / sampling_.stride;  // samples, a side
        const glm::ivec2 at(static_cast<int>(sample % width), static_cast<int>(sample / width) + first_row),
            pixel = window_.low + at / a_pixel, in_pixel = at % a_pixel;
        const auto n = static_cast<std::uint32_t>(options_.samples);
        SampleNumbers numbers{.x = static_cast<std::uint32_t>(pixel.x),
                              .y = static_cast<std::uint32_t>(pixel.y),
                              .frame = static_cast<std::uint32_t>(frame_),
                              .all = n * n};
        if (sampling_.is_by_pixel)
            numbers.index = static_cast<std::uint32_t>(pass_.stratum);
        else
            numbers.index = static_cast<std::uint32_t>(in_pixel.y * a_pixel + in_pixel.x);
        return numbers;
    }

    // Of a sample that stands for all of its pixel.
    SampleNumbers numbers_of_middle(int first_row, std::size_t sample) const {
        SampleNumbers numbers = numbers_of(first_row, sample);
        numbers.index = 0;
        numbers.all = 1;
        return numbers;
    }

    bool is_under(std::size_t sample) const { return !batch_.under.empty() && batch_.under[sample] != 0; }
    bool is_sea(std::size_t sample) const {
        return batch_.triangles[sample] != Rasteriser::kNone || is_under(sample);
    }

    // A sample of the batch in the rasteriser's pixels, and in those of the view.
    glm::dvec2 centre(int first_row, std::size_t sample) const {
        const PixelWindow window = drawn_window();
        const auto width = static_cast<std::size_t>(window.size().x);
        const glm::dvec2 middle(static_cast<double>(sample % width) + window.low.x + 0.5,
                                static_cast<double>(sample / width) + first_row + window.low.y + 0.5);
        if (batch_.places.empty()) return middle;
        const PixelPlace place = batch_.places[sample];
        return middle + glm::dvec2(place.x, place.y) / 256.0;
    }
    glm::dvec2 seen_at(int first_row, std::size_t sample) const {
        return (centre(first_row, sample) - 0.5) * static_cast<double>(sampling_.stride) + sampling_.first +
               0.5;
    }

    // Leaves work out once a run is cancelled.
    template <class Work>
    void in_parallel(std::size_t count, const Work& work) const {
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, kShadeGrain),
                          [&](const tbb::blocked_range<std::size_t>& range) {
                              if (cancel_ && *cancel_) return;
                              for (std::size_t i = range.begin(); i < range.end(); ++i) work(i);
                          });
    }

    void light_sky(int first_row) {
        const LightingChoice& lighting = options_.lighting;
        const bool has_sky = (lighting.sky || lighting.sun) && !options_.alpha, has_spray = !spray_.empty();
        const bool has_veil = options_.alpha && (has_spray || !batch_.climbed.empty());
        batch_.veil.assign(has_veil ? batch_.triangles.size() : 0, 0.0f);
        if (!has_sky && !has_spray) return;
        in_parallel(batch_.triangles.size(), [&](std::size_t i) {
            if (is_sea(i) || is_object(i)) return;
            if (!batch_.places.empty() && !batch_.places[i].is_taken()) return;
            const glm::dvec3 direction = view_.direction(seen_at(first_row, i));
            const auto cos_off_axis = static_cast<float>(glm::dot(direction, view_.forward));
            if (has_sky)
                batch_.radiance[i] =
                    sea_.behind(air_, glm::vec3(direction),
                                pixel_angle(static_cast<float>(view_.pixel_tangent()), cos_off_axis));
            if (!has_spray) return;
            const float left = see_through_spray(spray_, glm::vec3(direction), {}, batch_.radiance[i]);
            if (options_.alpha) batch_.veil[i] = 1.0f - left;
        });
    }

    void light_sea(int first_row) {
        batch_.in_sea.assign(objects_ ? batch_.triangles.size() : 0, BodiesInSea{});
        if (batch_.sea.empty()) return;
        batch_.lit.resize(batch_.sea.size());
        sea_.light(batch_.seen, sea_.sky(), air_, spray_, batch_.lit);
        if (objects_) {
            shadow_sea(first_row);
            if (objects_->has_lamps()) light_sea_by_lamps(first_row);
            mirror_objects(first_row);
            see_into_water(first_row);
        }
        for (std::size_t i = 0; i < batch_.sea.size(); ++i) batch_.radiance[batch_.sea[i]] = batch_.lit[i];
    }

    // Where bodies hide the sun from the sea.
    void shadow_sea(int first_row) {
        const std::size_t count = batch_.sea.size();
        batch_.sun_share.resize(count);
        batch_.in_shadow.assign(count, 0);
        in_parallel(count, [&](std::size_t i) {
            batch_.sun_share[i] = objects_->sun_share(sea_place(first_row, batch_.sea[i]), batch_.seen.up[i],
                                                      numbers_of(first_row, batch_.sea[i]));
            batch_.in_shadow[i] = batch_.sun_share[i] < 1.0f;
        });
        if (std::find(batch_.in_shadow.begin(), batch_.in_shadow.end(), 1) == batch_.in_shadow.end()) return;
        Sky unlit = sea_.sky();
        unlit.sun_radiance = unlit.sun_irradiance = glm::vec3(0.0f);
        // From high up each place has its own sun, which the air's table holds: there the sky of the eye's nadir has to do.
        Air air = air_;
        air.by_place = 0.0f;
        batch_.unlit.resize(count);
        sea_.light(batch_.seen, unlit, air, spray_, batch_.unlit, batch_.in_shadow);
        in_parallel(count, [&](std::size_t i) {
            if (!batch_.in_shadow[i]) return;
            const float share = batch_.sun_share[i];
            SeaRadiance& lit = batch_.lit[i];
            lit.sun *= share;
            // Of what the water between a place and an eye below it scatters, little goes through the place.
            if (!batch_.seen.from_below.empty() && batch_.seen.from_below[i] != 0) return;
            lit.sea = glm::mix(batch_.unlit[i].sea, lit.sea, share);
            lit.foam = glm::mix(batch_.unlit[i].foam, lit.foam, share);
        });
    }

    glm::vec3 upright(std::size_t i) const {
        return glm::vec3(from_level(glm::dvec3(sea_.answers().vectors(Product::Normal)[i]),
                                    glm::dvec3(batch_.seen.up[i])));
    }
    glm::vec3 above_sea(int first_row, std::size_t i) const {
        return sea_place(first_row, batch_.sea[i]) + 1e-3f * batch_.seen.up[i];
    }

    // Foam and the water send back lamps' light as they do the sky's.
    void light_sea_by_lamps(int first_row) {
        const std::size_t count = batch_.sea.size();
        std::vector<std::uint8_t>& is_lit = batch_.in_shadow;
        batch_.lamplight.resize(count);
        is_lit.assign(count, 0);
        in_parallel(count, [&](std::size_t i) {
            if (!batch_.seen.from_below.empty() && batch_.seen.from_below[i] != 0) return;
            batch_.lamplight[i] = objects_->lamplight(above_sea(first_row, i), upright(i),
                                                      numbers_of(first_row, batch_.sea[i]));
            is_lit[i] = batch_.lamplight[i] != glm::vec3(0.0f);
        });
        if (std::find(is_lit.begin(), is_lit.end(), 1) == is_lit.end()) return;
        Sky white = sea_.sky();
        white.sun_radiance = white.sun_irradiance = glm::vec3(0.0f);
        white.sky_irradiance = glm::vec3(1.0f);
        Air air = air_;
        air.by_place = 0.0f;
        batch_.unlit.resize(count);
        sea_.light(batch_.seen, white, air, spray_, batch_.unlit, is_lit);
        in_parallel(count, [&](std::size_t i) {
            if (!is_lit[i]) return;
            batch_.lit[i].sea += batch_.lamplight[i] * batch_.unlit[i].sea;
            batch_.lit[i].foam += batch_.lamplight[i] * batch_.unlit[i].foam;
        });
    }

    // What facets of the sea mirror of bodies, in place of the sky behind them.
    void mirror_objects(int first_row) {
        const std::vector<glm::vec3>& variance = sea_.answers().vectors(Product::SlopeVariance);
        in_parallel(batch_.sea.size(), [&](std::size_t i) {
            if (!batch_.seen.from_below.empty() && batch_.seen.from_below[i] != 0) return;
            const std::size_t sample = batch_.sea[i];
            const bool may_be_mirrored =
                objects_->may_be_mirrored(sea_place(first_row, sample), batch_.seen.to_eye[i], upright(i),
                                          variance[i].x + variance[i].y + batch_.seen.mesh_variance[i]);
            if (!may_be_mirrored && !objects_->has_lamps()) return;
            const SampleNumbers numbers = numbers_of(first_row, sample);
            const SeaFacets facets = sea_.facets(batch_.seen, i);
            const std::uint32_t rays =
                may_be_mirrored ? numbers.rays(kMirroringFacets, kLeastMirroringFacets) : 0;
            LitObjects::LampsInSea lamps;
            if (objects_->has_lamps())
                lamps = objects_->lamps_in(facets, above_sea(first_row, i), rays, numbers);
            if (rays == 0 && lamps.count == 0) return;
            const glm::vec3 left = left_before(i);
            if (lamps.count > 0)
                batch_.in_sea[sample].more += left * objects_->mirrored_places(lamps, numbers);
            if (rays == 0) return;
            // Facets of slopes so spread turn the rays by twice as much, of which each of them has its share.
            const float spread =
                sample_tangent() +
                2.0f * std::sqrt((variance[i].x + variance[i].y + batch_.seen.mesh_variance[i]) /
                                 static_cast<float>(rays));
            mirror_by_rays(facets,
                           {.from = above_sea(first_row, i),
                            .width_m = sample_tangent() * batch_.seen.distance_m[i],
                            .spread = spread},
                           left, numbers, lamps, batch_.in_sea[sample], rays);
        });
    }

    // Of a pixel, and of a sample at least: each sample has a slope of its own, and with four facets a rough sea's mirror image is grain.
    static constexpr std::uint32_t kMirroringFacets = 128, kLeastMirroringFacets = 16;

    // ray: all but where it goes.
    void mirror_by_rays(const SeaFacets& facets, Ray ray, const glm::vec3& left, const SampleNumbers& numbers,
                        const LitObjects::LampsInSea& lamps, BodiesInSea& shown, std::uint32_t count) const {
        constexpr std::uint32_t kUse = 100, kBounce = 101;
        const SampleNumbers::Places of_facets = numbers.places(kUse), bounces = numbers.places(kBounce);
        // All facets of a pixel lie at even steps of x from a place that chance gives, a sample's far from each other: the sum of a bell
        // at even steps hardly depends on where they begin.
        const auto n = static_cast<std::uint32_t>(options_.samples);
        const auto drawn = philox({numbers.x, numbers.y, numbers.frame, kUse}, kUse);
        const float begin = static_cast<float>(drawn[0] >> 8) * 0x1p-24f;
        const std::uint32_t turn = (numbers.index * (n + 1) + drawn[1] % numbers.all) % numbers.all;
        for (std::uint32_t k = 0; k < count; ++k) {
            glm::vec2 place = of_facets.of(k, count);
            place.x = (static_cast<float>(k * numbers.all + turn) + begin) /
                      static_cast<float>(count * numbers.all);
            const MirroredLight mirrored = facets.mirrored(place, count);
            if (!(mirrored.weight > 0.0f)) continue;
            ray.towards = mirrored.from;
            const glm::vec3 weight = mirrored.weight * left, sky = weight * objects_->sky(ray.towards);
            shown.sky += sky;
            const RayHit hit = objects_->nearest(ray);
            if (!hit.is_hit()) continue;
            glm::vec3 light = objects_->estimate(ray, hit, bounces.of(k, count));
            if (lamps.count > 0) {
                const auto [of_lamp, part] = objects_->lamp_met(lamps, ray, hit);
                light -= of_lamp;
                shown.more += (part * weight) * of_lamp;
            }
            shown.mirrored += weight * light;
            shown.hidden += sky;
        }
    }

    // Bodies in the water, through its surface as one mean facet, and in front of what the water behind them sends.
    void see_into_water(int first_row) {
        if (!options_.lighting.water || !sea_.water().has_body) return;
        const std::vector<glm::vec3>& normal = sea_.answers().vectors(Product::Normal);
        const std::vector<float>& coverage = sea_.answers().numbers(Product::Coverage);
        const float clear_m = objects_->sight_in_water_m();
        in_parallel(batch_.sea.size(), [&](std::size_t i) {
            if (!batch_.seen.from_below.empty() && batch_.seen.from_below[i] != 0) return;
            const glm::vec3 place = sea_place(first_row, batch_.sea[i]);
            if (!objects_->is_near(place, clear_m)) return;
            const glm::vec3 upright(from_level(glm::dvec3(normal[i]), glm::dvec3(batch_.seen.up[i])));
            const glm::vec3 to_eye = batch_.seen.to_eye[i];
            const float cosine = glm::dot(upright, to_eye);
            if (!(cosine > 0.02f)) return;
            const Ray ray{.from = place,
                          .towards = refracted_by_water(-to_eye, upright),
                          .farthest_m = clear_m,
                          .width_m = sample_tangent() * batch_.seen.distance_m[i],
                          .spread = sample_tangent()};
            const RayHit hit = objects_->nearest(ray);
            if (!hit.is_hit() || hit.distance_m > clear_m) return;
            const float clear = coverage.empty() ? 1.0f : 1.0f - std::clamp(coverage[i], 0.0f, 1.0f);
            const glm::vec3 left = water_lets_through(sea_.water(), hit.distance_m);
            const glm::vec3 body = (clear * (1.0f - mirrored_by_level_water(cosine)) * kBehindGlass) * left *
                                   objects_->radiance_in_water(ray, hit);
            batch_.in_sea[batch_.sea[i]].more += body * left_before(i) - left * batch_.lit[i].sea;
        });
    }

    // The part of the light of a place of the sea that comes through the air and the spray before it.
    glm::vec3 left_before(std::size_t i) const {
        SeaRadiance white{.sea = glm::vec3(1.0f)};
        const std::span to_eye(&batch_.seen.to_eye[i], 1);
        const std::span distance_m(&batch_.seen.distance_m[i], 1);
        if (options_.lighting.air) see_through(air_, to_eye, distance_m, {&white, 1});
        see_through_spray(spray_, to_eye, distance_m, {&white, 1});
        return white.sea;
    }

    // The bodies that samples show, through what is before them.
    void light_objects(int first_row) {
        batch_.object.assign(batch_.triangles.size(), glm::vec3(0.0f));
        in_parallel(batch_.triangles.size(), [&](std::size_t i) {
            if (!is_object(i)) return;
            const Ray ray = ray_of(first_row, i);
            const RayHit& hit = batch_.body[i];
            const bool is_out = objects_->is_holdout(hit);
            SeaRadiance& seen = batch_.radiance[i];
            seen = {};
            if (is_under(i)) {
                if (is_out) return;
                // The water sends what it would without an end, less what of that comes from behind the body.
                std::array<SeaRadiance, 2> water;
                sea_.light_water(eye(), {&ray.towards, 1}, std::span(water).first(1));
                FloorEye there = eye();
                there.position_m += static_cast<double>(hit.distance_m) * glm::dvec3(ray.towards);
                there.position_m.z = std::min(there.position_m.z, -1e-3);
                sea_.light_water(there, {&ray.towards, 1}, std::span(water).last(1));
                const glm::vec3 left = water_lets_through(sea_.water(), hit.distance_m);
                seen.sea = glm::max(water[0].sea - left * water[1].sea, glm::vec3(0.0f));
                batch_.object[i] = kBehindGlass * left * objects_->radiance_in_water(ray, hit);
                return;
            }
            SeaRadiance light;
            if (!is_out) {
                light.sea = objects_->radiance(ray, hit, numbers_of(first_row, i));
                const glm::vec3 to_eye = -ray.towards;
                if (options_.lighting.air) see_through(air_, {&to_eye, 1}, {&hit.distance_m, 1}, {&light, 1});
            }
            const float left =
                spray_.empty() ? 1.0f : see_through_spray(spray_, ray.towards, hit.distance_m, light);
            if (is_out && !batch_.veil.empty()) batch_.veil[i] = 1.0f - left;
            batch_.object[i] = light.sea;
            seen.air = light.air;
        });
    }
    // Whether alpha is 1 for it.
    bool is_covered(std::size_t sample) const {
        return is_object(sample) ? !objects_->is_holdout(batch_.body[sample]) : is_sea(sample);
    }

    // No pixel's light is below 0 (LitObjects::radiance()). A Cryptomatte has its largest share first.
    void end_objects(Picture& picture) const {
        for (float& light : picture.data[index(PictureLayer::Object)]) light = std::max(light, 0.0f);
        std::vector<float>& mattes = picture.data[index(PictureLayer::Cryptomatte)];
        if (mattes.empty()) return;
        for (const std::vector<Unranked>& row : unranked_)
            for (const Unranked& of : row) keep_in_ranks(ranks_of(mattes, of.pixel), of.id, of.share);
        in_parallel(picture.layers.size(), [&](std::size_t pixel) { sort_ranks(ranks_of(mattes, pixel)); });
    }

    // What a pixel's samples of the sea show of bodies, more than without them, in all. Of the sky that they mirror, `sky`, bodies take the
    // share that they do among the facets: so no chance takes more than there is.
    static glm::vec3 shown_in_sea(const BodiesInSea& all, const glm::vec3& sky) {
        glm::vec3 shown = all.more;
        for (int c = 0; c < 3; ++c) {
            constexpr float kMost = 4.0f;  // facets tell more or less of a bright spot of the sky
            const float scale = all.sky[c] > 0.0f ? sky[c] / all.sky[c] : 1.0f;
            shown[c] += std::clamp(scale, 1.0f / kMost, kMost) * all.mirrored[c] - scale * all.hidden[c];
        }
        return shown;
    }

    FloorEye eye() const {
        return {.position_m = view_.position_m,
                .curvature_per_m = mesh_.points.curvature_per_m,
                .pixel_tangent = view_.pixel_tangent()};
    }

    void light_water(int first_row) {
        if (batch_.water.empty()) return;
        std::vector<glm::vec3> direction;
        for (const std::size_t sample : batch_.water)
            direction.emplace_back(view_.direction(seen_at(first_row, sample)));
        batch_.lit.resize(batch_.water.size());
        sea_.light_water(eye(), direction, batch_.lit);
        for (std::size_t i = 0; i < batch_.water.size(); ++i)
            batch_.radiance[batch_.water[i]] = batch_.lit[i];
    }

    void light_meniscus(int first_row) {
        if (batch_.climbed.empty()) return;
        std::vector<MeniscusSight> sights;
        for (const std::size_t sample : batch_.climbed)
            sights.push_back({glm::vec3(view_.direction(seen_at(first_row, sample))),
                              static_cast<float>(batch_.glass_m[sample])});
        batch_.lit.resize(sights.size());
        sea_.light_meniscus(eye(), glm::vec3(view_.forward), sights, batch_.lit);
        for (std::size_t i = 0; i < sights.size(); ++i) {
            const std::size_t sample = batch_.climbed[i];
            const float share = meniscus_share(batch_.glass_m[sample]);
            batch_.radiance[sample] = mixed(batch_.radiance[sample], batch_.lit[i], share);
            if (objects_) {
                batch_.object[sample] *= 1.0f - share;
                batch_.in_sea[sample] *= 1.0f - share;
            }
            if (!batch_.veil.empty() && !is_covered(sample))
                batch_.veil[sample] += share * (1.0f - batch_.veil[sample]);
        }
    }

    // Over what the samples of the rows show, from the farthest on.
    void draw_drops(int first_row, int rows) {
        const PixelWindow window = drawn_window();
        const int width = window.size().x;
        batch_.sea_m.assign(batch_.triangles.size(), kSprayEndless_m);
        batch_.drops.assign(options_.deep ? batch_.triangles.size() : 0, DropsBefore{});
        for (std::size_t i = 0; i < batch_.sea.size(); ++i)
            batch_.sea_m[batch_.sea[i]] = batch_.seen.distance_m[i];
        for (std::size_t i = 0; i < batch_.body.size(); ++i)
            if (is_object(i)) batch_.sea_m[i] = batch_.body[i].distance_m;
        // Of the view's pixels to the rasteriser's, whose middles passes look beside.
        const double beside = batch_.places.empty() ? 0.0 : 0.5;
        const auto drawn_at = [&](double at_px, double first, int low) {
            return (at_px - first - 0.5) / sampling_.stride - low;
        };
        constexpr int kRows = 4;
        tbb::parallel_for(0, (rows + kRows - 1) / kRows, [&](int band) {
            const int low = first_row + kRows * band, high = std::min(low + kRows, first_row + rows) - 1;
            for (const SeenDrop& drop : drops_) {
                const double radius = drop.radius_px / sampling_.stride + beside;
                const double x = drawn_at(drop.at_px.x, sampling_.first.x, window.low.x),
                             y = drawn_at(drop.at_px.y, sampling_.first.y, window.low.y);
                const int top = std::max(static_cast<int>(std::ceil(y - radius)), low),
                          bottom = std::min(static_cast<int>(std::floor(y + radius)), high),
                          left = std::max(static_cast<int>(std::ceil(x - radius)), 0),
                          right = std::min(static_cast<int>(std::floor(x + radius)), width - 1);
                for (int row = top; row <= bottom; ++row)
                    for (int column = left; column <= right; ++column)
                        hide_by(drop, first_row,
                                static_cast<std::size_t>(row - first_row) * static_cast<std::size_t>(width) +
                                    static_cast<std::size_t>(column));
            }
        });
    }

    void hide_by(const SeenDrop& drop, int first_row, std::size_t sample) {
        if (is_under(sample) || (!batch_.places.empty() && !batch_.places[sample].is_taken())) return;
        const float hidden = drop.hides(seen_at(first_row, sample), batch_.sea_m[sample]);
        if (!(hidden > 0.0f)) return;
        SeaRadiance& seen = batch_.radiance[sample];
        for (glm::vec3* layer : {&seen.sun, &seen.sky, &seen.sea, &seen.foam, &seen.air})
            *layer *= 1.0f - hidden;
        if (objects_) {
            batch_.object[sample] *= 1.0f - hidden;
            batch_.in_sea[sample] *= 1.0f - hidden;
        }
        seen.air += hidden * drop.radiance;
        if (!batch_.drops.empty()) {
            DropsBefore& before = batch_.drops[sample];
            const float behind = (1.0f - hidden) * (1.0f - before.left);
            before.distance_m = (behind * before.distance_m + hidden * drop.distance_m) / (behind + hidden);
            before.left *= 1.0f - hidden;
            before.light = (1.0f - hidden) * before.light + hidden * drop.radiance;
        }
        if (!batch_.veil.empty() && batch_.triangles[sample] == Rasteriser::kNone && !is_covered(sample))
            batch_.veil[sample] += hidden * (1.0f - batch_.veil[sample]);
    }

    // The place at rest that each sample of the sea shows, its footprint and the way to the eye.
    void find_places(int first_row) {
        const std::size_t count = batch_.sea.size();
        SeenSea<T>& seen = batch_.seen;
        seen.origin_m = mesh_.points.origin_m;
        seen.eye = eye();
        seen.resize(count);
        const bool is_flat = mesh_.normal.empty();
        seen.rest_normal.resize(is_flat ? 0 : count);
        seen.crest.resize(crest_.empty() ? 0 : count);
        seen.from_below.resize(batch_.under.empty() ? 0 : count);
        for (std::size_t i = 0; i < seen.from_below.size(); ++i)
            seen.from_below[i] = batch_.under[batch_.sea[i]];
        const glm::dvec3 eye = view_.position_m - glm::dvec3(mesh_.points.origin_m, 0.0);
        in_parallel(count, [&](std::size_t i) {
            const std::uint32_t triangle = batch_.triangles[batch_.sea[i]];
            const glm::dvec3 weights = raster_.weights(triangle, centre(first_row, batch_.sea[i]));
            glm::dvec2 rest(0.0), pixel_axis_m(0.0);
            glm::dvec3 position(0.0);
            double pixel_m = 0.0;
            glm::dvec3 mesh_variance(0.0), normal(0.0);
            for (int corner = 0; corner < 3; ++corner) {
                const std::uint32_t vertex = mesh_.triangles[3 * std::size_t{triangle} + corner];
                rest += weights[corner] * glm::dvec2(rest_[vertex]);
                position += weights[corner] * glm::dvec3(position_[vertex]);
                pixel_m += weights[corner] * static_cast<double>(mesh_.points.pixel_m[vertex]);
                pixel_axis_m += weights[corner] * glm::dvec2(mesh_.points.pixel_axis_m[vertex]);
                mesh_variance += weights[corner] * glm::dvec3(mesh_variance_[vertex]);
                if (!is_flat) normal += weights[corner] * glm::dvec3(mesh_.normal[vertex]);
            }
            if (!is_flat) seen.rest_normal[i] = glm::vec<3, T>(normal);
            if (!crest_.empty()) {
                glm::vec3 crest(0.0f);
                for (int corner = 0; corner < 3; ++corner)
                    crest += static_cast<float>(weights[corner]) *
                             crest_[mesh_.triangles[3 * std::size_t{triangle} + corner]];
                seen.crest[i] = crest;
            }
            seen.rest[i] = glm::vec<2, T>(rest);
            seen.up[i] = glm::vec3(earth_up(rest, mesh_.points.curvature_per_m));
            const auto pixel = pixel_on_mesh(
                triangle, first_row, batch_.sea[i],
                PixelFootprint<double>{.width = pixel_m, .axis_x = pixel_axis_m.x, .axis_y = pixel_axis_m.y});
            seen.pixel_axis_m[i] = glm::vec<2, T>(pixel.axis_x, pixel.axis_y);
            // Rounding must not reach the level below the frame's first.
            seen.pixel_m[i] = std::max(static_cast<T>(pixel.width), first_pixel_m_);
            const glm::dvec3 way = eye - position;
            const double distance = glm::length(way);
            seen.distance_m[i] = static_cast<float>(distance);
            // At the eye itself, which the near plane keeps from happening, up is as good as any.
            seen.mesh_variance[i] =
                static_cast<float>((mesh_variance.x * way.x * way.x + mesh_variance.y * way.y * way.y +
                                    2.0 * mesh_variance.z * way.x * way.y) /
                                   std::max(way.x * way.x + way.y * way.y, 1e-12));
            seen.to_eye[i] = distance > 0.0 ? glm::vec3(way / distance) : glm::vec3(0.0f, 0.0f, 1.0f);
        });
    }

    PixelFootprint<double> pixel_on_mesh(std::uint32_t triangle, int first_row, std::size_t sample,
                                         PixelFootprint<double> at_rest) const {
        const double tangent = view_.pixel_tangent();
        const glm::dvec2 from_middle = seen_at(first_row, sample) - 0.5 * glm::dvec2(view_.resolution);
        const glm::dvec2 middle = view_.middle_tangents();
        const glm::dvec3 ray = view_.forward +
                               tangent * (from_middle.x * view_.right - from_middle.y * view_.up) +
                               (middle.x * view_.right + middle.y * view_.up);
        const glm::dvec2 nearer =
            raster_.relative_change(triangle, centre(first_row, sample)) / (sampling_.stride * tangent);
        return footprint_on_mesh(at_rest, view_.right.x, view_.right.y, view_.up.x, view_.up.y, ray.x, ray.y,
                                 nearer.x, -nearer.y);
    }

    // The batch's samples into the picture's pixels.
    void average(int first_row, int rows, Picture& picture) const {
        const int n = options_.samples / sampling_.stride;  // of this pass, a side
        const auto sample_width = static_cast<std::size_t>(drawn_window().size().x);
        const auto width = static_cast<std::size_t>(window_.size().x);
        const float share = 1.0f / static_cast<float>(options_.samples * options_.samples);
        const bool has_skyline = has_places() && !sampling_.is_by_pixel && !options_.alpha;
        std::vector<std::vector<SkylinePixel>> skyline(rows / n);
        std::vector<DeepRow> deep(options_.deep ? rows / n : 0);
        tbb::parallel_for(0, rows / n, [&](int row) {
            const std::size_t to = first_pixel(picture, first_row / n + row);
            if (options_.deep) deep[row].first = to;
            for (std::size_t x = 0; x < width; ++x) {
                SeaRadiance sum;
                glm::vec3 of_sky(0.0f);
                int of_sea = 0, covered = 0;  // with bodies; without holdouts
                float of_veil = 0.0f;         // before the sky
                for (int y = 0; y < n; ++y)
                    for (int i = 0; i < n; ++i) {
                        const std::size_t at = sample_width * (row * n + y) + x * n + i;
                        const SeaRadiance& sample = batch_.radiance[at];
                        sum.sun += sample.sun;
                        sum.sky += sample.sky;
                        sum.sea += sample.sea;
                        sum.foam += sample.foam;
                        sum.air += sample.air;
                        if (is_sea(at) || is_object(at))
                            ++of_sea;
                        else
                            of_sky += radiance_of(sample);
                        if (is_covered(at)) ++covered;
                        if (!batch_.veil.empty()) of_veil += batch_.veil[at];
                    }
                SeaRadiance& pixel = picture.layers[to + x];
                pixel.sun += sum.sun * share;
                pixel.sky += sum.sky * share;
                pixel.sea += sum.sea * share;
                pixel.foam += sum.foam * share;
                pixel.air += sum.air * share;
                if (objects_) add_objects(row, x, n, share, picture, to + x);
                if (options_.alpha) picture.alpha[to + x] += (static_cast<float>(covered) + of_veil) * share;
                if (options_.deep) add_deep(first_row, row, x, picture, deep[row]);
                if (has_skyline && of_sea > 0 && of_sea < n * n)
                    skyline[row].push_back({.pixel = to + x,
                                            .sky = 1.0f - static_cast<float>(of_sea) * share,
                                            .light = of_sky * share});
            }
        });
        for (const std::vector<SkylinePixel>& of_row : skyline)
            picture.skyline.insert(picture.skyline.end(), of_row.begin(), of_row.end());
        std::move(deep.begin(), deep.end(), std::back_inserter(deep_rows_));
    }

    // The next pixel of a row, all of whose samples are in the batch.
    void add_deep(int first_row, int row, std::size_t x, const Picture& picture, DeepRow& to) const {
        const int n = options_.samples;
        const auto sample_width = static_cast<std::size_t>(drawn_window().size().x);
        const std::size_t pixel = to.first + x;
        const float share = 1.0f / static_cast<float>(n * n);
        const auto sample_at = [&](int i) {
            return sample_width * static_cast<std::size_t>(row * n + i / n) +
                   x * static_cast<std::size_t>(n) + static_cast<std::size_t>(i % n);
        };
        const auto of_picture = [&](PictureLayer layer) {
            const std::vector<float>& of = picture.data[index(layer)];
            return of.empty() ? glm::vec3(0.0f)
                              : glm::vec3(of[3 * pixel], of[3 * pixel + 1], of[3 * pixel + 2]);
        };
        // What the sea shows of bodies is known of the pixel alone, and end_objects() leaves out bodies' light that is below 0.
        int of_sea = 0;
        for (int i = 0; i < n * n; ++i) of_sea += batch_.triangles[sample_at(i)] != Rasteriser::kNone;
        const glm::vec3 reflection =
            of_picture(PictureLayer::Reflection) / (share * static_cast<float>(std::max(of_sea, 1)));
        const glm::vec3 object_counts(
            glm::greaterThanEqual(of_picture(PictureLayer::Object), glm::vec3(0.0f)));
        std::vector<DeepSight> sights;
        for (int i = 0; i < n * n; ++i) {
            const std::size_t at = sample_at(i);
            const bool has_surface = batch_.triangles[at] != Rasteriser::kNone;
            const glm::dvec3 direction = view_.direction(seen_at(first_row, at));
            const auto along = static_cast<float>(glm::dot(direction, view_.forward));
            std::optional<float> distance_m;
            DeepSight sight;
            glm::vec3 light = radiance_of(batch_.radiance[at]);
            if (is_object(at)) {
                distance_m = batch_.body[at].distance_m;
                sight.id = mattes_[static_cast<std::size_t>(batch_.body[at].body)];
            } else if (is_sea(at)) {
                sight.id = kSeaMatte;
                if (has_surface)
                    distance_m =
                        static_cast<float>(glm::length(glm::dvec3(sea_place(first_row, at)) - eye_place()));
                else if (direction.z < 0.0 && sea_.water().floor_m < 1e6f)
                    distance_m = static_cast<float>(sea_.floor().distance_m(view_.position_m, direction));
            }
            if (objects_) light += object_counts * batch_.object[at];
            if (has_surface) light += reflection;
            sight.z_m = std::min(along * distance_m.value_or(kSkyDepth_m), kSkyDepth_m);
            const DropsBefore drops = batch_.drops.empty() ? DropsBefore{} : batch_.drops[at];
            light -= drops.light;
            if (is_covered(at)) {
                SpraySeen spray;
                if (!is_under(at))
                    spray = spray_before(spray_, glm::vec3(direction), distance_m, has_surface);
                sight.alpha = drops.left * spray.transmittance;
                sight.veil = drops.left - sight.alpha;
                sight.veil_light = drops.left * spray.scattered;
                sight.light = light - sight.veil_light;
            } else {
                sight.veil = batch_.veil.empty() ? 0.0f : batch_.veil[at] - (1.0f - drops.left);
                sight.veil_light = light;
            }
            for (float* of : {&sight.alpha, &sight.veil}) *of = std::max(*of, 0.0f) * share;
            for (glm::vec3* of : {&sight.light, &sight.veil_light}) *of *= share;
            if (sight.alpha > 0.0f || sight.veil > 0.0f) sights.push_back(sight);
            if (drops.left < 1.0f)
                sights.push_back({.z_m = std::min(along * drops.distance_m, sight.z_m),
                                  .alpha = share * (1.0f - drops.left),
                                  .light = share * drops.light});
        }
        const std::size_t middle = sample_at(n / 2 * n + n / 2);
        const glm::dvec3 direction = view_.direction(seen_at(first_row, middle));
        const auto along = static_cast<float>(glm::dot(direction, view_.forward));
        to.counts.push_back(add_deep_pixel(
            sights,
            [&](float z_m) {
                std::optional<float> distance_m;
                if (z_m < kSkyDepth_m) distance_m = z_m / along;
                return 1.0f - spray_before(spray_, glm::vec3(direction), distance_m, false).transmittance;
            },
            to.samples));
    }

    // The rows of all windows as those of the picture.
    void end_deep(Picture& picture) {
        std::sort(deep_rows_.begin(), deep_rows_.end(),
                  [](const DeepRow& a, const DeepRow& b) { return a.first < b.first; });
        std::size_t samples = 0;
        for (const DeepRow& row : deep_rows_) samples += row.samples.size();
        picture.deep.samples.reserve(samples);
        for (const DeepRow& row : deep_rows_) {
            picture.deep.counts.insert(picture.deep.counts.end(), row.counts.begin(), row.counts.end());
            picture.deep.samples.insert(picture.deep.samples.end(), row.samples.begin(), row.samples.end());
        }
        deep_rows_ = {};
    }

    static std::span<float, kMatteFloats> ranks_of(std::vector<float>& mattes, std::size_t pixel) {
        return std::span(mattes).subspan(kMatteFloats * pixel).template first<kMatteFloats>();
    }
    // What samples to come may still make more than a rank's. A row of pixels is one thread's.
    void add_unranked(const Picture& picture, std::size_t pixel, float id, float share) const {
        std::vector<Unranked>& row = unranked_[pixel / static_cast<std::size_t>(picture.resolution.x)];
        const auto same = std::find_if(row.begin(), row.end(),
                                       [&](const Unranked& of) { return of.pixel == pixel && of.id == id; });
        if (same != row.end())
            same->share += share;
        else
            row.push_back({pixel, id, share});
    }

    // A pixel's light of bodies, and what it shows of which.
    void add_objects(int row, std::size_t x, int n, float share, Picture& picture, std::size_t pixel) const {
        std::vector<float>& mattes = picture.data[index(PictureLayer::Cryptomatte)];
        const auto sample_width = static_cast<std::size_t>(drawn_window().size().x);
        glm::vec3 object(0.0f), sky(0.0f);
        BodiesInSea shown;
        for (int y = 0; y < n; ++y)
            for (int i = 0; i < n; ++i) {
                const std::size_t at = sample_width * (row * n + y) + x * n + i;
                object += batch_.object[at];
                const BodiesInSea& in_sea = batch_.in_sea[at];
                shown.mirrored += in_sea.mirrored;
                shown.hidden += in_sea.hidden;
                shown.sky += in_sea.sky;
                shown.more += in_sea.more;
                if (in_sea.sky != glm::vec3(0.0f)) sky += batch_.radiance[at].sky;
                if (mattes.empty() || !(is_object(at) || is_sea(at))) continue;
                const float id =
                    is_object(at) ? mattes_[static_cast<std::size_t>(batch_.body[at].body)] : kSeaMatte;
                if (!add_to_ranks(ranks_of(mattes, pixel), id, share))
                    add_unranked(picture, pixel, id, share);
            }
        const glm::vec3 reflection = shown_in_sea(shown, sky);
        for (int c = 0; c < 3; ++c) {
            picture.data[index(PictureLayer::Object)][3 * pixel + c] += share * object[c];
            picture.data[index(PictureLayer::Reflection)][3 * pixel + c] += share * reflection[c];
        }
    }

    // What the middle of each pixel shows, beside its light.
    void describe(int first_row, int rows, int frame, Picture& picture) const {
        const int n = options_.samples / sampling_.stride;
        const auto sample_width = static_cast<std::size_t>(drawn_window().size().x);
        const auto width = static_cast<std::size_t>(window_.size().x);
        Scene pictured = scene_;
        pictured.camera.resolution = display_;
        const Motion motion(pictured, frame, glm::dvec3(mesh_.points.origin_m, 0.0));
        tbb::parallel_for(0, rows / n, [&](int row) {
            const std::size_t to = first_pixel(picture, first_row / n + row);
            for (std::size_t x = 0; x < width; ++x) {
                const std::size_t middle = sample_width * (row * n + n / 2) + x * n + n / 2;
                picture.sea[to + x] = is_sea(middle);
                if (has_data()) describe_sample(first_row, middle, motion, picture, to + x);
            }
        });
    }

    void describe_sample(int first_row, std::size_t sample, const Motion& motion, Picture& picture,
                         std::size_t pixel) const {
        const auto set = [&](PictureLayer layer, auto value) {
            std::vector<float>& to = picture.data[index(layer)];
            for (int c = 0; !to.empty() && c < value.length(); ++c)
                to[pixel * value.length() + c] = static_cast<float>(value[c]);
        };
        const auto set_motion = [&](const glm::dvec4& way) {
            set(PictureLayer::Motion, way);
            // Cycles: the frame before less this one, and this one less the next.
            set(PictureLayer::Vector, glm::dvec4(way.z, way.w, -way.x, -way.y));
        };
        const std::uint32_t triangle = batch_.triangles[sample];
        const glm::dvec3 origin(mesh_.points.origin_m, 0.0);
        set(PictureLayer::Shadow, glm::vec1(1.0f));
        if (triangle == Rasteriser::kNone) {
            set(PictureLayer::SlopeVariance, glm::vec3(0.0f));
            for (const PictureLayer layer :
                 {PictureLayer::Coverage, PictureLayer::Breaking, PictureLayer::FoamAge})
                set(layer, glm::vec1(0.0f));
            if (is_object(sample)) {
                const Ray ray = ray_of(first_row, sample);
                const RayHit& hit = batch_.body[sample];
                const auto places = objects_->places(ray, hit);
                const glm::vec3 normal = objects_->normal(ray, hit);
                set(PictureLayer::Depth,
                    glm::dvec1(glm::dot(view_.forward, places[1] + origin - view_.position_m)));
                set(PictureLayer::Position, places[1] + origin);
                set(PictureLayer::Normal, normal);
                set(PictureLayer::Shadow,
                    glm::vec1(objects_->sun_share(ray, hit, numbers_of_middle(first_row, sample))));
                if (needs_motion(options_.layers)) set_motion(motion.of(places));
                return;
            }
            const glm::dvec3 direction = view_.direction(seen_at(first_row, sample));
            // The floor under water; what has none, and the sky, is endlessly far.
            const bool has_floor = is_under(sample) && direction.z < 0.0 && sea_.water().floor_m < 1e6f;
            const double floor_m =
                has_floor ? sea_.floor().distance_m(view_.position_m, direction) : kSkyDepth_m;
            if (floor_m < kSkyDepth_m) {
                const glm::dvec3 at = view_.position_m + floor_m * direction;
                set(PictureLayer::Depth, glm::dvec1(floor_m * glm::dot(view_.forward, direction)));
                set(PictureLayer::Position, at);
                set(PictureLayer::Normal, glm::vec3(0.0f, 0.0f, 1.0f));
                if (needs_motion(options_.layers)) set_motion(motion.of({at - origin, 1.0}, glm::dvec3(0.0)));
                return;
            }
            set(PictureLayer::Depth, glm::vec1(kSkyDepth_m));
            for (const PictureLayer layer : {PictureLayer::Position, PictureLayer::Normal})
                set(layer, glm::vec3(0.0f));
            if (needs_motion(options_.layers)) set_motion(motion.of({direction, 0.0}, glm::dvec3(0.0)));
            return;
        }
        const glm::dvec3 weights = raster_.weights(triangle, centre(first_row, sample));
        glm::dvec3 position(0.0), velocity(0.0);
        for (int corner = 0; corner < 3; ++corner) {
            const std::uint32_t vertex = mesh_.triangles[3 * std::size_t{triangle} + corner];
            position += weights[corner] * glm::dvec3(position_[vertex]);
            if (!velocity_.empty()) velocity += weights[corner] * glm::dvec3(velocity_[vertex]);
        }
        set(PictureLayer::Depth, glm::dvec1(glm::dot(view_.forward, position + origin - view_.position_m)));
        set(PictureLayer::Position, position + origin);
        if (needs_motion(options_.layers)) set_motion(motion.of({position, 1.0}, velocity));
        // Samples that show the sea stand in rising order.
        const std::size_t i =
            std::lower_bound(batch_.sea.begin(), batch_.sea.end(), sample) - batch_.sea.begin();
        if (objects_)
            set(PictureLayer::Shadow, glm::vec1(objects_->sun_share(glm::vec3(position), batch_.seen.up[i],
                                                                    numbers_of_middle(first_row, sample))));
        const std::vector<float>& coverage = sea_.answers().numbers(Product::Coverage);
        set(PictureLayer::Normal, from_level(glm::dvec3(sea_.answers().vectors(Product::Normal)[i]),
                                             glm::dvec3(batch_.seen.up[i])));
        set(PictureLayer::SlopeVariance, sea_.answers().vectors(Product::SlopeVariance)[i]);
        // Foam that isn't persistent is all of waves that break now.
        const std::vector<float>&breaking = sea_.answers().numbers(Product::Breaking),
              &age_s = sea_.answers().numbers(Product::FoamAge);
        const auto value = [&](const std::vector<float>& of) { return glm::vec1(of.empty() ? 0.0f : of[i]); };
        set(PictureLayer::Coverage, value(coverage));
        set(PictureLayer::Breaking, value(sea_.foam_lives() ? breaking : coverage));
        set(PictureLayer::FoamAge, value(age_s));
    }

    static constexpr int kQuery = SeaLight<T>::kQuery;

    Scene scene_;
    RenderOptions options_;
    SeaLight<T> sea_;
    DrawnSea drawn_;
    glm::ivec2 display_;  // [pixels], as the camera has it
    PixelWindow data_;
    std::vector<PicturePart> picture_parts_;
    glm::ivec2 overscan_px_{0};  // of the part at hand
    PixelWindow window_;         // of the batch at hand
    bool is_aimed_ = false;      // the rasteriser has it
    View view_;
    Air air_;  // before that view's eye
    Spray spray_;
    std::optional<SprayDrops<T>> flying_;  // once they are near
    std::vector<SprayDrop> in_air_;
    std::vector<SeenDrop> drops_;
    double air_height_m_ = 0.0;
    bool may_be_below_ = false;           // some of the view's front glass may be under water
    std::optional<Waterline> waterline_;  // then
    std::optional<double> set_s_;         // the time that the sea is set to
    SamplesOfPass sampling_;
    PicturePass pass_;
    int parts_ = 0, frame_ = 0;
    SeaMesh mesh_;
    T first_pixel_m_ = T(0);                     // the finest level that the frame reads
    std::vector<glm::vec<2, T>> rest_;           // the mesh's own, in T
    std::vector<glm::vec<3, T>> mesh_variance_;  // (σxx, σyy, σxy) of the slopes that cells don't resolve
    std::vector<glm::vec3> crest_;               // as SeaPoint's; empty: no light comes through crests
    std::vector<T> cell_m_;
    std::vector<glm::vec<2, T>> cell_axis_m_;
    std::vector<glm::vec<3, T>> position_;
    std::vector<glm::vec<3, T>> velocity_;  // where motion vectors are asked for
    std::vector<glm::dvec4> clip_;
    Rasteriser raster_;
    Batch<T> batch_;
    std::unique_ptr<LitObjects> objects_;  // of scenes with some
    std::optional<Hulls> hulls_;           // of those that keep water out
    bool are_objects_lit_ = false;
    // Shares of a pixel's bodies beyond those that have its ranks, by row.
    struct Unranked {
        std::size_t pixel;
        float id, share;
    };
    mutable std::vector<std::vector<Unranked>> unranked_;
    std::vector<float> mattes_;  // by object
    mutable std::vector<DeepRow> deep_rows_;
    const std::atomic<bool>* cancel_ = nullptr;
};

}  // namespace

Renderer::Renderer(const Scene& scene, const RenderOptions& options, Sky sky, std::span<const int> frames,
                   const BuildWatch& watch) {
    check_render(scene, options);
    const Plan plan = picture_plan(of_samples(scene, options.samples), frames, options);
    impl_ = with_precision(plan.knobs.double_precision, [&]<class T>(T) -> std::unique_ptr<Impl> {
        return std::make_unique<RendererOf<T, Impl>>(plan, options, std::move(sky), watch);
    });
}

Renderer::~Renderer() = default;

void Renderer::render(int frame, Picture& picture, const BuildWatch& watch) {
    impl_->render(frame, picture, watch);
}
void Renderer::check_cameras(std::span<const int> frames, const BuildWatch& watch) {
    impl_->check_cameras(frames, watch);
}
const Plan& Renderer::plan() const {
    return impl_->plan();
}
const Sky& Renderer::sky() const {
    return impl_->sky();
}

}  // namespace pelagic
