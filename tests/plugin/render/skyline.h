// The skyline of a sea, for each column of a picture: as dense rings of the query show it, and as a picture does.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <memory>
#include <vector>

#include "core/base/constants.h"
#include "core/evaluate/evaluate.h"
#include "core/plan/plan.h"
#include "core/surface/earth.h"
#include "core/surface/view.h"
#include "core/waves/frame.h"
#include "plugin/render/render.h"

namespace pelagic {

// The topmost place [px from the picture's top] where the middle of each column meets the surface that the query
// describes. The camera looks along the horizon, without roll.
//
// Points at rest lie in rings round the camera's nadir, one a column in azimuth and two pixels' width apart, and are
// filtered by half a pixel: that hides some thousandths of a pixel. Nearer than 10 m, where no skyline is, by as much as
// there. The rings end where no crest that the sea can be
// expected to have rises a twentieth of a pixel above the horizon, which is the skyline where nothing hides it.
inline std::vector<double> skyline_of_query(const Scene& scene, int frame) {
    const View view = view_at(scene.camera, frame);
    const auto prepared = prepare(scene);
    const double pixel = view.pixel_tangent(), nearest_m = 2.0, finest_m = 0.5 * pixel * 10.0;
    const Query query = view_query(
        *prepared,
        {.products = products(Product::Position), .finest_cell_m = finest_m, .finest_pixel_m = finest_m});
    Frame<float> state(std::make_shared<const Sea<float>>(make_plan(prepared, {query})));
    state.set(scene.shot.time_s(frame));

    const int width = view.resolution.x;
    const glm::dvec2 ahead = glm::normalize(glm::dvec2(view.forward)), right(ahead.y, -ahead.x);
    const double flat = std::hypot(view.forward.x, view.forward.y);
    // On the earth's sphere, as the picture is, or on a flat sea.
    const double curvature_per_m = projected_grid_options(*prepared).curvature_per_m;
    const double dip = std::acos(1.0 / (1.0 + std::max(view.position_m.z, 0.0) * curvature_per_m));
    const double horizon_px =
        0.5 * view.resolution.y + std::tan(std::atan2(view.forward.z, flat) + dip) / pixel;
    std::vector<double> top_px(static_cast<std::size_t>(width), horizon_px);
    const double above_m = std::max(prepared->extent.height_m - view.position_m.z, 0.0);
    const double farthest_m = std::max(above_m / (0.05 * pixel), 100.0);
    std::vector<glm::vec2> rest;
    std::vector<glm::vec3> position;
    std::vector<float> cell_m;
    for (double r = nearest_m; r < farthest_m; r += std::max(2.0 * pixel * r, 0.02)) {
        // Those that displacement brings into view as well.
        const double aside = std::asin(std::min(prepared->extent.reach_m / r, 1.0));
        const double half = std::min(std::atan(view.tan_half_width) + aside, kPi);
        const auto count = static_cast<std::size_t>(std::ceil(2.0 * half / pixel)) + 1;
        rest.resize(count);
        position.resize(count);
        cell_m.assign(count, static_cast<float>(std::max(0.5 * pixel * r, finest_m)));
        for (std::size_t i = 0; i < count; ++i) {
            const double azimuth =
                half * (2.0 * static_cast<double>(i) / static_cast<double>(count - 1) - 1.0);
            rest[i] = glm::vec2(r * (std::cos(azimuth) * ahead + std::sin(azimuth) * right));
        }
        Results<float> results;
        results.set(Product::Position, {position.data()});
        evaluate(state, 0,
                 Points<float>{.origin_m = glm::dvec2(view.position_m),
                               .count = count,
                               .rest_m = {rest.data()},
                               .cell_m = {cell_m.data()}},
                 results);
        const auto seen = [&](std::size_t i) {
            const glm::dvec3 way =
                on_earth(glm::dvec3(position[i]), curvature_per_m) - glm::dvec3(0.0, 0.0, view.position_m.z);
            const double depth = glm::dot(way, view.forward);
            return depth < 0.1 ? glm::dvec2(NAN)
                               : glm::dvec2(0.5 * width + glm::dot(way, view.right) / depth / pixel,
                                            0.5 * view.resolution.y - glm::dot(way, view.up) / depth / pixel);
        };
        glm::dvec2 last = seen(0);
        for (std::size_t i = 1; i < count; ++i) {
            const glm::dvec2 next = seen(i);
            const double from = std::max(std::ceil(std::min(last.x, next.x) - 0.5), 0.0);
            const double to = std::min(std::floor(std::max(last.x, next.x) - 0.5), width - 1.0);
            for (double x = from; x <= to; ++x) {  // none where one of them is behind the camera
                const double part = next.x == last.x ? 0.0 : (x + 0.5 - last.x) / (next.x - last.x);
                double& top = top_px[static_cast<std::size_t>(x)];
                top = std::min(top, last.y + part * (next.y - last.y));
            }
            last = next;
        }
    }
    return top_px;
}

// The upper edge of each column's first pixel of sea [px]; the picture's height where there is none.
inline std::vector<double> skyline_of(const Picture& picture) {
    const auto width = static_cast<std::size_t>(picture.resolution.x);
    std::vector<double> top_px(width, picture.resolution.y);
    for (std::size_t i = picture.sea.size(); i-- > 0;)
        if (picture.sea[i] != 0) top_px[i % width] = static_cast<double>(i / width);
    return top_px;
}

// The share of columns where the two are within a pixel.
inline double agreement(const std::vector<double>& a, const std::vector<double>& b) {
    double good = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) good += std::abs(a[i] - b[i]) <= 1.0 ? 1.0 : 0.0;
    return good / static_cast<double>(a.size());
}

}  // namespace pelagic
