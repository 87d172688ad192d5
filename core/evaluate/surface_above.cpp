#include "core/evaluate/surface_above.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat2x2.hpp>
#include <glm/matrix.hpp>
#include <glm/vec2.hpp>
#include <vector>

#include "core/evaluate/bounds.h"
#include "core/evaluate/prepared_query.h"

namespace pelagic {
namespace {

// Squares are halved until kCells cells a side sample them finely enough. A cell is this long [m] or, where a
// footprint lets only longer waves through, this part of the footprint: forty cells to the shortest wave. Extremely
// choppy waves may fold within less.
constexpr int kCells = 32;
constexpr double kFinestSpacing_m = 0.02, kSpacingOfCell = 0.05;

// A place at rest, and where it is displaced to, both relative to the point's place.
struct Node {
    glm::dvec2 rest_m;
    glm::dvec3 position_m;
};

// The surface round one place of the world. Coordinates are relative to that place.
template <class T>
class Surroundings {
  public:
    Surroundings(const Frame<T>& frame, int query, glm::dvec2 place_m, double cell_m)
        : place_m_(place_m),
          cell_m_(static_cast<T>(cell_m)),
          spacing_m_(std::max(kFinestSpacing_m, kSpacingOfCell * cell_m)),
          bounds_(frame, query, {.finest_m = cell_m, .coarsest_m = cell_m}),
          query_(frame, query, products(Product::Position), place_m) {}

    std::optional<double> highest_above(double z_m) {
        const DisplacementBounds all = bounds_.everywhere();
        highest_m_ = z_m;
        if (!(all.z.hi > z_m)) return std::nullopt;
        const double half_m = std::max({all.reach_m().x, all.reach_m().y, spacing_m_});
        search({glm::dvec2(-half_m), glm::dvec2(half_m)});
        if (highest_m_ > z_m) return highest_m_;
        return std::nullopt;
    }

  private:
    // Searches a square, unless its bounds exclude a sheet over the place that is higher than those found.
    void search(const RestRegion& square) {
        const DisplacementBounds bounds =
            bounds_.region({place_m_ + square.min_m, place_m_ + square.max_m}, 1);
        const std::array reach{bounds.dx, bounds.dy};
        for (int axis = 0; axis < 2; ++axis)
            if (square.min_m[axis] + reach[axis].lo > 0.0 || square.max_m[axis] + reach[axis].hi < 0.0)
                return;
        if (!(bounds.z.hi > highest_m_)) return;
        if (square.max_m.x - square.min_m.x <= kCells * spacing_m_) return sample(square);
        const glm::dvec2 middle = 0.5 * (square.min_m + square.max_m);
        for (const glm::dvec2 corner : {square.min_m, glm::dvec2(square.max_m.x, square.min_m.y),
                                        glm::dvec2(square.min_m.x, square.max_m.y), square.max_m})
            search({glm::min(corner, middle), glm::max(corner, middle)});
    }

    // Finds the triangles of a fine mesh of the square that cover the place.
    void sample(const RestRegion& square) {
        constexpr int kSide = kCells + 1;
        rest_m_.resize(kSide * kSide);
        const glm::dvec2 step = (square.max_m - square.min_m) / static_cast<double>(kCells);
        for (int j = 0; j < kSide; ++j)
            for (int i = 0; i < kSide; ++i)
                rest_m_[j * kSide + i] = glm::vec<2, T>(square.min_m + step * glm::dvec2(i, j));
        evaluate();
        const std::vector<glm::vec<3, T>> corners = position_m_;
        const std::vector<glm::vec<2, T>> rests = rest_m_;
        const auto node = [&](int i, int j) {
            return Node{glm::dvec2(rests[j * kSide + i]), glm::dvec3(corners[j * kSide + i])};
        };
        for (int j = 0; j < kCells; ++j)
            for (int i = 0; i < kCells; ++i) {
                consider(node(i, j), node(i + 1, j), node(i, j + 1));
                consider(node(i + 1, j + 1), node(i, j + 1), node(i + 1, j));
            }
    }

    // A sheet where the triangle covers the place: its height there, and then that of the surface itself.
    void consider(const Node& a, const Node& b, const Node& c) {
        const glm::dmat2 edges(glm::dvec2(b.position_m - a.position_m),
                               glm::dvec2(c.position_m - a.position_m));
        const double area = glm::determinant(edges);
        if (area == 0.0) return;  // seen from the side
        const glm::dvec2 share = glm::inverse(edges) * -glm::dvec2(a.position_m);
        constexpr double kRounding = 1e-6;  // neighbours leave no gap between them
        if (share.x < -kRounding || share.y < -kRounding || share.x + share.y > 1.0 + kRounding) return;
        const double on_triangle_m = a.position_m.z + share.x * (b.position_m.z - a.position_m.z) +
                                     share.y * (c.position_m.z - a.position_m.z);
        const glm::dmat2 rest_edges(b.rest_m - a.rest_m, c.rest_m - a.rest_m);
        const glm::dmat2 rest_from_position = rest_edges * glm::inverse(edges);
        glm::dvec2 rest_m = a.rest_m + rest_edges * share;
        // The surface itself, by Newton's steps with the triangle's slope; where they don't come nearer, the
        // triangle is the answer.
        double height_m = on_triangle_m, missing_m = glm::length(rest_edges[0]);
        for (int tries = 0; tries < 4; ++tries) {
            rest_m_.assign(1, glm::vec<2, T>(rest_m));
            evaluate();
            const glm::dvec3 position_m(position_m_[0]);
            const double now_m = glm::length(glm::dvec2(position_m));
            if (!(now_m < missing_m)) break;
            missing_m = now_m;
            height_m = position_m.z;
            rest_m -= rest_from_position * glm::dvec2(position_m);
        }
        highest_m_ = std::max(highest_m_, height_m);
    }

    void evaluate() {
        position_m_.resize(rest_m_.size());
        Results<T> results;
        results.set(Product::Position, {position_m_.data()});
        cells_m_.resize(rest_m_.size(), cell_m_);
        query_.evaluate({.origin_m = place_m_,
                         .count = rest_m_.size(),
                         .rest_m = {rest_m_.data()},
                         .cell_m = {cells_m_.data()}},
                        results);
    }

    glm::dvec2 place_m_;
    T cell_m_;
    double spacing_m_;
    FrameBounds<T> bounds_;
    PreparedQuery<T> query_;
    std::vector<glm::vec<2, T>> rest_m_;
    std::vector<T> cells_m_;
    std::vector<glm::vec<3, T>> position_m_;
    double highest_m_ = 0.0;  // of the sheets found
};

}  // namespace

template <class T>
std::optional<double> surface_above(const Frame<T>& frame, int query, glm::dvec3 point_m, double cell_m) {
    return Surroundings<T>(frame, query, glm::dvec2(point_m), cell_m).highest_above(point_m.z);
}

template std::optional<double> surface_above(const Frame<float>&, int, glm::dvec3, double);
template std::optional<double> surface_above(const Frame<double>&, int, glm::dvec3, double);

}  // namespace pelagic
