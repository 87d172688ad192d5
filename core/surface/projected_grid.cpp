// The projected grid. See projected_grid.h.
#include "core/surface/projected_grid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <optional>

#include "core/base/constants.h"

namespace pelagic {
namespace {

// What lies beyond the last row is seen under less than this many pixels.
constexpr double kHorizon_px = 0.05;
// No row is further, so that squares of distances stay finite in single precision.
constexpr double kFarthest_m = 1e15;
// A camera in the surface of a calm sea still stands this high over it.
constexpr double kLeastHeight_m = 0.01;
// The picture's plane stretches angles by 1/cos² of their distance from the axis. Cells are made as small as
// a corner asks for, but not below this share of the axis' own (60° away from it).
constexpr double kStretched = 0.25;
// Cells of rows that only displaced crests come into view from, and of rows within kNear reaches of the
// nadir, which go most of the way round it, may be this much larger.
constexpr double kMargin = 3.0, kNear = 2.0;
// In view, columns shift by this part of a cell from row to row at most: a side is then longer than the
// rows' distance, by up to √(1 + ¼) in a corner.
constexpr double kShift = 0.5;
// Cells are made smaller by this, so that such a side is no longer than asked: by trial over poses and lenses
// (the largest was 1.08 × cell_px without it).
constexpr double kSlack = 0.92;
// Counts are multiples of this, and not beyond the largest: 8K pictures with a cell for each pixel.
constexpr int kCountStep = 16, kLargestCount = 8192;

double cross(glm::dvec2 a, glm::dvec2 b) {
    return a.x * b.y - a.y * b.x;
}

// A convex polygon, counter-clockwise; a segment or a point where there is no more; empty.
using Polygon = std::vector<glm::dvec2>;

// Andrew's monotone chain.
Polygon convex_hull(std::vector<glm::dvec2> points) {
    const auto before = [](glm::dvec2 a, glm::dvec2 b) { return a.x < b.x || (a.x == b.x && a.y < b.y); };
    std::sort(points.begin(), points.end(), before);
    points.erase(std::unique(points.begin(), points.end()), points.end());
    if (points.size() < 3) return points;
    Polygon hull;
    const auto chain = [&](auto first, auto last) {
        const std::size_t start = hull.size();
        for (auto at = first; at != last; ++at) {
            while (hull.size() >= start + 2 &&
                   cross(hull.back() - hull[hull.size() - 2], *at - hull.back()) <= 0.0)
                hull.pop_back();
            hull.push_back(*at);
        }
        hull.pop_back();  // the other chain's first
    };
    chain(points.begin(), points.end());
    chain(points.rbegin(), points.rend());
    return hull;
}

// Where the camera stands, and which way it looks: azimuths are counted from the middle of the picture.
struct Station {
    double height_m;            // h above the sea at rest
    double effective_height_m;  // √(h² + (Hs/2)²)
    double farthest_m;          // the last row
    double corner_cos;          // of the angle between a corner of the picture and its axis
    glm::dvec2 ahead;           // unit: azimuth 0
};

Station station_of(const View& view, const ProjectedGridOptions& options) {
    Station at;
    at.height_m = view.position_m.z;
    at.effective_height_m =
        std::max(std::hypot(at.height_m, 0.5 * options.significant_height_m), kLeastHeight_m);
    const double tan_corner =
        view.tan_half_width *
        std::hypot(1.0, static_cast<double>(view.resolution.y) / static_cast<double>(view.resolution.x));
    at.corner_cos = 1.0 / std::hypot(1.0, tan_corner);
    at.farthest_m = std::min(at.effective_height_m / (kHorizon_px * view.pixel_tangent() *
                                                      std::max(at.corner_cos * at.corner_cos, 1e-6)),
                             kFarthest_m);
    // forward's own azimuth; where the camera looks straight down or up, that of the picture's upper or lower
    // edge, and without a jump on the way there.
    const glm::dvec3 middle = view.forward - view.forward.z * view.up;
    const double length = std::hypot(middle.x, middle.y);
    at.ahead = length > 0.0 ? glm::dvec2(middle) / length : glm::dvec2(0.0, 1.0);
    return at;
}

// The shadow of what is in view of the slab |z| ≤ height_m: the camera's nadir is 0, +x is ahead. Cut off
// well beyond the last row.
Polygon in_view(const View& view, const Station& at, double height_m) {
    const double far_m = 8.0 * at.farthest_m;
    std::vector<glm::dvec2> points;
    const auto flat = [&](glm::dvec3 d) {
        const glm::dvec2 xy(d);
        return glm::dvec2(glm::dot(at.ahead, xy), cross(at.ahead, xy));
    };
    if (std::abs(at.height_m) <= height_m) points.emplace_back(0.0, 0.0);
    // Rays of the picture's border, from the camera to both faces of the slab.
    constexpr int kSteps = 16;  // an edge, evenly in angle: the far cut's chords stay beyond the last row
    std::vector<glm::dvec3> border;
    std::array<glm::dvec3, 4> corners;
    const glm::dvec2 size(view.resolution);
    const std::array<glm::dvec2, 4> places{glm::dvec2(0.0), {size.x, 0.0}, size, {0.0, size.y}};
    for (int i = 0; i < 4; ++i) corners[i] = view.direction(places[i]);
    for (int i = 0; i < 4; ++i) {
        const glm::dvec3 a = corners[i], b = corners[(i + 1) % 4];
        const double angle = std::acos(std::clamp(glm::dot(a, b), -1.0, 1.0));
        for (int s = 0; s < kSteps; ++s) {
            const double t = s / double{kSteps};
            border.push_back(angle > 1e-9 ? (std::sin((1.0 - t) * angle) * a + std::sin(t * angle) * b) /
                                                std::sin(angle)
                                          : a);
        }
    }
    bool hits = !points.empty();
    for (const glm::dvec3& d : border)
        for (const double face_m : {-height_m, height_m}) {
            const double way_m = (face_m - at.height_m) / d.z;
            if (!(way_m >= 0.0)) continue;
            hits = true;
            const double across = std::hypot(d.x, d.y);
            points.push_back(flat(d) * std::min(way_m, far_m / std::max(across, 1e-300)));
        }
    if (!hits) return {};
    // The horizon, where it is in view: between the two places where the border crosses it.
    std::vector<double> crossings;
    for (std::size_t i = 0; i < border.size(); ++i) {
        const glm::dvec3 a = border[i], b = border[(i + 1) % border.size()];
        if ((a.z < 0.0) == (b.z < 0.0)) continue;
        const glm::dvec2 level = flat(a * b.z - b * a.z);
        // a·b_z − b·a_z points along a or against it.
        const double side = b.z - a.z;
        crossings.push_back(std::atan2(side < 0.0 ? -level.y : level.y, side < 0.0 ? -level.x : level.x));
    }
    if (crossings.size() == 2) {
        double first = crossings[0], span = std::remainder(crossings[1] - first, 2.0 * kPi);
        constexpr int kHorizonSteps = 16;
        for (int s = 0; s <= kHorizonSteps; ++s) {
            const double azimuth = first + span * s / kHorizonSteps;
            points.push_back(far_m * glm::dvec2(std::cos(azimuth), std::sin(azimuth)));
        }
    }
    return convex_hull(std::move(points));
}

// Calls visit(a, b) with each side; a point is a side, too.
template <class Visit>
void for_each_side(const Polygon& polygon, Visit&& visit) {
    for (std::size_t i = 0; i < polygon.size(); ++i) visit(polygon[i], polygon[(i + 1) % polygon.size()]);
}

bool contains(const Polygon& polygon, glm::dvec2 p) {
    if (polygon.size() < 3) return false;
    bool inside = true;
    for_each_side(polygon,
                  [&](glm::dvec2 a, glm::dvec2 b) { inside = inside && cross(b - a, p - a) >= 0.0; });
    return inside;
}

struct Interval {
    double first = 0.0, last = 0.0;
};

// The polygon's least and largest distance from the nadir.
Interval distances(const Polygon& polygon) {
    Interval r{contains(polygon, {0.0, 0.0}) ? 0.0 : std::numeric_limits<double>::infinity(), 0.0};
    for_each_side(polygon, [&](glm::dvec2 a, glm::dvec2 b) {
        r.last = std::max(r.last, glm::length(a));
        const glm::dvec2 way = b - a;
        const double square = glm::dot(way, way);
        const double t = square > 0.0 ? std::clamp(-glm::dot(a, way) / square, 0.0, 1.0) : 0.0;
        r.first = std::min(r.first, glm::length(a + t * way));
    });
    return r;
}

// The largest |azimuth| of the polygon's points between two circles; none where it has none there.
std::optional<double> half_width(const Polygon& polygon, Interval ring) {
    // Straight behind: then all round.
    if (contains(polygon, {-ring.first, 0.0})) return kPi;
    std::optional<double> widest;
    const auto take = [&](glm::dvec2 p) {
        widest = std::max(widest.value_or(0.0), std::abs(std::atan2(p.y, p.x)));
    };
    // Along a side the azimuth only rises or only falls: it is widest where the side enters or leaves.
    for_each_side(polygon, [&](glm::dvec2 a, glm::dvec2 b) {
        const double r = glm::length(a);
        if (r >= ring.first && r <= ring.last) take(a);
        const double length = glm::length(b - a);
        if (!(length > 0.0)) return;
        const glm::dvec2 along = (b - a) / length;
        const double start = glm::dot(a, along);
        const double distance = cross(along, a);  // of the line from the nadir
        const glm::dvec2 foot = distance * glm::dvec2(-along.y, along.x);
        for (const double circle : {ring.first, ring.last}) {
            const double square = circle * circle - distance * distance;
            if (square < 0.0) continue;
            for (const double s : {-std::sqrt(square), std::sqrt(square)})
                if (s >= start && s <= start + length) take(foot + s * along);
        }
        if ((a.y < 0.0) != (b.y < 0.0)) {
            const double x = a.x - a.y * (b.x - a.x) / (b.y - a.y);
            if (-x >= ring.first && -x <= ring.last) widest = kPi;
        }
    });
    return widest;
}

struct Row {
    double radius_m;
    double half_width;  // azimuths, to either side of ahead
    bool in_view;       // of the sea at rest
    double seen_width;  // of it alone, likewise
    bool fine;          // in view, and not so near that the reach of crests goes most of the way round
};

// A pose's rows, `count` cells of them or as many as it needs.
std::vector<Row> rows_of(const View& view, const ProjectedGridOptions& options, const Station& at,
                         double cell_angle, int count) {
    const double reach_m = options.bounds.reach_m;
    const Polygon slab = in_view(view, at, options.bounds.height_m), plane = in_view(view, at, 0.0);
    Interval radii{0.5 * at.farthest_m, at.farthest_m}, seen = radii;
    if (!slab.empty()) {
        const Interval reached = distances(slab);
        radii.last = std::min(reached.last + reach_m, at.farthest_m);
        radii.first = std::clamp(reached.first - reach_m, 0.0, 0.5 * radii.last);
    }
    if (!plane.empty()) {
        seen = distances(plane);
        seen.first = std::clamp(seen.first, radii.first, radii.last);
        seen.last = std::clamp(seen.last, radii.first, radii.last);
    } else {
        seen = radii;
    }
    const auto angle_at = [&](double radius_m) { return std::atan2(radius_m, at.effective_height_m); };
    // Cells from the first row to an angle: fewer in the margins.
    const Interval angles{angle_at(radii.first), angle_at(radii.last)};
    const Interval core{angle_at(seen.first), angle_at(seen.last)};
    const double before = (core.first - angles.first) / (kMargin * cell_angle);
    const double inside = (core.last - core.first) / cell_angle;
    const double after = (angles.last - core.last) / (kMargin * cell_angle);
    const double all = before + inside + after;
    const auto angle_of = [&](double cells) {
        if (cells < before) return angles.first + cells * kMargin * cell_angle;
        if (cells < before + inside) return core.first + (cells - before) * cell_angle;
        return std::min(core.last + (cells - before - inside) * kMargin * cell_angle, angles.last);
    };
    if (count == 0) {
        const double needed = std::ceil(all / kCountStep) * kCountStep;
        count = static_cast<int>(std::clamp(needed, 1.0 * kCountStep, 1.0 * kLargestCount));
    }
    std::vector<Row> rows(static_cast<std::size_t>(count) + 1);
    for (int i = 0; i <= count; ++i)
        rows[i].radius_m = i == 0       ? radii.first
                           : i == count ? radii.last
                                        : at.effective_height_m * std::tan(angle_of(all * i / count));
    // A row's chords lie inside its circle.
    const int least_columns = options.size.columns > 0 ? options.size.columns : kCountStep;
    const double sagitta = std::cos(kPi / std::max(least_columns, 3));
    for (int i = 0; i <= count; ++i) {
        // What lies between the neighbouring rows: the cells' sides then leave nothing out.
        const Interval ring{rows[std::max(i - 1, 0)].radius_m * sagitta,
                            rows[std::min(i + 1, count)].radius_m};
        const Interval reached{std::max(ring.first - reach_m, 0.0), ring.last + reach_m};
        std::optional<double> half;
        if (ring.first <= reach_m && reach_m > 0.0)
            half = kPi;
        else if (const auto seen_half = half_width(slab, reached))
            half = *seen_half + (reach_m > 0.0 ? std::asin(reach_m / ring.first) : 0.0);
        rows[i].half_width = std::min(half.value_or(std::atan(view.tan_half_width)), kPi);
        rows[i].in_view = rows[i].radius_m >= seen.first && rows[i].radius_m <= seen.last;
        rows[i].fine = rows[i].in_view && rows[i].radius_m >= kNear * reach_m;
        rows[i].seen_width = rows[i].in_view ? half_width(plane, ring).value_or(0.0) : 0.0;
    }
    // What is in view stays straight: columns follow a neighbouring row that is wider.
    const auto follow = [&](Row& row, const Row& neighbour) {
        const double cell = kShift * cell_angle * std::hypot(row.radius_m, at.effective_height_m) /
                            std::max(row.radius_m, 1e-300);
        row.half_width = std::max(row.half_width, neighbour.half_width - cell);
    };
    for (int i = count; i-- > 0;) follow(rows[i], rows[i + 1]);
    for (int i = 1; i <= count; ++i)
        if (rows[i - 1].fine) follow(rows[i], rows[i - 1]);
    if (radii.last < at.farthest_m) rows.back().radius_m /= sagitta;
    return rows;
}

double cell_angle_of(const View& view, const ProjectedGridOptions& options, const Station& at) {
    return kSlack * options.cell_px * view.pixel_tangent() *
           std::max(at.corner_cos * at.corner_cos, kStretched);
}

// What a pixel covers along its longer side at a distance from the nadir, where the way from the camera has
// this cosine with the picture's axis.
double pixel_footprint_m(const View& view, const Station& at, double radius_m, double cosine) {
    return view.pixel_tangent() * cosine *
           (radius_m * radius_m / at.effective_height_m + at.effective_height_m);
}

}  // namespace

ProjectedGridNeeds together(const ProjectedGridNeeds& a, const ProjectedGridNeeds& b) {
    return {.size = {std::max(a.size.columns, b.size.columns), std::max(a.size.rows, b.size.rows)},
            .finest_cell_m = std::min(a.finest_cell_m, b.finest_cell_m),
            .finest_pixel_m = std::min(a.finest_pixel_m, b.finest_pixel_m)};
}

ProjectedGridNeeds projected_grid_needs(const View& view, const ProjectedGridOptions& options) {
    const Station at = station_of(view, options);
    const double cell_angle = cell_angle_of(view, options, at);
    const std::vector<Row> rows = rows_of(view, options, at, cell_angle, 0);
    double cells = 0.0;
    for (const Row& row : rows) {
        const double width = row.fine ? row.half_width : std::max(row.seen_width, row.half_width / kMargin);
        const double across = 2.0 * width * row.radius_m / std::hypot(row.radius_m, at.effective_height_m);
        cells = std::max(cells, across / cell_angle);
    }
    const double columns =
        std::clamp(std::ceil(cells / kCountStep) * kCountStep, 1.0 * kCountStep, 1.0 * kLargestCount);
    double finest_cell_m = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i + 1 < rows.size(); ++i)
        finest_cell_m = std::min(finest_cell_m, rows[i + 1].radius_m - rows[i].radius_m);
    return {.size = {static_cast<int>(columns), static_cast<int>(rows.size()) - 1},
            .finest_cell_m = finest_cell_m,
            .finest_pixel_m = pixel_footprint_m(view, at, rows[0].radius_m, at.corner_cos)};
}

