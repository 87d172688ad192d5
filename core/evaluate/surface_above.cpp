#include "core/evaluate/surface_above.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat2x2.hpp>
#include <glm/matrix.hpp>
#include <glm/vec2.hpp>
#include <iterator>
#include <limits>
#include <vector>

#include "core/base/constants.h"

namespace pelagic {
namespace {

// Squares are halved until kCells cells a side sample them finely enough. A cell is this long [m] or, where a
// footprint lets only longer waves through, this part of the footprint: forty cells to the shortest wave. Extremely
// choppy waves may fold within less. For many places the cells are five times as long: eight to the shortest wave.
constexpr int kCells = 32;
// Of these, blocks of so many a side are looked at first by their corners alone: those whose corners, and as far again as
// these lie apart, don't surround the point have no sheet over it.
constexpr int kBlock = 4;
constexpr double kFinestSpacing_m = 0.02, kSpacingOfCell = 0.05, kCoarser = 5.0;
// A search may look at so many squares and points; for one of many places, at a quarter. Storms with folds take a fifth of
// that. A sea that goes aside by hundreds of its wavelengths, as no water does, takes more: it is searched again with cells
// of four times the length, until that is enough.
constexpr long kMostSquares = 16'384, kMostPoints = 1'048'576;
constexpr double kCoarserAgain = 4.0;

// A place at rest, and where it is displaced to, both relative to the point's place.
struct Node {
    glm::dvec2 rest_m;
    glm::dvec3 position_m;
};

// A sheet over a place: its height, the point at rest relative to the place, and how far beside the place that goes.
struct Sheet {
    double height_m;
    glm::dvec2 rest_m;
    double residual_m;
};

// What a search does with a sheet that a triangle has found.
struct Steps {
    int most = 4;              // towards the surface itself
    double tolerance_m = 0.0;  // near enough
    // Whether one that they don't reach doesn't count: otherwise the triangle is the answer.
    bool must_arrive = false;
};

// The surface round one place of the world. Coordinates are relative to that place.
template <class T>
class Surroundings {
  public:
    // `by`: Position or Displacement, for which the query is prepared.
    Surroundings(const FrameBounds<T>& bounds, const PreparedQuery<T>& query, VectorProduct by,
                 glm::dvec2 place_m, double cell_m, double spacing, bool alone)
        : bounds_(bounds),
          query_(query),
          by_(by),
          place_m_(place_m),
          cell_m_(static_cast<T>(cell_m)),
          spacing_m_(spacing * std::max(kFinestSpacing_m, kSpacingOfCell * cell_m)),
          alone_(alone) {}

    // The highest sheet that lies above z.
    std::optional<Sheet> highest_above(double z_m, const Steps& steps = {}) {
        steps_ = steps;
        highest_m_ = z_m;
        const DisplacementBounds all = bounds_.everywhere();
        if (!(all.z.hi > z_m)) return std::nullopt;
        const double half_m = std::max({all.reach_m().x, all.reach_m().y, spacing_m_});
        const long share = alone_ ? 4 : 1;
        do {
            squares_left_ = kMostSquares / share;
            points_left_ = kMostPoints / share;
            search({glm::dvec2(-half_m), glm::dvec2(half_m)});
            spacing_m_ *= kCoarserAgain;
        } while (is_over_the_most());
        return highest_;
    }

  private:
    bool is_over_the_most() const { return squares_left_ < 0 || points_left_ < 0; }

    // Searches a square, unless its bounds exclude a sheet over the place that is higher than those found, or the search
    // has become too long.
    void search(const RestRegion& square) {
        --squares_left_;
        if (is_over_the_most()) return;
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
        constexpr int kBlocks = kCells / kBlock, kCorners = kBlocks + 1, kSide = kBlock + 1;
        const glm::dvec2 step = (square.max_m - square.min_m) / static_cast<double>(kCells);
        const auto add = [&](int i, int j) {
            rest_m_.push_back(glm::vec<2, T>(square.min_m + step * glm::dvec2(i, j)));
        };
        rest_m_.clear();
        for (int j = 0; j < kCorners; ++j)
            for (int i = 0; i < kCorners; ++i) add(i * kBlock, j * kBlock);
        evaluate();
        rest_m_.clear();
        for (int j = 0; j < kBlocks; ++j)
            for (int i = 0; i < kBlocks; ++i)
                if (may_cover(&position_m_[j * kCorners + i], kCorners))
                    for (int y = 0; y < kSide; ++y)
                        for (int x = 0; x < kSide; ++x) add(i * kBlock + x, j * kBlock + y);
        if (rest_m_.empty()) return;
        evaluate();
        const std::vector<glm::vec<3, T>> corners = position_m_;
        const std::vector<glm::vec<2, T>> rests = rest_m_;
        for (std::size_t first = 0; first < rests.size(); first += kSide * kSide) {
            const auto node = [&](int i, int j) {
                const std::size_t at = first + static_cast<std::size_t>(j * kSide + i);
                return Node{glm::dvec2(rests[at]), glm::dvec3(corners[at])};
            };
            for (int j = 0; j < kBlock; ++j)
                for (int i = 0; i < kBlock; ++i) {
                    consider(node(i, j), node(i + 1, j), node(i, j + 1));
                    consider(node(i + 1, j + 1), node(i, j + 1), node(i + 1, j));
                }
        }
    }

