// pelagic.GpuSea, GpuLight and GpuGrid: what a host's own GPU code draws the sea from, as plugin/host/preview does.
// Arrays and text; no OpenGL.
#include <pybind11/numpy.h>
#include <pybind11/stl.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/trigonometric.hpp>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/evaluate/hulls.h"
#include "core/evaluate/object_place.h"
#include "core/lighting/air.h"
#include "core/lighting/object.h"
#include "core/lighting/tone.h"
#include "core/plan/hulls.h"
#include "core/plan/plan.h"
#include "core/scene/budget.h"
#include "core/scene/canonical.h"
#include "core/scene/number_keys.h"
#include "core/scene/text.h"
#include "core/surface/footprint_levels.h"
#include "core/surface/projected_grid.h"
#include "core/waves/whitecaps.h"
#include "plugin/host/gpu/foam_worker.h"
#include "plugin/host/gpu/objects_view.h"
#include "plugin/host/gpu/packed_frame.h"
#include "plugin/host/gpu/packed_hulls.h"
#include "plugin/host/gpu/shader_variants.h"
#include "plugin/host/gpu/sky_atlas.h"
#include "plugin/host/gpu/uniforms.h"
#include "plugin/host/python/arrays.h"
#include "plugin/host/python/bindings.h"
#include "plugin/host/python/task.h"
#include "plugin/host/python/watch.h"
#include "plugin/light/exposure.h"
#include "plugin/light/light.h"
#include "plugin/render/render.h"
#include "plugin/render/under_water.h"

namespace pelagic::python {
namespace {

namespace py = pybind11;

// Names to numbers and tuples.
py::dict dict_of(const std::vector<Uniform>& uniforms) {
    py::dict made;
    for (const Uniform& uniform : uniforms) {
        const glm::vec4& v = uniform.value;
        if (uniform.is_integer) {
            made[py::str(uniform.name)] = static_cast<int>(v.x);
        } else if (uniform.components == 1) {
            made[py::str(uniform.name)] = v.x;
        } else {
            py::tuple values(uniform.components);
            for (int i = 0; i < uniform.components; ++i) values[i] = v[i];
            made[py::str(uniform.name)] = values;
        }
    }
    return made;
}

// ---- Light

struct GpuLight {
    explicit GpuLight(const Scene& scene) : made_from(light_content(scene)) {
        refuse_keys(scene, "camera");
        sky = make_sky(scene);
        map_size = sky.map.size();
        uniforms = light_uniforms(sky);
        const glm::mat3 balance = white_balance(scene.camera.white_balance_k);
        for (int i = 0; i < 3; ++i)
            uniforms.push_back(
                {std::array{"white_balance_red", "white_balance_green", "white_balance_blue"}[i], 3,
                 glm::vec4(balance[i], 0.0f)});
        atlas = sky_atlas(sky.map);
        foam_picture = kept_foam_picture(scene);
    }
    bool serves(const Scene& scene) const { return light_content(scene) == made_from; }

    std::string made_from;
    Sky sky;
    int map_size = 0;
    std::vector<Uniform> uniforms;
    SkyAtlas atlas;
    std::shared_ptr<const FoamImage> foam_picture;
    // What was metered last: hosts ask at each redraw, and metering takes tens of milliseconds.
    struct Metered {
        std::string made_from;
        float exposure = 1.0f;
    };
    Metered metered{};
};

using Matrix = py::array_t<double, py::array::c_style | py::array::forcecast>;

glm::dmat4 checked_matrix(const Matrix& from, const char* name) {
    if (from.ndim() != 2 || from.shape(0) != 4 || from.shape(1) != 4)
        throw py::value_error(std::string(name) + ": accepted: matrices (4, 4)");
    glm::dmat4 made;
    for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 4; ++column) made[column][row] = from.at(row, column);
    return made;
}

// The hulls of a host's own objects.
class GpuHulls {
  public:
    using Points = py::array_t<float, py::array::c_style | py::array::forcecast>;
    using Triangles = py::array_t<std::uint32_t, py::array::c_style | py::array::forcecast>;

    explicit GpuHulls(const std::vector<std::pair<Points, Triangles>>& meshes) {
        std::vector<ObjectMeshData> all;
        for (const auto& [points, triangles] : meshes) {
            if (points.ndim() != 2 || points.shape(1) != 3 || triangles.ndim() != 2 ||
                triangles.shape(1) != 3)
                throw py::value_error("meshes: accepted: pairs of points (n, 3) and triangles (m, 3)");
            ObjectMeshData& data = all.emplace_back();
            data.materials.resize(1);
            for (py::ssize_t i = 0; i < points.shape(0); ++i)
                data.points_m.emplace_back(points.at(i, 0), points.at(i, 1), points.at(i, 2));
            data.triangles.assign(triangles.data(), triangles.data() + triangles.size());
            data.normals.assign(data.triangles.size(), glm::vec3(0.0f, 0.0f, 1.0f));  // no hull asks for them
            data.material.assign(static_cast<std::size_t>(triangles.shape(0)), 0);
        }
        const OthersMayRun others_may_run;
        for (ObjectMeshData& data : all) {
            hulls_.emplace_back();
            meshes_.emplace_back();
            try {
                meshes_.back() = std::make_shared<const ObjectMesh>(std::move(data));
                hulls_.back() = hull_of(*meshes_.back());
            } catch (const std::invalid_argument&) {  // an artist's mesh may be anything
            }
        }
        packed_ = PackedHulls(hulls_);
    }

