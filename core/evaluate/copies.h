// A cascade's grid read at points that show copies of its tile, at random offsets and blended (core/plan/copies.h).
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <span>

#include "core/evaluate/chunk.h"
#include "core/evaluate/kernels.h"
#include "core/plan/copies.h"

namespace pelagic {

// A cascade's copies, seen from the origin of the points.
struct CopyOrigin {
    uint key = 0;
    CopyPlace x, y;
    double cells_per_m = 1.0;

    CopyOrigin() = default;
    CopyOrigin(uint copies_key, double size_m, glm::dvec2 origin_m)
        : key(copies_key),
          x(copy_place(origin_m.x / size_m)),
          y(copy_place(origin_m.y / size_m)),
          cells_per_m(1.0 / size_m) {}

    // Of a cell that is so many cells from the origin's.
    CopyOffset<double> offset(std::int64_t i, std::int64_t j) const {
        return copy_offset<double>(key, static_cast<uint>(x.cell + i), static_cast<uint>(y.cell + j));
    }
};

// Which copies a chunk's points show. Found when it is first asked for.
template <class T>
class CopyPlaces {
  public:
    void forget() { is_known_ = false; }
    void find(const CopyOrigin& origin, const Chunk<T>& chunk, const EvaluateKernels<T>& kernels) {
        if (is_known_) return;
        is_known_ = true;
        const ChunkSpan<T> span = kernels.span_of(chunk);
        bool is_known_place = span.is_finite;
        const auto place = [&](const CopyPlace& from, T rest_m) {
            const double cells = from.from_middle + static_cast<double>(rest_m) * origin.cells_per_m;
            is_known_place = is_known_place && std::abs(cells) < kFarthestCell;
            return copy_place(cells);
        };
        const CopyPlace x0 = place(origin.x, span.low_x), x1 = place(origin.x, span.high_x);
        const CopyPlace y0 = place(origin.y, span.low_y), y1 = place(origin.y, span.high_y);
        constexpr double kInside = kPlainHalf - 1e-9;  // beyond rounding, in whichever way points are placed
        const auto plain = [&](const CopyPlace& low, const CopyPlace& high) {
            return low.cell == high.cell && low.from_middle > -kInside && high.from_middle < kInside;
        };
        is_one_ = is_known_place && plain(x0, x1) && plain(y0, y1);
        if (is_one_) {
            offset_ = origin.offset(x0.cell, y0.cell);
            return;
        }
        kernels.place_copies({origin.cells_per_m, origin.x.from_middle}, chunk.rest_x.data(), chunk.padded(),
                             x_);
        kernels.place_copies({origin.cells_per_m, origin.y.from_middle}, chunk.rest_y.data(), chunk.padded(),
                             y_);
        find_stretches(chunk.count);
    }

    // Whether all of the chunk's points show one and the same copy, and its offset.
    bool is_one() const { return is_one_; }
    const CopyOffset<double>& offset() const { return offset_; }
    // Each point's, otherwise.
    const CopyAxis<T>& x() const { return x_; }
    const CopyAxis<T>& y() const { return y_; }
    // Points one after another that show the same copies.
    struct Stretch {
        std::uint16_t first, end;
    };
    std::span<const Stretch> stretches() const { return {stretches_.data(), stretch_count_}; }

  private:
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

