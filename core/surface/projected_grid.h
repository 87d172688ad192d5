// The projected grid (Johanson 2004; Bruneton, Neyret, Holzschuch 2010, §4): points at rest that lie about a
// cell's size apart on the screen, wherever the camera is.
//
// Rows are circles round the camera's nadir, evenly spaced in the angle under which they are seen from the
// effective height √(h² + (Hs/2)²), which is the camera's own high above the waves and never falls to 0 among
// them; columns are evenly spaced in azimuth, a range of its own in each row. Cells of a camera that looks
// along the horizon are its screen's; straight down, upwards and below the crests there is no special case.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <vector>

#include "core/surface/view.h"

namespace pelagic {

// How far the surface goes from its rest, at most: half the height of the slab that it stays in, and its
// horizontal reach [m].
struct SurfaceBounds {
    double height_m = 0.0, reach_m = 0.0;
};

struct ProjectedGridOptions {
    double cell_px = 8.0;  // a cell's side on the screen, at most, in what is in view
    SurfaceBounds bounds;
    double significant_height_m = 0.0;  // Hs
};

// (columns + 1) × (rows + 1) points, columns fastest, rows outwards; the same numbers for every pose of a
// camera with this lens and resolution.
struct ProjectedGrid {
    int columns = 0, rows = 0;
    glm::dvec2 origin_m{0.0};       // the camera's nadir: points are relative to it
    std::vector<glm::vec2> rest_m;  // inside the horizon's circle, finite
    std::vector<float> cell_m;      // the larger distance to the neighbouring rows and columns
    std::vector<float> pixel_m;     // what a pixel covers along its longer side
};

// Covers every point at rest whose displaced place may be in view. Empty of meaning but valid where none is
// (looking up from above the crests): a grid at the horizon.
ProjectedGrid projected_grid(const View& view, const ProjectedGridOptions& options);

// Two triangles a cell, indices of rest_m; the same for every grid of this many columns and rows.
std::vector<std::uint32_t> projected_grid_triangles(int columns, int rows);

}  // namespace pelagic
