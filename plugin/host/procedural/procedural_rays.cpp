// The C interface's rays.
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <stdexcept>
#include <vector>

#include "core/surface/earth.h"
#include "plugin/host/procedural/c_interface.h"
#include "plugin/host/procedural/rays.h"

namespace pelagic::procedural {
namespace {

// No ray is followed farther, and none begins farther away: a tenth of a millimetre is lost there.
constexpr double kFarthest_m = 1e12, kFarthestOffset_m = 1e10;

// So many rays go between two looks at whether the sea is cancelled: some milliseconds.
constexpr std::size_t kAskedEach = 256;

// The rays of a call, one by one.
class Batch {
  public:
    Batch(const pelagic_rays& rays, const ShotFrame& frame) : rays_(rays), half_open_s_(frame.half_open_s()) {
        for (const double metres : rays.origin_m) check_place(metres, "rays.origin_m");
        if (rays.tolerance != 0.0 && !(rays.tolerance >= 0.05 && rays.tolerance <= 4.0))
            throw std::invalid_argument(
                "rays.tolerance is outside the range; accepted: 0.05 to 4 footprints, or 0");
        const bool on_earth = flag(rays.on_earth, "rays.on_earth");
        if (rays.count == 0) return;
        required(rays.direction, "rays.direction");
        check_count(rays.count, "rays.count");
        frame.check_times(rays.time_s, rays.count, "rays.time_s");
        sea_ = {.tiles = &frame.tiles(),
                .everywhere = frame.everywhere(),
                .finest_footprint_m = frame.shot().finest_cell_m,
                .origin_m = {rays.origin_m[0], rays.origin_m[1]},
                .curvature_per_m = on_earth ? kEarthCurvature_per_m : 0.0,
                .tolerance = rays.tolerance == 0.0 ? 0.5 : rays.tolerance};
    }

    const RaySea& sea() const { return sea_; }

    // False for a ray that hits nothing, whatever the sea is like. `length_m`: of its direction.
    bool ray(std::size_t i, SeaRay& ray, double& length_m) const {
        const auto vector = [&](const float* values) {
            return values ? glm::dvec3(values[3 * i], values[3 * i + 1], values[3 * i + 2]) : glm::dvec3(0.0);
        };
        const auto number = [&](const float* values, double otherwise) {
            return values ? static_cast<double>(values[i]) : otherwise;
        };
        const glm::dvec3 from_m = vector(rays_.offset_m), direction = vector(rays_.direction);
        length_m = glm::length(direction);
        if (!(glm::length(from_m) <= kFarthestOffset_m) || !std::isfinite(length_m) || !(length_m > 0.0))
            return false;
        ray.from_m = from_m + glm::dvec3(0.0, 0.0, rays_.origin_m[2]);
        ray.direction = direction / length_m;
        ray.near_m = std::max(number(rays_.near, 0.0), 0.0) * length_m;
        ray.far_m =
            std::min(number(rays_.far, std::numeric_limits<double>::infinity()) * length_m, kFarthest_m);
        ray.time_s =  // without what a host's arithmetic rounds
            std::clamp(number(rays_.time_s, half_open_s_) - half_open_s_, -half_open_s_, half_open_s_);
        ray.footprint_m = std::max(number(rays_.footprint_m, 0.0), 0.0);
        ray.spread = std::max(number(rays_.spread, 0.0), 0.0);
        return ray.near_m <= ray.far_m && std::isfinite(ray.footprint_m + ray.spread);
    }

