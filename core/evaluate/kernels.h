// The loops over points that evaluate() spends its time in, in the vectors of the CPU at hand (Highway,
// chosen at run time). All work on one Chunk.
#pragma once

#include <array>
#include <cstddef>

#include "core/evaluate/chunk.h"
#include "core/evaluate/results.h"
#include "core/evaluate/trains.h"
#include "core/plan/plan.h"

namespace pelagic {

// A cascade's grid, to be read at a chunk's points.
template <class T>
struct GridArgs {
    Sampling sampling = Sampling::Spline;
    int taps = 6, n = 1;
    double size_m = 1.0;  // of the tile
    double nodes_per_m = 1.0, origin_nodes_x = 0.0,
           origin_nodes_y = 0.0;                  // where the chunk's origin lies, 0 … n
    std::array<const T*, kFieldCount> samples{};  // as Frame::samples(); null: not wanted
    FieldSet cell_group;                          // fields that cell_weight weighs; pixel_weight the others
    const T *cell_weight = nullptr, *pixel_weight = nullptr;  // by point; null: 1
};

// The chunk's sums, turned into results: what isn't linear, once.
template <class T>
struct DeriveArgs {
    const Chunk<T>* chunk = nullptr;
    const Chunk<T>* breaking = nullptr;  // whose strain is that of the waves that break
    Results<T> results;                  // beginning at the chunk's first point
    HiddenMoments<T> hidden{};           // of all points' pixels, where there is no array
    const HiddenChunk<T>* hidden_of = nullptr;
    T whitecap_threshold = T(0);
    const T* whitecap_threshold_of = nullptr;  // by point, where gusts make them differ
    bool third_moment = true;
};

template <class T>
struct EvaluateKernels {
    void (*add_grid)(const GridArgs<T>&, Chunk<T>&);
    void (*derive)(const DeriveArgs<T>&);
};

// For the CPU that runs this.
template <class T>
EvaluateKernels<T> evaluate_kernels();

}  // namespace pelagic
