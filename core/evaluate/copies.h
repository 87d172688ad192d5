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
        for (std::size_t first = 0, end; first < to.count; first = end) {
            end = first + 1;
            if (has_shares_ && !counts(first)) continue;
            // Points that show the same copies, one after another.
            const auto code_x = x.code[first], code_y = y.code[first];
            while (end < to.count && x.code[end] == code_x && y.code[end] == code_y &&
                   !(has_shares_ && !counts(end)))
                ++end;
            const std::int64_t cell_x = CopyAxis<T>::cell_of(code_x), cell_y = CopyAxis<T>::cell_of(code_y);
            const int side_x = CopyAxis<T>::side_of(code_x), side_y = CopyAxis<T>::side_of(code_y);
            // A call of its own for these, without the way by way of copies_.
            constexpr std::size_t kLong = 16;
            if (side_x == 0 && side_y == 0 && end - first >= kLong && grid.sampling == Sampling::Spline) {
                const CopyOffset<double> offset = origin.offset(cell_x, cell_y);
                GridArgs<T> part = plain_;
                part.origin_nodes_x += offset.x * grid.n;
                part.origin_nodes_y += offset.y * grid.n;
                part.first = first;
                part.count = end - first;
                kernels.add_grid(part, to);
                continue;
            }
            for (const bool next_y : {false, true})
                for (const bool next_x : {false, true}) {
                    if ((next_x && side_x == 0) || (next_y && side_y == 0)) continue;
                    const CopyOffset<double> offset =
                        origin.offset(cell_x + (next_x ? side_x : 0), cell_y + (next_y ? side_y : 0));
                    const glm::dvec2 nodes(grid.origin_nodes_x + offset.x * grid.n,
                                           grid.origin_nodes_y + offset.y * grid.n);
                    for (std::size_t i = first; i < end;) {
                        const std::size_t room = Chunk<T>::kPoints - copies_.count,
                                          count = std::min(end - i, room);
                        take({static_cast<std::uint16_t>(i), static_cast<std::uint16_t>(copies_.count),
                              static_cast<std::uint16_t>(count)},
                             nodes, next_x, next_y, places, to);
                        i += count;
                        if (copies_.count == Chunk<T>::kPoints) flush(grid, to, kernels);
                    }
                }
        }
        flush(grid, to, kernels);
    }

  private:
    // Points of a chunk one after another, and where the copy that they show stands.
    struct Stretch {
        std::uint16_t point, at, count;
    };

    void take(const Stretch& stretch, glm::dvec2 nodes, bool next_x, bool next_y, const CopyPlaces<T>& places,
              const Chunk<T>& to) {
        const std::size_t at = copies_.count, from = stretch.point, count = stretch.count;
        stretches_[stretch_count_++] = stretch;
        copies_.count += count;
        std::copy_n(to.rest_x.begin() + from, count, copies_.rest_x.begin() + at);
        std::copy_n(to.rest_y.begin() + from, count, copies_.rest_y.begin() + at);
        std::fill_n(nodes_x_.begin() + at, count, nodes.x);
        std::fill_n(nodes_y_.begin() + at, count, nodes.y);
        const CopyAxis<T>&x = places.x(), &y = places.y();
        const T *weight_x = (next_x ? x.next : x.own).data() + from,
                *weight_y = (next_y ? y.next : y.own).data() + from;
        const T *other_x = (next_x ? x.own : x.next).data() + from,
                *other_y = (next_y ? y.own : y.next).data() + from;
        const T *rate_x = x.rate.data() + from, *rate_y = y.rate.data() + from;
        const T sign_x = next_x ? T(1) : T(-1), sign_y = next_y ? T(1) : T(-1);
        T *__restrict weight = weight_.data() + at, *__restrict slope_x = slope_x_.data() + at,
                      *__restrict slope_y = slope_y_.data() + at;
        for (std::size_t i = 0; i < count; ++i) weight[i] = weight_x[i] * weight_y[i];
        if (!has_gradient_) return;
        for (std::size_t i = 0; i < count; ++i) {
            slope_x[i] = sign_x * other_x[i] * rate_x[i] * weight_y[i];
            slope_y[i] = sign_y * other_y[i] * rate_y[i] * weight_x[i];
        }
    }

    // Adds Σ a·b over the copies to the points' sums, times their shares.
    struct Term {
        const T *a, *b;
    };
    void add_up(Term first, Term second, T sign, const T* share, T* sums) const {
        for (std::size_t s = 0; s < stretch_count_; ++s) {
            const auto [point, at, count] = stretches_[s];
            const T *a = first.a + at, *b = first.b + at;
            T* __restrict to = sums + point;
            alignas(64) typename Chunk<T>::Values sum;
            T* __restrict of = sum.data();
            if (second.a) {
                const T *c = second.a + at, *d = second.b + at;
                for (std::size_t i = 0; i < count; ++i) of[i] = a[i] * b[i] + sign * (c[i] * d[i]);
            } else {
                for (std::size_t i = 0; i < count; ++i) of[i] = a[i] * b[i];
            }
            if (share) {
                const T* by = share + point;
                for (std::size_t i = 0; i < count; ++i) to[i] += by[i] * of[i];
            } else {
                for (std::size_t i = 0; i < count; ++i) to[i] += of[i];
            }
        }
    }

    // Whether a point has a share in the grid: where it has a weight, that of what is read.
    bool counts(std::size_t i) const {
        return (of_cells_ && of_cells_[i] > T(0)) || (of_pixels_ && of_pixels_[i] > T(0));
    }

    void begin(const GridArgs<T>& grid, FieldSet wanted) {
        args_ = grid;
        of_cells_ = (wanted & cell_fields()).any() ? grid.cell_weight : nullptr;
        of_pixels_ = (wanted & ~cell_fields()).any() ? grid.pixel_weight : nullptr;
        has_shares_ = of_cells_ || of_pixels_;
        const FieldSet read = wanted | gradient_fields(wanted);
        for (std::size_t f = 0; f < kFieldCount; ++f) {
            if (!read[f]) args_.samples[f] = nullptr;
            wanted_[f] = wanted[f] && args_.samples[f];
            read_[f] = args_.samples[f] != nullptr;
        }
        plain_ = args_;
        for (std::size_t f = 0; f < kFieldCount; ++f)
            if (!wanted_[f]) plain_.samples[f] = nullptr;
        args_.cell_weight = args_.pixel_weight = nullptr;
        args_.nodes_x = nodes_x_.data();
        args_.nodes_y = nodes_y_.data();
        has_gradient_ = gradient_fields(wanted).any();
        copies_.count = stretch_count_ = 0;
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
            Term gradient{nullptr, nullptr};
            for (const Gradient& row : kGradients)
                if (index(row.derivative) == f && read_[index(row.of)])
                    gradient = {row.along_y ? slope_y_.data() : slope_x_.data(),
                                copies_.sums[index(row.of)].data()};
            add_up({weight_.data(), copies_.sums[f].data()}, gradient, T(1), weight_of(grid, f),
                   to.sums[f].data());
        }
        if (wanted_[index(Field::Dxy)] && read_[index(Field::Dx)])
            add_up({slope_x_.data(), copies_.sums[index(Field::Dy)].data()},
                   {slope_y_.data(), copies_.sums[index(Field::Dx)].data()}, T(-1),
                   weight_of(grid, index(Field::Dxy)), to.turn.data());
        copies_.count = stretch_count_ = 0;
    }

    GridArgs<T> args_, plain_;  // to read copies, and where there is but one
    FieldSet wanted_, read_;
    const T *of_cells_ = nullptr, *of_pixels_ = nullptr;  // the points' weights
    Chunk<T> copies_;
    alignas(64) std::array<double, Chunk<T>::kPoints> nodes_x_, nodes_y_;
    typename Chunk<T>::Values weight_, slope_x_, slope_y_;
    bool has_gradient_ = false, has_shares_ = false;
    std::array<Stretch, Chunk<T>::kPoints> stretches_;
    std::size_t stretch_count_ = 0;
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
