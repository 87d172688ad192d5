// The loops over points that evaluate() spends its time in, in the vectors of the CPU at hand (Highway,
// chosen at run time). All work on one Chunk.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "core/evaluate/chunk.h"
#include "core/evaluate/results.h"
#include "core/evaluate/trains.h"
#include "core/plan/plan.h"

namespace pelagic {

// Of a chunk's points.
struct PointRange {
    std::size_t first, end;  // `end` isn't one of them
};

// Successive points that read one shifted tile of a grid, and where the chunk's origin lies in it [nodes]. Those of
// `own` lie in the tile's own cell, those before and behind in cells beside it along x.
struct TilingRange {
    PointRange points, own;
    double nodes_x, nodes_y;
};

// The tiles that a chunk's points read: along y those of one cell, along x those of both, with their blending weights
// (core/plan/random_tiling.h). All arrays of T are by point, as long as a chunk's padded().
template <class T>
struct TilingArgs {
    // Along an axis: the tile's weight, and that of the other one beside it; how they change with the place [1/m];
    // and the sign of this tile's change.
    struct Axis {
        const T *weight, *other, *rate;
        T sign;
    };
    // The tile of a point's own cell along x, or of the cell beside it; the points that read it, in order.
    struct Side {
        Axis x;
        const PointRange* points;
        std::size_t count;
    };
    std::array<Side, 2> sides;  // own, next
    Axis y;
    const TilingRange* ranges;
    std::size_t range_count;
    FieldSet wanted;  // fields that are added; samples hold what their gradients need as well
};

// Where a row of points lies along x in a grid, and its splines' weights there: kept for the next row of a patch, whose points have
// the same x.
template <class T>
struct RowPlaces {
    static constexpr std::size_t kRoom = 2 * Chunk<T>::kPoints + Chunk<T>::kLongestVector;
    static constexpr std::size_t kParts = 32, kRuns = 64, kTaps = 6;
    using Index = std::conditional_t<sizeof(T) == 4, std::int32_t, std::int64_t>;

    // The first and the last one that begins a point's columns.
    struct Columns {
        Index low, high;
    };
    // Points that are read together, and the index of their first columns in `vectors`.
    struct Run {
        PointRange points;
        Columns columns;
        std::size_t vector;
    };
    // Successive points in one shifted tile. Their values stand from `at` on.
    struct Part {
        PointRange points;
        double nodes_x;
        std::size_t at, first_run, end_run;
    };

    alignas(64) std::array<Index, kRoom> column;  // each point's first
    alignas(64) std::array<std::array<T, kRoom>, kTaps> weight;
    std::array<Columns, kRoom> vectors;  // of the points of runs
    std::array<Run, kRuns> runs;
    std::array<Part, kParts> parts;
    std::size_t part_count = 0;
    std::uint64_t row = 0;  // whose points' x these are; 0: nobody's
};

// A cascade's grid, to be read at a chunk's points.
template <class T>
struct GridArgs {
    Sampling sampling = Sampling::Spline;
    int taps = 6, n = 1;
    double size_m = 1.0;  // of the tile
    double nodes_per_m = 1.0, origin_nodes_x = 0.0,
           origin_nodes_y = 0.0;                  // where the chunk's origin lies, 0 … 2n
    std::array<const T*, kFieldCount> samples{};  // as Frame::samples(); null: not wanted
    FieldSet cell_group;                          // fields that cell_weight weighs; pixel_weight the others
    const T *cell_weight = nullptr, *pixel_weight = nullptr;  // by point; null: 1
    const TilingArgs<T>* tiling = nullptr;                    // null: all points read the tile itself
    RowPlaces<T>* places =
        nullptr;  // where they are kept for chunks of the same x, which have the same `row`
    std::uint64_t row = 0;
};

// The points' weight in a field; null: 1.
template <class T>
const T* weight_of(const GridArgs<T>& args, std::size_t field) {
    return args.cell_group[field] ? args.cell_weight : args.pixel_weight;
}

// The least and the greatest of a chunk's coordinates, where all of them are finite.
template <class T>
struct ChunkSpan {
    T low_x, high_x, low_y, high_y;
    bool is_finite = true;
};

// Along an axis, which cells' tiles a chunk's points read (core/plan/random_tiling.h), and their BlendWeights.
template <class T>
struct TilingAxis {
    using Code = std::conditional_t<sizeof(T) == 4, std::int32_t, std::int64_t>;
    // Four times the cell in which each point lies, counted from the origin's, plus the side of the other tile that
    // it reads: 1, above; 3, below; 0, none.
    alignas(64) std::array<Code, Chunk<T>::kPoints> code;
    alignas(64) typename Chunk<T>::Values own, next,
        rate;  // rate: signed, as the weights change with the place [1/m]

    static std::int64_t cell_of(Code code) { return code >> 2; }
    static int side_of(Code code) { return (code & 3) == 3 ? -1 : static_cast<int>(code & 3); }
};
// Where the points' origin lies in its cell, and how large cells are.
struct TilingAxisArgs {
    double cells_per_m = 1.0, origin_from_middle = 0.0;
};

// The chunk's sums, turned into results: what isn't linear, once.
template <class T>
struct DeriveArgs {
    const Chunk<T>* chunk = nullptr;
    const Chunk<T>* breaking = nullptr;  // whose displacement gradient is that of the waves that break
    Results<T> results;                  // beginning at the chunk's first point
    UnresolvedMoments<T> unresolved{};   // of all points' pixels, where there is no array
    const UnresolvedChunk<T>* unresolved_of = nullptr;
    T whitecap_threshold = T(0);
    const T* whitecap_threshold_of = nullptr;  // by point, where gusts make them differ
    bool third_moment = true;
    Strided<const glm::vec<3, T>> rest_normal{};  // as in Points, beginning at the chunk's first point
};

template <class T>
struct EvaluateKernels {
    void (*add_grid)(const GridArgs<T>&, Chunk<T>&);
    void (*derive)(const DeriveArgs<T>&);
    ChunkSpan<T> (*span_of)(const Chunk<T>&);
    // Of `count` points that rest there [m], a multiple of every vector's length.
    void (*place_tiles)(const TilingAxisArgs&, const T* rest_m, std::size_t count, TilingAxis<T>&);
};

// For the CPU that runs this.
template <class T>
EvaluateKernels<T> evaluate_kernels();

}  // namespace pelagic
