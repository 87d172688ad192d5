// The height of the waves that a mesh leaves unresolved, by the length of its cells. It decides how long cells may be
// far away, where a camera sees waves from the side.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace pelagic {

struct UnresolvedHeight {
    static constexpr std::size_t kCells = 24;
    // The standard deviation of the waves that cells of cell_m(i) leave unresolved [m]: rising. All 0: a calm.
    std::array<double, kCells> deviation_m{};
    bool operator==(const UnresolvedHeight&) const = default;

    // Powers of two, from 4 mm to 32 km.
    static double cell_m(std::size_t i) { return std::ldexp(1.0, static_cast<int>(i) - 8); }

    // The longest cells that leave no more than this unresolved [m], > 0; infinite where all waves together are no
    // higher. Between the table's cells, and below its first, by powers of their length.
    double longest_cell_m(double height_m) const {
        if (height_m >= deviation_m.back()) return std::numeric_limits<double>::infinity();
        const auto above = static_cast<std::size_t>(
            std::upper_bound(deviation_m.begin(), deviation_m.end(), height_m) - deviation_m.begin());
        const double high_m = deviation_m[above], low_m = above > 0 ? deviation_m[above - 1] : 0.0;
        const double octaves = low_m > 0.0 ? std::log2(high_m / low_m) : 1.0;
        return cell_m(above) * std::exp2(std::max(std::log2(height_m / high_m) / octaves, -8.0));
    }
};

}  // namespace pelagic
