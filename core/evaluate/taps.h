// The taps of a chunk's ellipses in one grid, gathered to chunks that the grid is then read at.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "core/evaluate/footprints.h"
#include "core/evaluate/kernels.h"
#include "core/evaluate/random_tiling.h"

namespace pelagic {

template <class T>
class TapChunk {
  public:
    // origin_nodes: where the points' origin lies in the grid. `tiling`: of a cascade with random tiling; otherwise
    // null.
    void begin(const GridArgs<T>& grid, glm::dvec2 origin_nodes, FieldSet fields, const TilingOrigin* tiling,
               const EvaluateKernels<T>& kernels) {
        whole_ = args_ = grid;
        kernels_ = &kernels;
        tiling_ = tiling;
        fields_ = FieldSet();
        for (std::size_t f = 0; f < kFieldCount; ++f) {
            if (!fields[f]) args_.samples[f] = nullptr;
            fields_[f] = args_.samples[f] != nullptr;
        }
        args_.origin_nodes_x = origin_nodes.x;
        args_.origin_nodes_y = origin_nodes.y;
        turns_ = tiling && fields_[index(Field::Dxy)];
        taps_.count = 0;
    }

    // Point i of `to`, which has this share in the grid. whole_m: of its cascade.
    void add(std::size_t i, const Footprint<T>& footprint, T share, T whole_m, Chunk<T>& to) {
        if (fields_.none()) return;  // a tile without choppiness has no displacement gradient
        const Taps<T> taps = taps_of(std::max(footprint.width_m, whole_m), footprint.length_m);
        const int last = last_tap(static_cast<double>(taps.reach));
        for (int j = -last; j <= last; ++j) {
            const T way = static_cast<T>(j) * taps.spacing_m;
            const std::size_t at = taps_.count++;
            taps_.rest_x[at] = to.rest_x[i] + way * footprint.axis.x;
            taps_.rest_y[at] = to.rest_y[i] + way * footprint.axis.y;
            weight_[at] = share * tap_weight(taps.reach, static_cast<T>(j));
            point_[at] = static_cast<std::uint16_t>(i);
            if (taps_.count == Chunk<T>::kPoints) flush(to);
        }
    }

    // Reads what was gathered, into the sums of `to`.
    void flush(Chunk<T>& to) {
        const std::size_t count = taps_.count, padded = taps_.padded();
        if (count == 0) return;
        std::fill(taps_.rest_x.begin() + count, taps_.rest_x.begin() + padded, T(0));
        std::fill(taps_.rest_y.begin() + count, taps_.rest_y.begin() + padded, T(0));
        for (std::size_t f = 0; f < kFieldCount; ++f)
            if (fields_[f]) std::fill(taps_.sums[f].begin(), taps_.sums[f].begin() + padded, T(0));
        if (turns_) std::fill(taps_.turn.begin(), taps_.turn.begin() + padded, T(0));
        if (tiling_) {
            places_.forget(0);
            add_tiles(whole_, args_, fields_, *tiling_, places_, tiling_reader_, taps_, *kernels_);
        } else {
            kernels_->add_grid(args_, taps_);
        }
        for (std::size_t f = 0; f < kFieldCount; ++f) {
            if (!fields_[f]) continue;
            for (std::size_t at = 0; at < count; ++at)
                to.sums[f][point_[at]] += weight_[at] * taps_.sums[f][at];
        }
        for (std::size_t at = 0; turns_ && at < count; ++at)
            to.turn[point_[at]] += weight_[at] * taps_.turn[at];
        taps_.count = 0;
    }

  private:
    GridArgs<T> args_, whole_;  // the wanted samples, and all
    const EvaluateKernels<T>* kernels_ = nullptr;
    const TilingOrigin* tiling_ = nullptr;
    bool turns_ = false;
    TilingPlaces<T> places_;
    TilingReader<T> tiling_reader_;
    FieldSet fields_;
    Chunk<T> taps_;
    typename Chunk<T>::Values weight_;
    std::array<std::uint16_t, Chunk<T>::kPoints> point_;
};

}  // namespace pelagic
