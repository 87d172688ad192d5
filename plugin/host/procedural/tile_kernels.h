// A ray against the triangles of a tile of the sea, in the vectors of the CPU at hand (Highway, chosen at run time).
#pragma once

#include <array>
#include <cstddef>
#include <glm/vec3.hpp>

namespace pelagic::procedural {

// A tile has so many cells along a side. Points go row by row; each cell is two triangles, which meet in its diagonal
// from the lower to the higher corner.
inline constexpr int kTileCells = 8;
inline constexpr int kTileRow = kTileCells + 1, kTilePoints = kTileRow * kTileRow;
// The length of arrays of points: vectors read beyond the last point.
inline constexpr int kTileRoom = (kTilePoints + 15) / 16 * 16;

// By axis.
struct TilePoints {
    std::array<const float*, 3> at_m{};          // kTileRoom of each
    std::array<const float*, 3> velocity_mps{};  // null: they stand still
};

// Relative to the tile's origin.
struct TileRay {
    glm::vec3 from_m{0.0f}, direction{0.0f, 0.0f, -1.0f};
    float near = 0.0f, far = 0.0f;  // in lengths of the direction
    float time_s = 0.0f;            // since the moment of at_m
    float rounding_m =
        0.0f;  // of points: a ray that passes between neighbouring tiles, so near to both, meets one
};

struct TileHit {
    float distance = 0.0f;     // in lengths of the direction
    float x = 0.0f, y = 0.0f;  // of the place in the tile, 0 … kTileCells
};

// Four boxes side by side, x fastest, by axis: a ray is tried against all at once.
struct TileQuarters {
    std::array<std::array<float, 4>, 3> low_m{}, high_m{};
};

// A ray relative to the middle of the tile that has the quarters, and how much wider their boxes are.
struct QuartersRay {
    glm::dvec3 from_m{0.0}, per_direction{0.0};
    double near_m = 0.0, far_m = 0.0, widening_m = 0.0;
};

// Where the ray is within each box: near > far where it enters none.
struct QuartersEntered {
    alignas(32) std::array<double, 4> near_m, far_m;
};
using EnterQuarters = void (*)(const TileQuarters& boxes, const QuartersRay& ray, QuartersEntered& entered);
EnterQuarters enter_quarters();

// The nearest triangle between near and far, from above or from below; false, and `hit` as it was, where there is none.
using NearestInTile = bool (*)(const TilePoints& points, const TileRay& ray, TileHit& hit);
NearestInTile nearest_in_tile();

}  // namespace pelagic::procedural
