#include "plugin/host/procedural/surface_tiles.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <utility>

namespace pelagic::procedural {
namespace {

// The finest level that any tolerance needs, below the query's finest cell: deviations fall with the square of the
// points' distance.
constexpr int kLevelsBelowFinest = 4;
// For flat water, or where the cells of all levels resolve no waves.
constexpr int kMostLevels = 40;

TileBox box_of(const float* const at_m[3], const float* const velocity_mps[3], double half_open_s, int x0,
               int y0, int cells) {
    TileBox box{glm::vec3(INFINITY), glm::vec3(-INFINITY)};
    for (int axis = 0; axis < 3; ++axis) {
        float low = INFINITY, high = -INFINITY, most = 0.0f;
        for (int y = y0; y <= y0 + cells; ++y)
            for (int x = x0; x <= x0 + cells; ++x) {
                const int i = y * kTileRow + x;
                const float way = velocity_mps[axis]
                                      ? static_cast<float>(half_open_s) * std::abs(velocity_mps[axis][i])
                                      : 0.0f;
                low = std::min(low, at_m[axis][i] - way);
                high = std::max(high, at_m[axis][i] + way);
                most = std::max(most, std::abs(at_m[axis][i]) + way);
            }
        const float rounding = 1e-6f * most;
        box.low_m[axis] = low - rounding;
        box.high_m[axis] = high + rounding;
    }
    return box;
}

}  // namespace

std::size_t TileStore::Hash::operator()(const TilePlace& place) const {
    std::uint64_t h = static_cast<std::uint64_t>(place.level) * 0x9e3779b97f4a7c15u;
    for (const std::int64_t value : {place.x, place.y}) {
        h ^= static_cast<std::uint64_t>(value);
        h *= 0xff51afd7ed558ccdu;
        h ^= h >> 32;
    }
    return h;
}

const Tile* TileStore::find(const TilePlace& place) const {
    const auto found = tiles_.find(place);
    return found == tiles_.end() ? nullptr : found->second.get();
}

const Tile* TileStore::keep(const TilePlace& place, std::unique_ptr<const Tile> tile, std::size_t bytes) {
    const auto [at, is_new] = tiles_.emplace(place, std::move(tile));
    if (is_new) bytes_ += bytes;
    return at->second.get();
}

SurfaceTiles::SurfaceTiles(const PreparedQuery<float>& query, double finest_cell_m, double half_open_s,
                           std::size_t most_bytes, const MasksPlan* masks)
    : query_(&query),
      masks_(masks),
      finest_cell_m_(finest_cell_m),
      half_open_s_(half_open_s),
      most_bytes_(most_bytes),
      first_level_(static_cast<int>(std::floor(std::log2(finest_cell_m))) - kLevelsBelowFinest),
      store_(std::make_shared<TileStore>()) {
    bool is_flat = false;
    for (int level = first_level_; level < first_level_ + kMostLevels; ++level) {
        const double deviation_m = sampled_deviation_m(level, is_flat);
        const double before_m = deviations_m_.empty() ? 0.0 : deviations_m_.back();
        flat_deviation_m_ = std::max(before_m, deviation_m);
        if (is_flat) break;
        deviations_m_.push_back(flat_deviation_m_);
    }
}

double SurfaceTiles::width_m(int level) {
    return std::ldexp(static_cast<double>(kTileCells), level);
}

glm::dvec3 SurfaceTiles::middle_m(const TilePlace& place) {
    const double width = width_m(place.level);
    return {(static_cast<double>(place.x) + 0.5) * width, (static_cast<double>(place.y) + 0.5) * width, 0.0};
}

double SurfaceTiles::deviation_m(int level) const {
    if (level >= flat_level()) return flat_deviation_m_;
    return deviations_m_[static_cast<std::size_t>(std::max(level - first_level_, 0))];
}

int SurfaceTiles::level_within(double tolerance_m) const {
    if (tolerance_m >= flat_deviation_m_) return flat_level();
    const auto above = std::upper_bound(deviations_m_.begin(), deviations_m_.end(), tolerance_m);
    return first_level_ + std::max(static_cast<int>(above - deviations_m_.begin()) - 1, 0);
}

// Triangles differ most from the surface in the middle of their longest edge, the cell's diagonal. Waves are many and
// independent, so that differences are normal: the largest of 512 samples is some three standard deviations.
double SurfaceTiles::sampled_deviation_m(int level, bool& is_flat) const {
    constexpr int kPlaces = 128, kCells = 4;
    constexpr double kAboveLargest = 1.8;  // so many times that is over five standard deviations
    const double step_m = std::ldexp(1.0, level);
    std::vector<glm::vec2> rest_m;
    std::vector<float> cell_m;
    const bool moves = half_open_s_ > 0.0;
    // East of all masks, which change a part of the sea alone; where waves are higher so are their differences.
    double east_m = 0.0, gain = 1.0;
    if (masks_) {
        for (const MasksPlan::Mask& mask : masks_->masks)
            east_m = std::max(east_m, mask.middle_m.x + 2.0 * mask.reach_m);
        gain = masks_->largest();
    }
    double largest_m = 0.0;
    is_flat = true;
    for (int place = 0; place < kPlaces; ++place) {
        // Spread evenly over tens of kilometres, by multiples of two irrational numbers.
        const auto spread = [&](double by) { return 65536.0 * (place * by - std::floor(place * by)); };
        const glm::dvec2 origin_m =
            step_m * glm::floor(glm::dvec2(east_m + spread(0.754877666), spread(0.569840291)) / step_m);
        rest_m.clear();
        cell_m.clear();
        for (int i = 0; i < kCells; ++i) {
            // Multiples of the step, which floats hold exactly.
            const glm::vec2 cell(static_cast<float>(i * 37 % 64), static_cast<float>(i * 23 % 61));
            for (const float at : {0.0f, 1.0f, 0.5f})
                rest_m.push_back(static_cast<float>(step_m) * (cell + at));
            for (const double m : {step_m, step_m, finest_cell_m_}) cell_m.push_back(static_cast<float>(m));
        }
        std::vector<glm::vec3> position(rest_m.size()), velocity(moves ? rest_m.size() : 0);
        Results<float> results;
        results.set(Product::Position, {position.data()});
        if (moves) results.set(Product::Velocity, {velocity.data()});
        query_->evaluate_alone({.origin_m = origin_m,
                                .count = rest_m.size(),
                                .rest_m = {rest_m.data()},
                                .cell_m = {cell_m.data()}},
                               results);
        for (std::size_t i = 0; i < rest_m.size(); i += 3) {
            const auto off = [&](const std::vector<glm::vec3>& of) {
                return static_cast<double>(glm::length(0.5f * (of[i] + of[i + 1]) - of[i + 2]));
            };
            largest_m = std::max(largest_m, off(position) + (moves ? half_open_s_ * off(velocity) : 0.0));
            is_flat = is_flat && position[i] == glm::vec3(rest_m[i], 0.0f);
        }
    }
    return kAboveLargest * gain * largest_m;
}

std::shared_ptr<TileStore> SurfaceTiles::store() const {
    const std::lock_guard<std::mutex> lock(lock_);
    if (is_full(*store_)) store_ = std::make_shared<TileStore>();
    return store_;
}

const Tile& SurfaceTiles::tile(TileStore& store, const TilePlace& place) const {
    if (const Tile* found = store.find(place)) return *found;
    std::unique_ptr<Tile> tile = made(place);
    const std::size_t bytes =
        sizeof(Tile) + (half_open_s_ > 0.0 ? 6 : 3) * kTileRoom * sizeof(float) + 4 * sizeof(void*);
    return *store.keep(place, std::move(tile), bytes);
}

std::unique_ptr<Tile> SurfaceTiles::made(const TilePlace& place) const {
    const bool moves = half_open_s_ > 0.0;
    const float step_m = static_cast<float>(std::ldexp(1.0, place.level));
    std::array<glm::vec2, kTilePoints> rest_m;
    std::array<float, kTilePoints> cell_m;
    for (int i = 0; i < kTilePoints; ++i) {
        const glm::vec2 node(i % kTileRow, i / kTileRow);
        rest_m[static_cast<std::size_t>(i)] = step_m * (node - 0.5f * kTileCells);
    }
    cell_m.fill(step_m);
    std::array<glm::vec3, kTilePoints> position, velocity;
    Results<float> results;
    results.set(Product::Position, {position.data()});
    if (moves) results.set(Product::Velocity, {velocity.data()});
    query_->evaluate_alone({.origin_m = glm::dvec2(middle_m(place)),
                            .count = kTilePoints,
                            .rest_m = {rest_m.data()},
                            .cell_m = {cell_m.data()}},
                           results);
    auto tile = std::make_unique<Tile>();
    tile->place = place;
    tile->middle_m = middle_m(place);
    tile->values = std::make_unique<float[]>((moves ? 6 : 3) * kTileRoom);
    const float *at_m[3], *velocity_mps[3];
    for (int axis = 0; axis < 3; ++axis) {
        float* at = tile->values.get() + static_cast<std::size_t>(axis) * kTileRoom;
        float* fast = moves ? at + 3 * kTileRoom : nullptr;
        for (std::size_t i = 0; i < kTilePoints; ++i) {
            at[i] = position[i][axis];
            if (moves) fast[i] = velocity[i][axis];
        }
        tile->points.at_m[static_cast<std::size_t>(axis)] = at_m[axis] = at;
        tile->points.velocity_mps[static_cast<std::size_t>(axis)] = velocity_mps[axis] = fast;
    }
    constexpr int kHalf = kTileCells / 2;
    for (int q = 0; q < 4; ++q) {
        const TileBox quarter = box_of(at_m, velocity_mps, half_open_s_, q % 2 * kHalf, q / 2 * kHalf, kHalf);
        for (int axis = 0; axis < 3; ++axis) {
            const auto a = static_cast<std::size_t>(axis), at = static_cast<std::size_t>(q);
            tile->quarters.low_m[a][at] = quarter.low_m[axis];
            tile->quarters.high_m[a][at] = quarter.high_m[axis];
        }
        tile->box.low_m = q == 0 ? quarter.low_m : glm::min(tile->box.low_m, quarter.low_m);
        tile->box.high_m = q == 0 ? quarter.high_m : glm::max(tile->box.high_m, quarter.high_m);
    }
    return tile;
}

}  // namespace pelagic::procedural