    py::array map() const {
        const int rows = std::max(packed_.rows(), 1);
        std::vector<float> texels = packed_.maps();
        texels.resize(static_cast<std::size_t>(rows) * kHullColumns);
        return array_of<float>(std::move(texels), {rows, kHullColumns, 1});
    }
    // Where each mesh is in the grid.
    std::vector<glm::dmat4> checked(const std::vector<Matrix>& grid_from) const {
        if (grid_from.size() != hulls_.size())
            throw py::value_error("grid_from: accepted: a matrix for each mesh");
        std::vector<glm::dmat4> made;
        for (const Matrix& each : grid_from) made.push_back(checked_matrix(each, "grid_from"));
        return made;
    }
    // The hulls as a scene's objects, so that the same rules hold; water_m: height of the water at those that float.
    Scene as_scene(const std::vector<glm::dmat4>& grid_from,
                   const std::vector<std::optional<double>>& water_m) const {
        if (water_m.size() != hulls_.size())
            throw py::value_error("water_m: accepted: a height, or None, for each mesh");
        Scene scene;
        for (std::size_t i = 0; i < hulls_.size(); ++i) {
            SceneObject& object = scene.objects.emplace_back();
            const glm::dmat4& at = grid_from[i];
            // What is flat has no inside.
            if (!hulls_[i] || !(std::abs(glm::determinant(glm::dmat3(at))) > 1e-12)) continue;
            object.mesh = meshes_[i];
            object.scale = glm::length(glm::dvec3(at[0]));
            object.floats = water_m[i].has_value();
            object.east_m = at[3].x;
            object.north_m = at[3].y;
            object.up_m = at[3].z - water_m[i].value_or(0.0);
            object.heading_deg = glm::degrees(std::atan2(at[0].y, at[0].x));
        }
        return scene;
    }
    py::array places(const std::vector<glm::dmat4>& grid_from,
                     const std::vector<Hulls::Beside>& beside) const {
        std::vector<PlacedHull> placed;
        for (std::size_t i = 0; i < hulls_.size(); ++i)
            placed.push_back({hulls_[i].get(), grid_from[i], beside.empty() ? nullptr : &beside[i]});
        std::vector<glm::vec4> texels = packed_.places(placed);
        const auto rows = static_cast<py::ssize_t>(texels.size() / kHullPlaceColumns);
        return array_of<float>(std::move(texels), {rows, kHullPlaceColumns});
    }

  private:
    std::vector<std::shared_ptr<const ObjectMesh>> meshes_;
    std::vector<std::shared_ptr<const Hull>> hulls_;
    PackedHulls packed_{{}};
};

glm::dvec2 checked_origin(std::array<double, 2> origin_m) {
    const glm::dvec2 origin(origin_m[0], origin_m[1]);
    if (!std::isfinite(origin.x) || !std::isfinite(origin.y))
        throw py::value_error("origin_m: accepted: (x, y), finite [m]");
    return origin;
}

// The uniforms and the texture of the air before an eye; of none without a height.
py::tuple air_of(const GpuLight& light, std::optional<double> height_m) {
    if (height_m && !std::isfinite(*height_m))
        throw py::value_error("height_m: accepted: a finite height [m], or None");
    Air air;
    if (light.sky.air) {
        const OthersMayRun others_may_run;
        air = light.sky.air->seen_from(height_m.value_or(0.0));
    }
    constexpr std::size_t kRow = Air::kWidth;
    air.texels.resize(kRow * Air::kHeight, glm::vec4(0.0f));
    if (!height_m) std::fill_n(air.texels.begin(), kRow * Air::kRows, glm::vec4(0.0f));
    py::dict uniforms = dict_of(air_uniforms(air));
    uniforms["eye_height_m"] = height_m.value_or(0.0);
    return py::make_tuple(uniforms, array_of<float>(std::move(air.texels), {Air::kHeight, Air::kWidth}));
}

double checked_footprint(double finest_m) {
    if (!(finest_m >= 0.0 && finest_m < 1e6))
        throw py::value_error("finest_m: accepted: a length below 1e6 m, from 0 up");
    return finest_m;
}

std::vector<double> checked_footprints(std::vector<double> footprints_m) {
    for (const double footprint_m : footprints_m)
        if (!(footprint_m > 0.0 && footprint_m < 1e6))
            throw py::value_error("hull_footprints_m: accepted: lengths above 0, below 1e6 m");
    return footprints_m;
}

template <class Made, class... More>
std::shared_ptr<Made> make_beside_others(const Scene& scene, More... more) {
    require_valid(scene);
    // A copy: other threads may change the caller's meanwhile.
    return beside_others([kept = scene, more...] { return std::make_shared<Made>(kept, more...); });
}

template <class Made, class... More>
std::unique_ptr<Task> begin_making(const Scene& scene, More... more) {
    require_valid(scene);
    return std::make_unique<Task>([kept = scene, more...](Task& task) -> Task::Made {
        std::shared_ptr<Made> made;
        if constexpr (std::is_constructible_v<Made, const Scene&, More..., const BuildWatch&>)
            made = std::make_shared<Made>(kept, more..., BuildWatch{.cancel = task.flag()});
        else
            made = std::make_shared<Made>(kept, more...);
        return [made] { return py::cast(made); };
    });
}

// ---- Grid

struct GpuGrid {
    std::shared_ptr<const ProjectedGrid> grid;
    py::array vertices;
};

py::array triangles_of(const GpuGrid& grid) {
    std::vector<std::uint32_t> indices =
        projected_grid_triangles({.columns = grid.grid->columns, .rows = grid.grid->rows});
    const auto count = static_cast<py::ssize_t>(indices.size() / 3);
    return array_of<std::uint32_t>(std::move(indices), {count, 3});
}

// The pictures of the objects that the sea mirrors and shows in its water, in a view, and the uniforms of both.
py::dict objects_of(const GpuGrid& grid, const View& view, const std::vector<Matrix>& grid_from,
                    const std::vector<std::array<std::array<double, 3>, 2>>& boxes_m,
                    const std::vector<double>& water_m) {
    if (grid_from.empty() || boxes_m.size() != grid_from.size() || water_m.size() != grid_from.size())
        throw py::value_error("grid_from: accepted: a matrix, a box and a height of each body, one at least");
    std::vector<ViewedBody> bodies;
    for (std::size_t i = 0; i < grid_from.size(); ++i) {
        const auto& [least, most] = boxes_m[i];
        bodies.push_back({grid_from_box(checked_matrix(grid_from[i], "grid_from"),
                                        {least[0], least[1], least[2]}, {most[0], most[1], most[2]}),
                          water_m[i]});
    }
    const glm::dvec3 eye_m = view.position_m - glm::dvec3(grid.grid->origin_m, 0.0);
    const auto dict_of = [](const ObjectsView& made) {
        py::array_t<double> clip({4, 4});
        for (int row = 0; row < 4; ++row)
            for (int column = 0; column < 4; ++column)
                clip.mutable_at(row, column) = made.clip_from_grid[column][row];
        py::dict told;
        told["size"] = py::make_tuple(made.size.x, made.size.y);
        told["eye_m"] = py::make_tuple(made.eye_m.x, made.eye_m.y, made.eye_m.z);
        told["clip_from_grid"] = clip;
        told["texels"] = made.texels;
        return told;
    };
    const ObjectsView mirrored = mirrored_view(bodies, eye_m, view.pixel_tangent(), kObjectsSide);
    const ObjectsView in_water = in_water_view(bodies, eye_m, view.pixel_tangent(), kObjectsSide);
    const std::vector<glm::mat4> boxes = object_boxes(bodies, mirrored.eye_m);
    std::vector<float> numbers(&boxes.front()[0].x, &boxes.front()[0].x + 16 * boxes.size());
    const auto count = static_cast<py::ssize_t>(boxes.size());
    py::dict told;
    told["mirrored"] = dict_of(mirrored);
    if (in_water.size.x > 0) told["in_water"] = dict_of(in_water);
    told["boxes"] = array_of<float>(std::move(numbers), {count, 16});
    return told;
}

// ---- Sea

// GpuSea's thread. The program's end waits for it.
class FoamThread final : public NativeWork {
  public:
    // With the interpreter held, as Enlisted.
    explicit FoamThread(std::shared_ptr<const SeaOverTime<float>> sea)
        : worker_(std::make_unique<FoamWorker>(std::move(sea))) {}

