// The projected grid (Johanson 2004; Bruneton, Neyret, Holzschuch 2010, §3.2): points at rest, about one cell
// apart on the screen, wherever the camera is.
//
// Rows are circles round the camera's nadir. Near by they are evenly spaced in the angle at which they are seen from
// the effective height √(h² + (Hs/2)²): nearly the camera's own high above the waves, and never 0 among them. At the
// distance d such a cell is d²/h times that angle long: 250 m at 330 m, seen from 4 m. There, however, waves are seen
// from the side. So rows are also so close together that the heights they leave unresolved look no higher than a
// third of a pixel. Where waves are as steep at every length, their distance is then in proportion to d, until all
// waves together look lower than that: a few hundred rows. Columns are evenly spaced in azimuth; each row has its own
// range. For a camera that looks at the horizon, cells align with the screen. Looking straight down, looking up and
// being below the crests are no special cases.
//
// Coverage: the part of the slab |z| ≤ bounds.height_m that is in view is a convex polyhedron. Its projection
// onto the plane is a convex polygon, and a point at rest may come into view if it lies within bounds.reach_m
// of that polygon. Each row spans those points. No rays are cast.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "core/surface/extent.h"
#include "core/surface/pixel_footprint.h"
#include "core/surface/unresolved_height.h"
#include "core/surface/view.h"

namespace pelagic {

// The largest displacement of the surface: half the height of the slab that contains it, and its horizontal
// reach [m].
struct SurfaceBounds {
    double height_m = 0.0, reach_m = 0.0;
};

// A grid's topology: columns × rows cells, (columns + 1) × (rows + 1) points.
struct ProjectedGridSize {
    int columns = 0, rows = 0;
    bool operator==(const ProjectedGridSize&) const = default;
};
inline std::size_t points_of(ProjectedGridSize size) {
    return (static_cast<std::size_t>(size.columns) + 1) * (static_cast<std::size_t>(size.rows) + 1);
}

struct ProjectedGridOptions {
    // The largest side of a cell on the screen where the sea at rest is in view, for lenses whose corners are
    // up to 60° off the axis; beyond that angle cells are stretched by up to 1/(4 cos²). Cells are some three
    // times as large where only displaced crests come into view, and within twice their reach of the nadir. A
    // lens of less than some 20° has larger ones where the sea moves farther than the lens sees: points stay in
    // proportion to the picture's cells.
    double cell_px = 8.0;
    SurfaceBounds bounds;
    double significant_height_m = 0.0;  // Hs
    UnresolvedHeight unresolved{};      // of the waves; without, rows are even in angle
    double curvature_per_m = 0.0;       // of the earth on which the sea lies (earth.h); 0: flat
    // 0: as many as this pose needs (projected_grid_needs). Others, for poses that are to share a topology.
    ProjectedGridSize size{};
    // Footprints finer than this pose's own first level count as that level (footprint_levels.h). So a plan that has finer levels, for
    // other poses, gives this one the same bits. Wave trains alone need no levels: they use each point's own footprints.
    bool has_levels = false;
};
// Of a scene's camera.
ProjectedGridOptions projected_grid_options(const Scene& scene, const Extent& extent);

// Points by row, from the innermost row outwards; columns fastest.
struct ProjectedGrid {
    int columns = 0, rows = 0;
    glm::dvec2 origin_m{0.0};         // the camera's nadir; the points are relative to it
    double curvature_per_m = 0.0;     // as asked for: the points are laid round the nadir (earth.h)
    std::vector<glm::vec2> rest_m{};  // finite, inside the horizon's circle
    // Footprints as in Points (core/evaluate/evaluate.h): the short axis of each, and the long one as a vector.
    // A cell's are its distances to the neighbouring rows and columns, the shorter no less than a cell is wide on
    // the screen; a pixel's are those of the sea at rest, 0.6 of what it covers, and the long one points away from the
    // camera's nadir (core/surface/pixel_footprint.inl has them for a sea that is tilted).
    std::vector<float> cell_m{}, pixel_m{};
    std::vector<glm::vec2> cell_axis_m{}, pixel_axis_m{};
};

// The requirements of a pose.
struct ProjectedGridNeeds {
    ProjectedGridSize size;  // multiples of 16, so that neighbouring poses often agree
    // Lower bounds of the points' footprints in a grid of this size [m], for a query's levels; of pixels, where waves two
    // deviations high are seen. Spare rows may make cells smaller, and single crests come nearer; those are filtered as
    // if they did not.
    double finest_cell_m = 0.0, finest_pixel_m = 0.0;
};
ProjectedGridNeeds projected_grid_needs(const View& view, const ProjectedGridOptions& options);
// The smallest requirements that cover all of these poses, at least one.
ProjectedGridNeeds projected_grid_needs(std::span<const View> views, const ProjectedGridOptions& options);

// Covers every point at rest whose displaced position may be in view. Where none is (looking up from above
// the crests), the grid is valid and lies at the horizon. Throws BuildCancelled.
ProjectedGrid projected_grid(const View& view, const ProjectedGridOptions& options,
                             const std::atomic<bool>* cancel = nullptr);

// A pixel's footprint at a point at rest, relative to the camera's nadir: as the grid's points have it.
PixelFootprint<double> pixel_at_rest(const View& view, const ProjectedGridOptions& options,
                                     glm::dvec2 rest_m);

// Two triangles per cell, as indices of rest_m. They depend on the size alone.
std::vector<std::uint32_t> projected_grid_triangles(ProjectedGridSize size);

}  // namespace pelagic
