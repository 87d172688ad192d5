// Which wavenumbers each cascade holds. See cascade_bands.h.
#include "core/scene/cascade_bands.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

namespace pelagic {

std::vector<double> lower_edges(std::span<const double> sizes_m) {
    std::vector<double> edges(sizes_m.size(), 0.0);
    for (std::size_t i = 1; i < sizes_m.size(); ++i) {
        edges[i] = 2.0 * std::numbers::pi * kBandModes / sizes_m[i];
    }
    return edges;
}

int modes_within(double size_m, double edge) {
    const double modes = edge * size_m / (2.0 * std::numbers::pi) + std::sqrt(0.5);
    // Where the bound is met exactly, rounding in the edge must not add a mode.
    constexpr double kRounding = 1e-12;
    const double whole = std::ceil(modes * (1.0 - kRounding));
    constexpr double kLargest = std::numeric_limits<int>::max() / 4;
    return static_cast<int>(std::min(whole, kLargest));
}

int sufficient_resolution(double size_m, double next_lower_edge) {
    return std::max(kMinCascadeResolution, 2 * (modes_within(size_m, next_lower_edge) + 1));
}

}  // namespace pelagic
