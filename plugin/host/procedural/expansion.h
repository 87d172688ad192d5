// The mesh for a camera: how fine its cells are, and the grid that they make.
#pragma once

#include "core/evaluate/evaluate.h"
#include "core/surface/projected_grid.h"
#include "core/surface/view.h"
#include "plugin/host/procedural/procedural_frame.h"

namespace pelagic::procedural {

// No mesh is finer.
inline constexpr double kFinestCell_px = 0.25;

struct ExpansionChoice {
    double cell_px = kCell_px;  // the side of a cell on the screen
    double error_px = 0.0;  // above 0: the largest cells that keep 95 % of the picture so near to the surface
    bool triangles = false, on_earth = false;
};

struct Expansion {
    View view;
    ProjectedGridOptions options;
    bool triangles = false;
};

// In the frame's arena.
Expansion expansion_of(const ShotFrame& frame, const View& view, const ExpansionChoice& choice);
Points<float> points_of(const ProjectedGrid& grid);

// The distance of the mesh's faces from the surface of the finest cells, along its normal, in pixels there: 95 % of
// the picture's sea are within it. By samples.
double mesh_error_px(const ShotFrame& frame, const Expansion& expansion);

}  // namespace pelagic::procedural
