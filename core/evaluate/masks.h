// Calm and rough places at a chunk's points (core/plan/masks.h).
#pragma once

#include <glm/vec2.hpp>
#include <span>

#include "core/evaluate/chunk.h"
#include "core/plan/masks.h"
#include "core/plan/wake_strip.h"

namespace pelagic {

// The masks' gains at a chunk's points.
template <class T>
struct MaskChunk {
    using Values = typename Chunk<T>::Values;
    alignas(64) Values waves, x, y, ripples, foam;  // x, y: how `waves` changes with the place [1/m]
    bool has_edges = false, has_ripples = false;    // whether that isn't 0 somewhere, or `ripples` not 1

    // Whether any of them changes anything there.
    bool take(const MasksPlan& plan, std::span<const WakeStrip> strips, glm::dvec2 origin_m,
              const Chunk<T>& chunk);
};

// Multiplies the sums by the gain of waves. `values`: heights and horizontal displacements in the footprints of the derivatives.
template <class T>
void mask_sums(const MaskChunk<T>& masks, const Chunk<T>& values, Chunk<T>& chunk);

}  // namespace pelagic
