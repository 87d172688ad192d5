// The projected grid. See projected_grid.h.
#include "core/surface/projected_grid.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <optional>

#include "core/base/build_watch.h"
#include "core/base/constants.h"
#include "core/surface/earth.h"
#include "core/surface/earth_view.h"
#include "core/surface/footprint_levels.h"

namespace pelagic {
namespace {

// The sea beyond the last row covers less than this many pixels.
constexpr double kHorizon_px = 0.05;
// The last row is at most this far, so that squared distances stay finite in single precision.
constexpr double kFarthest_m = 1e15;
// The least effective height, for a camera at the surface of a calm sea.
constexpr double kLeastHeight_m = 0.01;
// A perspective picture stretches angles by 1/cos² of their distance from the optical axis. Cells are sized
// for the corners, but at most this much smaller than on the axis (a corner 60° off it).
constexpr double kStretched = 0.25;
// Cells may be kMargin times as large in rows that only displaced crests bring into view, and in rows within
// kNear reaches of the nadir, which span most of the circle.
constexpr double kMargin = 3.0, kNear = 2.0;
// In view, a column shifts by at most this part of a cell from row to row. A cell's side is then longer than
// the row spacing, by up to √(1 + ¼) in a corner.
constexpr double kShift = 0.5;
// Shrinks cells so that even such a side stays below cell_px. Found by trial over poses and lenses: the
// longest side was 1.08 × cell_px without it.
constexpr double kSlack = 0.92;
// A lens narrower than a quarter of a right angle across its picture's corners sees so little of the circle
// and of the way from the nadir to the horizon that evenly small cells would number millions. Rows keep their
// cells in the last kFine diagonals of what is in view of the sea at rest; the rest on either side, where only
// crests come before the lens, gets no more rows than kBeside diagonals have cells, and columns are no more than
// kAcross diagonals have. kSpare cells more let small pictures have a round grid.
constexpr double kFine = 4.0, kBeside = 1.0, kAcross = 6.0, kSpare = 64.0;
// The footprint that blurs as the mean over a pixel does, in pixels: the mean halves waves that are 1.66 pixels long,
// a footprint those of three footprints (core/plan/filter.h).
constexpr double kPixel = 0.6;
// Rows are so close together that the heights which cells of their length leave unresolved look kHeight_px high
// (standard deviation), where cells are no larger than kHeightCell_px across; larger ones leave more in proportion.
// The skyline of a gale is then within a pixel of the sea's own in 99 % of a picture's columns
// (skyline_test.cpp). Rows that heights alone ask for are no more than kHigh diagonals have cells: a telephoto lens sees
// crests behind crests for tens of kilometres.
constexpr double kHeight_px = 0.3, kHeightCell_px = 8.0, kHigh = 6.0;
// Counts are multiples of kCountStep. The largest serves an 8K picture with one cell per pixel.
constexpr int kCountStep = 16, kLargestCount = 8192;

double cross(glm::dvec2 a, glm::dvec2 b) {
    return a.x * b.y - a.y * b.x;
}

// A convex polygon, counter-clockwise; degenerate to a segment or a point; or empty.
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
        hull.pop_back();  // equals the other chain's first point
    };
    chain(points.begin(), points.end());
    chain(points.rbegin(), points.rend());
    return hull;
}

// The camera's place and heading. Azimuths are relative to `ahead`.
struct Station {
    double height_m;            // h above the sea at rest
    double effective_height_m;  // √(h² + (Hs/2)²)
    double farthest_m;          // radius of the last row
    double corner_cos;          // cosine of the angle between the optical axis and a corner of the picture
    double diagonal;            // the angle between opposite corners
    glm::dvec2 ahead;           // unit vector of azimuth 0
    EarthView earth{0.0, 0.0, 0.0};
};

