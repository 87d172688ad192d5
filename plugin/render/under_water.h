// A camera under water. Renderer draws what it sees in an open sea whose water has a body, and so do the preview's pictures, its window where all of it
// looks through water; where the water has none, in a cage's pool, and by others, such pictures are refused.
#pragma once

#include <optional>

#include "core/lighting/floor.h"
#include "core/surface/projected_grid.h"
#include "core/surface/view.h"
#include "core/waves/frame.h"
#include "pelagic/scene.h"

namespace pelagic {

// Whether the sea may reach the camera: false above the highest crest to be expected (core/plan/extent.h), where
// nobody needs to look at the sea itself.
bool is_among_waves(const View& view, const ProjectedGridOptions& options);

// The height z [m] of the surface above the camera, as its picture shows the surface there; nullopt for a
// camera in the air. Query 0 of the frame's plan is that of pictures (picture_plan()).
template <class T>
std::optional<double> surface_above_camera(const Frame<T>& frame, const View& view,
                                           const ProjectedGridOptions& options);

// Throws std::invalid_argument, which says how deep the shot's camera is under a surface that is so high [m].
[[noreturn]] void throw_under_water(const Scene& scene, double frame, double surface_m);

// For the shot's camera at a frame whose time `state` has. Throws as above.
template <class T>
void refuse_under_water(const Frame<T>& state, const Scene& scene, double frame,
                        const ProjectedGridOptions& options);

// Throws std::invalid_argument for a camera that isn't above the sea's floor.
void refuse_in_floor(const Scene& scene, double frame, const Floor& floor);

}  // namespace pelagic
