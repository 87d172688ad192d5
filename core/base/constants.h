// Mathematical constants.
#pragma once

#include <numbers>

namespace pelagic {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kTwoPi = 2.0 * kPi;

}  // namespace pelagic
