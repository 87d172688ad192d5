// Counter-based random numbers: a pure function of key and counter. So a value doesn't depend on the order of
// drawing, on threads or on how many others are drawn.
#pragma once

#include <array>
#include <cstdint>

namespace pelagic {

// Philox4x32-10 (Salmon, Moraes, Dror, Shaw 2011, "Parallel random numbers: as easy as 1, 2, 3").
// 128 counter bits and 64 key bits in, 128 random bits out.
std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter, std::uint64_t key);

// Two independent standard normal numbers (Box and Muller 1958), finite for every input: |ξ| < 9.5.
std::array<double, 2> normal_pair(std::array<std::uint32_t, 4> counter, std::uint64_t key);

}  // namespace pelagic
