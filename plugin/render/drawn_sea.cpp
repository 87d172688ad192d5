#include "plugin/render/drawn_sea.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>
#include <limits>
#include <numeric>
#include <unordered_map>
#include <utility>

#include "core/scene/canonical.h"
#include "core/scene/keys.h"
#include "core/scene/text.h"
#include "core/surface/footprint_levels.h"
#include "plugin/light/light.h"
#include "plugin/render/under_water.h"
#include "plugin/render/waterline.h"

namespace pelagic {
namespace {

// Makes a mesh of those points alone that triangles have, in their order.
void drop_lonely_points(SeaMesh& mesh) {
    ProjectedGrid& points = mesh.points;
    std::vector<std::uint8_t> is_used(points.rest_m.size());
    for (const std::uint32_t index : mesh.triangles) is_used[index] = 1;
    std::vector<std::uint32_t> moved(is_used.size());
    std::uint32_t kept = 0;
    for (std::size_t i = 0; i < is_used.size(); ++i) {
        moved[i] = kept;
        if (is_used[i] == 0) continue;
        points.rest_m[kept] = points.rest_m[i];
        points.cell_m[kept] = points.cell_m[i];
        points.pixel_m[kept] = points.pixel_m[i];
        points.cell_axis_m[kept] = points.cell_axis_m[i];
        points.pixel_axis_m[kept] = points.pixel_axis_m[i];
        ++kept;
    }
    for (std::uint32_t& index : mesh.triangles) index = moved[index];
    for (auto* numbers : {&points.cell_m, &points.pixel_m}) numbers->resize(kept);
    for (auto* places : {&points.rest_m, &points.cell_axis_m, &points.pixel_axis_m}) places->resize(kept);
}

// Cuts off what lies beyond the line where sign · (the coordinate along an axis) is `most`, relative to the points' origin.
class Cut {
  public:
    Cut(SeaMesh& mesh, int axis, float sign, float most)
        : points_(mesh.points), axis_(axis), sign_(sign), most_(most) {
        std::vector<std::uint32_t> kept;
        kept.reserve(mesh.triangles.size());
        for (std::size_t t = 0; t + 2 < mesh.triangles.size(); t += 3) {
            std::array<std::uint32_t, 4> polygon{};
            int corners = 0;
            for (int i = 0; i < 3; ++i) {
                const std::uint32_t a = mesh.triangles[t + i], b = mesh.triangles[t + (i + 1) % 3];
                const bool is_a = is_inside(a), is_b = is_inside(b);
                if (is_a) polygon[corners++] = a;
                if (is_a != is_b) polygon[corners++] = between(a, b);
            }
            for (int i = 2; i < corners; ++i)
                kept.insert(kept.end(), {polygon[0], polygon[i - 1], polygon[i]});
        }
        mesh.triangles = std::move(kept);
    }

  private:
    bool is_inside(std::uint32_t i) const { return sign_ * points_.rest_m[i][axis_] <= most_; }

    std::uint32_t between(std::uint32_t a, std::uint32_t b) {
        if (a > b) std::swap(a, b);
        const auto [found, is_new] = made_.try_emplace((std::uint64_t{a} << 32) | b, 0);
        if (!is_new) return found->second;
        found->second = static_cast<std::uint32_t>(points_.rest_m.size());
        const double from = points_.rest_m[a][axis_], to = points_.rest_m[b][axis_];
        const double share = (static_cast<double>(sign_) * static_cast<double>(most_) - from) / (to - from);
        const auto mix = [&](auto& values) {
            const auto first = values[a], second = values[b];
            values.push_back(first + (second - first) * static_cast<float>(share));
        };
        mix(points_.rest_m);
        mix(points_.cell_m);
        mix(points_.pixel_m);
        mix(points_.cell_axis_m);
        mix(points_.pixel_axis_m);
        points_.rest_m.back()[axis_] = sign_ * most_;
        return found->second;
    }

