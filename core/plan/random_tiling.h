// waves.tiling = "random": a cascade is its one tile at random offsets, blended, so that no pattern is seen from
// the air (Heitz and Neyret 2018, "High-performance by-example noise using a histogram-preserving blending operator"; on
// squares instead of triangles, and of a Gaussian field, which needs no histogram preserved).
//
// For cascade c of size L the plane is cut into square cells of side L, cell (i, j) round the middle (i L, j L). Each
// cell has the tile at an offset of its own, tile_offset(tiling_key(seed, c), i, j).
// Across a border the tiles on both sides blend over kBlendRamp L, along x and y apart: a point reads one tile, two,
// or near a corner four. The squares of their weights add up to 1, and different offsets are uncorrelated, so all
// second moments are the spectrum's. Offsets depend on the
// shot's seed, the cascade and the cell alone: not on time, camera, surface or footprint. Cell (0, 0) has none: the middle of it,
// out to 0.5 − 0.5 kBlendRamp of L, is the tile as it is.
//
// The weights' gradient belongs to what is derived from the sum: ηx = Σ w ηx_c + wx η_c, and likewise Dxx; Dxy = Σ w Dxy_c + wy Dx_c and
// Dyx = Σ w Dxy_c + wx Dy_c differ. It adds the variance E[|∇w|²] Var η to the slopes', kBlendSlopes Var η/L² along each
// axis.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/base/number.h"
#include "core/plan/filter.h"

namespace pelagic {

using uint = std::uint32_t;  // GLSL's name

#include "core/plan/random_tiling.inl"

// The part of a cell's half in which nothing blends.
inline constexpr double kPlainHalf = 0.5 - 0.5 * kBlendRamp;
// E[w_x²] L², summed over the blended tiles: the mean of θ′² over the plane, 3.0384 / kBlendRamp.
inline constexpr double kBlendSlopes = 3.0383937607 / kBlendRamp;

// Along an axis from the points' origin, in cells: places farther away, or that are no number, read the origin's
// cell.
inline constexpr double kFarthestCell = 0x1p28;

// Below 2²⁰.
inline uint tiling_key(std::uint64_t seed, int cascade) {
    const TileBits low =
        tile_bits(static_cast<uint>(seed), static_cast<uint>(seed >> 32), static_cast<uint>(cascade));
    return low.x << 10 | low.y;
}

// Along an axis, in double: the cell that a point lies in, and how far it lies from its middle, in cells, −½ … ½. A place
// that is no number, or beyond 2⁶² cells, is in cell 0.
struct TilePlace {
    std::int64_t cell = 0;
    double from_middle = 0.0;
};
inline TilePlace tile_place(double cells) {
    if (!(std::abs(cells) < 0x1p62)) return {};
    const double cell = std::floor(cells + 0.5);
    return {static_cast<std::int64_t>(cell), cells - cell};
}

}  // namespace pelagic
