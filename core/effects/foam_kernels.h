// The loops over a tile's nodes that persistent foam spends its time in, in the vectors of the CPU at hand (Highway,
// chosen at run time).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace pelagic {

// What a frame makes of one interval's shares.
struct FoamShares {
    const std::uint16_t* share = nullptr;  // by node: the upper half of a float
    float foam = 0.0f, age = 0.0f;         // weights in the two sums
};

// Where points lie among the nodes of a level, along an axis. By point, with room for a vector that begins at the last one.
struct FoamAxis {
    static constexpr std::size_t kPoints = 256, kRoom = kPoints + 64 / sizeof(float);
    alignas(64) std::array<double, kRoom> tile;        // the tile's number, whole
    alignas(64) std::array<std::int32_t, kRoom> node;  // at or below the point, in the tile
    alignas(64) std::array<float, kRoom> rest;         // the way to the next node, 0 … 1
};

// Of the points' origin and places [m] in a level's cells.
struct FoamAxisArgs {
    double origin_m = 0.0, cells_per_m = 1.0;
    const double* rest_m = nullptr;  // by point
};

// What earlier breaking has left: foam, and foam times its age [s], by node or by point.
struct ResidualFoam {
    const float *foam, *aged;
};

struct FoamKernels {
    // Of points first … end − 1. What lies beyond is overwritten.
    void (*place)(const FoamAxisArgs&, std::size_t first, std::size_t end, FoamAxis&);
    // Between the nodes of the tile that points first … end − 1 lie in, and of these alone. A tile has rows of kTileCells + 1 nodes;
    // the 15 numbers behind the last one may be read.
    void (*between)(const ResidualFoam&, const FoamAxis& x, const FoamAxis& y, std::size_t first,
                    std::size_t end, float* foam, float* aged);
    // Combines foam that is left with foam that breaks: all foam, 0 … 1, and its mean age, breaking foam counting as
    // 0 [s]. under: share_under_breaking(). All six arrays hold `count` numbers rounded up to a whole 16.
    void (*add)(const ResidualFoam&, const float* breaking, const float* under, std::size_t count, float* all,
                float* age_s);
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

// What breaks less than this share, Φ of the deviate, counts as it, deviates of −7 among it, of calms and of places without surf
// (kLeastDeviate): nobody sees it, and it has an age, so that water without foam beside foam is none that has just broken.
inline constexpr float kNoFoamDeviate = -6.9f, kNoFoamShare = 2.6e-12f;

// For the CPU that runs this.
FoamKernels foam_kernels();

}  // namespace pelagic