ProjectedGrid projected_grid(const View& view, const ProjectedGridOptions& options) {
    const Station at = station_of(view, options);
    ProjectedGridOptions sized = options;
    if (sized.size.columns <= 0 || sized.size.rows <= 0)
        sized.size = projected_grid_needs(view, options).size;
    const auto [columns, row_count] = sized.size;
    const std::vector<Row> rows = rows_of(view, sized, at, cell_angle_of(view, options, at), row_count);

    ProjectedGrid grid{.columns = columns, .rows = row_count, .origin_m = glm::dvec2(view.position_m)};
    const std::size_t stride = static_cast<std::size_t>(columns) + 1;
    const std::size_t count = stride * rows.size();
    grid.rest_m.resize(count);
    grid.cell_m.resize(count);
    grid.pixel_m.resize(count);
    std::vector<glm::dvec2> previous(stride), row(stride);
    std::vector<double> cell_m(count, 0.0);
    for (std::size_t j = 0; j < rows.size(); ++j) {
        const double r = rows[j].radius_m;
        for (std::size_t i = 0; i < stride; ++i) {
            const double azimuth = rows[j].half_width * (2.0 * static_cast<double>(i) / columns - 1.0);
            const glm::dvec2 unit(std::cos(azimuth), std::sin(azimuth));
            // Rightwards in the picture: clockwise from above.
            row[i] = r * glm::dvec2(at.ahead.x * unit.x + at.ahead.y * unit.y,
                                    at.ahead.y * unit.x - at.ahead.x * unit.y);
            const std::size_t here = j * stride + i;
            grid.rest_m[here] = glm::vec2(row[i]);
            // A pixel's angle falls with the cosine of its distance from the axis, at least; to the corner's.
            const glm::dvec3 way =
                glm::normalize(glm::dvec3(row[i], -std::copysign(at.effective_height_m, at.height_m)));
            const double cosine = std::max(glm::dot(way, view.forward), at.corner_cos);
            grid.pixel_m[here] = static_cast<float>(pixel_footprint_m(view, at, r, cosine));
            const auto join = [&](std::size_t other, double distance_m) {
                cell_m[here] = std::max(cell_m[here], distance_m);
                cell_m[other] = std::max(cell_m[other], distance_m);
            };
            if (i > 0) join(here - 1, glm::length(row[i] - row[i - 1]));
            if (j > 0) join(here - stride, glm::length(row[i] - previous[i]));
        }
        previous.swap(row);
    }
    std::transform(cell_m.begin(), cell_m.end(), grid.cell_m.begin(),
                   [](double metres) { return static_cast<float>(metres); });
    return grid;
}

std::vector<std::uint32_t> projected_grid_triangles(ProjectedGridSize size) {
    const auto columns = static_cast<std::uint32_t>(size.columns),
               rows = static_cast<std::uint32_t>(size.rows);
    const std::uint32_t stride = columns + 1;
    std::vector<std::uint32_t> triangles;
    triangles.reserve(std::size_t(6) * columns * rows);
    for (std::uint32_t j = 0; j < rows; ++j)
        for (std::uint32_t i = 0; i < columns; ++i) {
            // Counter-clockwise from above: columns run to the right, rows away from the camera.
            const std::uint32_t near_left = j * stride + i, far_left = near_left + stride;
            for (const std::uint32_t index :
                 {near_left, near_left + 1, far_left + 1, near_left, far_left + 1, far_left})
                triangles.push_back(index);
        }
    return triangles;
}

}  // namespace pelagic
