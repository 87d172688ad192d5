// Integer points inside and outside a circle.
#pragma once

#include <cmath>

namespace pelagic {

// The smallest integer y ≥ 0 with x² + y² ≥ square, but at most `most`.
inline int first_beyond(double square, int x, int most) {
    const double rest = square - static_cast<double>(x) * x;
    if (!(rest > 0.0)) return 0;
    if (rest > static_cast<double>(most) * most) return most;
    auto y = static_cast<int>(std::ceil(std::sqrt(rest)));
    while (y > 0 && static_cast<double>(y - 1) * (y - 1) >= rest) --y;
    while (static_cast<double>(y) * y < rest) ++y;
    return y < most ? y : most;
}

}  // namespace pelagic