    FoamWorker* worker() { return worker_.get(); }  // null in a forked process

    void cancel() override {
        if (worker_) worker_->cancel();
    }
    bool is_done() const override { return !worker_ || !worker_->is_busy(); }
    // Neither joined nor destroyed: the thread may have been anywhere.
    void abandon() override { static_cast<void>(worker_.release()); }

  private:
    Enlisted enlisted_{*this};
    std::unique_ptr<FoamWorker> worker_;
};

class GpuSea {
  public:
    GpuSea(const Scene& scene, double finest_m, const std::vector<double>& hull_footprints_m,
           const BuildWatch& watch = {})
        : finest_m_(finest_m),
          hull_footprints_m_(hull_footprints_m),
          made_from_(what_counts(scene)),
          lighting_(render_options(scene).lighting),
          prepared_(prepare(without_budget(scene))),
          sea_(std::make_shared<const SeaOverTime<float>>(
              make_plan(prepared_, queries_of(*prepared_, finest_m, hull_footprints_m),
                        {.double_precision = false}),
              watch)),
          frame_(sea_),
          now_(std::make_shared<Tables>(sea_->first())) {}

    bool serves(const Scene& scene) const { return what_counts(scene) == made_from_; }

    double finest_m() const { return finest_m_; }
    const std::vector<double>& hull_footprints_m() const { return hull_footprints_m_; }
    double finest_for(const View& view) const {
        const double finest_m = projected_grid_needs(view, projected_grid_options(*prepared_)).finest_pixel_m;
        return first_level_m(std::max(finest_m, kLeast_m));
    }

    void set(double t_s) {
        const OthersMayRun others_may_run;
        const std::lock_guard writing(mutex_);
        // Without other tasks of the same TBB meanwhile: the host's own might ask this sea, and wait for themselves.
        tbb::this_task_arena::isolate([&] {
            frame_.set(t_s);
            if (&now_->layout().sea() != &frame_.sea()) now_ = std::make_shared<Tables>(frame_.shared_sea());
            now_->packed.pack(frame_);
        });
    }

    // Of the time that was set; nullopt before.
    std::optional<double> water_over(const View& view) const {
        const OthersMayRun others_may_run;
        const std::lock_guard reading(mutex_);
        if (!frame_.is_set()) return std::nullopt;
        return tbb::this_task_arena::isolate(
            [&] { return surface_above_camera(frame_, view, projected_grid_options(*prepared_)); });
    }

    // The water along hulls at the time that was set; empty where this sea wasn't built for them. at: where a scene's objects are in the
    // world; per_s: how that changes, but for the waves.
    std::vector<Hulls::Beside> beside(const Scene& bodies, const std::vector<glm::dmat4>& at,
                                      const std::vector<glm::dmat4>& per_s) const {
        const std::optional<Query> asked = hulls_query(bodies, false);
        if (!asked || !std::ranges::all_of(asked->cell_m, [&](double m) {
                return std::ranges::find(hull_footprints_m_, m) != hull_footprints_m_.end();
            }))
            return {};
        const OthersMayRun others_may_run;
        const std::lock_guard reading(mutex_);
        const std::optional<int> query = hulls_query(frame_.sea().plan());
        if (!frame_.is_set() || !query) return {};
        return tbb::this_task_arena::isolate([&] {
            std::vector<Hulls::Moved> moved;
            for (std::size_t i = 0; i < at.size(); ++i) {
                Hulls::Moved& body = moved.emplace_back();
                body.axes = glm::dmat3(at[i]);
                body.place_m = glm::dvec3(at[i][3]);
                body.axes_per_s = glm::dmat3(per_s[i]);
                body.place_mps = glm::dvec3(per_s[i][3]);
                if (bodies.objects[i].mesh && bodies.objects[i].floats) add_waves(bodies, i, *query, body);
            }
            Hulls hulls(bodies);
            hulls.place(moved);
            return hulls.beside(frame_, query);
        });
    }

    py::dict shaders(const GpuLight& light, bool objects) const {
        DrawOptions options{
            .lighting = lighting_, .has_objects = objects, .has_images = objects, .for_host = true};
        options.lighting.air = options.lighting.air && light.sky.air;
        options.sky_from_air = light.sky.air && light.sky.air->has_sky();
        const auto pair = [](const ShaderVariant& variant) {
            return py::make_tuple(std::string(variant.vertex().body()),
                                  std::string(variant.fragment().body()));
        };
        py::dict made;
        made["sea"] = pair(ShaderVariant::of_sea(now()->layout(), options, light.map_size));
        made["sky"] = pair(ShaderVariant::of_sky(options, light.map_size));
        for (const auto& [name, picture] : {std::pair{"object_mirrored", ObjectPicture::Mirrored},
                                            std::pair{"object_in_water", ObjectPicture::InWater}})
            if (objects) made[name] = pair(ShaderVariant::of_object(options, light.map_size, picture));
        return made;
    }

