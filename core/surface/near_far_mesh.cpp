#include "core/surface/near_far_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "core/base/constants.h"

namespace pelagic {
namespace {

// Rings reach this far where the near patch is as given. Beyond, waves of 1 m (standard deviation; a significant
// height of 4 m) span less than an eighth of a milliradian, a sixth of a pixel of the default camera. The far part
// may leave that unresolved.
constexpr double kRings_m = 8192.0;
// A circle of fewer columns is seen to have corners.
constexpr int kLeastColumns = 64;
// Far rows, at least, and how many of the near patch's cells there are for each.
constexpr int kLeastRows = 16, kCellsPerRow = 4;

// The ring round a square.
NearFarMesh::Level ring_round(const NearFarMesh::Level& inner, int resolution) {
    // In cells of the inner square, counted from the ring's cell below the camera: the square reaches from p − before
    // to p − before + cells, where p is 0 or 1, and the hole from −2 left to −2 left + 2 hole. At least one cell is
    // between them.
    const int left = inner.before / 2 + 1;
    NearFarMesh::Level ring;
    ring.hole = (inner.cells - inner.before + 2 * left + 3) / 2;
    ring.width = std::max((resolution - ring.hole) / 2, 1);
    ring.cells = ring.hole + 2 * ring.width;
    ring.before = left + ring.width;
    ring.first_point = inner.first_point + inner.points();
    return ring;
}

void add_face(Faces& faces, std::initializer_list<std::size_t> corners) {
    faces.counts.push_back(static_cast<std::int32_t>(corners.size()));
    for (const std::size_t corner : corners) faces.indices.push_back(static_cast<std::int32_t>(corner));
}

// Points along one side of a border, and where they lie along it: a strip's diagonals are chosen by that.
struct Side {
    std::vector<std::size_t> points;
    std::vector<double> at;
};

// Triangles between two parallel lines, of which the outer one is on the right of the way.
void add_strip(const Side& inner, const Side& outer, Faces& faces) {
    std::size_t i = 0, j = 0;
    while (i + 1 < inner.points.size() || j + 1 < outer.points.size()) {
        const bool goes_out =
            j + 1 < outer.points.size() &&
            (i + 1 == inner.points.size() || outer.at[j] + outer.at[j + 1] <= inner.at[i] + inner.at[i + 1]);
        if (goes_out) {
            add_face(faces, {outer.points[j], outer.points[j + 1], inner.points[i]});
            ++j;
        } else {
            add_face(faces, {inner.points[i], outer.points[j], inner.points[i + 1]});
            ++i;
        }
    }
}

// One side of a square within a level, counter-clockwise: 0 is the lower one, 1 the right one, …
// The square's corners are (first, first) and (first + cells, first + cells).
std::vector<std::size_t> square_side(const NearFarMesh::Level& level, int first, int cells, int side) {
    std::vector<std::size_t> points;
    for (int i = 0; i <= cells; ++i) {
        const int low = first, high = first + cells;
        const std::array<std::array<int, 2>, 4> at{
            {{low + i, low}, {high, low + i}, {high - i, high}, {low, high - i}}};
        points.push_back(level.point(at[side][0], at[side][1]));
    }
    return points;
}

// n + 1 places from `from` in equal steps.
std::vector<double> even(double from, double step, std::size_t count) {
    std::vector<double> at(count);
    for (std::size_t i = 0; i < count; ++i) at[i] = from + step * static_cast<double>(i);
    return at;
}

}  // namespace

std::size_t NearFarMesh::Level::points() const {
    return point(cells, cells) + 1 - first_point;
}

std::size_t NearFarMesh::Level::point(int x, int y) const {
    const auto full = static_cast<std::size_t>(cells) + 1;
    if (!has_hole() || y <= width) return first_point + full * y + x;
    const std::size_t part = 2 * (static_cast<std::size_t>(width) + 1), beside = hole - 1;
    const std::size_t lower = first_point + full * (width + 1);
    if (y < width + hole) return lower + part * (y - width - 1) + (x <= width ? x : x - beside);
    return lower + part * beside + full * (y - width - hole) + x;
}

NearFarMesh::NearFarMesh(double size_m, int resolution) {
    levels_.push_back({.cells = resolution, .before = resolution / 2});
    for (double half_m = 0.5 * size_m; half_m < kRings_m; half_m *= 2.0)
        levels_.push_back(ring_round(levels_.back(), resolution));
    first_far_ = levels_.back().first_point + levels_.back().points();
    columns_ = std::max(4 * levels_.back().cells, kLeastColumns);
    rows_ = std::max((resolution + kCellsPerRow - 1) / kCellsPerRow, kLeastRows);
}

std::size_t NearFarMesh::quads() const {
    std::size_t sum = static_cast<std::size_t>(rows_ - 1) * static_cast<std::size_t>(columns_);
    for (const Level& level : levels_) {
        const auto side = static_cast<std::size_t>(level.cells), hole = static_cast<std::size_t>(level.hole);
        sum += side * side - hole * hole;
    }
    return sum;
}

// A band has one for each edge of both its borders.
std::size_t NearFarMesh::triangles() const {
    auto sum = static_cast<std::size_t>(columns_);
    for (const Level& level : levels_) sum += 4 * static_cast<std::size_t>(level.cells + level.hole);
    return sum;
}

void NearFarMesh::add_quads(const Level& level, Faces& faces) const {
    for (int y = 0; y < level.cells; ++y)
        for (int x = 0; x < level.cells; ++x) {
            if (x >= level.width && y >= level.width && y < level.width + level.hole &&
                x < level.width + level.hole)
                x = level.width + level.hole;
            add_face(faces, {level.point(x, y), level.point(x + 1, y), level.point(x + 1, y + 1),
                             level.point(x, y + 1)});
        }
}

// From a level to the next, or to the far part's first row.
void NearFarMesh::add_band(std::size_t level, Faces& faces) const {
    const Level& inside = levels_[level];
    for (int side = 0; side < 4; ++side) {
        Side inner{square_side(inside, 0, inside.cells, side), {}}, outer;
        if (level + 1 < levels_.size()) {
            const Level& outside = levels_[level + 1];
            outer.points = square_side(outside, outside.width, outside.hole, side);
            // In cells of the inner square, in the middle of its steps; rising along the way on all sides.
            const double gap = 2.0 * (outside.before - outside.width) - inside.before + 0.5;
            const double shift = side < 2 ? gap : 2.0 * outside.hole - inside.cells - gap;
            inner.at = even(shift, 1.0, inner.points.size());
            outer.at = even(0.0, 2.0, outer.points.size());
        } else {
            const int quarter = columns_ / 4;
            for (int i = 0; i <= quarter; ++i) {
                outer.points.push_back(far_point(0, (side * quarter + i) % columns_));
                outer.at.push_back(0.5 * (inside.cells + 2) * std::tan(0.5 * kPi * i / quarter - 0.25 * kPi));
            }
            inner.at = even(-0.5 * inside.cells, 1.0, inner.points.size());
        }
        add_strip(inner, outer, faces);
    }
}

void NearFarMesh::set_st(Faces& faces) const {
    faces.st.clear();
    faces.st.reserve(points());
    // Concentric layers: one for each square, and one for the far part.
    const double layers = static_cast<double>(levels_.size()) + 1.0;
    const auto add = [&](double x, double y, double layer) {  // max(|x|, |y|) is 1
        const double half = 0.5 * layer / layers;
        faces.st.emplace_back(static_cast<float>(0.5 + half * x), static_cast<float>(0.5 + half * y));
    };
    for (std::size_t l = 0; l < levels_.size(); ++l) {
        const Level& level = levels_[l];
        level.for_each_point([&](int px, int py) {
            const double x = 2.0 * px / level.cells - 1.0, y = 2.0 * py / level.cells - 1.0;
            const double out = std::max(std::abs(x), std::abs(y));
            // The hole's border lies a part of the ring's width away from the square inside it.
            const double inmost = (level.hole - 1.0) / level.cells;
            const double layer =
                level.has_hole() ? static_cast<double>(l) + (out - inmost) / (1.0 - inmost) : out;
            add(out > 0.0 ? x / out : 0.0, out > 0.0 ? y / out : 0.0, layer);
        });
    }
    for (int row = 0; row < rows_; ++row)
        for (int column = 0; column < columns_; ++column) {
            const double azimuth = kTwoPi * column / columns_ - 0.75 * kPi;
            const double x = std::cos(azimuth), y = std::sin(azimuth),
                         out = std::max(std::abs(x), std::abs(y));
            add(x / out, y / out, layers - 1.0 + (row + 1.0) / rows_);
        }
}

void NearFarMesh::set_faces(Faces& faces) const {
    faces.counts.clear();
    faces.indices.clear();
    faces.counts.reserve(quads() + triangles());
    faces.indices.reserve(4 * quads() + 3 * triangles());
    for (std::size_t level = 0; level < levels_.size(); ++level) {
        add_quads(levels_[level], faces);
        add_band(level, faces);
    }
    for (int row = 0; row + 1 < rows_; ++row)
        for (int column = 0; column < columns_; ++column) {
            const int next = (column + 1) % columns_;
            add_face(faces, {far_point(row, column), far_point(row + 1, column), far_point(row + 1, next),
                             far_point(row, next)});
        }
    set_st(faces);
}

}  // namespace pelagic
