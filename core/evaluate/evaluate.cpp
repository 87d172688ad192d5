#include "core/evaluate/evaluate.h"

#include "core/evaluate/prepared_query.h"

namespace pelagic {

template <class T>
void evaluate(const Frame<T>& frame, int query, const Points<T>& points, const Results<T>& results) {
    PreparedQuery<T>(frame, query, results.given(), points.origin_m).evaluate(points, results);
}

template void evaluate(const Frame<float>&, int, const Points<float>&, const Results<float>&);
template void evaluate(const Frame<double>&, int, const Points<double>&, const Results<double>&);

}  // namespace pelagic
