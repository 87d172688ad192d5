// A few hundred points on their way through evaluate(): small enough for the first-level cache, each quantity
// side by side so that vectors read and write it whole.
#pragma once

#include <array>
#include <cstddef>

#include "core/plan/fields.h"

namespace pelagic {

template <class T>
struct Chunk {
    static constexpr std::size_t kPoints = 256;  // a multiple of every vector's length
    using Values = std::array<T, kPoints>;

    static constexpr std::size_t kLongestVector = 64 / sizeof(T);

    // 1 … kPoints. Vectors work on whole multiples of their length: values beyond, up to padded(), are finite and
    // unused.
    std::size_t count = 0;
    static constexpr std::size_t padded(std::size_t count) {
        return (count + kLongestVector - 1) / kLongestVector * kLongestVector;
    }
    std::size_t padded() const { return padded(count); }

    // [m], relative to the query's origin; with room for a vector that begins at the last point.
    alignas(64) std::array<T, kPoints + kLongestVector> rest_x, rest_y;
    // Σ over the components so far, by field; only the wanted ones are set.
    alignas(64) std::array<Values, kFieldCount> sums;
    alignas(64) Values turn;  // ∂Dy/∂x − ∂Dx/∂y: 0 except where tiles blend (core/plan/random_tiling.h)
};

}  // namespace pelagic
