#include "plugin/host/gpu/packed_foam.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/ext/vector_int2_sized.hpp>
#include <glm/geometric.hpp>

namespace pelagic {
namespace {

constexpr int kSide = FoamPlan::kTileCells + 1;

}  // namespace

PackedFoam::PackedFoam(const FoamHistory<float>& history, glm::dvec2 centre_m)
    : mean_(history.mean()),
      mean_times_age_s_(history.mean_times_age_s()),
      cells_per_m_(static_cast<float>(1.0 / history.plan().cell_m)),
      past_m_(static_cast<float>(history.plan().past_m)),
      breaking_m_(static_cast<float>(history.plan().breaking_m)),
      breaking_deviate_(static_cast<float>(history.breaking_deviate())) {
    std::vector<FoamNodes> tiles = history.nodes();
    std::erase_if(tiles, [&](const FoamNodes& tile) {
        const glm::dvec2 at = glm::dvec2(tile.place.x, tile.place.y) -
                              (centre_m - history.drifted_m(tile.place.level)) /
                                  (history.plan().cell_of(tile.place.level) * FoamPlan::kTileCells);
        return !(std::max(std::abs(at.x), std::abs(at.y)) < kFarthestTile);
    });
    history_bytes_ = history.held_bytes();
    pages_size_ = {1, 0};
    for (int level = 0; level < FoamPlan::kLevels; ++level) {
        Box& box = boxes_[static_cast<std::size_t>(level)];
        box.cells_per_m = std::ldexp(1.0 / history.plan().cell_m, -level);
        box.drifted_m = history.drifted_m(level);
        box.row = pages_size_.y;
        glm::i64vec2 low(0), high(-1);
        for (const FoamNodes& tile : tiles) {
            if (tile.place.level != level) continue;
            const glm::i64vec2 at(tile.place.x, tile.place.y);
            const bool is_first = high.x < low.x;
            low = is_first ? at : glm::min(low, at);
            high = is_first ? at : glm::max(high, at);
        }
        box.first = glm::dvec2(low);
        box.size = glm::ivec2(high - low) + 1;
        pages_size_ = {std::max(pages_size_.x, box.size.x), pages_size_.y + box.size.y};
    }
    pages_size_.y = std::max(pages_size_.y, 1);
    pages_.assign(static_cast<std::size_t>(pages_size_.x) * pages_size_.y, -1.0f);
    const auto count = static_cast<int>(tiles.size());
    const int rows = (count + kTilesAcross - 1) / kTilesAcross;
    if (count > 0) nodes_size_ = kSide * glm::ivec2(std::min(count, kTilesAcross), rows);
    if (history.plan().sums() > 2) {
        channels_ = 4;
        mean_bubbles_ = history.mean_bubbles();
    }
    nodes_.assign(static_cast<std::size_t>(channels_) * nodes_size_.x * nodes_size_.y, 0.0f);
    for (int i = 0; i < count; ++i) {
        const FoamNodes& tile = tiles[static_cast<std::size_t>(i)];
        const Box& box = boxes_[static_cast<std::size_t>(tile.place.level)];
        const glm::ivec2 in_box(glm::dvec2(tile.place.x, tile.place.y) - box.first);
        pages_[static_cast<std::size_t>(box.row + in_box.y) * pages_size_.x + in_box.x] =
            static_cast<float>(i);
        const glm::ivec2 first = kSide * glm::ivec2(i % kTilesAcross, i / kTilesAcross);
        for (int y = 0; y < kSide; ++y)
            for (int x = 0; x < kSide; ++x) {
                float* const node =
                    &nodes_[channels_ *
                            (static_cast<std::size_t>(first.y + y) * nodes_size_.x + first.x + x)];
                node[0] = tile.foam[y * kSide + x];
                node[1] = tile.aged[y * kSide + x];
                if (channels_ > 2) node[2] = tile.bubbles[y * kSide + x];
            }
    }
}

std::vector<glm::vec4> PackedFoam::level_texels(glm::dvec2 origin_m) const {
    std::vector<glm::vec4> texels;
    for (const Box& box : boxes_) {
        const glm::dvec2 first =
            (origin_m - box.drifted_m) * box.cells_per_m - box.first * double{FoamPlan::kTileCells};
        texels.emplace_back(glm::vec2(first), static_cast<float>(box.cells_per_m), 0.0f);
        texels.emplace_back(glm::vec2(box.size), static_cast<float>(box.row), 0.0f);
    }
    texels.emplace_back(mean_, mean_times_age_s_, cells_per_m_, mean_bubbles_);
    texels.emplace_back(past_m_, breaking_m_, breaking_deviate_, 0.0f);
    return texels;
}

std::size_t PackedFoam::bytes_for(const FoamPlan& foam, std::size_t history_bytes) {
    const std::size_t tiles = history_bytes / foam.tile_bytes();
    return (tiles + kTilesAcross) * FoamPlan::kTileNodes * (foam.sums() > 2 ? 4 : 2) * sizeof(float);
}

std::vector<FoamPlace> foam_places(const FoamPlan& foam, double time_s, const ProjectedGrid& grid,
                                   const std::atomic<bool>* cancel) {
    std::vector<FoamPlace> places;
    std::array<FoamPlace, FoamPlan::kLevels> before;
    before.fill({.level = -1});
    const auto take = [&](int level, glm::dvec2 low, glm::dvec2 high) {
        const glm::dvec2 offset_m = grid.origin_m - foam.drift_of(level) * time_s;
        const double tiles_per_m = 1.0 / std::ldexp(foam.cell_m * FoamPlan::kTileCells, level);
        const glm::i64vec2 first(glm::floor((offset_m + low) * tiles_per_m)),
            last(glm::floor((offset_m + high) * tiles_per_m));
        for (std::int64_t y = first.y; y <= last.y; ++y)
            for (std::int64_t x = first.x; x <= last.x; ++x) {
                const FoamPlace place{level, x, y};
                FoamPlace& last_one = before[static_cast<std::size_t>(level)];
                if (!(place == last_one)) places.push_back(place);
                last_one = place;
            }
    };
    const auto stride = static_cast<std::size_t>(grid.columns) + 1;
    const auto level_at = [&](std::size_t i) {
        return foam_level_blend(foam, foam_footprint_m(grid.pixel_m[i], glm::length(grid.pixel_axis_m[i])))
            .level;
    };
    // Of points beside those of a whole grid each has the half of its cell on either side, cut into parts as below.
    constexpr double kHalf = 0.6;  // and something for cells that get larger
    const std::size_t of_grid = grid.columns > 0 ? (static_cast<std::size_t>(grid.columns) + 1) *
                                                       (static_cast<std::size_t>(grid.rows) + 1)
                                                 : 0;
    for (std::size_t i = of_grid; i < grid.rest_m.size(); ++i) {
        if (i % 4096 == 0) stop_if(cancel);
        const glm::dvec2 at(grid.rest_m[i]), axis_m = kHalf * glm::dvec2(grid.cell_axis_m[i]);
        const double width_m = kHalf * static_cast<double>(grid.cell_m[i]);
        const int finest = level_at(i);
        for (int level = finest; level <= std::min(finest + 2, FoamPlan::kLevels - 1); ++level) {
            const double tile_m = std::ldexp(foam.cell_m * FoamPlan::kTileCells, level);
            const int parts =
                static_cast<int>(std::clamp(std::ceil(2.0 * glm::length(axis_m) / tile_m), 1.0, 64.0));
            for (int part = 0; part < parts; ++part) {
                const glm::dvec2 a = at + axis_m * (2.0 * part / parts - 1.0),
                                 b = at + axis_m * (2.0 * (part + 1) / parts - 1.0);
                take(level, glm::min(a, b) - width_m, glm::max(a, b) + width_m);
            }
        }
    }
    for (std::size_t row = 0; row < static_cast<std::size_t>(grid.rows); ++row) {
        stop_if(cancel);
        for (std::size_t column = 0; column + 1 < stride; ++column) {
            const std::size_t i = row * stride + column;
            const std::array corners{i, i + 1, i + stride, i + stride + 1};
            int finest = FoamPlan::kLevels, coarsest = 0;
            for (const std::size_t corner : corners) {
                const int level = level_at(corner);
                finest = std::min(finest, level);
                coarsest = std::max(coarsest, level);
            }
            const std::array<glm::dvec2, 4> at{
                glm::dvec2(grid.rest_m[corners[0]]), glm::dvec2(grid.rest_m[corners[1]]),
                glm::dvec2(grid.rest_m[corners[2]]), glm::dvec2(grid.rest_m[corners[3]])};
            // The next level is blended in, and one more serves pixels that waves stretch.
            for (int level = finest; level <= std::min(coarsest + 2, FoamPlan::kLevels - 1); ++level) {
                // A long cell isn't along the axes. It is cut into parts no longer than a tile, so that their boxes
                // hold little else.
                const double tile_m = std::ldexp(foam.cell_m * FoamPlan::kTileCells, level);
                const auto parts = [&](double length_m) {
                    return static_cast<int>(std::clamp(std::ceil(length_m / tile_m), 1.0, 64.0));
                };
                const int across = parts(std::max(glm::length(at[1] - at[0]), glm::length(at[3] - at[2])));
                const int along = parts(std::max(glm::length(at[2] - at[0]), glm::length(at[3] - at[1])));
                const auto inside = [&](int x, int y) {
                    const double s = static_cast<double>(x) / across, t = static_cast<double>(y) / along;
                    return glm::mix(glm::mix(at[0], at[1], s), glm::mix(at[2], at[3], s), t);
                };
                for (int y = 0; y < along; ++y)
                    for (int x = 0; x < across; ++x) {
                        const glm::dvec2 a = inside(x, y), b = inside(x + 1, y), c = inside(x, y + 1),
                                         d = inside(x + 1, y + 1);
                        take(level, glm::min(glm::min(a, b), glm::min(c, d)),
                             glm::max(glm::max(a, b), glm::max(c, d)));
                    }
            }
        }
    }
    return places;
}

}  // namespace pelagic