    ProjectedGrid& points_;
    int axis_;
    float sign_, most_;
    std::unordered_map<std::uint64_t, std::uint32_t> made_;  // by the ends of the side that is cut
};

// Of polygons over points that begin at `first`.
void add_triangles(const Faces& faces, std::uint32_t first, std::vector<std::uint32_t>& triangles) {
    const std::int32_t* corner = faces.indices.data();
    for (const std::int32_t corners : faces.counts) {
        for (std::int32_t i = 2; i < corners; ++i)
            for (const std::int32_t at : {corner[0], corner[i - 1], corner[i]})
                triangles.push_back(first + static_cast<std::uint32_t>(at));
        corner += corners;
    }
}

// A cage as finely as it takes to know how near it is.
std::shared_ptr<const RestSurface> coarse_surface(Scene scene, const Extent& extent) {
    constexpr double kFaces = 65536.0;
    const auto faces = static_cast<double>(scene.surface.cage->mesh().face_counts.size());
    const double splits = std::clamp(std::floor(0.5 * std::log2(kFaces / faces)), 0.0, 3.0);
    scene.surface.cage_level = {.splits = static_cast<int>(splits)};
    return make_surface(scene, extent);
}

}  // namespace

bool shows_open_sea(const Surface& surface) {
    switch (surface.kind) {
        case SurfaceKind::Patch:
            return surface.beyond != Beyond::Nothing;
        case SurfaceKind::Cage:
            return surface.beyond == Beyond::Sea;
        case SurfaceKind::ProjectedGrid:
        case SurfaceKind::NearFar:
        case SurfaceKind::Planet:
            return true;
    }
    return true;
}

SeaMesh open_sea(ProjectedGrid grid) {
    std::vector<std::uint32_t> triangles = projected_grid_triangles({grid.columns, grid.rows});
    return {.points = std::move(grid), .height_m = {}, .normal = {}, .triangles = std::move(triangles)};
}

void cut_to_square(double half_side_m, SeaMesh& mesh) {
    for (const int axis : {0, 1})
        for (const double sign : {1.0, -1.0})
            Cut(mesh, axis, static_cast<float>(sign),
                static_cast<float>(half_side_m - sign * mesh.points.origin_m[axis]));
    drop_lonely_points(mesh);
    mesh.points.columns = mesh.points.rows = 0;
}

DrawnSea::DrawnSea(const PreparedScene& prepared, bool has_levels)
    : grid_(projected_grid_options(prepared)),
      has_grid_(shows_open_sea(prepared.scene.surface)),
      has_body_(prepared.scene.water.body) {
    grid_.has_levels = has_levels;
    const Scene& scene = prepared.scene;
    if (scene.surface.kind == SurfaceKind::Cage) {
        cage_ = make_surface(scene, prepared.extent);
        const auto coarse = coarse_surface(scene, prepared.extent);
        coarse->points_at(scene.shot.first_frame, coarse_);
        Faces faces;
        coarse->faces_at(scene.shot.first_frame, faces);
        add_triangles(faces, 0, coarse_triangles_);
        made_of_ =
            (has_grid_ ? "cage in the sea " : "cage ") + canonical(portable(scene), key_parts(KeyPart::Cage));
    } else if (!has_grid_) {
        has_grid_ = true;
        half_side_m_ = 0.5 * scene.surface.size_m;
        made_of_ = "patch " + number_text(scene.surface.size_m);
    }
}

double DrawnSea::rest_m() const {
    if (has_grid_ || coarse_.height_m.empty()) return 0.0;
    return std::accumulate(coarse_.height_m.begin(), coarse_.height_m.end(), 0.0) /
           static_cast<double>(coarse_.height_m.size());
}

double DrawnSea::rest_m(glm::dvec2 place_m) const {
    if (!cage_) return 0.0;
    const glm::dvec2 place = place_m - coarse_.origin_m;
    std::optional<double> highest_m;
    for (std::size_t t = 0; t + 2 < coarse_triangles_.size(); t += 3) {
        std::array<glm::dvec2, 3> corner;
        for (std::size_t i = 0; i < 3; ++i)
            corner[i] = glm::dvec2(coarse_.rest_m[coarse_triangles_[t + i]]) - place;
        std::array<double, 3> weight{};  // twice the area across from each corner
        for (std::size_t i = 0; i < 3; ++i) {
            const glm::dvec2 a = corner[(i + 1) % 3], b = corner[(i + 2) % 3];
            weight[i] = a.x * b.y - a.y * b.x;
        }
        const double area = weight[0] + weight[1] + weight[2];
        if (area == 0.0 || std::ranges::any_of(weight, [&](double part) { return part / area < 0.0; }))
            continue;
        double height_m = 0.0;
        for (std::size_t i = 0; i < 3; ++i)
            height_m += weight[i] / area * static_cast<double>(coarse_.height_m[coarse_triangles_[t + i]]);
        highest_m = std::max(highest_m.value_or(height_m), height_m);
    }
    return highest_m.value_or(rest_m());
}

DrawnSea::Needs DrawnSea::needs(std::span<const SeaView> seen) const {
    Needs needs{.finest_cell_m = std::numeric_limits<double>::infinity(),
                .finest_pixel_m = std::numeric_limits<double>::infinity()};
    if (has_grid_) {
        std::vector<View> views;
        for (const SeaView& each : seen) views.push_back(each.view);
        const ProjectedGridNeeds grid = projected_grid_needs(views, grid_);
        needs = {grid.finest_cell_m, grid.finest_pixel_m, points_of(grid.size)};
    }
    if (!cage_) return needs;
    std::vector<int> frames;
    for (const SeaView& each : seen)
        if (frames.empty() || frames.back() != each.frame) frames.push_back(each.frame);
    const SurfaceNeeds cage = cage_->needs(frames);
    needs.finest_cell_m = std::min(needs.finest_cell_m, cage.finest_cell_m);
    needs.finest_pixel_m = std::min(needs.finest_pixel_m, finest_cage_pixel_m(seen));
    needs.points += cage.points;
    return needs;
}

// A pixel where the cage comes nearest to an eye. Over the middle of a face that is h away points are farther by half the
// square of the face's side.
double DrawnSea::finest_cage_pixel_m(std::span<const SeaView> seen) const {
    double finest_m = std::numeric_limits<double>::infinity();
    const View* before = nullptr;
    for (const SeaView& each : seen) {
        const View& view = each.view;
        if (before && *before == view) continue;
        before = &view;
        const glm::dvec2 eye = glm::dvec2(view.position_m) - coarse_.origin_m;
        const double nearest2 = tbb::parallel_reduce(
            tbb::blocked_range<std::size_t>(0, coarse_.rest_m.size(), 4096),
            std::numeric_limits<double>::infinity(),
            [&](const tbb::blocked_range<std::size_t>& range, double least) {
                for (std::size_t i = range.begin(); i < range.end(); ++i) {
                    const glm::dvec3 way(coarse_.rest_m[i] - eye, coarse_.height_m[i] - view.position_m.z);
                    const double cell_m = coarse_.cell_m[i];
                    least = std::min(least, std::max(glm::dot(way, way) - 0.5 * cell_m * cell_m, 0.0));
                }
                return least;
            },
            [](double a, double b) { return std::min(a, b); });
        View above = view;
        above.position_m.z = std::sqrt(nearest2);
        finest_m = std::min(finest_m, pixel_at_rest(above, grid_, glm::dvec2(0.0)).width);
    }
    return finest_m;
}

void DrawnSea::lay_out(const SeaView& seen, SeaMesh& mesh, std::optional<double> cell_px) const {
    mesh.height_m.clear();
    mesh.normal.clear();
    if (has_grid_) {
        const ProjectedGridSize before{mesh.points.columns, mesh.points.rows};
        ProjectedGridOptions options = grid_;
        options.cell_px = cell_px.value_or(grid_.cell_px);
        mesh.points = projected_grid(seen.view, options);
        const ProjectedGridSize size{mesh.points.columns, mesh.points.rows};
        if (cage_ || size != before) mesh.triangles = projected_grid_triangles(size);
    } else {
        mesh.points = {.origin_m = glm::dvec2(seen.view.position_m),
                       .curvature_per_m = grid_.curvature_per_m};
        mesh.triangles.clear();
    }
    if (half_side_m_) cut_to_square(*half_side_m_, mesh);
    if (cage_) add_cage(seen, mesh);
}

void DrawnSea::add_cage(const SeaView& seen, SeaMesh& mesh) const {
    ProjectedGrid& to = mesh.points;
    const std::size_t first = to.rest_m.size();
    mesh.height_m.assign(first, 0.0f);
    mesh.normal.assign(first, glm::vec3(0.0f, 0.0f, 1.0f));
    RestPoints<double> cage;
    cage_->points_at(seen.frame, cage);
    const std::size_t count = first + cage.rest_m.size();
    mesh.height_m.insert(mesh.height_m.end(), cage.height_m.begin(), cage.height_m.end());
    for (const glm::dvec3& normal : cage.normal) mesh.normal.emplace_back(normal);
    for (auto* numbers : {&to.cell_m, &to.pixel_m}) numbers->resize(count);
    for (auto* places : {&to.rest_m, &to.cell_axis_m, &to.pixel_axis_m}) places->resize(count);
    const double least_m = grid_.has_levels ? first_level_m(finest_cage_pixel_m(std::span(&seen, 1))) : 0.0;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, cage.rest_m.size(), 1024),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                          for (std::size_t i = range.begin(); i < range.end(); ++i) {
                              const glm::dvec2 rest_m = cage.origin_m + cage.rest_m[i] - to.origin_m;
                              View above = seen.view;
                              above.position_m.z -= cage.height_m[i];
                              const PixelFootprint<double> pixel = pixel_at_rest(above, grid_, rest_m);
                              to.rest_m[first + i] = glm::vec2(rest_m);
                              to.cell_m[first + i] = static_cast<float>(std::max(cage.cell_m[i], least_m));
                              to.pixel_m[first + i] = static_cast<float>(std::max(pixel.width, least_m));
                              to.pixel_axis_m[first + i] = glm::vec2(pixel.axis_x, pixel.axis_y);
                          }
                      });
    if (first == 0) mesh.triangles.clear();
    Faces faces;
    cage_->faces_at(seen.frame, faces);
    add_triangles(faces, static_cast<std::uint32_t>(first), mesh.triangles);
}

