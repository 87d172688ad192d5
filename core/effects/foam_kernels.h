// The loops over a tile's nodes that living foam spends its time in, in the vectors of the CPU at hand (Highway, chosen at
// run time).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace pelagic {

// What a frame makes of one interval's shares.
struct FoamShares {
    const std::uint16_t* share = nullptr;  // by node: the upper half of a float
    float foam = 0.0f, age = 0.0f;         // weights in the two sums
};

struct FoamKernels {
    // y of Φ(y) = P(J < threshold), by node, limited to ± kFarthestFoamDeviate. Arrays as long as y's, or Buffers.
    void (*deviates)(const float* mean, const float* variance, const float* third, const float* threshold,
                     bool third_moment, std::span<float> y);
    // The mean of Φ(y) over the interval between the third of six deviates, a step apart, and the fourth.
    void (*share)(const float* const y[6], std::span<std::uint16_t> share);
    // Σ foam · share and Σ age · share, in the order given.
    void (*sum)(std::span<const FoamShares> shares, std::span<float> foam, std::span<float> age);
};

// So far that what lies between two samples isn't bent by the limit.
inline constexpr float kFarthestFoamDeviate = 1e3f;

// For the CPU that runs this.
FoamKernels foam_kernels();

}  // namespace pelagic
