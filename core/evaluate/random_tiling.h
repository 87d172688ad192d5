// A cascade's grid with random tiling, read at points: each cell has the tile at an offset of its own, and tiles
// blend across the cells' borders (core/plan/random_tiling.h).
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <span>

#include "core/evaluate/chunk.h"
#include "core/evaluate/kernels.h"
#include "core/plan/random_tiling.h"

namespace pelagic {

// Where the origin of the points lies in a cascade's tiling.
struct TilingOrigin {
    uint key = 0;
    TilePlace x, y;
    double cells_per_m = 1.0;

    TilingOrigin() = default;
    TilingOrigin(uint tiling_key, double size_m, glm::dvec2 origin_m)
        : key(tiling_key),
          x(tile_place(origin_m.x / size_m)),
          y(tile_place(origin_m.y / size_m)),
          cells_per_m(1.0 / size_m) {}

    // The offset of the tile whose cell is so many cells from the origin's.
    TileOffset<double> offset(std::int64_t i, std::int64_t j) const {
        return tile_offset<double>(key, static_cast<uint>(x.cell + i), static_cast<uint>(y.cell + j));
    }
};

// Which shifted tiles a chunk's points read. Found when it is first asked for.
template <class T>
class TilingPlaces {
  public:
    // `row`: chunks with the same number have the same x. 0: no other chunk has this one's x.
    void forget(std::uint64_t row) {
        is_known_ = false;
        row_ = row;
    }
    void find(const TilingOrigin& origin, const Chunk<T>& chunk, const EvaluateKernels<T>& kernels) {
        if (is_known_) return;
        is_known_ = true;
        const ChunkSpan<T> span = kernels.span_of(chunk);
        bool is_known_place = span.is_finite;
        const auto place = [&](const TilePlace& from, T rest_m) {
            const double cells = from.from_middle + static_cast<double>(rest_m) * origin.cells_per_m;
            is_known_place = is_known_place && std::abs(cells) < kFarthestCell;
            return tile_place(cells);
        };
        const TilePlace x0 = place(origin.x, span.low_x), x1 = place(origin.x, span.high_x);
        const TilePlace y0 = place(origin.y, span.low_y), y1 = place(origin.y, span.high_y);
        constexpr double kInside = kPlainHalf - 1e-9;  // beyond rounding, in whichever way points are placed
        const auto plain = [&](const TilePlace& low, const TilePlace& high) {
            return low.cell == high.cell && low.from_middle > -kInside && high.from_middle < kInside;
        };
        is_one_ = is_known_place && plain(x0, x1) && plain(y0, y1);
        if (is_one_) {
            offset_ = origin.offset(x0.cell, y0.cell);
            return;
        }
        const bool has_same_x = row_ != 0 && row_of_x_ == row_;
        if (!has_same_x)
            kernels.place_tiles({origin.cells_per_m, origin.x.from_middle}, chunk.rest_x.data(),
                                chunk.padded(), x_);
        row_of_x_ = row_;
        const bool was_level = is_level_;
        is_level_ = span.is_finite && span.low_y == span.high_y;  // a row of a patch
        place_y({origin.cells_per_m, origin.y.from_middle}, chunk, kernels);
        if (!(has_same_x && was_level && is_level_)) find_stretches(chunk.count);  // else as the row before
    }

    // Whether all of the chunk's points read one and the same shifted tile, and its offset.
    bool is_one() const { return is_one_; }
    const TileOffset<double>& offset() const { return offset_; }
    // Each point's, otherwise.
    const TilingAxis<T>& x() const { return x_; }
    const TilingAxis<T>& y() const { return y_; }
    // Successive points that read the same tiles.
    struct Stretch {
        std::uint16_t first, end;
    };
    std::span<const Stretch> stretches() const { return {stretches_.data(), stretch_count_}; }

  private:
    void place_y(const TilingAxisArgs& args, const Chunk<T>& chunk, const EvaluateKernels<T>& kernels) {
        const std::size_t padded = chunk.padded();
        if (!is_level_) return kernels.place_tiles(args, chunk.rest_y.data(), padded, y_);
        kernels.place_tiles(args, chunk.rest_y.data(), Chunk<T>::kLongestVector, y_);
        std::fill(y_.code.begin() + 1, y_.code.begin() + padded, y_.code[0]);
        for (auto* values : {&y_.own, &y_.next, &y_.rate})
            std::fill(values->begin() + 1, values->begin() + padded, values->front());
    }

    void find_stretches(std::size_t count) {
        stretch_count_ = 0;
        for (std::size_t first = 0, end; first < count; first = end) {
            const auto code_x = x_.code[first], code_y = y_.code[first];
            end = first + 1;
            while (end < count && x_.code[end] == code_x && y_.code[end] == code_y) ++end;
            stretches_[stretch_count_++] = {static_cast<std::uint16_t>(first),
                                            static_cast<std::uint16_t>(end)};
        }
    }