    py::dict uniforms() const { return dict_of(query_uniforms(now()->layout())); }

    // Views of the packed frame's memory, which they keep alive.
    py::dict textures() const {
        const auto tables = now();
        const SeaLayout& layout = tables->layout();
        const py::capsule owner(new std::shared_ptr<Tables>(tables),
                                [](void* held) { delete static_cast<std::shared_ptr<Tables>*>(held); });
        static constexpr std::array<const char*, 3> kNames{"cell_fields", "pixel_fields", "pixel_fields_2"};
        py::dict made;
        for (std::size_t p = 0; p < tables->packed.planes().size(); ++p) {
            const SeaLayout::Plane& plane = layout.planes()[p];
            made[kNames[p]] = view_of(owner, tables->packed.planes()[p].data(),
                                      {plane.size.y, plane.size.x, plane.channels});
        }
        if (made.empty()) return made;  // no time was set
        if (const std::vector<glm::vec4>& wakes = tables->packed.wakes(); !wakes.empty()) {
            const glm::ivec2 size = layout.wake_size();
            made["wake_table"] = view_of(owner, &wakes[0].x, {size.y, size.x, 4});
        }
        const int columns = layout.ellipse_columns();
        made["ellipse_table"] =
            view_of(owner, &tables->ellipse_table[0].x,
                    {static_cast<py::ssize_t>(tables->ellipse_table.size()) / columns, columns, 4});
        if (!tables->mask_cells.empty()) {
            const glm::ivec2 size = layout.mask_cells_size();
            made["mask_cells"] = view_of(owner, tables->mask_cells.data(), {size.y, size.x, 1});
        }
        if (!tables->coast_cells.empty()) {
            const glm::ivec2 size = layout.coast_sizes().cells;
            made["coast_cells"] = view_of(owner, &tables->coast_cells[0].x, {size.y, size.x, 4});
        }
        if (!tables->coast_trains.empty()) {
            const glm::ivec2 size = layout.coast_sizes().trains;
            made["coast_trains"] = view_of(owner, &tables->coast_trains[0].x, {size.y, size.x, 2});
        }
        if (!tables->train_table.empty())
            made["train_table"] =
                view_of(owner, &tables->train_table[0].x,
                        {SeaLayout::kTrainTexels,
                         static_cast<py::ssize_t>(tables->train_table.size()) / SeaLayout::kTrainTexels, 4});
        return made;
    }

    py::tuple at_origin(std::array<double, 2> origin_m) const {
        const glm::dvec2 origin = checked_origin(origin_m);
        const auto reading = locked();
        const SeaLayout& layout = now_->layout();
        py::object cycles = py::none();
        if (layout.has_trains()) {
            std::vector<float> values = layout.train_cycles(origin, now_->packed.time_within_loop_s());
            values.resize(std::max<std::size_t>(values.size(), 1));  // a texture has a texel
            const auto count = static_cast<py::ssize_t>(values.size());
            cycles = array_of<float>(std::move(values), {1, count, 1});
        }
        return py::make_tuple(
            array_of<std::uint8_t>(layout.tables(origin, now_->packed.time_within_loop_s())), cycles);
    }

    GpuGrid grid(const View& view, std::optional<double> cell_px, bool on_earth) const {
        ProjectedGridOptions options = projected_grid_options(*prepared_);
        if (!on_earth) options.curvature_per_m = 0.0;
        if (cell_px) {
            if (!(*cell_px > 0.0 && *cell_px <= std::numeric_limits<double>::max()))
                throw py::value_error("cell_px: accepted: a number above 0");
            options.cell_px = *cell_px;
        }
        ProjectedGrid grid;
        std::vector<std::array<float, 8>> vertices;
        const bool has_levels = now()->layout().pixels().footprints_m.size() > 1;
        {
            const OthersMayRun others_may_run;
            const ProjectedGridSize size = projected_grid_needs(view, options).size;
            options.size = {.columns = std::min(size.columns, kMostCells),
                            .rows = std::min(size.rows, kMostCells)};
            options.has_levels = has_levels;
            grid = projected_grid(view, options);
            vertices.resize(grid.rest_m.size());
            for (std::size_t i = 0; i < vertices.size(); ++i)
                vertices[i] = {grid.rest_m[i].x,       grid.rest_m[i].y,      grid.cell_m[i],
                               grid.cell_axis_m[i].x,  grid.cell_axis_m[i].y, grid.pixel_m[i],
                               grid.pixel_axis_m[i].x, grid.pixel_axis_m[i].y};
        }
        return {std::make_shared<const ProjectedGrid>(std::move(grid)), array_of<float>(std::move(vertices))};
    }

    py::dict foam(const Scene& scene, std::array<double, 2> origin_m, const GpuLight& light) const {
        const auto tables = now();
        const Sea<float>& sea = tables->layout().sea();
        const double active =
            has_living_foam() ? active_foam(sea.plan().from->scene, sea.residual_coverage()) : 1.0;
        return dict_of(foam_uniforms(
            foam_pattern(make_foam(scene, light.foam_picture, active), checked_origin(origin_m))));
    }
    // Hosts ask at each redraw, and it takes milliseconds.
    py::dict water(const Scene& scene) const {
        std::string from = canonical(scene, key_parts(KeyPart::Water));
        if (const auto tables = now(); tables != water_of_ || from != water_from_) {
            water_ = water_uniforms(make_water(scene, tables->layout().sea().plan().from->spectrum));
            water_from_ = std::move(from);
            water_of_ = tables;
        }
        return dict_of(water_);
    }

