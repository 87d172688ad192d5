#include "core/evaluate/places.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat2x2.hpp>
#include <limits>
#include <span>
#include <vector>

namespace pelagic {
namespace {

constexpr std::size_t kAtOnce = 128;  // places that a task looks for side by side
// A step is at most so many times the distance that is missing: near a fold the derivative is nearly singular.
constexpr double kLongestStep = 3.0;

// Broyden's "good" method (1965) for f(r) = r + D(r) − p = 0 from r = p, whose derivative is near the identity
// where the sea isn't steep.
class Search {
  public:
    explicit Search(glm::dvec2 place_m) : place_m_(place_m), next_m_(place_m), best_m_(place_m) {}

    glm::dvec2 next_m() const { return next_m_; }
    glm::dvec2 best_m() const { return best_m_; }
    double residual_m() const { return residual_m_; }  // of the best

    // The displacement at `rest_m`, next_m() as a query has rounded it; true: near enough.
    bool take(glm::dvec2 rest_m, glm::dvec2 displacement_m, double tolerance_m) {
        const glm::dvec2 off_m = rest_m + displacement_m - place_m_;
        const double distance_m = glm::length(off_m);
        if (std::isfinite(residual_m_)) learn(rest_m - last_rest_m_, off_m - last_off_m_);
        if (distance_m < residual_m_) {
            residual_m_ = distance_m;
            best_m_ = rest_m;
        }
        last_rest_m_ = rest_m;
        last_off_m_ = off_m;
        glm::dvec2 step_m = -(inverse_ * off_m);
        const double length_m = glm::length(step_m), longest_m = kLongestStep * distance_m;
        if (length_m > longest_m) step_m *= longest_m / length_m;
        next_m_ = rest_m + step_m;
        return residual_m_ <= tolerance_m;
    }

  private:
    // The inverse derivative after a step that changed f.
    void learn(glm::dvec2 step_m, glm::dvec2 change_m) {
        const glm::dvec2 expected_m = inverse_ * change_m;
        const double scale = glm::dot(step_m, expected_m);
        if (std::abs(scale) <= 1e-3 * glm::dot(step_m, step_m)) return;  // it would be singular
        inverse_ += glm::outerProduct((step_m - expected_m) / scale, step_m * inverse_);
    }

    glm::dvec2 place_m_, next_m_, best_m_, last_rest_m_{0.0}, last_off_m_{0.0};
    double residual_m_ = std::numeric_limits<double>::infinity();
    glm::dmat2 inverse_{1.0};
};

// A task's places that are still looked for, side by side as a query wants them.
template <class T>
struct Batch {
    std::array<std::size_t, kAtOnce> place;
    std::array<glm::vec<2, T>, kAtOnce> rest_m;
    std::array<T, kAtOnce> cell_m;
    std::array<glm::vec<2, T>, kAtOnce> cell_axis_m;
    std::array<glm::vec<3, T>, kAtOnce> displacement_m;
};

template <class T>
void find_some(const PreparedQuery<T>& query, const Points<T>& places, const PlaceSearch& search,
               std::span<Search> searches, std::size_t first) {
    Batch<T> batch;
    std::size_t left = searches.size();
    for (std::size_t i = 0; i < left; ++i) batch.place[i] = i;
    for (int step = 0; step < search.most_steps && left > 0; ++step) {
        for (std::size_t i = 0; i < left; ++i) {
            batch.rest_m[i] = glm::vec<2, T>(searches[batch.place[i]].next_m());
            if (places.cell_m) batch.cell_m[i] = places.cell_m[first + batch.place[i]];
            if (places.cell_axis_m) batch.cell_axis_m[i] = places.cell_axis_m[first + batch.place[i]];
        }
        Points<T> points{.origin_m = places.origin_m, .count = left, .rest_m = {batch.rest_m.data()}};
        if (places.cell_m) points.cell_m = {batch.cell_m.data()};
        if (places.cell_axis_m) points.cell_axis_m = {batch.cell_axis_m.data()};
        Results<T> results;
        results.set(Product::Displacement, {batch.displacement_m.data()});
        query.evaluate(points, results);
        std::size_t kept = 0;
        for (std::size_t i = 0; i < left; ++i) {
            Search& one = searches[batch.place[i]];
            if (!one.take(glm::dvec2(batch.rest_m[i]), glm::dvec2(batch.displacement_m[i]),
                          search.tolerance_m))
                batch.place[kept++] = batch.place[i];
        }
        left = kept;
    }
}

}  // namespace

template <class T>
void find_rest(const PreparedQuery<T>& query, const Points<T>& places, const PlaceSearch& search,
               Strided<glm::vec<2, T>> rest_m, Strided<T> residual_m, bool alone) {
    using Blocks = tbb::blocked_range<std::size_t>;
    const auto find = [&](const Blocks& range) {
        for (std::size_t begin = range.begin(); begin < range.end(); begin += kAtOnce) {
            const std::size_t end = std::min(begin + kAtOnce, range.end());
            std::vector<Search> searches;
            searches.reserve(end - begin);
            for (std::size_t i = begin; i < end; ++i) searches.emplace_back(glm::dvec2(places.rest_m[i]));
            find_some(query, places, search, std::span(searches), begin);
            for (std::size_t i = begin; i < end; ++i) {
                rest_m[i] = glm::vec<2, T>(searches[i - begin].best_m());
                if (residual_m) residual_m[i] = static_cast<T>(searches[i - begin].residual_m());
            }
        }
    };
    const Blocks all(0, places.count, kAtOnce);
    alone ? find(all) : tbb::parallel_for(all, find);
}

template void find_rest(const PreparedQuery<float>&, const Points<float>&, const PlaceSearch&,
                        Strided<glm::vec2>, Strided<float>, bool);
template void find_rest(const PreparedQuery<double>&, const Points<double>&, const PlaceSearch&,
                        Strided<glm::dvec2>, Strided<double>, bool);

}  // namespace pelagic
