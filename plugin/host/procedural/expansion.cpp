#include "plugin/host/procedural/expansion.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <numeric>
#include <utility>
#include <vector>

#include "core/surface/earth.h"

namespace pelagic::procedural {
namespace {

constexpr double kCoarsestCell_px = 8.0;  // as those of our own pictures

Expansion expansion_with(const ShotFrame& frame, const View& view, const ExpansionChoice& choice,
                         double cell_px) {
    Expansion expansion{.view = view, .options = grid_options(frame, cell_px), .triangles = choice.triangles};
    expansion.options.curvature_per_m = choice.on_earth ? kEarthCurvature_per_m : 0.0;
    expansion.options.size = projected_grid_needs(view, expansion.options).size;
    return expansion;
}

// Corners of some cells' triangles, with a point in each.
struct Samples {
    std::vector<glm::vec2> rest_m, cell_axis_m;  // three of each, and the points in them
    std::vector<float> cell_m;
    std::vector<glm::vec2> inside_m;
    std::vector<glm::vec3> weight;
};

Samples samples_of(const ProjectedGrid& grid, std::size_t count) {
    Samples samples;
    const auto columns = static_cast<std::size_t>(grid.columns), rows = static_cast<std::size_t>(grid.rows);
    const auto fraction = [](double x) { return x - std::floor(x); };
    for (std::size_t i = 0; i < count; ++i) {
        // Evenly spread over the cells and the triangles in them (Roberts 2018).
        const double n = static_cast<double>(i);
        const auto column = std::min(
            static_cast<std::size_t>(fraction(0.7548776662 * n) * static_cast<double>(columns)), columns - 1);
        const auto row = std::min(
            static_cast<std::size_t>(fraction(0.5698402910 * n) * static_cast<double>(rows)), rows - 1);
        const std::size_t a = row * (columns + 1) + column, c = a + columns + 2;
        const std::size_t b = i % 2 == 0 ? a + 1 : c, d = i % 2 == 0 ? c : c - 1;
        double u = fraction(0.6180339887 * n), v = fraction(0.4142135624 * n);
        if (u + v > 1.0) u = 1.0 - u, v = 1.0 - v;
        samples.weight.emplace_back(1.0 - u - v, u, v);
        glm::vec2 inside_m(0.0f);
        for (const auto& [corner, weight] : {std::pair(a, 1.0 - u - v), std::pair(b, u), std::pair(d, v)}) {
            samples.rest_m.push_back(grid.rest_m[corner]);
            samples.cell_m.push_back(grid.cell_m[corner]);
            samples.cell_axis_m.push_back(grid.cell_axis_m[corner]);
            inside_m += static_cast<float>(weight) * grid.rest_m[corner];
        }
        samples.inside_m.push_back(inside_m);
    }
    return samples;
}

}  // namespace

Points<float> points_of(const ProjectedGrid& grid) {
    return {.origin_m = grid.origin_m,
            .count = grid.rest_m.size(),
            .rest_m = {grid.rest_m.data()},
            .cell_m = {grid.cell_m.data()},
            .pixel_m = {grid.pixel_m.data()},
            .cell_axis_m = {grid.cell_axis_m.data()},
            .pixel_axis_m = {grid.pixel_axis_m.data()}};
}

double mesh_error_px(const ShotFrame& frame, const Expansion& expansion) {
    constexpr std::size_t kSamples = 32768;
    const ProjectedGrid grid = projected_grid(expansion.view, expansion.options, &frame.shot().is_cancelled);
    const Samples samples = samples_of(grid, kSamples);
    std::vector<glm::vec3> corner_m(samples.rest_m.size()), exact_m(kSamples), normal(kSamples);
    Results<float> corners, exact;
    corners.set(Product::Position, {corner_m.data()});
    frame.evaluate_by_all({.origin_m = grid.origin_m,
                           .count = samples.rest_m.size(),
                           .rest_m = {samples.rest_m.data()},
                           .cell_m = {samples.cell_m.data()},
                           .cell_axis_m = {samples.cell_axis_m.data()}},
                          corners);
    exact.set(Product::Position, {exact_m.data()});
    exact.set(Product::Normal, {normal.data()});
    frame.evaluate_by_all({.origin_m = grid.origin_m, .count = kSamples, .rest_m = {samples.inside_m.data()}},
                          exact);

    const View& view = expansion.view;
    const double pixel = 2.0 * view.tan_half_width / view.resolution.x;
    const glm::dvec3 eye_m(0.0, 0.0, view.position_m.z);
    const auto on_screen = [&](glm::vec3 at_m) {
        const glm::dvec3 to_m = on_earth(glm::dvec3(at_m), grid.curvature_per_m) - eye_m;
        const double depth_m = glm::dot(to_m, view.forward);
        return glm::dvec3(glm::dot(to_m, view.right), glm::dot(to_m, view.up), depth_m) /
               (std::max(depth_m, 1e-9) * pixel);
    };
    struct Seen {
        double error_px, area_px2;
    };
    std::vector<Seen> seen;
    for (std::size_t i = 0; i < kSamples; ++i) {
        const glm::vec3 *at_m = &corner_m[3 * i], &weight = samples.weight[i];
        const glm::vec3 on_face_m = weight.x * at_m[0] + weight.y * at_m[1] + weight.z * at_m[2];
        const glm::dvec3 a = on_screen(at_m[0]), b = on_screen(at_m[1]), c = on_screen(at_m[2]),
                         p = on_screen(on_face_m);
        // Faces seen from behind or beside the picture don't count.
        const double area_px2 = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
        if (!(area_px2 > 0.0) || !(std::min({a.z, b.z, c.z}) > 0.0) ||
            std::abs(p.x) > 0.5 * view.resolution.x || std::abs(p.y) > 0.5 * view.resolution.y)
            continue;
        const double width_m = pixel * glm::length(glm::dvec3(on_face_m) - eye_m);
        const double off_m = std::abs(glm::dot(glm::dvec3(on_face_m - exact_m[i]), glm::dvec3(normal[i])));
        seen.push_back({off_m / width_m, area_px2});
    }
    std::sort(seen.begin(), seen.end(), [](const Seen& x, const Seen& y) { return x.error_px < y.error_px; });
    double left_px2 = 0.95 * std::accumulate(seen.begin(), seen.end(), 0.0, [](double sum, const Seen& each) {
                          return sum + each.area_px2;
                      });
    for (const Seen& each : seen)
        if ((left_px2 -= each.area_px2) <= 0.0) return each.error_px;
    return 0.0;
}

namespace {

// The largest cells, to a tenth, that keep the error.
double cell_within(const ShotFrame& frame, const View& view, const ExpansionChoice& choice) {
    const auto is_near = [&](double cell_px) {
        return mesh_error_px(frame, expansion_with(frame, view, choice, cell_px)) <= choice.error_px;
    };
    // Errors fall with the cells, but not evenly.
    double near_px = kCoarsestCell_px, far_px = kCoarsestCell_px;
    while (near_px > kFinestCell_px && !is_near(near_px)) {
        far_px = near_px;
        near_px = std::max(0.5 * near_px, kFinestCell_px);
    }
    constexpr double kNearEnough = 1.1;
    while (far_px > kNearEnough * near_px) {
        const double between_px = std::sqrt(near_px * far_px);
        (is_near(between_px) ? near_px : far_px) = between_px;
    }
    return near_px;
}

}  // namespace

Expansion expansion_of(const ShotFrame& frame, const View& view, const ExpansionChoice& choice) {
    if (choice.error_px == 0.0) return expansion_with(frame, view, choice, choice.cell_px);
    const auto found = frame.remembered_cell_px(view, choice.error_px, choice.on_earth);
    const double cell_px = found ? *found : cell_within(frame, view, choice);
    if (!found) frame.remember_cell_px(view, choice.error_px, choice.on_earth, cell_px);
    return expansion_with(frame, view, choice, cell_px);
}

}  // namespace pelagic::procedural