    // As water(): kept while scene and light are the same.
    py::dict surroundings(const Scene& scene, const std::shared_ptr<const GpuLight>& light) const {
        std::string from = canonical(scene);
        if (const auto tables = now(); light != surroundings_of_ || from != surroundings_from_) {
            surroundings_ = surroundings_uniforms(object_surroundings(
                lighting_, light->sky, make_water(scene, tables->layout().sea().plan().from->spectrum),
                law_coverage(scene)));
            surroundings_from_ = std::move(from);
            surroundings_of_ = light;
        }
        return dict_of(surroundings_);
    }

    bool has_living_foam() const { return now()->layout().has_living_foam(); }
    void ask_foam(double t_s, const std::vector<GpuGrid*>& grids) {
        if (!(std::abs(t_s) <= Frame<float>::kLatest_s))
            throw py::value_error("t: accepted: a time of at most 1e12 s to either side of 0");
        FoamWorker::Grids asked;
        for (const GpuGrid* grid : grids) {
            if (!grid) throw py::type_error("grids: accepted: a list of GpuGrid");
            asked.push_back(grid->grid);
        }
        if (!has_living_foam()) return;
        if (!foam_thread_ || !foam_thread_->worker()) foam_thread_.emplace(sea_);
        foam_thread_->worker()->ask(t_s, std::move(asked));
    }
    bool is_foam_busy() const { return foam_thread_ && !foam_thread_->is_done(); }
    // Empty where there is nothing new.
    py::dict take_foam() {
        py::dict made;
        if (!has_living_foam()) return made;
        std::shared_ptr<const PackedFoam> foam;
        if (FoamWorker* const worker = foam_thread_ ? foam_thread_->worker() : nullptr) {
            if (const std::string problem = worker->error(); !problem.empty())
                throw std::runtime_error(problem);
            foam = worker->take();
        }
        if (!foam && foam_) return made;
        foam_ = foam ? std::move(foam) : std::make_shared<const PackedFoam>();
        const auto picture = [](auto values, glm::ivec2 size, py::ssize_t channels) {
            py::array_t<float> all = array_of<float>(std::move(values));
            return all.reshape({py::ssize_t{size.y}, py::ssize_t{size.x}, channels});
        };
        made["foam_nodes"] = picture(std::vector(foam_->nodes()), foam_->nodes_size(), foam_->channels());
        made["foam_pages"] = picture(std::vector(foam_->pages()), foam_->pages_size(), 1);
        return made;
    }
    py::array foam_levels(std::array<double, 2> origin_m) const {
        const glm::dvec2 origin = checked_origin(origin_m);
        std::vector<glm::vec4> texels = (foam_ ? *foam_ : PackedFoam()).level_texels(origin);
        const auto rows = static_cast<py::ssize_t>(texels.size()) / PackedFoam::kLevelTexels;
        return array_of<float>(std::move(texels), {rows, PackedFoam::kLevelTexels});
    }

    std::size_t bytes() const {
        std::size_t sum = sea_->plan().sea_bytes() + sea_->plan().frame_bytes();
        if (foam_) sum += foam_->bytes() + foam_->history_bytes();
        const auto tables = now();
        sum += tables->layout().coast_sizes().bytes();
        for (const SeaLayout::Plane& plane : tables->layout().planes())
            sum += sizeof(float) * static_cast<std::size_t>(plane.channels) * plane.size.x * plane.size.y;
        return sum;
    }

    bool changes() const { return prepared_->weather != nullptr; }

  private:
    // Of a time's sea: the next set() packs another frame into it, or, where the sea changes, makes another.
    struct Tables {
        explicit Tables(const std::shared_ptr<const Sea<float>>& sea)
            : packed(sea, 0), ellipse_table(layout().ellipse_texels()) {
            if (layout().has_trains()) train_table = layout().train_texels();
            if (layout().has_mask_pictures()) mask_cells = layout().mask_cells();
            if (layout().has_surf()) {
                coast_cells = layout().coast_cell_texels();
                coast_trains = layout().coast_train_texels();
            }
        }
        const SeaLayout& layout() const { return *packed.layout(); }

        PackedFrame packed;
        std::vector<glm::vec4> train_table, ellipse_table, coast_cells;
        std::vector<glm::vec2> coast_trains;
        std::vector<float> mask_cells;
    };
    std::shared_ptr<Tables> now() const {
        const auto reading = locked();
        return now_;
    }

    // Waits without the interpreter: who sets meanwhile may take long.
    std::unique_lock<std::mutex> locked() const {
        const OthersMayRun others_may_run;
        return std::unique_lock(mutex_);
    }

    // The clock only by the loop that it makes and by when heroes, fronts, vessels and keys stand: set() is given the sea's time.
    static std::string what_counts(const Scene& scene) {
        std::string moments;
        for (const HeroWave& hero : scene.waves.heroes)
            moments += number_text(scene.shot.time_s(hero.frame)) + ' ';
        for (const GustFront& front : scene.sea.gust_fronts)
            moments += number_text(scene.shot.time_s(front.frame)) + ' ';
        if (!scene.waves.vessels.empty())  // their keys are at frames
            for (const double frame : {0.0, 1.0}) moments += number_text(scene.shot.time_s(frame)) + ' ';
        for (const int frame : frames_of_sea(scene)) moments += number_text(scene.shot.time_s(frame)) + ' ';
        return canonical(scene, kKeyParts) + number_text(scene.shot.sea_loop_s()) + moments +
               (has_bubbles(scene) ? " bubbles" : "");
    }

    // How the waves move what floats on them.
    void add_waves(const Scene& bodies, std::size_t object, int query, Hulls::Moved& body) const {
        constexpr double kBeside_s = 0.01;
        const auto pose = [&](double late_s) {
            return place_object(frame_, bodies, bodies.objects[object], {.query = query, .late_s = late_s})
                .pose;
        };
        const ObjectPose before = pose(-kBeside_s), behind = pose(kBeside_s);
        const glm::dmat3 turns_per_s =
            (behind.turn - before.turn) * glm::inverse(pose(0.0).turn) / (2.0 * kBeside_s);
        body.axes_per_s += turns_per_s * body.axes;
        body.place_mps += (behind.place_m - before.place_m) / (2.0 * kBeside_s);
    }