    bool is_known_ = false, is_one_ = false, is_level_ = false;
    std::uint64_t row_ = 0, row_of_x_ = 0;
    TileOffset<double> offset_{0.0, 0.0};
    TilingAxis<T> x_, y_;
    std::array<Stretch, Chunk<T>::kPoints> stretches_;
    std::size_t stretch_count_ = 0;
};

// Reads a grid's shifted tiles at a chunk's points.
template <class T>
class TilingReader {
  public:
    // `grid`: with the samples of all its fields, its origin and its weights by point. Adds `wanted`.
    void add(GridArgs<T> grid, FieldSet wanted, const TilingOrigin& origin, const TilingPlaces<T>& places,
             Chunk<T>& to, const EvaluateKernels<T>& kernels) {
        const FieldSet read = wanted | gradient_fields(wanted);
        for (std::size_t f = 0; f < kFieldCount; ++f)
            if (!read[f]) grid.samples[f] = nullptr;
        of_cells_ = (wanted & cell_fields()).any() ? grid.cell_weight : nullptr;
        of_pixels_ = (wanted & ~cell_fields()).any() ? grid.pixel_weight : nullptr;
        TilingArgs<T> tiling;
        tiling.ranges = ranges_.data();
        tiling.wanted = wanted;
        grid.tiling = &tiling;
        for (const bool next_y : {false, true}) {
            if (next_y) {  // tiles there have other offsets, and kept places are those in the points' own cells
                grid.places = nullptr;
                grid.row = 0;
            }
            find(grid, origin, places, next_y);
            if (range_count_ == 0) continue;
            tiling.range_count = range_count_;
            tiling.y = axis(places.y(), next_y);
            for (const bool next_x : {false, true})
                tiling.sides[next_x] = {axis(places.x(), next_x), points_[next_x].data(),
                                        point_count_[next_x]};
            kernels.add_grid(grid, to);
        }
    }

  private:
    static typename TilingArgs<T>::Axis axis(const TilingAxis<T>& of, bool next) {
        return next ? typename TilingArgs<T>::Axis{of.next.data(), of.own.data(), of.rate.data(), T(1)}
                    : typename TilingArgs<T>::Axis{of.own.data(), of.next.data(), of.rate.data(), T(-1)};
    }

    // The points that read the tiles of their own cell or of the next one along y, and these tiles' offsets.
    void find(const GridArgs<T>& grid, const TilingOrigin& origin, const TilingPlaces<T>& places,
              bool next_y) {
        range_count_ = 0;
        point_count_ = {};
        for (const auto [first, end] : places.stretches()) {
            const auto code_x = places.x().code[first], code_y = places.y().code[first];
            const int side_x = TilingAxis<T>::side_of(code_x), side_y = TilingAxis<T>::side_of(code_y);
            if (next_y && side_y == 0) continue;
            const std::int64_t y = TilingAxis<T>::cell_of(code_y) + (next_y ? side_y : 0);
            for (const bool next_x : {false, true}) {
                if (next_x && side_x == 0) continue;
                const std::int64_t x = TilingAxis<T>::cell_of(code_x) + (next_x ? side_x : 0);
                if (!of_cells_ && !of_pixels_) {
                    take({first, end}, next_x, x, y, grid, origin);
                    continue;
                }
                for (std::size_t i = first; i < end; ++i)
                    if (counts(i)) take({i, i + 1}, next_x, x, y, grid, origin);
            }
        }
    }

    // Points beside a tile's cell are read together with those in it, as one row.
    void take(PointRange points, bool next_x, std::int64_t x, std::int64_t y, const GridArgs<T>& grid,
              const TilingOrigin& origin) {
        PointRange* seen = points_[next_x].data() + point_count_[next_x];
        if (point_count_[next_x] > 0 && seen[-1].end == points.first)
            seen[-1].end = points.end;
        else
            *seen = points, ++point_count_[next_x];
        // Points can be added to the last two tiles.
        for (std::size_t r = range_count_; r > 0 && r + 2 > range_count_; --r) {
            TilingRange& range = ranges_[r - 1];
            const bool is_own_over = range.own.end > range.own.first && range.own.end < range.points.end;
            if (cells_[r - 1] != Cell{x, y} || range.points.end != points.first || (!next_x && is_own_over))
                continue;
            range.points.end = points.end;
            if (!next_x)
                range.own = {range.own.end > range.own.first ? range.own.first : points.first, points.end};
            return;
        }
        const TileOffset<double> offset = origin.offset(x, y);
        cells_[range_count_] = {x, y};
        ranges_[range_count_++] = {points, next_x ? PointRange{points.first, points.first} : points,
                                   grid.origin_nodes_x + offset.x * grid.n,
                                   grid.origin_nodes_y + offset.y * grid.n};
    }

    // Whether a point has a weight in the grid, for the fields that are read.
    bool counts(std::size_t i) const {
        return (of_cells_ && of_cells_[i] > T(0)) || (of_pixels_ && of_pixels_[i] > T(0));
    }

    // Not a pair, whose members would all be zeroed for each query.
    struct Cell {
        std::int64_t x, y;
        bool operator==(const Cell&) const = default;
    };

    const T *of_cells_ = nullptr, *of_pixels_ = nullptr;  // the points' weights
    // A point lies in one or two ranges.
    std::array<TilingRange, 2 * Chunk<T>::kPoints> ranges_;
    std::array<Cell, 2 * Chunk<T>::kPoints> cells_;  // of their tiles
    std::size_t range_count_ = 0;
    std::array<std::array<PointRange, Chunk<T>::kPoints>, 2> points_;  // of the own cell's tile, of the next
    std::array<std::size_t, 2> point_count_{};
};

// Adds the wanted fields of a grid at the chunk's points. `args`: the grid with those fields' samples alone, and where the origin
// lies in the tile; `grid`: with all samples.
template <class T>
void add_tiles(const GridArgs<T>& grid, GridArgs<T> args, FieldSet wanted, const TilingOrigin& origin,
               TilingPlaces<T>& places, TilingReader<T>& tiling, Chunk<T>& chunk,
               const EvaluateKernels<T>& kernels) {
    places.find(origin, chunk, kernels);
    if (places.is_one()) {
        args.origin_nodes_x += places.offset().x * args.n;
        args.origin_nodes_y += places.offset().y * args.n;
        kernels.add_grid(args, chunk);
        return;
    }
    args.samples = grid.samples;
    tiling.add(args, wanted, origin, places, chunk, kernels);
}

}  // namespace pelagic
