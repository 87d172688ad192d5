// The modes that a cascade generates: wavevectors (mx, my)·2π/L with 0 < mx² + my² ≤ R². The sea is real, so
// h(−k) is h(k)'s conjugate and half of the disc is kept: my > 0, and my = 0 with mx > 0. Rows of rising my,
// mx rising in each.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

namespace pelagic {

// The largest mx with mx² + my² ≤ radius²; 0 ≤ my ≤ radius.
inline int half_width(int radius, int my) {
    const auto square = static_cast<std::int64_t>(radius) * radius - static_cast<std::int64_t>(my) * my;
    auto width = static_cast<std::int64_t>(std::sqrt(static_cast<double>(square)));
    while (width * width > square) --width;
    while ((width + 1) * (width + 1) <= square) ++width;
    return static_cast<int>(width);
}

inline int row_first(int radius, int my) {
    return my == 0 ? 1 : -half_width(radius, my);
}
inline int row_length(int radius, int my) {
    return half_width(radius, my) - row_first(radius, my) + 1;
}

inline std::size_t half_plane_modes(int radius) {
    std::size_t count = 0;
    for (int my = 0; radius > 0 && my <= radius; ++my)
        count += static_cast<std::size_t>(row_length(radius, my));
    return count;
}

// What a mode costs in a Sea: h0(k) and conj(h0(−k)), choppiness·coth(kd)/k, and the angular frequency
// (double, so that phases stay exact late in time).
inline std::size_t sea_bytes_per_mode(bool double_precision, bool choppy) {
    const std::size_t scalar = double_precision ? 8 : 4;
    return 4 * scalar + (choppy ? scalar : 0) + sizeof(double);
}

}  // namespace pelagic
