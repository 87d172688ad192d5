// The sea at places of the world: which points at rest are displaced there.
#pragma once

#include <vector>

#include "core/evaluate/prepared_query.h"

namespace pelagic {

struct PlaceSearch {
    double tolerance_m =
        1e-3;             // of the horizontal distance; a residual of single precision may stay above it
    int most_steps = 32;  // displacements looked at for one place
};

// Writes the point at rest whose displaced position is above place i, by iteration, to rest_m[i], and how far
// from the place that position is, horizontally, to residual_m[i] (an empty view: not wanted). Where the
// surface has folded over itself there are several such points: one of them. Where the search ends without
// one, the nearest that it has met: finite in any sea.
//
// places: as points of a query, but rest_m are places of the world. The query must hold Product::Displacement,
// and `query` be prepared for it. Each place is looked for by itself: its answer depends on nothing else. On all
// threads of the calling arena, or `alone`: by the calling thread. rest_m must not overlap the places.
template <class T>
void find_rest(const PreparedQuery<T>& query, const Points<T>& places, const PlaceSearch& search,
               Strided<glm::vec<2, T>> rest_m, Strided<T> residual_m, bool alone = false);

// What the query says at the points at rest that find_rest() finds for the places.
template <class T>
void evaluate_at(const PreparedQuery<T>& query, Points<T> places, const PlaceSearch& search,
                 const Results<T>& results) {
    std::vector<glm::vec<2, T>> rest_m(places.count);
    find_rest(query, places, search, {rest_m.data()}, Strided<T>{});
    places.rest_m = {rest_m.data()};
    query.evaluate(places, results);
}

}  // namespace pelagic