Station station_of(const View& view, const ProjectedGridOptions& options) {
    Station at;
    at.height_m = view.position_m.z;
    at.effective_height_m =
        std::max(std::hypot(at.height_m, 0.5 * options.significant_height_m), kLeastHeight_m);
    const double tan_corner =
        view.tan_half_width *
        std::hypot(1.0 + 2.0 * std::abs(view.shift.x),
                   static_cast<double>(view.resolution.y) / static_cast<double>(view.resolution.x) +
                       2.0 * std::abs(view.shift.y));
    at.corner_cos = 1.0 / std::hypot(1.0, tan_corner);
    at.diagonal = 2.0 * std::atan(tan_corner);
    at.farthest_m = std::min(at.effective_height_m / (kHorizon_px * view.pixel_tangent() *
                                                      std::max(at.corner_cos * at.corner_cos, 1e-6)),
                             kFarthest_m);
    at.earth = EarthView(at.height_m, options.curvature_per_m, options.bounds.height_m);
    // The azimuth of `forward`; where that is vertical, the azimuth of the picture's upper or lower edge.
    // This expression goes from one to the other without a jump.
    // A shift to the right takes it along, so that rows reach no farther to one side than to the other.
    const glm::dvec3 middle = view.forward - view.forward.z * view.up + view.middle_tangents().x * view.right;
    const double length = std::hypot(middle.x, middle.y);
    at.ahead = length > 0.0 ? glm::dvec2(middle) / length : glm::dvec2(0.0, 1.0);
    return at;
}

