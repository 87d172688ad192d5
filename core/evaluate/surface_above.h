// The surface above places of the world, the highest of its sheets where it has folded over itself.
#pragma once

#include <glm/vec3.hpp>
#include <optional>

#include "core/evaluate/bounds.h"
#include "core/evaluate/places.h"

namespace pelagic {

// The height z [m] at which the displaced surface lies above the point, the highest of its sheets where it has
// folded over itself; nullopt where all of it lies at or below the point. The surface is the one that `query`
// answers for cells of this footprint [m], sampled finely enough for waves from some 10 cm up; waves that are
// shorter move it by less than they are high.
//
// Squares at rest that may be displaced there are found by the frame's bounds, so that no sheet is missed and
// nothing is evaluated where the surface can't reach the point; a sea that goes aside by hundreds of its wavelengths is
// sampled more coarsely, so that the search ends. On all threads of the calling arena. Throws
// std::invalid_argument for a query without Product::Position, or a frame without a time.
template <class T>
std::optional<double> surface_above(const Frame<T>& frame, int query, glm::dvec3 point_m, double cell_m);

// As find_rest(), but where the surface has folded over itself, the point at rest of its highest sheet there. Round the
// one that find_rest() finds 24 points say whether the surface has folded nearby, which takes as long as finding it;
// where it has, all that may be displaced to the place is searched as above, which takes up to a millisecond, and for the
// first such place of a time some 50 more. Cells are taken as round. `bounds`: those of the prepared query.
template <class T>
void find_highest_rest(const BoundsByLevel<T>& bounds, const PreparedQuery<T>& query, const Points<T>& places,
                       const PlaceSearch& search, Strided<glm::vec<2, T>> rest_m, Strided<T> residual_m,
                       bool alone = false);

}  // namespace pelagic
