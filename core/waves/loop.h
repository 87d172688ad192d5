// Exact loops: in a loop of T seconds every wave makes a whole number of cycles (Tessendorf 2001, §4).
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/constants.h"

namespace pelagic {

// ω [rad/s] in cycles per second. In a loop (loop_s > 0) it is rounded to a whole number of cycles, at least
// one, so that slow waves don't freeze.
inline double looped_cycles_per_s(double omega, double loop_s) {
    const double cycles = omega / kTwoPi;
    return loop_s > 0.0 ? std::max(1.0, std::round(cycles * loop_s)) / loop_s : cycles;
}

// t modulo the loop, so that the last frame and the first meet bit for bit; t itself without a loop.
inline double time_within_loop_s(double t_s, double loop_s) {
    if (!(loop_s > 0.0)) return t_s;
    const double reduced_s = t_s - loop_s * std::floor(t_s / loop_s);
    // Allows for the rounding of (f − 1)/fps and of the division.
    const double same_s = 4.0 * std::numeric_limits<double>::epsilon() * std::max(std::abs(t_s), loop_s);
    return loop_s - reduced_s < same_s || reduced_s < same_s ? 0.0 : reduced_s;
}

}  // namespace pelagic
