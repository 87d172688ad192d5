// Spray along rays by small steps through the sea itself: no map. At each of them the surface above the place in the world, and what
// breaks there, are what evaluate() says.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <span>
#include <vector>

#include "core/effects/spray.h"
#include "core/evaluate/places.h"
#include "core/lighting/spray.h"
#include "core/plan/spray.h"
#include "core/surface/earth.h"
#include "core/waves/frame.h"

namespace pelagic::test {

struct SprayRay {
    glm::dvec3 direction{0.0};  // unit, from the eye
    double length_m = 0.0;
    double thickness = 0.0;
};

// Rays in the eye's axes that meet the sea somewhere about their length, with the length at which they meet it and with their
// optical thickness. Those that don't meet it there are left out. The frame's plan is that of pictures with
// spray. cell_m: of the surface's height.
inline std::vector<SprayRay> exact_rays(const Frame<float>& frame, const glm::dvec3& eye_m,
                                        double curvature_per_m, double cell_m, std::span<const SprayRay> rays,
                                        const Spray& map) {
    constexpr double kLonger = 1.3, kSmoothest_m = 2.0;
    const SprayVeil veil(frame);
    const SprayLaw& law = veil.law();
    const double high_m = veil.is_torn() ? 10.0 * law.haze.scale_m : 10.0 * law.over_foam.scale_m;
    struct Step {
        std::size_t ray;
        double at_m, height_m, length_m;
    };
    std::vector<Step> steps;
    std::vector<glm::vec2> places;
    for (std::size_t i = 0; i < rays.size(); ++i)
        for (double s_m = 0.0; s_m < kLonger * rays[i].length_m;) {
            const double length_m = std::max(0.25, 2e-3 * s_m);
            const glm::dvec3 at = (s_m + 0.5 * length_m) * rays[i].direction + glm::dvec3(0.0, 0.0, eye_m.z);
            const glm::dvec3 flat = curvature_per_m > 0.0 ? from_earth(at, curvature_per_m) : at;
            s_m += length_m;
            // Above all crests by many scale heights.
            if (flat.z > 2.0 * frame.sea().extent().height_m + high_m) continue;
            if (flat.z < -2.0 * frame.sea().extent().height_m) break;
            places.emplace_back(glm::dvec2(flat));
            steps.push_back({i, s_m - 0.5 * length_m, flat.z, length_m});
        }
    std::vector<float> cells(places.size(), static_cast<float>(cell_m)),
        spreads(places.size(), static_cast<float>(std::max(cell_m, kSmoothest_m))), coverage(places.size());
    std::vector<glm::vec3> displacement(places.size());
    Points<float> points{.origin_m = glm::dvec2(eye_m),
                         .count = places.size(),
                         .rest_m = {places.data()},
                         .cell_m = {cells.data()},
                         .pixel_m = {spreads.data()}};
    const PreparedQuery<float> query(frame, 0, products(Product::Displacement, Product::Breaking),
                                     points.origin_m);
    Results<float> results;
    results.set(Product::Displacement, {displacement.data()});
    results.set(Product::Breaking, {coverage.data()});
    evaluate_at(query, points, {}, results);
    std::vector<glm::dvec3> shares(places.size());
    std::vector<double> lifts_m(places.size());
    veil.shares<float>(query, points, coverage, displacement, std::vector<double>(places.size(), cell_m),
                       shares, lifts_m);
    std::vector<SprayRay> met;
    for (std::size_t i = 0; i < steps.size();) {
        SprayRay ray{.direction = rays[steps[i].ray].direction};
        const std::size_t of = steps[i].ray;
        double before_m = 0.0, before_z = 0.0;
        for (; i < steps.size() && steps[i].ray == of; ++i) {
            if (ray.length_m > 0.0) continue;
            const double z_m = steps[i].height_m - static_cast<double>(displacement[i].z);
            const double z_over_m = std::max(z_m, 0.0);
            const glm::vec2 place_m(places[i]);
            const double ribbons = law.ribbons.mean(law.ribbons.extinction_per_m * shares[i], z_over_m,
                                                    z_over_m + 1e-3, lifts_m[i]);
            const double density =
                law.over_foam.extinction_per_m * shares[i].x * std::exp(-z_over_m / law.over_foam.scale_m) +
                law.haze.extinction_per_m * std::exp(-z_over_m / law.haze.scale_m) +
                ribbons *
                    static_cast<double>(spray_thread(
                        map, place_m, static_cast<float>(z_over_m - lifts_m[i]), static_cast<float>(ribbons),
                        map.threads.pixel_rad * glm::length(glm::vec3(place_m, map.eye_m))));
            if (z_m > 0.0) {
                ray.thickness += density * steps[i].length_m;
                before_m = steps[i].at_m;
                before_z = z_m;
                continue;
            }
            // The step before counts up to its own end.
            ray.length_m = before_m + (steps[i].at_m - before_m) * before_z / (before_z - z_m);
            ray.thickness += density * (ray.length_m - (steps[i].at_m - 0.5 * steps[i].length_m));
        }
        if (ray.length_m > 0.0) met.push_back(ray);
    }
    return met;
}

}  // namespace pelagic::test