  private:
    const pelagic_rays& rays_;
    double half_open_s_;
    RaySea sea_;
};

// Hits whose values are asked for together.
struct Waiting {
    std::vector<std::size_t> ray;
    std::vector<glm::vec2> rest_m;
    std::vector<float> footprint_m;
    std::vector<glm::dvec3> position_m;
    void clear() {
        ray.clear();
        rest_m.clear();
        footprint_m.clear();
        position_m.clear();
    }
};

constexpr std::array<NumberProduct, 3> kNumbers{Product::Coverage, Product::Breaking, Product::FoamAge};

// The values at the hits, each at its place in the middle of the shutter, written where its ray's belong.
void give_values(const ShotFrame& frame, const RaySea& sea, const Waiting& hits, const Wanted& wanted) {
    const std::size_t count = hits.ray.size();
    if (count == 0) return;
    const Results<float>& to = wanted.results;
    std::array<std::vector<glm::vec3>, 3> vectors;
    std::array<std::vector<float>, 3> numbers;
    constexpr std::array<VectorProduct, 3> kVectors{Product::Normal, Product::Velocity,
                                                    Product::SlopeVariance};
    Results<float> results;
    for (std::size_t v = 0; v < kVectors.size(); ++v) {
        if (!to.holds(kVectors[v])) continue;
        vectors[v].resize(count);
        results.set(kVectors[v], {vectors[v].data()});
    }
    for (std::size_t n = 0; n < kNumbers.size(); ++n) {
        if (!to.holds(kNumbers[n])) continue;
        numbers[n].resize(count);
        results.set(kNumbers[n], {numbers[n].data()});
    }
    if (results.given().any())
        frame.evaluate({.points = {.origin_m = sea.origin_m,
                                   .count = count,
                                   .rest_m = {hits.rest_m.data()},
                                   .cell_m = {hits.footprint_m.data()},
                                   .pixel_m = {hits.footprint_m.data()}}},
                       results, wanted.coverage);
    for (std::size_t h = 0; h < count; ++h) {
        const std::size_t i = hits.ray[h];
        const glm::dvec3 up = earth_up(glm::dvec2(hits.rest_m[h]), sea.curvature_per_m);
        for (std::size_t v = 0; v < kVectors.size(); ++v) {
            const auto at = to.vectors(kVectors[v]);
            if (!at) continue;
            const bool turns = sea.curvature_per_m != 0.0 && v < 2;
            at[i] = turns ? glm::vec3(from_level(glm::dvec3(vectors[v][h]), up)) : vectors[v][h];
        }
        for (std::size_t n = 0; n < kNumbers.size(); ++n)
            if (const auto at = to.numbers(kNumbers[n])) at[i] = numbers[n][h];
        if (const auto at = to.vectors(Product::Position)) at[i] = glm::vec3(hits.position_m[h]);
    }
}

void give_zeros(const Results<float>& to, std::size_t i) {
    for (const VectorProduct product :
         {VectorProduct(Product::Position), VectorProduct(Product::Normal), VectorProduct(Product::Velocity),
          VectorProduct(Product::SlopeVariance)})
        if (const auto at = to.vectors(product)) at[i] = glm::vec3(0.0f);
    for (const NumberProduct product : kNumbers)
        if (const auto at = to.numbers(product)) at[i] = 0.0f;
}

void intersect(const ShotFrame& frame, const pelagic_rays& rays, const pelagic_hits& hits,
               const Wanted& wanted) {
    const Results<float>& values = wanted.results;
    // New places go through the foam's past together: once for a call.
    const bool goes_back =
        wanted.coverage == CoverageOf::AllFoam && (values.given() & lasting_products()).any();
    const std::size_t together = goes_back ? rays.count : 256;
    constexpr double kMost = std::numeric_limits<float>::max();
    const Batch batch(rays, frame);
    RayTracer tracer(batch.sea());
    Waiting waiting;
    const bool wants_values = values.given().any();
    for (std::size_t i = 0; i < rays.count; ++i) {
        if (i % kAskedEach == 0) stop_if(&frame.shot().is_cancelled);
        SeaRay ray;
        SeaHit hit;
        double length_m = 0.0;
        const bool is_hit = batch.ray(i, ray, length_m) && tracer.trace(ray, false, hit);
        if (hits.distance)
            hits.distance[i] = is_hit ? static_cast<float>(std::min(hit.distance_m / length_m, kMost))
                                      : std::numeric_limits<float>::infinity();
        if (hits.footprint_m) hits.footprint_m[i] = static_cast<float>(hit.footprint_m);
        if (hits.rest_m) {
            hits.rest_m[2 * i] = static_cast<float>(hit.rest_m.x);
            hits.rest_m[2 * i + 1] = static_cast<float>(hit.rest_m.y);
        }
        if (!wants_values) continue;
        if (!is_hit) {
            give_zeros(values, i);
            continue;
        }
        waiting.ray.push_back(i);
        waiting.rest_m.emplace_back(hit.rest_m);
        waiting.footprint_m.push_back(static_cast<float>(hit.footprint_m));
        waiting.position_m.push_back(ray.from_m + hit.distance_m * ray.direction);
        if (waiting.ray.size() < together) continue;
        give_values(frame, batch.sea(), waiting, wanted);
        waiting.clear();
    }
    give_values(frame, batch.sea(), waiting, wanted);
}

}  // namespace
}  // namespace pelagic::procedural

using namespace pelagic;
using namespace pelagic::procedural;

pelagic_status pelagic_intersect(const pelagic_frame* frame, const pelagic_rays* rays,
                                 const pelagic_hits* hits, pelagic_error* error) {
    return guarded(error, [&] {
        const auto asked = taken(rays, "rays");
        const auto into = taken(hits, "hits");
        const Wanted wanted = into.values ? wanted_in(taken(into.values, "hits.values")) : Wanted{};
        intersect(frame_of(frame), asked, into, wanted);
        return PELAGIC_OK;
    });
}

pelagic_status pelagic_occluded(const pelagic_frame* frame, const pelagic_rays* rays, unsigned char* occluded,
                                pelagic_error* error) {
    return guarded(error, [&] {
        const auto asked = taken(rays, "rays");
        const Batch batch(asked, frame_of(frame));
        if (asked.count > 0) required(occluded, "occluded");
        RayTracer tracer(batch.sea());
        for (std::size_t i = 0; i < asked.count; ++i) {
            if (i % kAskedEach == 0) stop_if(&frame_of(frame).shot().is_cancelled);
            SeaRay ray;
            SeaHit hit;
            double length_m = 0.0;
            occluded[i] = batch.ray(i, ray, length_m) && tracer.trace(ray, true, hit) ? 1 : 0;
        }
        return PELAGIC_OK;
    });
}
