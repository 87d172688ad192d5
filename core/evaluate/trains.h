// The trains' part of the query: their fields at a chunk's points.
#pragma once

#include <cstddef>

#include "core/evaluate/chunk.h"
#include "core/plan/filter.h"
#include "core/waves/coast.h"
#include "core/waves/trains.h"

namespace pelagic {

// What the points' pixels leave unresolved, by point; rows parallel to kUnresolvedMoments.
template <class T>
struct UnresolvedChunk {
    alignas(64) std::array<typename Chunk<T>::Values, kUnresolvedMoments.size()> moments;
};

template <class T>
struct TrainArgs {
    const Trains<T>* trains = nullptr;
    // Where given, the trains go by it: their local lengths, ways and heights. Points are then from an origin in the world.
    const Coast<T>* coast = nullptr;
    glm::dvec2 origin_m{0.0};
    const double* start_cycles = nullptr;  // phases_at() the chunk's origin and the frame's time
    FootprintFilter filter{};
    FieldSet wanted{};
    // Footprints [m] of all points, or of each in the chunk's order, where there is an array. Cells filter
    // positions and velocities, pixels the derivatives.
    T cell_m = T(0), pixel_m = T(0);
    const T* cell_of = nullptr;   // padded() long; values beyond the chunk's count are not used
    const T* pixel_of = nullptr;  // the same
    // Of footprints that are ellipses, beside their widths: the direction of the long axis times √(length² − width²),
    // so that the ellipse is √(width² + (stretch · k̂)²) long along k̂. As cell_of and pixel_of; null: round.
    struct Stretch {
        const T *x = nullptr, *y = nullptr;
    };
    Stretch cell_stretch{}, pixel_stretch{};
    // Where given: what pixel_of (or pixel_m) leaves unresolved.
    UnresolvedChunk<T>* unresolved = nullptr;
    // Where given, it gets the displacement gradient of the waves that break. Its points at rest are the chunk's.
    Chunk<T>* breaking = nullptr;
};

// Adds the wanted fields to chunk.sums, and says how many times a train was evaluated at a point: those of
// which something passes, and no others. A point's result depends on nothing but the point (and the
// instruction set). In vectors, by the best instructions of this CPU.
template <class T>
std::size_t add_trains(const TrainArgs<T>& args, Chunk<T>& chunk);

}  // namespace pelagic
