// A cascade's grid read at points that show copies of its tile, at random offsets and blended (core/plan/copies.h).
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>

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
        const auto place = [&](const CopyPlace& from, T rest_m) {
            return copy_place(from.from_middle + static_cast<double>(rest_m) * origin.cells_per_m);
        };
        const CopyPlace x0 = place(origin.x, span.low_x), x1 = place(origin.x, span.high_x);
        const CopyPlace y0 = place(origin.y, span.low_y), y1 = place(origin.y, span.high_y);
        constexpr double kInside = kPlainHalf - 1e-9;  // beyond rounding, in whichever way points are placed
        const auto plain = [&](const CopyPlace& low, const CopyPlace& high) {
            return low.cell == high.cell && low.from_middle > -kInside && high.from_middle < kInside;
        };
        is_one_ = plain(x0, x1) && plain(y0, y1);
        if (is_one_) {
            offset_ = origin.offset(x0.cell, y0.cell);
            return;
        }
        kernels.place_copies({origin.cells_per_m, origin.x.from_middle}, chunk.rest_x.data(), chunk.padded(),
                             x_);
        kernels.place_copies({origin.cells_per_m, origin.y.from_middle}, chunk.rest_y.data(), chunk.padded(),
                             y_);
    }

    // Whether all of the chunk's points show one and the same copy, and its offset.
    bool is_one() const { return is_one_; }
    const CopyOffset<double>& offset() const { return offset_; }
    // Each point's, otherwise.
    const CopyAxis<T>& x() const { return x_; }
    const CopyAxis<T>& y() const { return y_; }

  private:
    bool is_known_ = false, is_one_ = false;
    CopyOffset<double> offset_{0.0, 0.0};
    CopyAxis<T> x_, y_;
};

// Reads a grid at the copies of a chunk's points, which are gathered to chunks of their own.
template <class T>
class CopyChunk {
  public:
    // `grid`: with the samples of all its fields, its origin and its weights by point. Adds `wanted`.
    void add(const GridArgs<T>& grid, FieldSet wanted, const CopyOrigin& origin, const CopyPlaces<T>& places,
             Chunk<T>& to, const EvaluateKernels<T>& kernels) {
        begin(grid, wanted);
        const CopyAxis<T>&x = places.x(), &y = places.y();
        for (int copy = 0; copy < 4; ++copy) {
            const bool next_x = copy & 1, next_y = copy & 2;
            std::int64_t cell_x = 0, cell_y = 0;
            glm::dvec2 nodes(0.0);
            bool has_cell = false;
            for (std::size_t i = 0; i < to.count; ++i) {
                const T weight_x = next_x ? x.next[i] : x.own[i], weight_y = next_y ? y.next[i] : y.own[i];
                if (!(weight_x > T(0) && weight_y > T(0)) || !counts(i)) continue;
                const std::int64_t at_x = x.cell[i] + (next_x ? side_of(x.rate[i]) : 0);
                const std::int64_t at_y = y.cell[i] + (next_y ? side_of(y.rate[i]) : 0);
                if (!has_cell || at_x != cell_x || at_y != cell_y) {
                    const CopyOffset<double> offset = origin.offset(at_x, at_y);
                    nodes = {grid.origin_nodes_x + offset.x * grid.n,
                             grid.origin_nodes_y + offset.y * grid.n};
                    cell_x = at_x;
                    cell_y = at_y;
                    has_cell = true;
                }
                const std::size_t at = copies_.count++;
                copies_.rest_x[at] = to.rest_x[i];
                copies_.rest_y[at] = to.rest_y[i];
                nodes_x_[at] = nodes.x;
                nodes_y_[at] = nodes.y;
                weight_[at] = weight_x * weight_y;
                slope_x_[at] = (next_x ? x.own[i] : -x.next[i]) * x.rate[i] * weight_y;
                slope_y_[at] = (next_y ? y.own[i] : -y.next[i]) * y.rate[i] * weight_x;
                point_[at] = static_cast<std::uint16_t>(i);
                if (copies_.count == Chunk<T>::kPoints) flush(grid, to, kernels);
            }
        }
        flush(grid, to, kernels);
    }

