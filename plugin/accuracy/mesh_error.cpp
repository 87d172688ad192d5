#include "plugin/accuracy/mesh_error.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <random>

#include "core/evaluate/evaluate.h"
#include "plugin/accuracy/sea_answers.h"

namespace pelagic {
namespace {

constexpr double kSamples_per_px = 0.2;

}  // namespace

SeenSurface seen_surface(const Scene& scene, const View& view) {
    SeenSurface seen{.prepared = prepare(scene), .sea = nullptr, .view = view};
    const Query query = view_query(*seen.prepared, {.products = products(Product::Position, Product::Normal),
                                                    .finest_cell_m = SeenSurface::kFinest_m,
                                                    .finest_pixel_m = SeenSurface::kFinest_m});
    seen.sea =
        std::make_unique<Frame<float>>(std::make_shared<const Sea<float>>(make_plan(seen.prepared, {query})));
    return seen;
}

std::vector<glm::vec3> positions_of(const SeenSurface& seen, const RestPoints<float>& at) {
    std::vector<glm::vec3> position_m(at.rest_m.size());
    Points<float> points{.origin_m = at.origin_m, .count = at.rest_m.size(), .rest_m = {at.rest_m.data()}};
    if (!at.cell_m.empty()) points.cell_m = {at.cell_m.data()};
    if (!at.cell_axis_m.empty()) points.cell_axis_m = {at.cell_axis_m.data()};
    Results<float> results;
    results.set(Product::Position, {position_m.data()});
    evaluate(*seen.sea, 0, points, results);
    return position_m;
}

MeshPicture::MeshPicture(const SeenSurface& seen, const RestPoints<float>& at)
    : view_(seen.view),
      pixel_(view_.pixel_tangent()),
      curvature_per_m_(at.curvature_per_m),
      from_m_(at.origin_m - at.touches_at_m, 0.0),
      eye_m_(view_.position_m - glm::dvec3(at.touches_at_m, 0.0)) {}

glm::dvec3 MeshPicture::place(glm::vec3 position_m) const {
    return on_earth(from_m_ + glm::dvec3(position_m), curvature_per_m_);
}

glm::dvec3 MeshPicture::on_screen(glm::dvec3 place_m) const {
    const glm::dvec3 to = place_m - eye_m_;
    const double depth_m = glm::dot(to, view_.forward);
    return glm::dvec3(glm::dot(to, view_.right), glm::dot(to, view_.up), depth_m) /
           (std::max(depth_m, 1e-9) * pixel_);
}

bool MeshPicture::holds(glm::dvec3 at_px) const {
    return at_px.z > 0.0 && std::abs(at_px.x) <= 0.5 * view_.resolution.x &&
           std::abs(at_px.y) <= 0.5 * view_.resolution.y;
}

double MeshPicture::pixel_m(glm::dvec3 place_m) const {
    return pixel_ * glm::length(place_m - eye_m_);
}

double error_px(const SeenSurface& seen, const RestPoints<float>& at, const MeshPicture& picture,
                const FaceSamples& samples, double share) {
    std::vector<glm::vec3> exact_m(samples.rest_m.size()), normal(samples.rest_m.size());
    Results<float> results;
    results.set(Product::Position, {exact_m.data()});
    results.set(Product::Normal, {normal.data()});
    evaluate(*seen.sea, 0,
             {.origin_m = at.origin_m, .count = samples.rest_m.size(), .rest_m = {samples.rest_m.data()}},
             results);
    std::vector<double> errors;
    for (std::size_t i = 0; i < exact_m.size(); ++i) {
        const glm::dvec3 exact = picture.place(exact_m[i]);
        errors.push_back(std::abs(glm::dot(samples.face_m[i] - exact, glm::dvec3(normal[i]))) /
                         picture.pixel_m(exact));
    }
    return percentile(errors, share);
}

FaceSamples samples_of(const SeenSurface& seen, const RestPoints<float>& at, const Faces& faces,
                       const MeshPicture& picture) {
    const std::vector<glm::vec3> position_m = positions_of(seen, at);
    std::vector<glm::dvec3> place_m(position_m.size());
    std::transform(position_m.begin(), position_m.end(), place_m.begin(),
                   [&](glm::vec3 position) { return picture.place(position); });
    std::mt19937 random(3);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    FaceSamples samples;
    const auto add = [&](std::int32_t a, std::int32_t b, std::int32_t c) {
        const glm::dvec3 sa = picture.on_screen(place_m[a]), sb = picture.on_screen(place_m[b]),
                         sc = picture.on_screen(place_m[c]);
        if (!(std::min({sa.z, sb.z, sc.z}) > 0.0)) return;
        const double area_px2 = 0.5 * ((sb.x - sa.x) * (sc.y - sa.y) - (sb.y - sa.y) * (sc.x - sa.x));
        if (!(area_px2 > 0.0)) return;
        const glm::dvec3 low = glm::min(sa, glm::min(sb, sc)), high = glm::max(sa, glm::max(sb, sc));
        const glm::dvec2 half = 0.5 * glm::dvec2(seen.view.resolution);
        if (low.x > half.x || high.x < -half.x || low.y > half.y || high.y < -half.y) return;
        // A face that reaches far beyond the picture has no more samples than the picture.
        const double most = kSamples_per_px * seen.view.resolution.x * seen.view.resolution.y;
        const double count = std::min(kSamples_per_px * area_px2, most) + uniform(random);
        for (int i = 1; i <= static_cast<int>(count); ++i) {
            double u = uniform(random), v = uniform(random);
            if (u + v > 1.0) u = 1.0 - u, v = 1.0 - v;
            const glm::dvec3 face =
                place_m[a] + u * (place_m[b] - place_m[a]) + v * (place_m[c] - place_m[a]);
            if (!picture.holds(picture.on_screen(face))) continue;
            const auto p = static_cast<float>(u), q = static_cast<float>(v);
            samples.rest_m.push_back(at.rest_m[a] + p * (at.rest_m[b] - at.rest_m[a]) +
                                     q * (at.rest_m[c] - at.rest_m[a]));
            samples.face_m.push_back(face);
        }
    };
    const std::int32_t* corner = faces.indices.data();
    for (const std::int32_t count : faces.counts) {
        for (std::int32_t i = 2; i < count; ++i) add(corner[0], corner[i - 1], corner[i]);
        corner += count;
    }
    return samples;
}

}  // namespace pelagic
