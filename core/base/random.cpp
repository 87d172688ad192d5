#include "core/base/random.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pelagic {

std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter, std::uint64_t key) {
    // Multipliers and Weyl increments of the paper, table 2.
    constexpr std::uint64_t kMultiplier0 = 0xD2511F53u, kMultiplier1 = 0xCD9E8D57u;
    constexpr std::uint32_t kWeyl0 = 0x9E3779B9u, kWeyl1 = 0xBB67AE85u;
    auto key0 = static_cast<std::uint32_t>(key);
    auto key1 = static_cast<std::uint32_t>(key >> 32);
    for (int round = 0; round < 10; ++round) {
        const std::uint64_t product0 = kMultiplier0 * counter[0];
        const std::uint64_t product1 = kMultiplier1 * counter[2];
        counter = {static_cast<std::uint32_t>(product1 >> 32) ^ counter[1] ^ key0,
                   static_cast<std::uint32_t>(product1),
                   static_cast<std::uint32_t>(product0 >> 32) ^ counter[3] ^ key1,
                   static_cast<std::uint32_t>(product0)};
        key0 += kWeyl0;
        key1 += kWeyl1;
    }
    return counter;
}

std::array<double, 2> normal_pair(std::array<std::uint32_t, 4> counter, std::uint64_t key) {
    const auto bits = philox(counter, key);
    const auto wide = [](std::uint32_t high, std::uint32_t low) {
        return (static_cast<std::uint64_t>(high) << 32) | low;
    };
    // u in (0, 1], so that its logarithm is finite. The smallest value, 2^-64, bounds |ξ| by √(128 ln 2).
    const double u = (static_cast<double>(wide(bits[0], bits[1])) + 1.0) * 0x1p-64;
    const double angle = 2.0 * std::numbers::pi * (static_cast<double>(wide(bits[2], bits[3])) * 0x1p-64);
    const double radius = std::sqrt(-2.0 * std::log(std::min(u, 1.0)));
    return {radius * std::cos(angle), radius * std::sin(angle)};
}

}  // namespace pelagic
