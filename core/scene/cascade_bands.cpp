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

int sufficient_resolution(double size_m, double next_lower_edge) {
    const double modes = next_lower_edge * size_m / (2.0 * std::numbers::pi);
    // Where the bound is met exactly, rounding in the edge must not ask for two samples more.
    constexpr double kRounding = 1e-12;
    const double half = std::ceil((modes + 0.5) * (1.0 - kRounding));
    constexpr double kLargestHalf = std::numeric_limits<int>::max() / 2;
    if (!(half < kLargestHalf)) return std::numeric_limits<int>::max() - 1;
    return std::max(kMinCascadeResolution, 2 * static_cast<int>(half));
}

}  // namespace pelagic