    // Whether a sheet over the place, higher than those found, may lie within a block whose first corner this is.
    bool may_cover(const glm::vec<3, T>* corner, int row) const {
        const std::array corners{glm::dvec3(corner[0]), glm::dvec3(corner[1]), glm::dvec3(corner[row]),
                                 glm::dvec3(corner[row + 1])};
        glm::dvec3 low = corners[0], high = corners[0];
        for (const glm::dvec3& at : corners) {
            low = glm::min(low, at);
            high = glm::max(high, at);
        }
        const glm::dvec3 beyond(glm::length(high - low));
        low -= beyond;
        high += beyond;
        return low.x <= 0.0 && high.x >= 0.0 && low.y <= 0.0 && high.y >= 0.0 && high.z > highest_m_;
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
        glm::dvec2 rest_m = a.rest_m + rest_edges * share, found_m = rest_m;
        // The surface itself, by Newton's steps with the triangle's slope; where they don't come nearer, the
        // triangle is the answer.
        double height_m = on_triangle_m, missing_m = glm::length(rest_edges[0]);
        for (int tries = 0; tries < steps_.most && missing_m > steps_.tolerance_m; ++tries) {
            rest_m_.assign(1, glm::vec<2, T>(rest_m));
            evaluate();
            const glm::dvec3 position_m(position_m_[0]);
            const double now_m = glm::length(glm::dvec2(position_m));
            if (!(now_m < missing_m)) break;
            missing_m = now_m;
            height_m = position_m.z;
            found_m = glm::dvec2(rest_m_[0]);
            rest_m -= rest_from_position * glm::dvec2(position_m);
        }
        if (!(height_m > highest_m_) || (steps_.must_arrive && missing_m > steps_.tolerance_m)) return;
        highest_m_ = height_m;
        highest_ = {height_m, found_m, missing_m};
    }

    void evaluate() {
        points_left_ -= std::ssize(rest_m_);
        position_m_.resize(rest_m_.size());
        Results<T> results;
        results.set(by_, {position_m_.data()});
        cells_m_.resize(rest_m_.size(), cell_m_);
        const Points<T> points{.origin_m = place_m_,
                               .count = rest_m_.size(),
                               .rest_m = {rest_m_.data()},
                               .cell_m = {cells_m_.data()}};
        alone_ ? query_.evaluate_alone(points, results) : query_.evaluate(points, results);
        if (by_ == Product::Position) return;
        for (std::size_t i = 0; i < rest_m_.size(); ++i) position_m_[i] += glm::vec<3, T>(rest_m_[i], T(0));
    }