bool DrawnSea::is_below(const View& view) const {
    return has_below() && glass_heights(view).highest_m < -grid_.bounds.height_m;
}

bool DrawnSea::may_be_under_waves(const View& view) const {
    const glm::dvec2 place_m(view.position_m);
    const bool has_sea =
        half_side_m_ ? std::max(std::abs(place_m.x), std::abs(place_m.y)) <= *half_side_m_ : has_grid_;
    return has_sea && is_among_waves(view, grid_);
}

std::optional<double> DrawnSea::cage_above(const View& view) const {
    const glm::dvec2 eye(glm::dvec2(view.position_m) - coarse_.origin_m);
    const auto cross = [](glm::dvec2 a, glm::dvec2 b) { return a.x * b.y - a.y * b.x; };
    std::optional<double> lowest_m;
    bool is_met_from_below = false;
    for (std::size_t t = 0; t + 2 < coarse_triangles_.size(); t += 3) {
        std::array<glm::dvec2, 3> from{};
        for (int i = 0; i < 3; ++i) from[i] = coarse_.rest_m[coarse_triangles_[t + i]] - eye;
        const glm::dvec3 parts(cross(from[1], from[2]), cross(from[2], from[0]), cross(from[0], from[1]));
        const double twice_area = parts.x + parts.y + parts.z;
        if (twice_area == 0.0 || glm::any(glm::lessThan(parts * twice_area, glm::dvec3(0.0)))) continue;
        double height_m = 0.0;
        for (int i = 0; i < 3; ++i)
            height_m += parts[i] / twice_area * coarse_.height_m[coarse_triangles_[t + i]];
        if (!(height_m > view.position_m.z) || (lowest_m && *lowest_m <= height_m)) continue;
        lowest_m = height_m;
        is_met_from_below = twice_area > 0.0;
    }
    return is_met_from_below ? lowest_m : std::nullopt;
}

template <class T>
void DrawnSea::refuse_under_water(const Frame<T>& state, const Scene& scene, double frame) const {
    const View view = view_at(scene.camera, frame);
    if (const auto surface_m = cage_above(view)) throw_under_water(scene, frame, *surface_m);
    if (may_be_under_waves(view)) pelagic::refuse_under_water(state, scene, frame, grid_);
}
template void DrawnSea::refuse_under_water(const Frame<float>&, const Scene&, double) const;
template void DrawnSea::refuse_under_water(const Frame<double>&, const Scene&, double) const;

std::size_t DrawnSea::surface_bytes(std::size_t points) const {
    if (!cage_) return 0;
    const SurfaceBytes bytes = cage_->bytes(points, sizeof(double));
    // And what the mesh has of each point beside those of a grid.
    return bytes.held + bytes.making + points * (2 * sizeof(double) + sizeof(float) + sizeof(glm::vec3)) +
           coarse_.rest_m.size() * 11 * sizeof(double);
}

}  // namespace pelagic
