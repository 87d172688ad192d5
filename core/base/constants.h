// Constants of mathematics, and the earth's.
#pragma once

#include <numbers>

namespace pelagic {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kTwoPi = 2.0 * kPi;
inline constexpr double kEarthRadius_m = 6371e3;
inline constexpr double kGravity = 9.81;  // m/s²

}  // namespace pelagic