    static std::vector<Query> queries_of(const PreparedScene& prepared, double finest_m,
                                         const std::vector<double>& hull_footprints_m) {
        std::vector<Query> queries{query_of(prepared, finest_m)};
        if (auto hulls = hulls_query({hull_footprints_m.begin(), hull_footprints_m.end()}))
            queries.push_back(std::move(*hulls));
        return queries;
    }
    // A cell is several pixels wide.
    static Query query_of(const PreparedScene& prepared, double finest_m) {
        return view_query(prepared, {.products = {},
                                     .finest_cell_m = 0.5 * prepared.scene.surface.cell_px * finest_m,
                                     .finest_pixel_m = finest_m});
    }

    static py::array view_of(const py::object& owner, const float* data, std::vector<py::ssize_t> shape) {
        py::array_t<float> view(std::move(shape), data, owner);
        view.attr("setflags")(py::arg("write") = false);
        return view;
    }

    static constexpr KeyPartSet kKeyParts =
        key_parts(KeyPart::Waves, KeyPart::Foam, KeyPart::Gusts, KeyPart::Quality, KeyPart::Grid);
    // A side of a grid. Views along the surface from far behind, as orthographic ones are, would need millions.
    static constexpr int kMostCells = 1024;
    static constexpr double kLeast_m = 1e-4;  // no wave is shorter than some millimetres
    double finest_m_ = 0.0;
    std::vector<double> hull_footprints_m_;
    std::string made_from_;
    LightingChoice lighting_;
    std::shared_ptr<const PreparedScene> prepared_;
    std::shared_ptr<const SeaOverTime<float>> sea_;
    Frame<float> frame_;
    std::shared_ptr<Tables> now_;  // of the time that was set last
    mutable std::mutex mutex_;
    std::shared_ptr<const PackedFoam> foam_;  // what was taken last
    std::optional<FoamThread> foam_thread_;   // of persistent foam that was asked for
    mutable std::vector<Uniform> water_;
    mutable std::string water_from_;
    mutable std::shared_ptr<const Tables> water_of_;
    mutable std::vector<Uniform> surroundings_;
    mutable std::string surroundings_from_;
    mutable std::shared_ptr<const GpuLight> surroundings_of_;
};

// Of footprints that a sea's hulls' query has.
std::vector<double> footprints_of_hulls(const GpuHulls& hulls, const std::vector<Matrix>& grid_from,
                                        const std::vector<std::optional<double>>& water_m) {
    const std::optional<Query> query = hulls_query(hulls.as_scene(hulls.checked(grid_from), water_m), false);
    return query ? query->cell_m : std::vector<double>();
}

py::array places_of_hulls(const GpuHulls& hulls, const std::vector<Matrix>& grid_from, const GpuSea* sea,
                          std::array<double, 2> origin_m, const std::vector<Matrix>& per_s,
                          const std::vector<std::optional<double>>& water_m) {
    const std::vector<glm::dmat4> at = hulls.checked(grid_from);
    if (!sea) return hulls.places(at, {});
    std::vector<glm::dmat4> world = at, changes;
    for (glm::dmat4& each : world) each[3] += glm::dvec4(checked_origin(origin_m), 0.0, 0.0);
    for (const Matrix& each : per_s) changes.push_back(checked_matrix(each, "per_s"));
    if (changes.size() != at.size()) throw py::value_error("per_s: accepted: a matrix for each mesh");
    return hulls.places(at, sea->beside(hulls.as_scene(world, water_m), world, changes));
}

void add_gpu_hulls(py::module_& module) {
    py::class_<GpuHulls>(
        module, "GpuHulls", py::module_local(),
        "Where a host's own objects keep water out, for GpuSea's shader with objects: as the objects of a shot do.\n\n"
        "meshes: (points, triangles) of each, float32 (n, 3) [m] in its own axes, z up, and indices (m, 3). Some tenths of a second "
        "for a large one; other threads run meanwhile, and equal meshes are made once. What keeps no water out does nothing: a sheet, a mesh without "
        "area, one with indices out of range or numbers that aren't finite.")
        .def(py::init<const std::vector<std::pair<GpuHulls::Points, GpuHulls::Triangles>>&>(),
             py::arg("meshes"))
        .def_property_readonly("map", &GpuHulls::map,
                               "The texture hull_maps: float32 (height, width, 1), texels as they are.")
        .def(
            "places", &places_of_hulls, py::arg("grid_from"), py::arg("sea") = py::none(),
            py::arg("origin_m") = std::array<double, 2>{0.0, 0.0}, py::arg("per_s") = py::list(),
            py::arg("water_m") = py::list(),
            "The texture hull_places, float32 (height, width, 4): of matrices (4, 4), one for each mesh, from its axes to the grid's "
            "coordinates.\n\n"
            "sea: the GpuSea whose water makes foam along them, at the time that was set; without one, and where that wasn't built for their "
            "footprints_m(), there is none. origin_m: the grid's. per_s: how each of the matrices changes in a second of the sea, (4, 4), "
            "without the waves; water_m: height of the water at what floats on it, which moves with the waves on top of that, and None for what doesn't.")
        .def(
            "footprints_m", &footprints_of_hulls, py::arg("grid_from"), py::arg("water_m"),
            "What a GpuSea must be built for to know the water along them: footprints [m], few, and the same for hulls of about one size.");
}

void add_gpu_light(py::module_& module) {
    py::class_<GpuLight, std::shared_ptr<GpuLight>>(
        module, "GpuLight", py::module_local(),
        "Sky and sun of a scene for GpuSea's shaders. ShotError for an invalid scene, ValueError for a "
        "sky's picture that can't be read.")
        .def(py::init(&make_beside_others<GpuLight>), py::arg("scene"))
        .def_static("begin", &begin_making<GpuLight>, py::arg("scene"),
                    "Begins to make one: a Task whose result is the GpuLight.")
        .def("serves", &GpuLight::serves, py::arg("scene"), "Whether that scene has the same light.")
        .def_property_readonly(
            "uniforms", [](const GpuLight& self) { return dict_of(self.uniforms); },
            "Uniforms of both shaders by name: numbers and tuples.")
        .def_property_readonly(
            "sky_map",
            [](const py::object& self) {
                const SkyAtlas& atlas = self.cast<const GpuLight&>().atlas;
                py::array_t<float> view({atlas.size.y, atlas.size.x, 4}, &atlas.texels[0].x, self);
                view.attr("setflags")(py::arg("write") = false);
                return view;
            },
            "The texture sky_map: float32 (height, width, 4), all its levels in one picture. Read-only.")
        .def_property_readonly(
            "foam_image",
            [](const GpuLight& self) {
                const FoamImage none, &shown = self.foam_picture ? *self.foam_picture : none;
                return array_of<float>(std::vector(shown.texels), {shown.rows(), shown.side, 1});
            },
            "The texture foam_image: float32 (height, width, 1), effects.foam_pattern's picture in all its levels.")
        .def(
            "air", &air_of, py::arg("height_m"),
            "(uniforms, air_table) of the air before an eye so high above the sea at rest [m]: uniforms of the sea's "
            "shader by name, and the texture air_table, float32 (height, width, 4), texels as they are. None: no air "
            "before the sea, for views without an eye. Takes some 25 ms.")
        .def(
            "exposure",
            [](GpuLight& self, const Scene& scene, double stops) {
                std::string made_from = canonical(scene) + std::to_string(stops);
                if (made_from != self.metered.made_from) {
                    require_valid(scene);
                    const float exposure = shot_exposure(scene, self.sky, stops);
                    self.metered = {std::move(made_from), exposure};
                }
                return self.metered.exposure;
            },
            py::arg("scene"), py::arg("stops") = 0.0,
            "The uniform exposure, of both shaders: that of a scene that this light serves, as Sky.exposure() has it.");
}

void add_gpu_grid(py::module_& module) {
    py::class_<GpuGrid>(module, "GpuGrid", py::module_local(),
                        "The projected grid of a view, as vertices for GpuSea's shader.")
        .def_property_readonly(
            "size", [](const GpuGrid& self) { return py::make_tuple(self.grid->columns, self.grid->rows); },
            "(columns, rows) of cells.")
        .def_property_readonly(
            "origin_m",
            [](const GpuGrid& self) { return py::make_tuple(self.grid->origin_m.x, self.grid->origin_m.y); },
            "(x, y) [m], in double precision: vertices are relative to it.")
        .def_property_readonly(
            "curvature_per_m", [](const GpuGrid& self) { return self.grid->curvature_per_m; },
            "The uniform of that name [1/m]: of the earth, round which the shader lays the grid; 0: flat.")
        .def_readonly(
            "vertices", &GpuGrid::vertices,
            "float32 (n, 8): the attributes rest_in (the first two), cell_in and pixel_in (three each) [m].")
        .def(
            "objects", &objects_of, py::arg("view"), py::arg("grid_from"), py::arg("boxes_m"),
            py::arg("water_m"),
            "How the objects are drawn that the sea shows in a view, one body at least. grid_from: matrices (4, 4) from a body's axes to the "
            "grid's coordinates; boxes_m: ((x, y, z), (x, y, z)), its least and its most there; water_m: height of the water at it. Returns mirrored, and in_water "
            "if part of one is in the water and the view above it, two pictures: size (width, height) in texels, eye_m, clip_from_grid float64 (4, 4) "
            "(of x, y and w; see depth_of_distance), and texels. And the sea's uniforms: mirrored_from_grid and in_water_from_grid are their "
            "clip_from_grid, mirrored_texels is texels of the first, and boxes, float32 (object_count, 16), object_boxes, column by column.")
        .def_property_readonly("triangles", &triangles_of,
                               "uint32 (m, 3), made anew; the nearest first. They depend on the size alone.");
}

}  // namespace

