// Constants of mathematics, and the earth's.
#pragma once

#include <numbers>

namespace pelagic {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kTwoPi = 2.0 * kPi;
inline constexpr double kEarthRadius_m = 6371e3;

}  // namespace pelagic
