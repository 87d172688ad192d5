// Whether a point of the world lies in the water: the surface above it.
#pragma once

#include <glm/vec3.hpp>
#include <optional>

#include "core/waves/frame.h"

namespace pelagic {

// The height z [m] at which the displaced surface lies above the point, the highest of its sheets where it has
// folded over itself; nullopt where all of it lies at or below the point. The surface is the one that `query`
// answers for cells of this footprint [m], sampled finely enough for waves from some 10 cm up; waves that are
// shorter move it by less than they are high.
//
// Squares at rest that may be displaced there are found by the frame's bounds, so that no sheet is missed and
// nothing is evaluated where the surface can't reach the point. On all threads of the calling arena. Throws
// std::invalid_argument for a query without Product::Position, or a frame without a time.
template <class T>
std::optional<double> surface_above(const Frame<T>& frame, int query, glm::dvec3 point_m, double cell_m);

}  // namespace pelagic