    bool is_known_ = false, is_one_ = false;
    CopyOffset<double> offset_{0.0, 0.0};
    CopyAxis<T> x_, y_;
    std::array<Stretch, Chunk<T>::kPoints> stretches_;
    std::size_t stretch_count_ = 0;
};

// Reads a grid at the copies of a chunk's points.
template <class T>
class CopyReader {
  public:
    // `grid`: with the samples of all its fields, its origin and its weights by point. Adds `wanted`.
    void add(GridArgs<T> grid, FieldSet wanted, const CopyOrigin& origin, const CopyPlaces<T>& places,
             Chunk<T>& to, const EvaluateKernels<T>& kernels) {
        const FieldSet read = wanted | gradient_fields(wanted);
        for (std::size_t f = 0; f < kFieldCount; ++f)
            if (!read[f]) grid.samples[f] = nullptr;
        of_cells_ = (wanted & cell_fields()).any() ? grid.cell_weight : nullptr;
        of_pixels_ = (wanted & ~cell_fields()).any() ? grid.pixel_weight : nullptr;
        CopyArgs<T> copies;
        copies.ranges = ranges_.data();
        copies.wanted = wanted;
        grid.copies = &copies;
        for (const bool next_y : {false, true})
            for (const bool next_x : {false, true}) {
                find(grid, origin, places, next_x, next_y);
                if (range_count_ == 0) continue;
                copies.range_count = range_count_;
                copies.x = axis(places.x(), next_x);
                copies.y = axis(places.y(), next_y);
                kernels.add_grid(grid, to);
            }
    }

  private:
    static typename CopyArgs<T>::Axis axis(const CopyAxis<T>& of, bool next) {
        return next ? typename CopyArgs<T>::Axis{of.next.data(), of.own.data(), of.rate.data(), T(1)}
                    : typename CopyArgs<T>::Axis{of.own.data(), of.next.data(), of.rate.data(), T(-1)};
    }

    // The points that see the copy in their own cell or in the next one, along each axis, and where it lies.
    void find(const GridArgs<T>& grid, const CopyOrigin& origin, const CopyPlaces<T>& places, bool next_x,
              bool next_y) {
        range_count_ = 0;
        for (const auto [first, end] : places.stretches()) {
            const auto code_x = places.x().code[first], code_y = places.y().code[first];
            const int side_x = CopyAxis<T>::side_of(code_x), side_y = CopyAxis<T>::side_of(code_y);
            if ((next_x && side_x == 0) || (next_y && side_y == 0)) continue;
            const CopyOffset<double> offset =
                origin.offset(CopyAxis<T>::cell_of(code_x) + (next_x ? side_x : 0),
                              CopyAxis<T>::cell_of(code_y) + (next_y ? side_y : 0));
            const double nodes_x = grid.origin_nodes_x + offset.x * grid.n,
                         nodes_y = grid.origin_nodes_y + offset.y * grid.n;
            if (!of_cells_ && !of_pixels_) {
                take({{first, end}, nodes_x, nodes_y});
                continue;
            }
            for (std::size_t i = first; i < end; ++i)
                if (counts(i)) take({{i, i + 1}, nodes_x, nodes_y});
        }
    }

    void take(const CopyRange& range) {
        CopyRange* last = range_count_ > 0 ? &ranges_[range_count_ - 1] : nullptr;
        if (last && last->points.end == range.points.first && last->nodes_x == range.nodes_x &&
            last->nodes_y == range.nodes_y)
            last->points.end = range.points.end;
        else
            ranges_[range_count_++] = range;
    }

    // Whether a point has a share in the grid: where it has a weight, that of what is read.
    bool counts(std::size_t i) const {
        return (of_cells_ && of_cells_[i] > T(0)) || (of_pixels_ && of_pixels_[i] > T(0));
    }

    const T *of_cells_ = nullptr, *of_pixels_ = nullptr;  // the points' weights
    std::array<CopyRange, Chunk<T>::kPoints> ranges_;
    std::size_t range_count_ = 0;
};

// Adds the wanted fields of a grid at the chunk's points. `args`: the grid with those fields' samples alone, and where the origin
// lies in the tile; `grid`: with all samples.
template <class T>
void add_copies(const GridArgs<T>& grid, GridArgs<T> args, FieldSet wanted, const CopyOrigin& origin,
                CopyPlaces<T>& places, CopyReader<T>& copies, Chunk<T>& chunk,
                const EvaluateKernels<T>& kernels) {
    places.find(origin, chunk, kernels);
    if (places.is_one()) {
        args.origin_nodes_x += places.offset().x * args.n;
        args.origin_nodes_y += places.offset().y * args.n;
        kernels.add_grid(args, chunk);
        return;
    }
    args.samples = grid.samples;
    copies.add(args, wanted, origin, places, chunk, kernels);
}

}  // namespace pelagic
