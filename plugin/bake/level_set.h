// The sea within a square as a closed solid, and the distances of voxels from its boundary: what a simulation of water
// starts from.
//
// The solid lies below the surface, above a floor and between four upright sides. Its surface is triangles over a lattice of
// heights, so that it is a height field: where the sea has folded over itself, one of its sheets counts.
#pragma once

#include <functional>
#include <span>

#include <glm/vec3.hpp>
#include "core/evaluate/hulls.h"
#include "plugin/format/vdb/vdb.h"

namespace pelagic {

struct SeaSolid {
    double size_m = 1.0;  // of the square's sides, centred on the origin
    int cells = 1;        // a side
    std::span<const float>
        heights_m;  // at the cells' corners, (cells + 1)² of them: rows of rising y, x rising in each
    double floor_m = -1.0;  // below all heights
    // Bodies that hold none of it. Near them distances are those of Hulls::depth_m(), where they are the nearest boundary.
    const Hulls* hulls = nullptr;
};

// Voxel (i, j, k)'s middle is at first_m + (i, j, k) · voxel_m.
struct VoxelLattice {
    double voxel_m = 1.0;
    glm::dvec3 first_m{0.0};
};
// Over a square centred on the origin, filled from its lower corner; z in whole voxels from 0.
VoxelLattice voxels_over(double size_m, double voxel_m);

inline constexpr double kHalfWidth_voxels = 3.0;

// Hands over the blocks that hold voxels nearer to the boundary than kHalfWidth_voxels: those are active, and have their
// Euclidean distances [m], negative inside. `take` is called on all threads of the calling arena, in any order.
void for_each_block(const SeaSolid& solid, const VoxelLattice& voxels,
                    const std::function<void(const vdb::Block<float>&)>& take);

}  // namespace pelagic
