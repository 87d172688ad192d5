// The footprints of a chunk's points, kept within a query's levels.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "core/evaluate/chunk.h"
#include "core/evaluate/evaluate.h"
#include "core/plan/taps.h"

namespace pelagic {

// A point's place between two levels of footprints: (1 − t) of the lower one and t of the next.
template <class T>
struct LevelBlend {
    std::size_t lower = 0;
    T t = T(0);
};

template <class T>
LevelBlend<T> level_blend_of(const std::vector<double>& levels_m, T footprint_m) {
    if (levels_m.size() == 1) return {};
    const double wanted = std::min(static_cast<double>(footprint_m), levels_m.back());
    if (!(wanted > levels_m.front())) return {};  // the finest level, also for a footprint that is no number
    const auto above = std::upper_bound(levels_m.begin() + 1, levels_m.end() - 1, wanted);
    const std::size_t upper = static_cast<std::size_t>(above - levels_m.begin());
    const double lower_m = levels_m[upper - 1], upper_m = levels_m[upper];
    return {upper - 1, static_cast<T>((wanted - lower_m) / (upper_m - lower_m))};
}

// width_m and length_m only of an ellipse.
template <class T>
struct Footprint {
    LevelBlend<T> blend;
    bool is_ellipse = false;
    T width_m = T(0), length_m = T(0);
    glm::vec<2, T> axis{};  // unit vector
};

template <class T>
struct ChunkFootprints {
    std::array<Footprint<T>, Chunk<T>::kPoints> of;
    bool any_round = true, any_ellipse = false;

    // Of `count` points from `first` on.
    void take(const std::vector<double>& levels_m, const Strided<const T>& width_m,
              const Strided<const glm::vec<2, T>>& axis_m, double longest_ellipse, std::size_t first,
              std::size_t count) {
        any_round = any_ellipse = false;
        for (std::size_t i = 0; i < count; ++i) {
            of[i] = footprint(levels_m, width_m, axis_m, longest_ellipse, first + i);
            (of[i].is_ellipse ? any_ellipse : any_round) = true;
        }
    }

    // The same points' for the waves that break, with as many levels (PlannedQuery::breaking_levels).
    void take_breaking(const ChunkFootprints& pixels, const Breaking& breaking, std::size_t count) {
        any_round = any_ellipse = false;
        const T least = static_cast<T>(breaking.footprint_m);
        for (std::size_t i = 0; i < count; ++i) {
            of[i] = pixels.of[i];
            of[i].width_m = std::max(of[i].width_m, least);
            of[i].is_ellipse = of[i].is_ellipse && of[i].length_m > of[i].width_m;
            (of[i].is_ellipse ? any_ellipse : any_round) = true;
        }
    }

  private:
    static Footprint<T> footprint(const std::vector<double>& levels_m, const Strided<const T>& width_m,
                                  const Strided<const glm::vec<2, T>>& axis_m, double longest_ellipse,
                                  std::size_t point) {
        Footprint<T> out;
        if (!width_m || levels_m.size() == 1) return out;
        if (axis_m) {
            const T front = static_cast<T>(levels_m.front()), back = static_cast<T>(levels_m.back());
            const glm::vec<2, T> axis = axis_m[point];
            const T whole_m = std::sqrt(axis.x * axis.x + axis.y * axis.y);
            const T length_m = std::min(whole_m, back), least = width_m[point];
            const T own_m = least > front ? least : front;
            if (length_m > own_m && std::isfinite(whole_m)) {
                out.is_ellipse = true;
                out.length_m = length_m;
                out.width_m = std::max(own_m, length_m / static_cast<T>(longest_ellipse));
                out.axis = axis / whole_m;
                out.blend = level_blend_of(levels_m, out.width_m);
                return out;
            }
        }
        out.blend = level_blend_of(levels_m, width_m[point]);
        return out;
    }
};

}  // namespace pelagic