// The convex hull of the part of the slab |z| ≤ height_m that is in view, projected onto the plane. The
// origin is the camera's nadir, +x is `ahead`. Truncated well beyond the last row.
Polygon in_view(const View& view, const Station& at, double height_m) {
    const double far_m = 8.0 * at.farthest_m;
    std::vector<glm::dvec2> points;
    const auto flat = [&](glm::dvec3 d) {
        const glm::dvec2 xy(d);
        return glm::dvec2(glm::dot(at.ahead, xy), cross(at.ahead, xy));
    };
    if (std::abs(at.height_m) <= height_m) points.emplace_back(0.0, 0.0);
    // Rays through the picture's border, cut with both faces of the slab.
    constexpr int kSteps = 16;  // per edge, evenly in angle: chords of the far cut stay beyond the last row
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
    // The horizon, if it is in view: the arc between its two crossings with the border.
    std::vector<double> crossings;
    for (std::size_t i = 0; i < border.size(); ++i) {
        const glm::dvec3 a = border[i], b = border[(i + 1) % border.size()];
        if ((a.z < 0.0) == (b.z < 0.0)) continue;
        const glm::dvec2 level = flat(a * b.z - b * a.z);
        // The sign that makes a·b_z − b·a_z point from the camera to the crossing.
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

// Calls visit(a, b) for each side. A polygon of one point has one side of length 0.
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

// The polygon's smallest and largest distance from the nadir.
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

// The largest |azimuth| of the polygon within a ring; nullopt where the two don't intersect.
std::optional<double> half_width(const Polygon& polygon, Interval ring) {
    // A polygon that contains a point straight behind the camera covers azimuth ± π.
    if (contains(polygon, {-ring.first, 0.0})) return kPi;
    std::optional<double> widest;
    const auto take = [&](glm::dvec2 p) {
        widest = std::max(widest.value_or(0.0), std::abs(std::atan2(p.y, p.x)));
    };
    // Azimuth is monotonic along a side, so its extremes are at vertices and where sides cross the circles.
    for_each_side(polygon, [&](glm::dvec2 a, glm::dvec2 b) {
        const double r = glm::length(a);
        if (r >= ring.first && r <= ring.last) take(a);
        const double length = glm::length(b - a);
        if (!(length > 0.0)) return;
        const glm::dvec2 along = (b - a) / length;
        const double start = glm::dot(a, along);
        const double distance = cross(along, a);  // from the nadir to the side's line
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
    double half_width;  // the row spans azimuths ± half_width
    bool in_view;       // the sea at rest is in view at this radius
    double seen_width;  // half width of that part
    bool fine;          // in_view, and farther than kNear reaches
};

bool is_narrow(const Station& at) {
    return kFine * at.diagonal < 0.5 * kPi;
}

// Where rows are: how many cells lie between the first one and a radius, which need not be a whole number. It is summed
// over short steps, each of which has as many cells as its angle asks for, or as the waves' heights do, whichever are
// more. All of it changes smoothly with the pose, and so do the rows.
class RowSpacing {
  public:
    // From radii.first to radii.last; the sea at rest is in view within `seen`. `count`: how many cells there will be;
    // 0: as many as are asked for.
    RowSpacing(Interval radii, Interval seen, const ProjectedGridOptions& options, const Station& at,
               double cell_angle, int count)
        : earth_(at.earth), height_m_(at.effective_height_m), first_m_(radii.first) {
        const double height_angle =
            kHeight_px / options.cell_px * cell_angle * std::max(options.cell_px / kHeightCell_px, 1.0);
        const auto part = [&](double last_m, Group group, double cell) {
            add_steps(last_m, group, cell * cell_angle, options.unresolved, height_angle);
        };
        // A narrow lens begins to have small cells here.
        double fine_m = radii.first;
        if (is_narrow(at)) {
            const double angle = earth_.angle_between(height_m_, 0.0, seen.last) - kFine * at.diagonal;
            const double flat_m = height_m_ * std::tan(std::clamp(angle, 0.0, 0.4999 * kPi));
            fine_m = std::clamp(at.earth.arc_of(flat_m), radii.first, seen.last);
        }
        part(std::min(fine_m, seen.first), kNearby, kMargin);
        if (fine_m < seen.first)
            part(seen.first, kFineOnes, kMargin);
        else
            part(fine_m, kNearby, 1.0);
        part(seen.last, kFineOnes, 1.0);
        part(radii.last, kBeyond, kMargin);

        const double diagonal = at.diagonal / cell_angle;
        if (is_narrow(at)) most_[kNearby] = most_[kBeyond] = kBeside * diagonal + kSpare;
        const double most =
            std::min(total(counts(0.0)) + kHigh * diagonal, 1.0 * (count > 0 ? count : kLargestCount));
        double share = 1.0;  // of the cells that heights ask for
        if (total(counts(share)) > most) {
            double least = 0.0;
            for (double half = 0.5; half > 1e-12; half *= 0.5)
                if (total(counts(least + half)) <= most) least += half;
            share = least;
        }
        const Counts wanted = counts(share);
        double sum = 0.0;
        for (Step& step : steps_) {
            const double cells = std::max(step.by_angle, share * step.by_height);
            sum += cells * std::min(most_[step.group] / wanted[step.group], 1.0);
            step.cells = sum;
        }
    }

    double cells() const { return steps_.empty() ? 0.0 : steps_.back().cells; }

    // 0 ≤ cells ≤ cells()
    double radius_m(double cells) const {
        if (steps_.empty()) return first_m_;  // all that is in view is one place
        const auto step = std::upper_bound(steps_.begin(), steps_.end() - 1, cells,
                                           [](double value, const Step& s) { return value < s.cells; });
        const double first_m = step == steps_.begin() ? first_m_ : (step - 1)->last_m;
        const double before = step == steps_.begin() ? 0.0 : (step - 1)->cells;
        // Even in angle: tan(a + b) of the step's first angle and a part of its own.
        const double part = (cells - before) / (step->cells - before);
        if (earth_.is_round()) {  // along the chord
            const double angle = angle_between(first_m, step->last_m);
            const double near_part = std::sin(part * angle) * earth_.distance_m(height_m_, first_m);
            const double far_part =
                std::sin((1.0 - part) * angle) * earth_.distance_m(height_m_, step->last_m);
            const double chord = near_part + far_part > 0.0 ? near_part / (near_part + far_part) : part;
            return first_m + (step->last_m - first_m) * chord;
        }
        const double rise = std::tan(part * angle_between(first_m, step->last_m));
        return (first_m + height_m_ * rise) / (1.0 - first_m / height_m_ * rise);
    }

  private:
    enum Group { kNearby, kFineOnes, kBeyond, kGroups };
    using Counts = std::array<double, kGroups>;

    struct Step {
        double last_m;
        Group group;
        double by_angle, by_height;  // cells
        double cells = 0.0;          // up to last_m
    };

    // The difference of two angles from the nadir. At the horizon the angles differ by less than their rounding.
    double angle_between(double first_m, double last_m) const {
        if (earth_.is_round()) return earth_.angle_between(height_m_, first_m, last_m);
        return std::atan2(height_m_ * (last_m - first_m), height_m_ * height_m_ + first_m * last_m);
    }

    // Up to last_m, even in asinh(r/h): in r below the camera, in log r far away.
    void add_steps(double last_m, Group group, double cell_angle, const UnresolvedHeight& unresolved,
                   double height_angle) {
        constexpr int kSteps = 256;
        double from_m = steps_.empty() ? first_m_ : steps_.back().last_m;
        if (!(last_m > from_m)) return;
        const double first = std::asinh(from_m / height_m_),
                     step = (std::asinh(last_m / height_m_) - first) / kSteps;
        for (int i = 1; i <= kSteps; ++i) {
            const double to_m = i == kSteps ? last_m : height_m_ * std::sinh(first + step * i);
            const double r_m = 0.5 * (from_m + to_m);
            // A height z is seen at an angle of z cos(elevation)/distance.
            const double height_m = height_angle * (r_m + height_m_ * (height_m_ / r_m));
            steps_.push_back({.last_m = to_m,
                              .group = group,
                              .by_angle = angle_between(from_m, to_m) / cell_angle,
                              .by_height = (to_m - from_m) / unresolved.longest_cell_m(height_m)});
            from_m = to_m;
        }
    }

    Counts counts(double share) const {
        Counts sum{};
        for (const Step& step : steps_) sum[step.group] += std::max(step.by_angle, share * step.by_height);
        return sum;
    }
    double total(const Counts& wanted) const {
        double sum = 0.0;
        for (int group = 0; group < kGroups; ++group) sum += std::min(wanted[group], most_[group]);
        return sum;
    }

    EarthView earth_;
    double height_m_, first_m_;
    Counts most_{1e300, 1e300, 1e300};
    std::vector<Step> steps_;
};

// Moves the nearest row to the horizon of the sea at rest, which is in the picture whatever the waves do.
void keep_horizon(std::vector<Row>& rows, double horizon_m) {
    if (!(horizon_m > rows.front().radius_m && horizon_m < rows.back().radius_m)) return;
    std::size_t nearest = 1;
    for (std::size_t i = 1; i + 1 < rows.size(); ++i)
        if (std::abs(rows[i].radius_m - horizon_m) < std::abs(rows[nearest].radius_m - horizon_m))
            nearest = i;
    if (nearest + 1 < rows.size()) rows[nearest].radius_m = horizon_m;
}

// The half width of a row of whose neighbourhood `seen` is in view, as waves move its points by reach_m: within the reach all of
// the circle, and from kNear reaches on no more than that asks for. Between it narrows evenly: columns that jump there make a row of
// long, skewed triangles right before a camera in a trough, which look like a wall with combed ripples.
double reached_width(double seen, double radius_m, double reach_m) {
    if (!(reach_m > 0.0)) return seen;
    const double reaches = radius_m / reach_m;
    const double asked = std::min(seen + std::asin(1.0 / reaches), kPi);
    if (reaches >= kNear) return asked;
    const double far = std::min(seen + std::asin(1.0 / kNear), kPi);
    return std::max(asked, far + (kPi - far) * (kNear - reaches) / (kNear - 1.0));
}

// The rows of a pose: count + 1 of them, or as many as the pose needs if count is 0.
std::vector<Row> rows_of(const View& view, const ProjectedGridOptions& options, const Station& at,
                         double cell_angle, int count) {
    const double reach_m = options.bounds.reach_m;
    const Polygon slab = in_view(view, at, options.bounds.height_m), plane = in_view(view, at, 0.0);
    const double farthest_m = std::min(at.farthest_m, at.earth.farthest_m());
    Interval radii{0.5 * farthest_m, farthest_m}, seen = radii;
    if (!slab.empty()) {
        // A crest lies before the place at rest that its ray would meet, and no nearer than on a flat sea.
        const Interval reached = distances(slab);
        radii.last = std::min(at.earth.arc_of(reached.last) + reach_m, farthest_m);
        radii.first = std::clamp(reached.first - reach_m, 0.0, 0.5 * radii.last);
    }
    if (!plane.empty()) {
        seen = distances(plane);
        seen = {at.earth.arc_of(seen.first), std::min(at.earth.arc_of(seen.last), at.earth.horizon_m())};
        seen.first = std::clamp(seen.first, radii.first, radii.last);
        seen.last = std::clamp(seen.last, radii.first, radii.last);
    } else {
        seen = radii;
    }
    const RowSpacing spacing(radii, seen, options, at, cell_angle, count);
    if (count == 0) {
        const double needed = std::ceil(spacing.cells() / kCountStep) * kCountStep;
        count = static_cast<int>(std::clamp(needed, 1.0 * kCountStep, 1.0 * kLargestCount));
    }
    std::vector<Row> rows(static_cast<std::size_t>(count) + 1);
    for (int i = 0; i <= count; ++i)
        rows[i].radius_m = i == 0       ? radii.first
                           : i == count ? radii.last
                                        : spacing.radius_m(spacing.cells() * i / count);
    keep_horizon(rows, at.earth.horizon_m());
    // A chord between two points of a row comes this much nearer than the row's radius.
    const int least_columns = options.size.columns > 0 ? options.size.columns : kCountStep;
    const double sagitta = std::cos(kPi / std::max(least_columns, 3));
    for (int i = 0; i <= count; ++i) {
        // Covering the ring up to both neighbouring rows leaves no gap between the rows' ends.
        const Interval ring{rows[std::max(i - 1, 0)].radius_m * sagitta,
                            rows[std::min(i + 1, count)].radius_m};
        Interval reached{std::max(ring.first - reach_m, 0.0), ring.last + reach_m};
        if (at.earth.is_round()) {
            reached.first = std::min(at.earth.flat_of(reached.first), at.farthest_m);
            if (reached.last >= at.earth.horizon_m()) reached.last = 8.0 * at.farthest_m;
        }
        // Where their rays meet a flat sea.
        const Interval flat{at.earth.flat_of(ring.first),
                            std::min(at.earth.flat_of(ring.last), 8.0 * at.farthest_m)};
        std::optional<double> half;
        if (ring.first <= reach_m && reach_m > 0.0)
            half = kPi;  // whatever is in view
        else if (const auto seen_half = half_width(slab, reached))
            half = reached_width(*seen_half, ring.first, reach_m);
        rows[i].half_width = std::min(half.value_or(std::atan(view.tan_half_width)), kPi);
        rows[i].in_view = rows[i].radius_m >= seen.first && rows[i].radius_m <= seen.last;
        rows[i].fine = rows[i].in_view && rows[i].radius_m >= kNear * reach_m;
        rows[i].seen_width = rows[i].in_view ? half_width(plane, flat).value_or(0.0) : 0.0;
    }
    // Columns must stay nearly straight where they are in view: a row follows a wider neighbour. A narrow lens
    // sees the columns in the middle, which shift by a small part of what the outermost do.
    const auto follow = [&](Row& row, const Row& neighbour) {
        double cell = kShift * cell_angle * std::hypot(row.radius_m, at.effective_height_m) /
                      std::max(row.radius_m, 1e-300);
        if (is_narrow(at)) cell *= std::max(neighbour.half_width / std::max(row.seen_width, 1e-9), 1.0);
        row.half_width = std::max(row.half_width, neighbour.half_width - cell);
    };
    for (int i = count; i-- > 0;) follow(rows[i], rows[i + 1]);
    for (int i = 1; i <= count; ++i)
        if (rows[i - 1].fine) follow(rows[i], rows[i - 1]);
    if (radii.last < farthest_m) rows.back().radius_m /= sagitta;
    return rows;
}

double cell_angle_of(const View& view, const ProjectedGridOptions& options, const Station& at) {
    return kSlack * options.cell_px * view.pixel_tangent() *
           std::max(at.corner_cos * at.corner_cos, kStretched);
}

// A pixel's footprint across the view, at a distance from the nadir. `cosine` is that of the angle between the
// optical axis and the direction to the point. Away from the eye it is longer by foreshortening().
double pixel_width_m(const View& view, const Station& at, double radius_m, double cosine) {
    return kPixel * view.pixel_tangent() * cosine * std::hypot(radius_m, at.effective_height_m);
}
double foreshortening(const Station& at, double radius_m) {
    return std::hypot(radius_m, at.effective_height_m) / at.effective_height_m;
}

// The same at a point at this distance from the eye. A pixel's angle shrinks with the cosine of its distance from the
// axis, down to the corner's.
double seen_pixel_m(const View& view, const Station& at, glm::dvec2 rest_m, double distance_m) {
    const double down_m = std::copysign(at.effective_height_m, at.height_m) * view.forward.z;
    const double ahead_m =
        std::max(glm::dot(rest_m, glm::dvec2(view.forward)) - down_m, at.corner_cos * distance_m);
    return kPixel * view.pixel_tangent() * ahead_m;
}

// How near the visible sea comes, with waves two standard deviations high where the bounds are five. Only single
// crests come nearer. Footprints for them would need two more levels, each with a grid four times as large, which
// hardly a pixel reads.
double nearest_seen_m(const View& view, const ProjectedGridOptions& options, const Station& at,
                      double nearest_m) {
    constexpr double kUsual = 2.0 / 5.0;
    const Polygon slab = in_view(view, at, kUsual * options.bounds.height_m);
    if (slab.empty()) return nearest_m;
    return std::max(distances(slab).first - kUsual * options.bounds.reach_m, nearest_m);
}

// What a cell is across the view where the sea at rest is in view [m].
double cell_width_m(const Station& at, double cell_angle, double radius_m) {
    return cell_angle * std::hypot(radius_m, at.effective_height_m);
}

}  // namespace

ProjectedGridOptions projected_grid_options(const Scene& scene, const Extent& extent) {
    return {.cell_px = scene.surface.cell_px,
            .bounds = {.height_m = extent.height_m, .reach_m = extent.reach_m},
            .significant_height_m = extent.significant_height_m,
            .unresolved = extent.unresolved,
            .curvature_per_m = scene.surface.earth_curvature ? kEarthCurvature_per_m : 0.0};
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
    if (is_narrow(at)) cells = std::min(cells, kAcross * at.diagonal / cell_angle + kSpare);
    const double columns =
        std::clamp(std::ceil(cells / kCountStep) * kCountStep, 1.0 * kCountStep, 1.0 * kLargestCount);
    double finest_cell_m = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i + 1 < rows.size(); ++i)
        finest_cell_m = std::min({finest_cell_m, rows[i + 1].radius_m - rows[i].radius_m,
                                  cell_width_m(at, cell_angle, rows[i].radius_m)});
    return {.size = {static_cast<int>(columns), static_cast<int>(rows.size()) - 1},
            .finest_cell_m = finest_cell_m,
            .finest_pixel_m =
                pixel_width_m(view, at, nearest_seen_m(view, options, at, rows[0].radius_m), at.corner_cos)};
}

ProjectedGridNeeds projected_grid_needs(std::span<const View> views, const ProjectedGridOptions& options) {
    const auto together = [](const ProjectedGridNeeds& a, const ProjectedGridNeeds& b) -> ProjectedGridNeeds {
        return {.size = {std::max(a.size.columns, b.size.columns), std::max(a.size.rows, b.size.rows)},
                .finest_cell_m = std::min(a.finest_cell_m, b.finest_cell_m),
                .finest_pixel_m = std::min(a.finest_pixel_m, b.finest_pixel_m)};
    };
    return tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(1, views.size()), projected_grid_needs(views.front(), options),
        [&](const tbb::blocked_range<std::size_t>& range, ProjectedGridNeeds sum) {
            for (std::size_t i = range.begin(); i != range.end(); ++i)
                if (views[i] != views[i - 1])  // the camera moves
                    sum = together(sum, projected_grid_needs(views[i], options));
            return sum;
        },
        together);
}

PixelFootprint<double> pixel_at_rest(const View& view, const ProjectedGridOptions& options,
                                     glm::dvec2 rest_m) {
    const Station at = station_of(view, options);
    const double radius_m = glm::length(rest_m);
    const double pixel_m = seen_pixel_m(view, at, rest_m, std::hypot(radius_m, at.effective_height_m));
    const glm::dvec2 away = radius_m > 0.0 ? rest_m / radius_m : at.ahead;
    const glm::dvec2 axis_m = pixel_m * foreshortening(at, radius_m) * away;
    return {.width = pixel_m, .axis_x = axis_m.x, .axis_y = axis_m.y};
}

ProjectedGrid projected_grid(const View& view, const ProjectedGridOptions& options,
                             const std::atomic<bool>* cancel) {
    const Station at = station_of(view, options);
    ProjectedGridOptions sized = options;
    ProjectedGridNeeds own;
    const bool is_sized = options.size.columns > 0 && options.size.rows > 0;
    if (!is_sized || options.has_levels) own = projected_grid_needs(view, options);
    if (!is_sized) sized.size = own.size;
    const auto [columns, row_count] = sized.size;
    const double cell_angle = cell_angle_of(view, options, at);
    const std::vector<Row> rows = rows_of(view, sized, at, cell_angle, row_count);

    ProjectedGrid grid{.columns = columns,
                       .rows = row_count,
                       .origin_m = glm::dvec2(view.position_m),
                       .curvature_per_m = options.curvature_per_m};
    const std::size_t stride = static_cast<std::size_t>(columns) + 1;
    const std::size_t count = stride * rows.size();
    grid.rest_m.resize(count);
    grid.cell_m.resize(count);
    grid.pixel_m.resize(count);
    grid.cell_axis_m.resize(count);
    grid.pixel_axis_m.resize(count);
    std::vector<glm::dvec2> previous(stride), row(stride);
    std::vector<double> across_m(rows.size()), away_m(count, 0.0);  // to the neighbouring columns, and rows
    for (std::size_t j = 0; j < rows.size(); ++j) {
        stop_if(cancel);
        const double r = rows[j].radius_m, distance_m = std::hypot(r, at.effective_height_m);
        const double step = 2.0 * rows[j].half_width / columns;
        const glm::dvec2 turn(std::cos(step), -std::sin(step));
        across_m[j] = 2.0 * r * std::sin(std::min(0.5 * step, 0.5 * kPi));
        // To the right in the picture, which is clockwise seen from above.
        const auto turned = [](glm::dvec2 a, glm::dvec2 b) {
            return glm::dvec2(a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x);
        };
        glm::dvec2 away =
            turned(at.ahead, glm::dvec2(std::cos(rows[j].half_width), std::sin(rows[j].half_width)));
        for (std::size_t i = 0; i < stride; ++i, away = turned(away, turn)) {
            row[i] = r * away;
            const std::size_t here = j * stride + i;
            grid.rest_m[here] = glm::vec2(row[i]);
            const double pixel_m = seen_pixel_m(view, at, row[i], distance_m);
            grid.pixel_m[here] = static_cast<float>(pixel_m);
            grid.pixel_axis_m[here] = glm::vec2(pixel_m * foreshortening(at, r) * away);
            grid.cell_axis_m[here] = glm::vec2(away);  // its length follows below
            if (j == 0) continue;
            away_m[here] = glm::length(row[i] - previous[i]);
            away_m[here - stride] = std::max(away_m[here - stride], away_m[here]);
        }
        previous.swap(row);
    }
    for (std::size_t j = 0; j < rows.size(); ++j) {
        stop_if(cancel);
        const double width_m = cell_width_m(at, cell_angle, rows[j].radius_m);
        for (std::size_t i = j * stride; i < (j + 1) * stride; ++i) {
            const double long_m = std::max(across_m[j], away_m[i]),
                         short_m = std::min(across_m[j], away_m[i]);
            const glm::vec2 away = grid.cell_axis_m[i];
            grid.cell_m[i] = static_cast<float>(std::min(std::max(short_m, width_m), long_m));
            grid.cell_axis_m[i] =
                static_cast<float>(long_m) * (away_m[i] >= across_m[j] ? away : glm::vec2(-away.y, away.x));
        }
    }
    const auto keep_to_levels = [](std::vector<float>& footprints_m, double finest_m) {
        const auto first_m = static_cast<float>(first_level_m(finest_m));
        for (float& footprint_m : footprints_m) footprint_m = std::max(footprint_m, first_m);
    };
    if (options.has_levels) {
        keep_to_levels(grid.cell_m, own.finest_cell_m);
        keep_to_levels(grid.pixel_m, own.finest_pixel_m);
    }
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
            // Counter-clockwise seen from above: columns run to the right, rows away from the camera.
            const std::uint32_t near_left = j * stride + i, far_left = near_left + stride;
            for (const std::uint32_t index :
                 {near_left, near_left + 1, far_left + 1, near_left, far_left + 1, far_left})
                triangles.push_back(index);
        }
    return triangles;
}

}  // namespace pelagic
