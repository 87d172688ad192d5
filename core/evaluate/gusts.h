// Gusts at points (core/waves/gusts.h), in the vectors of the CPU at hand.
#pragma once

#include <array>
#include <cstddef>
#include <glm/vec2.hpp>
#include <span>

#include "core/base/strided.h"
#include "core/evaluate/chunk.h"
#include "core/evaluate/evaluate.h"
#include "core/waves/gusts.h"

namespace pelagic {

// A chunk of points: their pixels, and then the effect of gusts there.
template <class T>
struct GustChunk {
    using Values = typename Chunk<T>::Values;
    alignas(64) Values width_m, axis_x, axis_y;  // of each point's pixel; axes only where there are ellipses
    alignas(64) Values factor, whitecap_threshold;  // out
    bool has_ellipses = false;

    // Footprints of points from `first` on; without their own `only_m`.
    void take(const Points<T>& points, T only_m, std::size_t first, std::size_t count);
};

// The phases of the pattern's waves at the points' origin, and where that is from the middles of fronts [m].
struct GustPhases {
    std::array<double, GustsPlan::kWaves> cycles{};
    GustsPlan::FromFronts from_fronts{};
};
GustPhases gust_phases(const GustsPlan& plan, glm::dvec2 origin_m, double time_within_loop_s);

// Of the chunk's points at rest, up to `padded`.
template <class T>
struct GustArgs {
    const Gusts* gusts = nullptr;
    const GustPhases* phases = nullptr;
    const T *rest_x = nullptr, *rest_y = nullptr;  // [m], aligned
    std::size_t padded = 0;
};
template <class T>
void gusts_at(const GustArgs<T>& args, GustChunk<T>& chunk);

// The threshold with which J is compared at each point, for callers that have moments of J of their own. `pixel_m`:
// the footprint of all points.
template <class T>
void whitecap_thresholds(const Gusts& gusts, double time_within_loop_s, const Points<T>& points,
                         double pixel_m, std::span<float> thresholds);

}  // namespace pelagic