void add_viewport(py::module_& module) {
    add_gpu_light(module);
    add_gpu_grid(module);
    py::class_<GpuSea, std::shared_ptr<GpuSea>>(
        module, "GpuSea", py::module_local(),
        "A sea for pictures from any camera, with what a GPU needs to draw it by itself: the preview's "
        "shaders, and their textures and uniforms.\n\n"
        "Built once from a scene, which takes as long as a Sea; other threads run meanwhile. ShotError for an "
        "invalid scene. Single precision. finest_m: no pixel's footprint is taken as finer [m], and what is "
        "left out of it roughens the surface; each halving costs up to four times the memory and the time. 0: "
        "nothing is left out. hull_footprints_m: GpuHulls.footprints_m() of hulls that are to have foam along them; each costs part of a frame.")
        .def(py::init([](const Scene& scene, double finest_m, const std::vector<double>& hull_footprints_m) {
                 return make_beside_others<GpuSea>(scene, checked_footprint(finest_m),
                                                   checked_footprints(hull_footprints_m));
             }),
             py::arg("scene"), py::arg("finest_m") = 0.0, py::arg("hull_footprints_m") = py::list())
        .def_static(
            "begin",
            [](const Scene& scene, double finest_m, const std::vector<double>& hull_footprints_m) {
                return begin_making<GpuSea>(scene, checked_footprint(finest_m),
                                            checked_footprints(hull_footprints_m));
            },
            py::arg("scene"), py::arg("finest_m") = 0.0, py::arg("hull_footprints_m") = py::list(),
            "Begins to build one: a Task whose result is the GpuSea.")
        .def_property_readonly("finest_m", &GpuSea::finest_m, "As it was built [m].")
        .def_property_readonly("hull_footprints_m", &GpuSea::hull_footprints_m,
                               "As it was built: a list [m].")
        .def("finest_for", &GpuSea::finest_for, py::arg("view"),
             "The finest_m that shows all waves that the pixels of this view can hold: a power of two [m].")
        .def("serves", &GpuSea::serves, py::arg("scene"),
             "Whether that scene has the same waves, foam and quality, so that nothing needs to be built.")
        .def("set", &GpuSea::set, py::arg("t"),
             "Makes it the sea at any finite time t [s]: `textures` changes. Other threads run meanwhile.")
        .def(
            "water_over", &GpuSea::water_over, py::arg("view"),
            "The height z [m] of the surface above the view's place, at the time that was set; None for a view "
            "in the air, the only one that can be drawn.")
        .def(
            "shaders", &GpuSea::shaders, py::arg("light"), py::arg("objects") = false,
            "{\"sea\": (vertex, fragment), \"sky\": (vertex, fragment)}: GLSL 3.30 without a #version line. "
            "Equal for seas with as many cascades and footprints.\n\n"
            "The host puts a function `vec4 host_colour(vec4 display)` before the fragment shaders, from sRGB "
            "values to what its framebuffer stores. Uniforms besides those of GpuSea and GpuLight: mat4 "
            "clip_from_grid (the host's projection of points relative to the grid's origin), exposure, and the "
            "pixels' rays: vec3 view_forward, view_right, view_up (the latter two times the tangent that a "
            "pixel covers), vec2 view_centre [px] from the bottom left, view_pixel_tangent. The sky is one "
            "triangle, three vertices without attributes; its uniform `farthest` is the depth, 1 at the far "
            "plane.\n\n"
            "objects: the sea shows the host's own. It draws their depth towards the sun, 0 … 1, into a texture sun_blockers (1 "
            "where there is nothing), and sets mat4 shadow_from_grid (from the grid's coordinates to the texture's and that depth; zeros: nothing is shadowed), vec4 "
            "shadow_reach (its width, height and depth [m], the tangent of the sun's radius), shadow_off (of depth), and view_height_m as "
            "eye_height_m.\n\n"
            "It draws them by the shader \"object_mirrored\" as GpuGrid.objects() says, linear light and coverage, into a texture mirrored_objects of "
            "twice that width: there level 0 begins at (0, 0), and level k, each texel the mean of four, at (width, 0) and its own size more; and by "
            "\"object_in_water\", which has the uniforms of water() besides, into textures objects_in_water, filtered, and objects_in_water_depth, "
            "texels as they are, both clamped to their edges. vec3 in_water_ahead is (1, -1, -.y / 2) of that picture's depth_of_distance; 0 "
            "where nothing is in the water, or water_body_look.x is 0. With the textures of GpuHulls, no sea is drawn in hulls.\n\n"
            "These shaders' attributes are place_in and normal_in (three each, the object's own) and "
            "material_in, a row of the texture object_materials, float32 (rows, 2, 4): colour and roughness, glow and 0; and image_at_in (two), a "
            "place in the texture object_image, linear colours that repeat and stand for the material's where int object_has_image isn't 0. Their uniforms besides "
            "GpuLight's, surroundings() and those beside sun_blockers: mat4 clip_from_object and grid_from_object, vec2 depth_of_distance (clip z is "
            "its .x w + .y), vec3 object_eye and object_colour, object_glow (a factor), object_water_m (height of the water), "
            "shadow_texel_m (how far off its own surface a place asks for its shadow).")
        .def_property_readonly(
            "uniforms", &GpuSea::uniforms,
            "Uniforms of the sea's shader by name: numbers (int where the shader's are) and "
            "tuples.")
        .def_property_readonly(
            "textures", &GpuSea::textures,
            "Textures of the sea's shader by name: float32 (height, width, 1, 2 or 4), texels as they are. "
            "Read-only views of memory that the next set() overwrites; only train_table, ellipse_table, mask_cells, coast_cells and coast_trains stay, unless it `changes`.")
        .def(
            "at_origin", &GpuSea::at_origin, py::arg("origin_m"),
            "(tables, train_cycles) for a grid's origin: the bytes of the uniform block SeaTables, which depend "
            "on time where there are gusts or vessels, as uint8; and the texture train_cycles, float32 (1, trains, 1), which does, or "
            "None.")
        .def(
            "foam", &GpuSea::foam, py::arg("scene"), py::arg("origin_m"), py::arg("light"),
            "Uniforms of the sea's shader by name: the pattern of foam, as a scene that this sea and this GpuLight serve has it, "
            "for a grid's origin [m].")
        .def(
            "surroundings", &GpuSea::surroundings, py::arg("scene"), py::arg("light").none(false),
            "Uniforms of the shaders \"object_mirrored\" and \"object_in_water\" by name: the light of sky and sea round bodies, of a scene that this sea and this "
            "GpuLight serve.")
        .def(
            "water", &GpuSea::water, py::arg("scene"),
            "Uniforms of the sea's shader and of \"object_in_water\" by name: the water of a scene that this sea serves.")
        .def_property_readonly(
            "changes", &GpuSea::changes,
            "Whether its scene's sea has keys: then uniforms and all textures change with set().")
        .def_property_readonly(
            "has_living_foam", &GpuSea::has_living_foam,
            "Whether earlier breaking leaves foam: then the shader has the textures of take_foam() and "
            "foam_levels().")
        .def(
            "ask_foam", &GpuSea::ask_foam, py::arg("t"), py::arg("grids"),
            "Wants what earlier breaking has left at a time t [s] where these GpuGrids are. It is made by a thread of its own, "
            "the latest request first; nothing waits. ValueError for a time beyond 1e12 s.")
        .def_property_readonly("is_foam_busy", &GpuSea::is_foam_busy,
                               "Whether that thread has something to do.")
        .def(
            "take_foam", &GpuSea::take_foam,
            "The textures foam_nodes and foam_pages, float32 (height, width, 2, or 4 with bubbles, and 1), of the latest request that is done: "
            "once, {} otherwise. The first call has textures of a sea without such foam.")
        .def(
            "foam_levels", &GpuSea::foam_levels, py::arg("origin_m"),
            "The texture foam_levels for what was taken last and a grid's origin [m], float32 (height, 2, 4).")
        .def(
            "grid", &GpuSea::grid, py::arg("view"), py::arg("cell_px") = py::none(),
            py::arg("on_earth") = true,
            "The projected grid of a view, a GpuGrid. cell_px: the cells' side on the screen; by default the "
            "scene's surface.cell_px. At most 1024 cells a side: where a view needs more, they are larger. on_earth: "
            "False for a flat sea, whatever the scene's surface.earth_curvature.")
        .def_property_readonly("bytes", &GpuSea::bytes, "Memory that it holds [bytes].");
    add_gpu_hulls(module);
}

}  // namespace pelagic::python
