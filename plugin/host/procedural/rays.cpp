#include "plugin/host/procedural/rays.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <utility>

#include "core/surface/earth.h"

namespace pelagic::procedural {
namespace {

// A ray that has gone this far between the heights of the waves meets only the sea at rest from there on: a level ray
// above the crests would look at each wave as far as doubles go.
constexpr double kLongestWay_m = 32768.0;
// Over this many cells two levels count: their surfaces cross each other every one or two cells.
constexpr double kSharedCells = 32.0;

// Narrows near … far to the part of from + s · direction within the box; false if there is none.
bool enters(glm::dvec3 from_m, glm::dvec3 per_direction, glm::dvec3 low_m, glm::dvec3 high_m, double& near_m,
            double& far_m) {
    for (int axis = 0; axis < 3; ++axis) {
        const double a = (low_m[axis] - from_m[axis]) * per_direction[axis];
        const double b = (high_m[axis] - from_m[axis]) * per_direction[axis];
        near_m = std::max(near_m, std::min(a, b));
        far_m = std::min(far_m, std::max(a, b));
    }
    return near_m <= far_m;
}

glm::dvec3 inverse(glm::dvec3 direction) {
    glm::dvec3 per;
    // Finite, so that 0 times it is a number.
    for (int axis = 0; axis < 3; ++axis)
        per[axis] = std::abs(direction[axis]) > 1e-200 ? 1.0 / direction[axis] : 1e200;
    return per;
}

}  // namespace

RayTracer::RayTracer(const RaySea& sea) : sea_(sea) {
    constexpr double kRounding_m = 0.01;  // of places far away; flat water is no thicker
    sea_.everywhere.height_m += kRounding_m;
    sea_.everywhere.reach_m += kRounding_m;
    waiting_.reserve(64);
}

double RayTracer::footprint_m(const SeaRay& ray, double s_m) const {
    constexpr double kWidest_m = 1e30;  // beyond any sea, and a number in single precision
    return std::min(std::max(ray.footprint_m + ray.spread * s_m, sea_.finest_footprint_m), kWidest_m);
}

// The part of a ray within the sphere that lies this much higher than the sea at rest.
RayTracer::Span RayTracer::within_sphere(const SeaRay& ray, double height_m) const {
    const double radius_m = 1.0 / sea_.curvature_per_m;
    const double b = glm::dot(ray.from_m, ray.direction) + radius_m * ray.direction.z;
    const double c =
        glm::dot(ray.from_m, ray.from_m) + 2.0 * radius_m * (ray.from_m.z - height_m) - height_m * height_m;
    const double within = b * b - c;
    if (!(within >= 0.0)) return {0.0, -1.0};
    const double rounding_m = (1.0 + 1e-9 * std::abs(b)) * (height_m < 0.0 ? -1.0 : 1.0);
    return {-b - std::sqrt(within) - rounding_m, -b + std::sqrt(within) + rounding_m};
}

// The part of a ray that is no higher and no lower than the waves go.
RayTracer::Span RayTracer::span_in_waves(const SeaRay& ray) const {
    const double height_m = sea_.everywhere.height_m;
    double near_m = ray.near_m, far_m = ray.far_m;
    if (sea_.curvature_per_m == 0.0) {
        const glm::dvec3 any(std::numeric_limits<double>::max(), std::numeric_limits<double>::max(),
                             height_m);
        enters(ray.from_m, inverse(ray.direction), -any, any, near_m, far_m);
        return {near_m, far_m};
    }
    // Between the spheres through the highest crests and the lowest troughs; what goes into the inner one has met the sea.
    const Span outer = within_sphere(ray, height_m), inner = within_sphere(ray, -height_m);
    near_m = std::max(near_m, outer.near_m);
    far_m = std::min(far_m, outer.far_m);
    if (inner.near_m < inner.far_m && inner.far_m > near_m) {
        const double lowest_m = 0.5 * (inner.near_m + inner.far_m);
        if (near_m < inner.near_m)
            far_m = std::min(far_m, inner.near_m);
        else if (near_m < lowest_m)
            return {0.0, -1.0};  // down to the bottom of the sea
        else
            near_m = inner.far_m;
    }
    return {near_m, far_m};
}

RayTracer::Piece RayTracer::piece_of(const SeaRay& ray, int level, double near_m, double far_m) const {
    Piece piece{.level = level,
                .from_m = ray.from_m,
                .direction = ray.direction,
                .per_direction = {},
                .near_m = near_m,
                .far_m = far_m,
                .time_s = ray.time_s};
    if (sea_.curvature_per_m != 0.0 && far_m > near_m) {
        const glm::dvec3 begin_m = from_earth(ray.from_m + near_m * ray.direction, sea_.curvature_per_m);
        const glm::dvec3 end_m = from_earth(ray.from_m + far_m * ray.direction, sea_.curvature_per_m);
        piece.direction = (end_m - begin_m) / (far_m - near_m);
        piece.from_m = begin_m - near_m * piece.direction;
    }
    piece.from_m += glm::dvec3(sea_.origin_m, 0.0);
    piece.per_direction = inverse(piece.direction);
    return piece;
}

bool RayTracer::trace(const SeaRay& ray, bool any, SeaHit& hit) {
    if (!store_ || sea_.tiles->is_full(*store_)) {
        store_ = sea_.tiles->store();
        roots_.fill({});
    }
    const SurfaceTiles& tiles = *sea_.tiles;
    const auto [begin_m, end_m] = span_in_waves(ray);
    const double last_m = begin_m + kLongestWay_m;
    SeaHit best{.distance_m = std::numeric_limits<double>::infinity()};
    for (double s_m = begin_m; s_m <= end_m && s_m < best.distance_m;) {
        const double tolerance_m = sea_.tolerance * footprint_m(ray, s_m);
        const bool is_flat = s_m >= last_m;
        if (is_flat && s_m == last_m && meets_rest_between(ray, begin_m, last_m, best)) break;
        const int level = is_flat ? tiles.flat_level() : tiles.level_within(tolerance_m);
        double next_m = end_m, shared_m = 0.0;
        if (level < tiles.flat_level()) {
            const double coarser_m =
                (tiles.deviation_m(level + 1) / sea_.tolerance - ray.footprint_m) / ray.spread;
            next_m = std::min(last_m, end_m);
            if (ray.spread > 0.0 && coarser_m < next_m) {
                next_m = std::max(coarser_m, s_m + 1e-3 * tolerance_m);
                shared_m = std::ldexp(kSharedCells, level);
            }
        }
        // A straight piece leaves the bent sea's ray by a tenth of the tolerance at most.
        if (sea_.curvature_per_m > 0.0)
            next_m = std::min(next_m, s_m + std::sqrt(0.8 * tolerance_m / sea_.curvature_per_m));
        next_m =
            std::min(std::max(next_m, s_m * (1.0 + 1e-12)), end_m);  // where tolerances are below doubles
        if (hit_piece(piece_of(ray, level, s_m, std::min(next_m + shared_m, end_m)), any, best) && any) break;
        if (!(next_m > s_m)) break;
        s_m = next_m;
    }
    if (!(best.distance_m <= ray.far_m)) return false;
    best.distance_m = std::max(best.distance_m, ray.near_m);  // a seam's width before it at most
    best.rest_m -= sea_.origin_m;
    best.footprint_m = footprint_m(ray, best.distance_m);
    hit = best;
    return true;
}

// Whether a ray that goes on over the sea at rest has come to its other side between these distances.
bool RayTracer::meets_rest_between(const SeaRay& ray, double begin_m, double end_m, SeaHit& best) const {
    const auto at = [&](double s_m) {
        const glm::dvec3 place_m = ray.from_m + s_m * ray.direction;
        return sea_.curvature_per_m == 0.0 ? place_m : from_earth(place_m, sea_.curvature_per_m);
    };
    const glm::dvec3 here_m = at(end_m);
    if ((at(begin_m).z > 0.0) == (here_m.z > 0.0)) return false;
    best.distance_m = end_m;
    best.rest_m = glm::dvec2(here_m) + sea_.origin_m;
    return true;
}

bool RayTracer::hit_piece(Piece piece, bool any, SeaHit& best) {
    const SurfaceTiles& tiles = *sea_.tiles;
    piece.far_m = std::min(piece.far_m, best.distance_m);
    if (piece.level >= tiles.flat_level()) {
        const double s_m = -piece.from_m.z * piece.per_direction.z;
        const double seam_m =
            1e-9 * (1.0 + std::abs(s_m));  // pieces of a bent sea are rounded each by itself
        if (!(s_m >= piece.near_m - seam_m && s_m < piece.far_m + seam_m && s_m < best.distance_m))
            return false;
        best.distance_m = s_m;
        best.rest_m = glm::dvec2(piece.from_m + s_m * piece.direction);
        return true;
    }
    constexpr double kAny = std::numeric_limits<double>::max();
    const glm::dvec3 most_m(kAny, kAny, sea_.everywhere.height_m);
    if (!enters(piece.from_m, piece.per_direction, -most_m, most_m, piece.near_m, piece.far_m)) return false;
    bool is_hit = false;
    waiting_.clear();
    root_places_.clear();
    push_roots(piece);
    while (!waiting_.empty()) {
        const Entry entry = waiting_.back();
        waiting_.pop_back();
        if (entry.near_m >= best.distance_m) break;
        const Tile& tile = tile_of(entry);
        if (tile.place.level == piece.level) {
            is_hit = hit_tile(tile, piece, best) || is_hit;
            if (is_hit && any) return true;
            continue;
        }
        QuartersEntered entered;
        enter_(tile.quarters,
               {.from_m = piece.from_m - tile.middle_m,
                .per_direction = piece.per_direction,
                .near_m = piece.near_m,
                .far_m = std::min(piece.far_m, best.distance_m),
                .widening_m = tiles.widening_m(tile.place.level, piece.level)},
               entered);
        for (std::size_t q = 0; q < 4; ++q)
            if (entered.near_m[q] <= entered.far_m[q]) push({entered.near_m[q], &tile, static_cast<int>(q)});
    }
    return is_hit;
}

void RayTracer::push_roots(const Piece& piece) {
    const glm::dvec2 a_m(piece.from_m + piece.near_m * piece.direction),
        b_m(piece.from_m + piece.far_m * piece.direction);
    const glm::dvec2 low_m = glm::min(a_m, b_m) - sea_.everywhere.reach_m,
                     high_m = glm::max(a_m, b_m) + sea_.everywhere.reach_m;
    // Roots so wide that a few of them hold all that may reach the piece.
    const double wide_m = std::max(
        {2.0 * sea_.everywhere.reach_m, 0.5 * std::abs(b_m.x - a_m.x), 0.5 * std::abs(b_m.y - a_m.y)});
    int level = piece.level;
    while (SurfaceTiles::width_m(level) < wide_m) ++level;
    const double width_m = SurfaceTiles::width_m(level);
    const glm::dvec3 half_m(glm::dvec2(0.5 * width_m + sea_.everywhere.reach_m), sea_.everywhere.height_m);
    const glm::dvec2 first = glm::floor(low_m / width_m), last = glm::floor(high_m / width_m);
    for (double y = first.y; y <= last.y; ++y)
        for (double x = first.x; x <= last.x; ++x) {
            const TilePlace place{level, static_cast<std::int64_t>(x), static_cast<std::int64_t>(y)};
            double near_m = piece.near_m, far_m = piece.far_m;
            if (enters(piece.from_m - SurfaceTiles::middle_m(place), piece.per_direction, -half_m, half_m,
                       near_m, far_m)) {
                push({near_m, nullptr, static_cast<int>(root_places_.size())});
                root_places_.push_back(place);
            }
        }
}

void RayTracer::push(const Entry& entry) {
    waiting_.push_back(entry);
    std::size_t at = waiting_.size() - 1;
    for (; at > 0 && waiting_[at - 1].near_m < entry.near_m; --at) waiting_[at] = waiting_[at - 1];
    waiting_[at] = entry;
}

const Tile& RayTracer::tile_of(const Entry& entry) {
    if (!entry.parent) return root_of(root_places_[static_cast<std::size_t>(entry.number)]);
    const Tile& parent = *entry.parent;
    std::atomic<const Tile*>& kept = parent.finer[static_cast<std::size_t>(entry.number)];
    if (const Tile* tile = kept.load(std::memory_order_acquire)) return *tile;
    const TilePlace& of = parent.place;
    const Tile& tile =
        sea_.tiles->tile(*store_, {of.level - 1, 2 * of.x + entry.number % 2, 2 * of.y + entry.number / 2});
    kept.store(&tile, std::memory_order_release);
    return tile;
}

const Tile& RayTracer::root_of(const TilePlace& place) {
    Root& root =
        roots_[static_cast<std::size_t>(place.x * 5 + place.y * 29 + place.level * 7) % roots_.size()];
    if (!root.tile || root.place != place) root = {place, &sea_.tiles->tile(*store_, place)};
    return *root.tile;
}

bool RayTracer::hit_tile(const Tile& tile, const Piece& piece, SeaHit& best) const {
    double near_m = piece.near_m, far_m = std::min(piece.far_m, best.distance_m);
    const glm::dvec3 from_m = piece.from_m - tile.middle_m;
    if (!enters(from_m, piece.per_direction, glm::dvec3(tile.box.low_m), glm::dvec3(tile.box.high_m), near_m,
                far_m))
        return false;
    const glm::vec3 begin_m(from_m + near_m * piece.direction);
    const glm::vec3 most_m =
        glm::max(glm::max(glm::abs(tile.box.low_m), glm::abs(tile.box.high_m)), glm::abs(begin_m));
    // Some eight roundings: of the points, of the ray's beginning, and of their difference.
    const float rounding_m = 1e-6f * std::max({most_m.x, most_m.y, most_m.z});
    const auto cell_m = static_cast<float>(std::ldexp(1.0, tile.place.level));
    TileHit hit;
    if (!nearest_(tile.points,
                  {.from_m = begin_m,
                   .direction = glm::vec3(piece.direction),
                   .near = -rounding_m,
                   .far = static_cast<float>(far_m - near_m) + rounding_m,
                   .time_s = static_cast<float>(piece.time_s),
                   .rounding_m = rounding_m},
                  hit))
        return false;
    const double distance_m = std::max(near_m + static_cast<double>(hit.distance), piece.near_m);
    if (!(distance_m < best.distance_m)) return false;
    best.distance_m = distance_m;
    best.rest_m =
        glm::dvec2(tile.middle_m) +
        static_cast<double>(cell_m) * (glm::dvec2(hit.x, hit.y) - 0.5 * static_cast<double>(kTileCells));
    return true;
}

}  // namespace pelagic::procedural
