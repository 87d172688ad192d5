// The levels of footprints of a view: powers of two in metres, whatever the scene and whichever frames are asked for.
// A point between two levels reads both.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/surface/projected_grid.h"

namespace pelagic {

// The finest level that a frame reads whose finest footprint is this [m], > 0: the nearest one. The level below would
// cost four times the samples, for at most a factor of √2 in footprint.
inline double first_level_m(double finest_footprint_m) {
    return std::exp2(std::round(std::log2(finest_footprint_m)));
}

// The coarsest level that is no coarser than the footprint.
inline double level_below_m(double footprint_m) {
    return std::exp2(std::floor(std::log2(footprint_m)));
}

// Footprints finer than the grid's own first level count as that level. So a plan that has finer levels, for other
// frames, gives this frame the same bits. `own`: the needs of this very pose.
inline void keep_to_levels(ProjectedGrid& grid, const ProjectedGridNeeds& own) {
    const auto keep = [](std::vector<float>& footprints_m, double finest_m) {
        const auto first_m = static_cast<float>(first_level_m(finest_m));
        for (float& footprint_m : footprints_m) footprint_m = std::max(footprint_m, first_m);
    };
    keep(grid.cell_m, own.finest_cell_m);
    keep(grid.pixel_m, own.finest_pixel_m);
}

}  // namespace pelagic
