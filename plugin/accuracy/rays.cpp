// Sweep of how far from the sea a ray's hit may lie.
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <memory>
#include <string>
#include <vector>

#include "core/scene/text.h"
#include "plugin/accuracy/rows.h"
#include "plugin/accuracy/sea_answers.h"
#include "plugin/host/procedural/procedural_frame.h"
#include "plugin/host/procedural/rays.h"

namespace pelagic::rows {
namespace {

using procedural::RaySea;
using procedural::RayTracer;
using procedural::SeaHit;
using procedural::SeaRay;
using procedural::ShotFrame;
using procedural::ShotSea;

constexpr int kMostRows = 90, kMostColumns = 160;
constexpr double kDefaultTolerance = RaySea().tolerance;

// Rays of the shot's pixels, every so many of them, against the sea of its middle frame.
class TracedPicture {
  public:
    explicit TracedPicture(const Scene& shot)
        : frame_(std::make_shared<const ShotSea>(shot, procedural::SeaOptions{}, BuildWatch{}),
                 middle_time_s(shot), middle_time_s(shot)) {
        const View view = view_at(shot.camera, middle_frame(shot));
        origin_m_ = glm::dvec2(view.position_m);
        const glm::ivec2 count = glm::min(view.resolution, glm::ivec2(kMostColumns, kMostRows));
        const glm::dvec2 half = 0.5 * glm::dvec2(view.resolution);
        for (int y = 0; y < count.y; ++y)
            for (int x = 0; x < count.x; ++x) {
                const glm::dvec2 at_px =
                    (glm::dvec2(x, y) + 0.5) / glm::dvec2(count) * glm::dvec2(view.resolution) - half;
                SeaRay ray;
                ray.from_m = {0.0, 0.0, view.position_m.z};
                ray.direction = glm::normalize(view.forward + view.pixel_tangent() *
                                                                  (at_px.x * view.right + at_px.y * view.up));
                ray.far_m = kFarthest_m;
                ray.spread = view.pixel_tangent();
                rays_.push_back(ray);
            }
    }

    std::vector<SeaHit> hits(double tolerance) const {
        std::vector<SeaHit> hits(rays_.size());
        constexpr std::size_t kGrain = 64;
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, rays_.size(), kGrain), [&](const auto& range) {
            RayTracer tracer({.tiles = &frame_.tiles(),
                              .everywhere = frame_.everywhere(),
                              .finest_footprint_m = frame_.shot().finest_cell_m,
                              .origin_m = origin_m_,
                              .tolerance = tolerance});
            for (std::size_t i = range.begin(); i < range.end(); ++i) tracer.trace(rays_[i], false, hits[i]);
        });
        return hits;
    }

    // The distance of each hit from the sea, along the normal where its place at rest lies, in footprints, which are
    // a pixel wide.
    std::vector<double> distances_px(const std::vector<SeaHit>& hits) const {
        std::vector<glm::vec2> rest_m;
        std::vector<std::size_t> ray;
        for (std::size_t i = 0; i < hits.size(); ++i) {
            if (!(hits[i].footprint_m > 0.0)) continue;  // none
            ray.push_back(i);
            rest_m.emplace_back(hits[i].rest_m);
        }
        std::vector<glm::vec3> position_m(ray.size()), normal(ray.size());
        Results<float> results;
        results.set(Product::Position, {position_m.data()});
        results.set(Product::Normal, {normal.data()});
        frame_.evaluate({.points = {.origin_m = origin_m_, .count = ray.size(), .rest_m = {rest_m.data()}}},
                        results);
        std::vector<double> distances;
        for (std::size_t h = 0; h < ray.size(); ++h) {
            const SeaRay& of = rays_[ray[h]];
            const SeaHit& hit = hits[ray[h]];
            const glm::dvec3 off_m = of.from_m + hit.distance_m * of.direction - glm::dvec3(position_m[h]);
            distances.push_back(std::abs(glm::dot(off_m, glm::dvec3(normal[h]))) / hit.footprint_m);
        }
        return distances;
    }

  private:
    static constexpr double kFarthest_m = 1e12;

    ShotFrame frame_;
    glm::dvec2 origin_m_{0.0};
    std::vector<SeaRay> rays_;
};

}  // namespace

Trials ray_tolerance(const Scene& shot) {
    const auto traced = std::make_shared<const TracedPicture>(shot);
    if (traced->distances_px(traced->hits(kDefaultTolerance)).empty())
        return {{}, "has nothing to sweep: no ray of the camera meets the sea"};
    Trials trials;
    for (const double tolerance : {0.05, 0.1, 0.25, kDefaultTolerance, 1.0, 2.0, 4.0}) {
        const auto hits = std::make_shared<std::vector<SeaHit>>();
        trials.trials.push_back(
            {.setting = number_text(tolerance) + " footprints",
             .is_shots = tolerance == kDefaultTolerance,
             .run = [=] { *hits = traced->hits(tolerance); },
             .errors =
                 [=] {
                     std::vector<double> off_px = traced->distances_px(*hits);
                     return std::vector<double>{percentile(off_px, 0.95), percentile(off_px, 0.5)};
                 },
             .bytes = 0});
    }
    return trials;
}

}  // namespace pelagic::rows
