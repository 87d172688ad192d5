#include "core/surface/near_far.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

#include "core/base/constants.h"
#include "core/scene/text.h"
#include "core/surface/earth.h"
#include "core/surface/earth_view.h"
#include "core/surface/footprint_levels.h"

namespace pelagic {
namespace {

// A flat sea ends where it is this much below the horizontal [rad], seen from the octave's greatest height, and at
// the latest at kFarthestEnd_m: squared distances stay finite in single precision.
constexpr double kFlatEnd = 0x1p-20, kFarthestEnd_m = 1e15;
// How far the earth's sphere touches z = 0 from the nadir, at most, along each axis.
constexpr double kTouchStep_m = 128.0;
// Far places are rounded to this part of their distance, a fiftieth of the narrowest column. So they are exact in
// single precision, relative to any origin near the nadir.
constexpr double kFarDigits = 0x1p-18;

// Eleven binary digits: a place of 2^12 cells has 23 of them, and single precision 24.
double rounded_cell_m(double cell_m) {
    int exponent = 0;
    const double digits = std::frexp(cell_m, &exponent);
    return std::ldexp(std::round(std::ldexp(digits, 11)), exponent - 11);
}

// The exponent of the largest power of two that is no larger than `value`, and at least 0.
int octaves_in(double value) {
    return value >= 2.0 ? std::ilogb(value) : 0;
}

// The earth's touching place steps with the nadir, which has steps at least as short.
double touch_step_m(double cell_m) {
    return cell_m * std::exp2(std::floor(std::log2(kTouchStep_m / cell_m)));
}

glm::dvec2 step_of(glm::dvec2 place_m, double step_m) {
    return glm::floor(place_m / step_m);
}

double longest(glm::dvec2 a, glm::dvec2 b) {
    return std::max(glm::length(a), glm::length(b));
}

}  // namespace

NearFar::NearFar(const Scene& scene, const Extent& extent)
    : camera_(scene.camera),
      size_m_(scene.surface.size_m),
      cell_m_(rounded_cell_m(size_m_ / scene.surface.resolution)),
      crest_m_(extent.height_m),
      curvature_per_m_(scene.surface.earth_curvature ? kEarthCurvature_per_m : 0.0),
      mesh_(size_m_, scene.surface.resolution) {
    const NearFarMesh::Level& last = mesh_.levels().back();
    begin_m_ = std::ldexp((0.5 * last.cells + 1.0) * cell_m_, mesh_.rings());
}

NearFarPlace NearFar::place_of(glm::dvec3 camera_m) const {
    const int octaves = octaves_in(std::abs(camera_m.z) / (0.5 * size_m_));
    NearFarPlace place;
    place.height_m = std::ldexp(size_m_, octaves);
    const EarthView earth(place.height_m, curvature_per_m_, crest_m_);
    const double end_m = std::min({earth.farthest_m(), place.height_m / kFlatEnd, kFarthestEnd_m});
    // Within twice the first row's half side the far part becomes round.
    const int coarser = std::min(octaves, octaves_in(end_m / (2.0 * begin_m_)));
    place.cell_m = std::ldexp(cell_m_, coarser);
    place.far_m = std::max(end_m, std::ldexp(2.0 * begin_m_, coarser));
    double step_m = place.cell_m;
    if (curvature_per_m_ != 0.0) step_m = std::min(step_m, touch_step_m(step_m));
    place.nadir_m = step_of(glm::dvec2(camera_m), step_m) * step_m;
    return place;
}

NearFarPlace NearFar::place_at(int frame) const {
    return place_of(view_at(camera_, frame).position_m);
}

std::string NearFar::describe() const {
    const std::string quads = number_text(mesh_.levels().front().cells);
    return "a near patch of " + quads + " × " + quads + " quads over " + number_text(size_m_) + " m, " +
           std::to_string(mesh_.rings()) + " rings round it and a far part of " +
           std::to_string(mesh_.columns()) + " × " + std::to_string(mesh_.rows()) +
           " to the horizon: " + std::to_string(mesh_.points()) + " points";
}

std::optional<View> NearFar::shaped_by(int frame) const {
    const NearFarPlace place = place_at(frame);
    return View{.position_m = glm::dvec3(place.nadir_m, place.height_m)};
}

SurfaceNeeds NearFar::needs(std::span<const int> frames) const {
    double finest_m = frames.empty() ? 0.0 : std::numeric_limits<double>::infinity();
    for (const int frame : frames) finest_m = std::min(finest_m, first_level_m(place_at(frame).cell_m));
    return {.finest_cell_m = finest_m,
            .finest_pixel_m = finest_m,
            .own_footprints = true,
            .points = mesh_.points()};
}

void NearFar::points_at(int frame, RestPoints<float>& points) const {
    lay_out(place_at(frame), points);
}
void NearFar::points_at(int frame, RestPoints<double>& points) const {
    lay_out(place_at(frame), points);
}

template <class T>
void NearFar::lay_out(const NearFarPlace& place, RestPoints<T>& points) const {
    // Near the nadir, so that floats hold every place, and in steps as long as they allow.
    const double first_row_m = begin_m_ * (place.cell_m / cell_m_);
    const double origin_step_m = std::min(level_below_m(place.cell_m) * 0x1p12, level_below_m(first_row_m));
    points.origin_m = glm::round(place.nadir_m / origin_step_m) * origin_step_m + 0.0;  // −0 is 0
    points.curvature_per_m = curvature_per_m_;
    const double touch_m = touch_step_m(place.cell_m);
    points.touches_at_m = (step_of(place.nadir_m, touch_m) + 0.5) * touch_m;

    for (auto* numbers : {&points.cell_m, &points.pixel_m}) numbers->resize(mesh_.points());
    for (auto* places : {&points.rest_m, &points.cell_axis_m, &points.pixel_axis_m})
        places->resize(mesh_.points());

    // Footprints are levels themselves: each depends on its cell alone, and reads a single level of a plan.
    double cell_m = place.cell_m, footprint_m = first_level_m(cell_m);
    glm::dvec2 lowest_m{0.0};
    std::size_t i = 0;
    for (const NearFarMesh::Level& level : mesh_.levels()) {
        const glm::dvec2 first = step_of(place.nadir_m, cell_m) - static_cast<double>(level.before);
        lowest_m = first * cell_m;
        level.for_each_point([&](int x, int y) {
            points.rest_m[i] = glm::vec<2, T>((first + glm::dvec2(x, y)) * cell_m - points.origin_m);
            // A point on the border belongs to a cell of the next square, too.
            points.cell_m[i] = static_cast<T>(level.is_on_border(x, y) ? 2.0 * footprint_m : footprint_m);
            points.cell_axis_m[i] = glm::vec<2, T>(T(0));
            ++i;
        });
        cell_m *= 2.0;
        footprint_m *= 2.0;
    }
    const double half_m = 0.25 * mesh_.levels().back().cells * cell_m;  // cells have doubled once more
    lay_out_far(place, lowest_m + half_m, points);
    points.pixel_m = points.cell_m;
    points.pixel_axis_m = points.cell_axis_m;
}

template <class T>
void NearFar::lay_out_far(const NearFarPlace& place, glm::dvec2 middle_m, RestPoints<T>& points) const {
    const int columns = mesh_.columns(), rows = mesh_.rows();
    const double first_m = begin_m_ * (place.cell_m / cell_m_);
    // Far enough from anywhere within a step, and in the middle of the chords between columns.
    const double aside_m = glm::length(middle_m - place.nadir_m) + kTouchStep_m * std::numbers::sqrt2;
    const double last_m = (place.far_m + aside_m) / std::cos(kPi / columns);
    const double octaves = std::log(last_m / first_m);
    const double border_cell_m = std::ldexp(place.cell_m, mesh_.rings());
    // The distance's logarithm is a cubic of the row, which begins with the last ring's cells.
    const double share = std::min(border_cell_m / first_m * (rows - 1) / octaves, 1.0);
    const double finest_m = first_level_m(place.cell_m);

    std::vector<glm::dvec2> away(static_cast<std::size_t>(columns));
    for (int column = 0; column < columns; ++column) {
        const double azimuth = kTwoPi * column / columns - 0.75 * kPi;
        away[column] = {std::cos(azimuth), std::sin(azimuth)};
    }
    const auto logarithm = [&](int row) {
        const double t = row / (rows - 1.0);
        return octaves * t * (share + (1.0 - share) * t * t);
    };
    // A square becomes a circle over an octave. Corners never come nearer from one row to the next.
    const auto rest_at = [&](int row, int column) {
        const double along = logarithm(row), square = std::max(1.0 - along / std::log(2.0), 0.0);
        const double radius_m = first_m * std::exp(along);
        const glm::dvec2 at = away[column];
        const double corner = std::pow(std::max(std::abs(at.x), std::abs(at.y)), -square);
        return radius_m * corner * at;
    };
    std::vector<glm::dvec2> before(away.size()), here(away.size()), next(away.size());
    const auto fill = [&](std::vector<glm::dvec2>& row_m, int row) {
        for (int column = 0; column < columns; ++column) row_m[column] = rest_at(row, column);
    };
    fill(here, 0);
    for (int row = 0; row < rows; ++row) {
        if (row + 1 < rows) fill(next, row + 1);
        const double digit_m = level_below_m(first_m * std::exp(logarithm(row))) * kFarDigits;
        for (int column = 0; column < columns; ++column) {
            const int left = column == 0 ? columns - 1 : column - 1, right = (column + 1) % columns;
            const glm::dvec2 at = here[column];
            const double across_m = longest(here[right] - at, here[left] - at);
            const double along_m = row == 0 ? longest(glm::dvec2(border_cell_m, 0.0), next[column] - at)
                                   : row + 1 == rows ? glm::length(at - before[column])
                                                     : longest(next[column] - at, at - before[column]);
            const std::size_t i = mesh_.far_point(row, column);
            const glm::dvec2 world_m = glm::round((middle_m + at) / digit_m) * digit_m;
            points.rest_m[i] = glm::vec<2, T>(world_m - points.origin_m);
            const double long_m = std::max({across_m, along_m, finest_m});
            points.cell_m[i] = static_cast<T>(std::max(std::min(across_m, along_m), finest_m));
            const glm::dvec2 axis =
                along_m >= across_m ? away[column] : glm::dvec2(-away[column].y, away[column].x);
            points.cell_axis_m[i] = glm::vec<2, T>(long_m * axis);
        }
        before.swap(here);
        here.swap(next);
    }
}

}  // namespace pelagic