    const FrameBounds<T>& bounds_;
    const PreparedQuery<T>& query_;
    VectorProduct by_;
    glm::dvec2 place_m_;
    T cell_m_;
    double spacing_m_;
    bool alone_;
    Steps steps_;
    long squares_left_ = 0, points_left_ = 0;
    std::vector<glm::vec<2, T>> rest_m_;
    std::vector<T> cells_m_;
    std::vector<glm::vec<3, T>> position_m_;
    double highest_m_ = 0.0;  // of the sheets found
    std::optional<Sheet> highest_;
};

// Whether the surface has folded round a point at rest: rings of points, each three times as far away as the one
// before, make triangles, and a fold turns some of them over, or nearly so. Beside `height_m` of the point itself.
template <class T>
bool has_folded(const PreparedQuery<T>& query, glm::dvec2 origin_m, glm::vec<2, T> rest_m, T cell_m,
                double innermost_m, double& height_m) {
    constexpr int kRings = 3, kSides = 8, kPoints = 1 + kRings * kSides;
    constexpr double kTurned = 0.15;  // of its area at rest: what is left of a triangle near a fold
    std::array<glm::vec<2, T>, kPoints> rest;
    std::array<glm::vec<3, T>, kPoints> moved;
    std::array<T, kPoints> cells;
    cells.fill(cell_m);
    rest[0] = rest_m;
    double radius_m = innermost_m;
    for (int ring = 0, i = 1; ring < kRings; ++ring, radius_m *= 3.0)
        for (int side = 0; side < kSides; ++side, ++i) {
            const double angle = kTwoPi * side / kSides;
            rest[i] = rest_m + glm::vec<2, T>(radius_m * glm::dvec2(std::cos(angle), std::sin(angle)));
        }
    Results<T> results;
    results.set(Product::Displacement, {moved.data()});
    query.evaluate_alone(
        {.origin_m = origin_m, .count = kPoints, .rest_m = {rest.data()}, .cell_m = {cells.data()}}, results);
    height_m = static_cast<double>(moved[0].z);
    const auto area = [](glm::dvec2 a, glm::dvec2 b) { return a.x * b.y - a.y * b.x; };
    const auto is_turned = [&](int a, int b, int c) {
        const auto edge = [&](int to) { return glm::dvec2(rest[to]) - glm::dvec2(rest[a]); };
        const auto moved_edge = [&](int to) {
            return edge(to) + glm::dvec2(moved[to]) - glm::dvec2(moved[a]);
        };
        return !(area(moved_edge(b), moved_edge(c)) >= kTurned * area(edge(b), edge(c)));
    };
    for (int side = 0; side < kSides; ++side) {
        int near = 1 + side, next = 1 + (side + 1) % kSides;
        if (is_turned(0, near, next)) return true;
        for (int ring = 1; ring < kRings; ++ring, near += kSides, next += kSides)
            if (is_turned(near, near + kSides, next + kSides) || is_turned(near, next + kSides, next))
                return true;
    }
    return false;
}

}  // namespace

template <class T>
std::optional<double> surface_above(const Frame<T>& frame, int query, glm::dvec3 point_m, double cell_m) {
    const glm::dvec2 place_m(point_m);
    const FrameBounds<T> bounds(frame, query, {.finest_m = cell_m, .coarsest_m = cell_m});
    const PreparedQuery<T> prepared(frame, query, products(Product::Position), place_m);
    const auto sheet = Surroundings<T>(bounds, prepared, Product::Position, place_m, cell_m, 1.0, false)
                           .highest_above(point_m.z);
    return sheet ? std::optional(sheet->height_m) : std::nullopt;
}

template <class T>
void find_highest_rest(const BoundsByLevel<T>& bounds, const PreparedQuery<T>& query, const Points<T>& places,
                       const PlaceSearch& search, Strided<glm::vec<2, T>> rest_m, Strided<T> residual_m,
                       bool alone) {
    std::vector<T> own_residuals_m(residual_m ? 0 : places.count);
    if (!residual_m) residual_m = {own_residuals_m.data()};
    find_rest(query, places, search, rest_m, residual_m, alone);
    const auto raise = [&](std::size_t i) {
        // Folds are as wide as the shortest waves that are resolved, or as far as the waves move their points.
        constexpr double kCellsNear = 4.0, kOfWay = 0.25;
        const T cell_m =
            std::max(places.cell_m ? places.cell_m[i] : T(0), static_cast<T>(bounds.finest_cell_m()));
        const glm::dvec2 place_m(places.rest_m[i]);
        const double way_m = glm::length(glm::dvec2(rest_m[i]) - place_m);
        const double innermost_m = std::max(
            {kCellsNear * static_cast<double>(cell_m), kOfWay * way_m, kCellsNear * kFinestSpacing_m});
        double height_m = 0.0;
        const bool is_there = residual_m[i] <= search.tolerance_m;
        if (!has_folded(query, places.origin_m, rest_m[i], cell_m, innermost_m, height_m) && is_there) return;
        Surroundings<T> surroundings(bounds.of_cell(cell_m), query, Product::Displacement,
                                     places.origin_m + place_m, cell_m, kCoarser, true);
        const auto sheet = surroundings.highest_above(
            is_there ? height_m : -std::numeric_limits<double>::infinity(),
            {.most = search.most_steps, .tolerance_m = search.tolerance_m, .must_arrive = is_there});
        if (!sheet) return;
        rest_m[i] = glm::vec<2, T>(place_m + sheet->rest_m);
        residual_m[i] = static_cast<T>(sheet->residual_m);
    };
    if (alone)
        for (std::size_t i = 0; i < places.count; ++i) raise(i);
    else
        tbb::parallel_for(std::size_t{0}, places.count, raise);
}

template void find_highest_rest(const BoundsByLevel<float>&, const PreparedQuery<float>&,
                                const Points<float>&, const PlaceSearch&, Strided<glm::vec2>, Strided<float>,
                                bool);
template void find_highest_rest(const BoundsByLevel<double>&, const PreparedQuery<double>&,
                                const Points<double>&, const PlaceSearch&, Strided<glm::dvec2>,
                                Strided<double>, bool);

template std::optional<double> surface_above(const Frame<float>&, int, glm::dvec3, double);
template std::optional<double> surface_above(const Frame<double>&, int, glm::dvec3, double);

}  // namespace pelagic
