// The query: points in, the sea there out. One batched, band-limited evaluation for meshes, maps, buoys and
// hosts.
#pragma once

#include <cstddef>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "core/base/strided.h"
#include "core/evaluate/results.h"
#include "core/waves/frame.h"

namespace pelagic {

// Points at rest [m], relative to an origin in double, so that a sea a million metres away loses nothing.
template <class T>
struct Points {
    glm::dvec2 origin_m{0.0};
    std::size_t count = 0;
    Strided<const glm::vec<2, T>> rest_m{};
    // Each point's footprints [m]; empty: the query's first one for all. Cascades keep them within the query's
    // levels; trains use them from its first level on, however large.
    Strided<const T> cell_m{}, pixel_m{};
    // Footprints that are ellipses: the direction of the long axis times its length [m], cell_m or pixel_m being
    // the length of the short one. Empty, or no longer than the short axis: round.
    Strided<const glm::vec<2, T>> cell_axis_m{}, pixel_axis_m{};
    // Normals, of any length, of the surface that the sea lies on, where that isn't flat: normals of the sea are then
    // those of the waves on it (core/evaluate/rest_normal.inl). All else is that of a flat sea over the same (x, y).
    Strided<const glm::vec<3, T>> rest_normal{};
};

// `query`: index into the plan's queries; decides what is computed and how finely. Sums the components, then
// derives once what isn't linear (normals, J, coverage). Runs on all threads of the calling arena; a point's
// result depends on nothing but the point, and is finite if rest_m is. Throws std::invalid_argument when
// something is asked that the query doesn't hold, or that a frame alone doesn't know (PreparedQuery).
template <class T>
void evaluate(const Frame<T>& frame, int query, const Points<T>& points, const Results<T>& results);

}  // namespace pelagic
