// The modes that a cascade generates: wavevectors (mx, my)·2π/L with 0 < mx² + my² < R². The sea is real, so
// h(−k) is h(k)'s conjugate and the half mx ≥ 0 is kept: columns of rising mx, my rising from −H to H in
// each. In column 0 a mode and its mirror image both stand (a transform along y wants the whole column), with
// (0, 0), which is no wave, between them.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

namespace pelagic {

// H, the largest my with mx² + my² < radius²; 0 ≤ mx < radius.
inline int half_height(int radius, int mx) {
    const auto square = static_cast<std::int64_t>(radius) * radius - static_cast<std::int64_t>(mx) * mx - 1;
    auto height = static_cast<std::int64_t>(std::sqrt(static_cast<double>(square)));
    while (height * height > square) --height;
    while ((height + 1) * (height + 1) <= square) ++height;
    return static_cast<int>(height);
}

inline std::size_t column_length(int radius, int mx) {
    return 2 * static_cast<std::size_t>(half_height(radius, mx)) + 1;
}

// How many stand in the lattice, (0, 0) and column 0's mirror images included; 0 for radius 0.
inline std::size_t lattice_modes(int radius) {
    std::size_t count = 0;
    for (int mx = 0; mx < radius; ++mx) count += column_length(radius, mx);
    return count;
}

// Whether a place of the lattice stands for a wave of its own and its mirror image: all but (0, 0) and column
// 0's lower half.
inline bool counts_as_wave(int mx, int my) {
    return mx > 0 || my > 0;
}

// What a mode costs in a Sea: h0(k) and conj(h0(−k)), choppiness·coth(kd)/k, and the angular frequency
// (double, so that phases stay exact late in time).
inline std::size_t sea_bytes_per_mode(bool double_precision, bool choppy) {
    const std::size_t scalar = double_precision ? 8 : 4;
    return 4 * scalar + (choppy ? scalar : 0) + sizeof(double);
}

}  // namespace pelagic