  private:
    // The neighbour lies where the weights change to.
    static int side_of(T rate) { return rate < T(0) ? -1 : 1; }
    // Whether a point has a share in the grid: where it has a weight, that of what is read.
    bool counts(std::size_t i) const {
        return (!of_cells_ && !of_pixels_) || (of_cells_ && of_cells_[i] > T(0)) ||
               (of_pixels_ && of_pixels_[i] > T(0));
    }

    void begin(const GridArgs<T>& grid, FieldSet wanted) {
        args_ = grid;
        of_cells_ = (wanted & cell_fields()).any() ? grid.cell_weight : nullptr;
        of_pixels_ = (wanted & ~cell_fields()).any() ? grid.pixel_weight : nullptr;
        const FieldSet read = wanted | gradient_fields(wanted);
        for (std::size_t f = 0; f < kFieldCount; ++f) {
            if (!read[f]) args_.samples[f] = nullptr;
            wanted_[f] = wanted[f] && args_.samples[f];
            read_[f] = args_.samples[f] != nullptr;
        }
        args_.cell_weight = args_.pixel_weight = nullptr;
        args_.nodes_x = nodes_x_.data();
        args_.nodes_y = nodes_y_.data();
        copies_.count = 0;
    }

    void flush(const GridArgs<T>& grid, Chunk<T>& to, const EvaluateKernels<T>& kernels) {
        const std::size_t count = copies_.count, padded = copies_.padded();
        if (count == 0) return;
        for (std::size_t at = count; at < padded; ++at) copies_.rest_x[at] = copies_.rest_y[at] = T(0);
        for (std::size_t at = count; at < padded; ++at) nodes_x_[at] = nodes_y_[at] = 0.0;
        for (std::size_t f = 0; f < kFieldCount; ++f)
            if (read_[f]) std::fill(copies_.sums[f].begin(), copies_.sums[f].begin() + padded, T(0));
        kernels.add_grid(args_, copies_);
        for (std::size_t f = 0; f < kFieldCount; ++f) {
            if (!wanted_[f]) continue;
            const T* share = weight_of(grid, f);
            const T* along = nullptr;
            const T* of = nullptr;
            for (const Gradient& gradient : kGradients) {
                if (index(gradient.derivative) != f || !read_[index(gradient.of)]) continue;
                along = gradient.along_y ? slope_y_.data() : slope_x_.data();
                of = copies_.sums[index(gradient.of)].data();
            }
            const T* own = copies_.sums[f].data();
            T* sums = to.sums[f].data();
            for (std::size_t at = 0; at < count; ++at) {
                T sum = weight_[at] * own[at];
                if (along) sum += along[at] * of[at];
                sums[point_[at]] += share ? share[point_[at]] * sum : sum;
            }
        }
        if (wanted_[index(Field::Dxy)] && read_[index(Field::Dx)]) {
            const T *share = weight_of(grid, index(Field::Dxy)), *dx = copies_.sums[index(Field::Dx)].data(),
                    *dy = copies_.sums[index(Field::Dy)].data();
            for (std::size_t at = 0; at < count; ++at) {
                const T turn = slope_x_[at] * dy[at] - slope_y_[at] * dx[at];
                to.turn[point_[at]] += share ? share[point_[at]] * turn : turn;
            }
        }
        copies_.count = 0;
    }

    GridArgs<T> args_;
    FieldSet wanted_, read_;
    const T *of_cells_ = nullptr, *of_pixels_ = nullptr;  // the points' weights
    Chunk<T> copies_;
    alignas(64) std::array<double, Chunk<T>::kPoints> nodes_x_, nodes_y_;
    typename Chunk<T>::Values weight_, slope_x_, slope_y_;
    std::array<std::uint16_t, Chunk<T>::kPoints> point_;
};

// Adds the wanted fields of a grid at the chunk's points. `args`: the grid with those fields' samples alone, and where the origin
// lies in the tile; `grid`: with all samples.
template <class T>
void add_copies(const GridArgs<T>& grid, GridArgs<T> args, FieldSet wanted, const CopyOrigin& origin,
                CopyPlaces<T>& places, CopyChunk<T>& copies, Chunk<T>& chunk,
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
