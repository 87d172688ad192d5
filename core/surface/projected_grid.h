// The projected grid (Johanson 2004; Bruneton, Neyret, Holzschuch 2010, §4): points at rest that lie about a
// cell's size apart on the screen, wherever the camera is.
//
// Rows are circles round the camera's nadir, evenly spaced in the angle under which they are seen from the
// effective height √(h² + (Hs/2)²), which is the camera's own high above the waves and never falls to 0 among
// them; columns are evenly spaced in azimuth, a range of its own in each row. Cells of a camera that looks
// along the horizon are its screen's; straight down, upwards and below the crests there is no special case.
//
// What is covered: the part of the slab |z| ≤ bounds.height_m that is in view is a convex polyhedron, its
// shadow on the plane a convex polygon, and a point at rest may come into view where it lies within
// bounds.reach_m of that polygon. Each row spans those, and nothing else is cast.
#pragma once

#include <cstddef>
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

// A grid's topology: columns × rows cells between points in columns + 1 by rows + 1.
struct ProjectedGridSize {
    int columns = 0, rows = 0;
    bool operator==(const ProjectedGridSize&) const = default;
};
inline std::size_t points_of(ProjectedGridSize size) {
    return (static_cast<std::size_t>(size.columns) + 1) * (static_cast<std::size_t>(size.rows) + 1);
}

struct ProjectedGridOptions {
    // A cell's side on the screen, at most, where the sea at rest is in view, for lenses whose corners are up
    // to 60° off the axis; beyond, the picture's border stretches cells by up to 1/(4 cos²). Where only
    // displaced crests come into view, and within twice their reach of the nadir, cells are some three times
    // as large.
    double cell_px = 8.0;
    SurfaceBounds bounds;
    double significant_height_m = 0.0;  // Hs
    // Other than the pose itself needs (projected_grid_needs): those of a whole shot, so that its frames all
    // have the same topology. 0: as many as needed.
    ProjectedGridSize size{};
};

// Columns fastest, rows outwards.
struct ProjectedGrid {
    int columns = 0, rows = 0;
    glm::dvec2 origin_m{0.0};         // the camera's nadir: points are relative to it
    std::vector<glm::vec2> rest_m{};  // inside the horizon's circle, finite
    std::vector<float> cell_m{};      // the larger distance to the neighbouring rows and columns
    std::vector<float> pixel_m{};     // what a pixel covers along its longer side
};

// What a pose asks for.
struct ProjectedGridNeeds {
    ProjectedGridSize size;  // in multiples of 16, so that neighbouring poses often agree
    // No point's footprints are finer in a grid of this size [m], for the ladder of a query. In one with rows
    // to spare cells may be, and are filtered as if they were not.
    double finest_cell_m = 0.0, finest_pixel_m = 0.0;
};
ProjectedGridNeeds projected_grid_needs(const View& view, const ProjectedGridOptions& options);
// Enough for both poses.
ProjectedGridNeeds together(const ProjectedGridNeeds& a, const ProjectedGridNeeds& b);

// Covers every point at rest whose displaced place may be in view. Empty of meaning but valid where none is
// (looking up from above the crests): a grid at the horizon.
ProjectedGrid projected_grid(const View& view, const ProjectedGridOptions& options);

// Two triangles a cell, indices of rest_m; the same for every grid of this many columns and rows.
std::vector<std::uint32_t> projected_grid_triangles(ProjectedGridSize size);

}  // namespace pelagic
