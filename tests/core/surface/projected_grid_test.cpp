// The projected grid: it covers everything that may come into view, its cells have the requested size, and
// every pose gives a valid grid.
#include "core/surface/projected_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <glm/geometric.hpp>
#include <random>
#include <set>

#include "core/base/build_watch.h"
#include "core/base/constants.h"

namespace pelagic {
namespace {

struct Pose {
    double height_m = 4.0, pitch_deg = 0.0, azimuth_deg = 0.0, fov_deg = 50.0;
    glm::ivec2 resolution{1280, 720};
    glm::dvec2 at_m{0.0};
    double roll_deg = 0.0;
    glm::dvec2 shift{0.0};
};

View view_of(const Pose& shot) {
    Camera camera;
    const double pitch = shot.pitch_deg * kPi / 180.0, azimuth = shot.azimuth_deg * kPi / 180.0;
    camera.position_m = glm::dvec3(shot.at_m, shot.height_m);
    // An exact right angle: std::cos(90°) isn't 0.
    const double level = std::abs(shot.pitch_deg) == 90.0 ? 0.0 : std::cos(pitch);
    camera.look_at_m = camera.position_m + 100.0 * glm::dvec3(level * std::cos(azimuth),
                                                              level * std::sin(azimuth), std::sin(pitch));
    camera.fov_deg = shot.fov_deg;
    camera.resolution = shot.resolution;
    camera.shift_x = shot.shift.x;
    camera.shift_y = shot.shift.y;
    camera.keys = {{.frame = 1,
                    .position_m = camera.position_m,
                    .look_at_m = camera.look_at_m,
                    .roll_deg = shot.roll_deg}};
    return view_at(camera, 1.0);
}

// Whether a cell of the grid contains p (relative to its origin). Searches the rows with radii near |p|.
bool covers(const ProjectedGrid& grid, glm::dvec2 p) {
    const int stride = grid.columns + 1;
    const auto at = [&](int row, int column) { return glm::dvec2(grid.rest_m[row * stride + column]); };
    const auto side = [](glm::dvec2 a, glm::dvec2 b, glm::dvec2 q) {
        const glm::dvec2 u = b - a, v = q - a;
        // A point on a border is in both cells, up to rounding.
        return u.x * v.y - u.y * v.x >= -1e-6 * (glm::length(u) * (glm::length(v) + glm::length(q)));
    };
    const double r = glm::length(p);
    int first = 0;
    while (first < grid.rows && glm::length(at(first + 1, 0)) < r * (1.0 - 1e-6)) ++first;
    for (int row = first; row < std::min(first + 3, grid.rows); ++row)
        for (int column = 0; column < grid.columns; ++column) {
            const glm::dvec2 a = at(row, column), b = at(row, column + 1), c = at(row + 1, column + 1),
                             d = at(row + 1, column);
            if ((side(a, b, p) && side(b, c, p) && side(c, a, p)) ||
                (side(a, c, p) && side(c, d, p) && side(d, a, p)))
                return true;
        }
    return false;
}

// Of waves as steep at every scale as a gale's, up to this standard deviation of heights.
UnresolvedHeight steep_waves(double deviation_m) {
    UnresolvedHeight unresolved;
    for (std::size_t i = 0; i < UnresolvedHeight::kCells; ++i)
        unresolved.deviation_m[i] = std::min(0.022 * UnresolvedHeight::cell_m(i), deviation_m);
    return unresolved;
}

std::vector<Pose> hard_shots() {
    std::vector<Pose> shots;
    for (const double height_m : {-30.0, -0.5, 0.0, 1e-9, 0.5, 2.0, 4.0, 60.0, 20e3, 1e5})
        for (const double pitch_deg : {-90.0, -89.999, -70.0, -30.0, -8.0, 0.0, 8.0, 45.0, 90.0})
            shots.push_back({.height_m = height_m, .pitch_deg = pitch_deg, .azimuth_deg = 33.0});
    for (const double fov_deg : {1.0, 10.0, 90.0, 130.0, 179.0})
        for (const double pitch_deg : {-90.0, -35.0, 0.0, 20.0})
            shots.push_back({.height_m = 7.0, .pitch_deg = pitch_deg, .fov_deg = fov_deg});
    // Telephoto lenses, also at the water line.
    for (const double height_m : {0.0, 0.3, 2.0, 50.0})
        for (const double fov_deg : {0.2, 1.0, 5.0, 15.0})
            for (const double pitch_deg : {-40.0, -3.0, 0.0, 0.5})
                shots.push_back({.height_m = height_m,
                                 .pitch_deg = pitch_deg,
                                 .fov_deg = fov_deg,
                                 .resolution = {320, 180}});
    shots.push_back({.resolution = {100, 1000}});
    shots.push_back({.resolution = {2000, 20}});
    shots.push_back({.pitch_deg = -40.0, .resolution = {1, 1}});
    shots.push_back({.azimuth_deg = 200.0, .at_m = {1e6, -1e6}});
    for (const double roll_deg : {3.0, -45.0, 90.0, 180.0})
        for (const double pitch_deg : {-90.0, -35.0, 0.0, 20.0})
            shots.push_back({.pitch_deg = pitch_deg, .roll_deg = roll_deg});
    for (const glm::dvec2 shift : {glm::dvec2(0.6, 0.0), {-0.3, -0.4}, {0.1, 1.5}})
        for (const double fov_deg : {5.0, 50.0, 100.0})
            for (const double pitch_deg : {-90.0, -20.0, 0.0})
                shots.push_back(
                    {.height_m = 6.0, .pitch_deg = pitch_deg, .fov_deg = fov_deg, .shift = shift});
    return shots;
}

std::string text_of(const Pose& shot) {
    return "height " + std::to_string(shot.height_m) + " pitch " + std::to_string(shot.pitch_deg) + " fov " +
           std::to_string(shot.fov_deg) + " " + std::to_string(shot.resolution.x) + " × " +
           std::to_string(shot.resolution.y) + " roll " + std::to_string(shot.roll_deg) + " shift " +
           std::to_string(shot.shift.x) + ' ' + std::to_string(shot.shift.y);
}

// Draws points at rest that a displacement within the bounds brings into view, in reverse: a pixel, a height
// within the slab on its ray, a displacement. Each point must lie in a cell.
TEST(ProjectedGrid, CoversWhateverMayComeIntoView) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    std::vector<Pose> shots = hard_shots();
    for (int i = 0; i < 60; ++i)
        shots.push_back({.height_m = std::pow(10.0, -1.0 + 5.0 * uniform(random)),
                         .pitch_deg = -90.0 + 150.0 * uniform(random),
                         .azimuth_deg = 360.0 * uniform(random),
                         .fov_deg = 5.0 + 120.0 * uniform(random),
                         .resolution = {200 + static_cast<int>(800 * uniform(random)), 400},
                         .roll_deg = i % 2 == 0 ? 0.0 : 360.0 * uniform(random)});
    int in_view = 0;
    for (const Pose& shot : shots) {
        const View view = view_of(shot);
        const double height_m = uniform(random) < 0.2 ? 0.0 : 4.0 * uniform(random);
        const double reach_m = uniform(random) < 0.2 ? 0.0 : 4.0 * uniform(random);
        const ProjectedGrid grid = projected_grid(view, {.cell_px = 24.0,
                                                         .bounds = {.height_m = height_m, .reach_m = reach_m},
                                                         .significant_height_m = 2.0,
                                                         .unresolved = steep_waves(0.5)});
        const double farthest_m = glm::length(glm::dvec2(grid.rest_m.back()));
        for (int i = 0; i < 60; ++i) {
            const glm::dvec2 pixel(uniform(random) * view.resolution.x, uniform(random) * view.resolution.y);
            const glm::dvec3 d = view.direction(pixel);
            // Often on the faces of the slab, where the extremes lie.
            const double z_m = height_m * std::clamp(3.0 * uniform(random) - 1.5, -1.0, 1.0);
            const double way_m = (z_m - view.position_m.z) / d.z;
            if (!(way_m >= 0.0) || !std::isfinite(way_m)) continue;
            const double turn = 2.0 * kPi * uniform(random);
            const double shift_m = reach_m * std::min(1.5 * uniform(random), 1.0);
            const glm::dvec2 p = way_m * glm::dvec2(d) + shift_m * glm::dvec2(std::cos(turn), std::sin(turn));
            if (glm::length(p) > farthest_m * 0.999) continue;  // closer than kHorizon_px to the horizon
            ++in_view;
            EXPECT_TRUE(covers(grid, p))
                << text_of(shot) << " bounds " << height_m << " " << reach_m << " at " << p.x << " " << p.y;
        }
    }
    EXPECT_GT(in_view, 4000);
}

TEST(ProjectedGrid, IsCancelled) {
    const std::atomic<bool> cancel = true;
    EXPECT_THROW(projected_grid(view_of({}), {}, &cancel), BuildCancelled);
}

TEST(ProjectedGrid, EveryPoseGivesAValidGrid) {
    for (const Pose& shot : hard_shots()) {
        SCOPED_TRACE(text_of(shot));
        for (const double height_m : {0.0, 3.0}) {
            const ProjectedGridOptions options{.bounds = {.height_m = height_m, .reach_m = 2.0},
                                               .significant_height_m = height_m,
                                               .unresolved = steep_waves(0.25 * height_m)};
            const View view = view_of(shot);
            const ProjectedGrid grid = projected_grid(view, options);
            ASSERT_EQ((ProjectedGridSize{grid.columns, grid.rows}), projected_grid_needs(view, options).size);
            ASSERT_GT(grid.columns, 0);
            ASSERT_GT(grid.rows, 0);
            const std::size_t count = (grid.columns + 1u) * (grid.rows + 1u);
            ASSERT_EQ(grid.rest_m.size(), count);
            ASSERT_EQ(grid.cell_m.size(), count);
            ASSERT_EQ(grid.pixel_m.size(), count);
            std::size_t bad = 0;
            for (std::size_t i = 0; i < count; ++i)
                bad += !(std::isfinite(grid.rest_m[i].x * grid.rest_m[i].x +
                                       grid.rest_m[i].y * grid.rest_m[i].y) &&
                         std::isfinite(grid.cell_m[i]) && grid.cell_m[i] > 0.0f &&
                         std::isfinite(grid.pixel_m[i]) && grid.pixel_m[i] > 0.0f);
            EXPECT_EQ(bad, 0u);
            EXPECT_EQ(grid.origin_m, shot.at_m);
        }
    }
}

// Points are in proportion to the picture's cells, whatever the lens and however near the water: a picture of
// 32 × 18 pixels through one degree at the water line had 12 million. Rows that heights ask for are no more than six
// diagonals' cells, beside some six in angle.
TEST(ProjectedGrid, PointsAreInProportionToThePicturesCells) {
    for (const double fov_deg : {0.1, 1.0, 5.0, 19.0, 21.0, 50.0, 170.0})
        for (const double height_m : {-0.1, 0.0, 0.5, 10.0, 300.0})
            for (const double pitch_deg : {-90.0, -30.0, 0.0, 3.0})
                for (const double wave_m : {0.0, 0.3, 10.0})
                    for (const double cell_px : {1.0, 8.0})
                        for (const glm::ivec2 resolution : {glm::ivec2{32, 18}, glm::ivec2{20, 400}}) {
                            const Pose shot{.height_m = height_m,
                                            .pitch_deg = pitch_deg,
                                            .fov_deg = fov_deg,
                                            .resolution = resolution};
                            const ProjectedGridOptions options{
                                .cell_px = cell_px,
                                .bounds = {.height_m = 1.3 * wave_m, .reach_m = wave_m},
                                .significant_height_m = wave_m,
                                .unresolved = steep_waves(0.25 * wave_m)};
                            const ProjectedGridSize size = projected_grid_needs(view_of(shot), options).size;
                            const double across = std::hypot(resolution.x, resolution.y) / cell_px;
                            EXPECT_LE(static_cast<double>(points_of(size)), 100.0 * across * across + 40e3)
                                << text_of(shot) << " waves " << wave_m << " cells " << cell_px << ": "
                                << size.columns << " × " << size.rows;
                        }
}

// A camera in a trough sees the sea within the waves' reach, where rows span the circle, and beyond it, where they don't: on the way
// columns leave their direction by less than twice the way to the next row, also at the picture's edge.
TEST(ProjectedGrid, ColumnsDoNotJumpBeforeACameraInATrough) {
    for (const double height_m : {0.5, 3.0})
        for (const double reach_m : {3.0, 12.0}) {
            const ProjectedGrid grid = projected_grid(
                view_of({.height_m = height_m, .pitch_deg = 5.0, .fov_deg = 38.0}),
                {.bounds = {.height_m = reach_m, .reach_m = reach_m}, .significant_height_m = reach_m});
            const int stride = grid.columns + 1;
            const glm::vec2 ahead =
                glm::normalize(grid.rest_m[static_cast<std::size_t>(grid.rows) * stride + grid.columns / 2]);
            double worst = 0.0;
            for (int row = 1; row < grid.rows; ++row)
                for (int column = 0; column < stride; ++column) {
                    const glm::vec2 here = grid.rest_m[static_cast<std::size_t>(row) * stride + column],
                                    next = grid.rest_m[static_cast<std::size_t>(row + 1) * stride + column];
                    if (!(glm::dot(here, ahead) > std::cos(0.35f) * glm::length(here))) continue;  // 20°
                    const auto sideways = static_cast<double>(std::abs(here.x * next.y - here.y * next.x)) /
                                          static_cast<double>(glm::length(next));
                    worst = std::max(worst,
                                     sideways / static_cast<double>(glm::length(next) - glm::length(here)));
                }
            std::printf("    %.1f m, reach %.0f m: %.2f\n", height_m, reach_m, worst);
            EXPECT_LT(worst, 2.0) << height_m << ' ' << reach_m;
        }
}

// The largest side on the screen of a cell whose corners are all in view, not nearer than nearest_m, over a
// sea at rest.
double largest_cell_px(const View& view, const ProjectedGrid& grid, double nearest_m) {
    const glm::dmat4 clip = view.clip_from(glm::dvec3(grid.origin_m, 0.0), 0.01);
    const int stride = grid.columns + 1;
    const auto pixel = [&](int row, int column, glm::dvec2& at) {
        const glm::dvec4 c = clip * glm::dvec4(glm::dvec2(grid.rest_m[row * stride + column]), 0.0, 1.0);
        at = 0.5 * glm::dvec2(c) / c.w * glm::dvec2(view.resolution);
        return c.w > 0.0 && std::abs(c.x) <= c.w && std::abs(c.y) <= c.w;
    };
    double largest_px = 0.0;
    for (int row = 0; row < grid.rows; ++row) {
        if (glm::length(grid.rest_m[row * stride]) < nearest_m) continue;
        for (int column = 0; column < grid.columns; ++column) {
            glm::dvec2 a, b, c;
            if (!pixel(row, column, a) || !pixel(row, column + 1, b) || !pixel(row + 1, column, c)) continue;
            largest_px = std::max({largest_px, glm::length(b - a), glm::length(c - a)});
        }
    }
    return largest_px;
}

TEST(ProjectedGrid, CellsAreNoLargerThanAsked) {
    double largest_px = 0.0;
    for (const double height_m : {0.5, 4.0, 200.0, 20e3})
        for (const double pitch_deg : {-90.0, -60.0, -30.0, -5.0, 0.0, 10.0})
            for (const double fov_deg : {1.0, 5.0, 20.0, 50.0, 90.0}) {
                const Pose shot{.height_m = height_m, .pitch_deg = pitch_deg, .fov_deg = fov_deg};
                const View view = view_of(shot);
                // Waves much lower than the camera, and waves as high as the lowest camera.
                const ProjectedGrid calm = projected_grid(
                    view, {.bounds = {.height_m = 0.02 * height_m, .reach_m = 0.02 * height_m}});
                const ProjectedGrid rough = projected_grid(view, {.bounds = {.height_m = 3.0, .reach_m = 3.0},
                                                                  .significant_height_m = 2.4,
                                                                  .unresolved = steep_waves(0.6)});
                largest_px = std::max(largest_px, largest_cell_px(view, calm, 0.0));
                EXPECT_LE(largest_cell_px(view, calm, 0.0), 8.0) << text_of(shot);
                // A telephoto lens that looks at nearby waves sees less than they move.
                EXPECT_LE(largest_cell_px(view, rough, fov_deg < 20.0 ? 100.0 : 6.0), 8.0) << text_of(shot);
            }
    // Nor much smaller: needless cells cost time.
    EXPECT_GT(largest_px, 7.0);
}

// Of what a row's cells hide, heights seen from the side are at most a third of a pixel: all rows between a camera and
// the horizon, in the middle of the picture. The sea at rest is seen from 4 m at 250 m a cell, 330 m away.
TEST(ProjectedGrid, CellsHideNoHeightsThatAreSeen) {
    for (const double height_m : {0.5, 4.0, 15.0, 200.0, 20e3})
        for (const double pitch_deg : {-30.0, -5.0, 0.0})
            for (const double fov_deg : {35.0, 50.0, 90.0})
                for (const double cell_px : {1.0, 8.0, 24.0}) {
                    const Pose shot{.height_m = height_m,
                                    .pitch_deg = pitch_deg,
                                    .fov_deg = fov_deg,
                                    .resolution = {320, 180}};
                    const View view = view_of(shot);
                    ProjectedGridOptions options{.cell_px = cell_px,
                                                 .bounds = {.height_m = 10.0, .reach_m = 10.0},
                                                 .significant_height_m = 8.0,
                                                 .unresolved = steep_waves(2.0)};
                    const ProjectedGrid grid = projected_grid(view, options);
                    double seen_px = 0.0;
                    for (int row = 0; row < grid.rows; ++row) {
                        const auto radius_m = [&](int j) {
                            return glm::length(
                                glm::dvec2(grid.rest_m[static_cast<std::size_t>(j) * (grid.columns + 1)]));
                        };
                        const double unresolved_m =
                            std::min(0.022 * (radius_m(row + 1) - radius_m(row)), 2.0);
                        const double across_m = std::hypot(radius_m(row), std::hypot(height_m, 4.0));
                        seen_px = std::max(seen_px, unresolved_m * radius_m(row) / (across_m * across_m) /
                                                        view.pixel_tangent());
                    }
                    // A tenth more where deviations rise by less than the table's octaves.
                    EXPECT_LE(seen_px, 0.33 * std::max(cell_px / 8.0, 1.0))
                        << text_of(shot) << " cells " << cell_px;
                }
}

// What waves ask for costs nothing where cells are as small without them, nor in a calm.
TEST(ProjectedGrid, HeightsCostRowsOnlyWhereTheyAreSeen) {
    for (const Pose& shot :
         {Pose{.height_m = 20e3, .pitch_deg = -10.0}, Pose{.height_m = 60.0, .pitch_deg = -80.0},
          Pose{.height_m = 30.0, .pitch_deg = -90.0}}) {
        ProjectedGridOptions options{.bounds = {.height_m = 3.0, .reach_m = 3.0},
                                     .significant_height_m = 2.4};
        const ProjectedGridSize without = projected_grid_needs(view_of(shot), options).size;
        options.unresolved = steep_waves(0.6);
        EXPECT_EQ(projected_grid_needs(view_of(shot), options).size, without) << text_of(shot);
    }
    const View level = view_of({});
    EXPECT_EQ(projected_grid_needs(level, {.bounds = {}, .unresolved = steep_waves(0.0)}).size,
              projected_grid_needs(level, {}).size);
    // From 4 m a gale takes some hundreds.
    const ProjectedGridOptions gale{.bounds = {.height_m = 10.0, .reach_m = 10.0},
                                    .significant_height_m = 8.0,
                                    .unresolved = steep_waves(2.0)};
    EXPECT_GT(projected_grid_needs(level, gale).size.rows, 500);
    EXPECT_LT(projected_grid_needs(level, gale).size.rows, 1200);
}

// Rows move by as little as the camera does: over a thousandth of its height, by a small part of a cell.
TEST(ProjectedGrid, RowsFollowTheCameraWithoutAJump) {
    const auto radii = [](double height_m, double fov_deg, ProjectedGridSize size) {
        const ProjectedGrid grid = projected_grid(view_of({.height_m = height_m, .fov_deg = fov_deg}),
                                                  {.bounds = {.height_m = 1.0, .reach_m = 1.0},
                                                   .significant_height_m = 1.0,
                                                   .unresolved = steep_waves(0.25),
                                                   .size = size});
        std::vector<double> radii_m;
        for (int row = 0; row <= grid.rows; ++row)
            radii_m.push_back(
                glm::length(glm::dvec2(grid.rest_m[static_cast<std::size_t>(row) * (grid.columns + 1)])));
        return radii_m;
    };
    for (const double fov_deg : {3.0, 50.0})
        for (const ProjectedGridSize size : {ProjectedGridSize{64, 400}, ProjectedGridSize{64, 2000}})
            for (double height_m = 2.0; height_m < 30.0; height_m *= 1.3) {
                const std::vector<double> a = radii(height_m, fov_deg, size),
                                          b = radii(1.001 * height_m, fov_deg, size);
                for (std::size_t row = 1; row + 1 < a.size(); ++row)
                    EXPECT_LE(std::abs(b[row] - a[row]), 5e-3 * a[row] + 0.1 * (a[row + 1] - a[row - 1]))
                        << height_m << " m " << fov_deg << " deg, row " << row << " of " << size.rows;
            }
}

// The gap between the last row and the horizon, in pixels along the picture's height.
TEST(ProjectedGrid, EndsWithinATwentiethOfAPixelOfTheHorizon) {
    for (const double height_m : {0.5, 4.0, 20e3, 1e5})
        for (const double pitch_deg : {-10.0, 0.0, 10.0})
            for (const double fov_deg : {20.0, 90.0}) {
                const Pose shot{.height_m = height_m, .pitch_deg = pitch_deg, .fov_deg = fov_deg};
                const View view = view_of(shot);
                const ProjectedGrid grid =
                    projected_grid(view, {.bounds = {.height_m = 1.0, .reach_m = 1.0}});
                const auto row_of = [&](glm::dvec3 d) {
                    return glm::dot(d, view.up) / glm::dot(d, view.forward) / view.pixel_tangent();
                };
                // Straight ahead: the grid's middle column is the picture's.
                const glm::dvec2 last(grid.rest_m[grid.rest_m.size() - 1 - grid.columns / 2]);
                const double gap_px =
                    row_of(glm::dvec3(glm::normalize(last), 0.0)) - row_of(glm::dvec3(last, -height_m));
                if (std::abs(row_of(glm::dvec3(glm::normalize(last), 0.0))) > 0.5 * view.resolution.y)
                    continue;  // not in view
                EXPECT_GT(gap_px, 0.0) << text_of(shot);
                EXPECT_LE(gap_px, 0.05) << text_of(shot);
            }
}

// All triangles have the same orientation seen from above, and their areas add up to the grid's.
TEST(ProjectedGrid, TrianglesFaceUpAndFillTheGrid) {
    const View view = view_of({.height_m = 10.0, .pitch_deg = -30.0});
    const ProjectedGrid grid = projected_grid(view, {.bounds = {.height_m = 1.0, .reach_m = 0.5}});
    const auto triangles = projected_grid_triangles({.columns = grid.columns, .rows = grid.rows});
    ASSERT_EQ(triangles.size(), 6u * grid.columns * grid.rows);
    const auto area = [&](std::uint32_t i, std::uint32_t j, std::uint32_t k) {
        const glm::dvec2 a(grid.rest_m[i]), u = glm::dvec2(grid.rest_m[j]) - a,
                                            v = glm::dvec2(grid.rest_m[k]) - a;
        return 0.5 * (u.x * v.y - u.y * v.x);
    };
    double sum = 0.0;
    for (std::size_t t = 0; t < triangles.size(); t += 3) {
        const double one = area(triangles[t], triangles[t + 1], triangles[t + 2]);
        EXPECT_GT(one, 0.0);
        sum += one;
    }
    // Each side is shared with another triangle in the opposite direction, or lies on the border.
    std::set<std::pair<std::uint32_t, std::uint32_t>> sides;
    for (std::size_t t = 0; t < triangles.size(); ++t)
        EXPECT_TRUE(sides.insert({triangles[t], triangles[t % 3 == 2 ? t - 2 : t + 1]}).second);
    std::size_t alone = 0;
    for (const auto& [from, to] : sides) alone += !sides.contains({to, from});
    EXPECT_EQ(alone, 2u * (grid.columns + grid.rows));
    // The area inside the border, by the shoelace formula.
    std::vector<glm::dvec2> border;
    const int stride = grid.columns + 1;
    for (int c = 0; c < grid.columns; ++c) border.emplace_back(grid.rest_m[c]);
    for (int r = 0; r < grid.rows; ++r) border.emplace_back(grid.rest_m[r * stride + grid.columns]);
    for (int c = grid.columns; c > 0; --c) border.emplace_back(grid.rest_m[grid.rows * stride + c]);
    for (int r = grid.rows; r > 0; --r) border.emplace_back(grid.rest_m[r * stride]);
    double outline = 0.0;
    for (std::size_t i = 0; i < border.size(); ++i) {
        const glm::dvec2 a = border[i], b = border[(i + 1) % border.size()];
        outline += 0.5 * (a.x * b.y - a.y * b.x);
    }
    EXPECT_NEAR(sum / outline, 1.0, 1e-9);
}

// The footprints agree with distances between neighbours and with pixels on the screen.
TEST(ProjectedGrid, FootprintsAreDistancesAndPixels) {
    const View view = view_of({.height_m = 6.0, .pitch_deg = -12.0});
    const ProjectedGrid grid = projected_grid(view, {});
    const int stride = grid.columns + 1;
    const auto at = [&](int row, int column) { return glm::dvec2(grid.rest_m[row * stride + column]); };
    for (int row = 1; row < grid.rows; row += 7)
        for (int column = 1; column < grid.columns; column += 11) {
            const glm::dvec2 p = at(row, column);
            const double largest_m =
                std::max({glm::length(at(row - 1, column) - p), glm::length(at(row + 1, column) - p),
                          glm::length(at(row, column - 1) - p), glm::length(at(row, column + 1) - p)});
            const glm::dvec2 cell_axis_m(grid.cell_axis_m[row * stride + column]);
            EXPECT_NEAR(glm::length(cell_axis_m) / largest_m, 1.0, 1e-4);
            EXPECT_LE(grid.cell_m[row * stride + column], 1.0001 * largest_m);
            // Half a footprint outwards and half inwards span 0.6 of a pixel on the screen; off the axis a little
            // less or more.
            const glm::dvec2 along_m = 0.5 * glm::dvec2(grid.pixel_axis_m[row * stride + column]);
            const double half_m = glm::length(along_m);
            const auto screen = [&](glm::dvec2 q) {
                const glm::dvec3 d(q, -6.0);
                return glm::dvec2(glm::dot(d, view.right), glm::dot(d, view.up)) /
                       (glm::dot(d, view.forward) * view.pixel_tangent());
            };
            if (half_m > 0.1 * glm::length(p)) continue;
            if (std::abs(screen(p).x) > 640.0 || std::abs(screen(p).y) > 360.0) continue;
            const glm::dvec2 out = glm::normalize(p);
            EXPECT_NEAR(glm::dot(along_m, out) / half_m, 1.0, 1e-6);
            const glm::dvec2 across_m =
                0.5 * static_cast<double>(grid.pixel_m[row * stride + column]) * glm::dvec2(-out.y, out.x);
            for (const glm::dvec2 side_m : {along_m, across_m}) {
                const double px = glm::length(screen(p + side_m) - screen(p - side_m));
                EXPECT_GT(px, 0.6 * 0.95);
                EXPECT_LT(px, 0.6 * 1.2);
            }
        }
}

// The frames of a shot, each in the common size.
TEST(ProjectedGrid, TakesAGivenSizeInEveryPose) {
    ProjectedGridOptions options{.bounds = {.height_m = 2.0, .reach_m = 2.0}, .significant_height_m = 2.0};
    const std::array views{view_of({.pitch_deg = 0.0}), view_of({.pitch_deg = -80.0})};
    const ProjectedGridNeeds needs = projected_grid_needs(views, options);
    options.size = needs.size;
    for (const View& view : views) {
        const ProjectedGrid grid = projected_grid(view, options);
        EXPECT_EQ((ProjectedGridSize{grid.columns, grid.rows}), needs.size);
        EXPECT_EQ(grid.rest_m.size(), points_of(needs.size));
        // In its own size no footprint is finer than promised.
        options.size = {};
        const ProjectedGridNeeds own = projected_grid_needs(view, options);
        const ProjectedGrid alone = projected_grid(view, options);
        options.size = needs.size;
        EXPECT_GE(*std::min_element(alone.cell_m.begin(), alone.cell_m.end()),
                  own.finest_cell_m * (1.0 - 1e-5));
        // Nor are those of pixels, but for single crests, which come nearer than the flat sea does.
        const ProjectedGridNeeds flat = projected_grid_needs(view, {});
        EXPECT_LE(own.finest_pixel_m, 1.05 * flat.finest_pixel_m);
        const ProjectedGrid of_flat = projected_grid(view, {});
        EXPECT_GE(*std::min_element(of_flat.pixel_m.begin(), of_flat.pixel_m.end()),
                  flat.finest_pixel_m * (1.0 - 1e-5));
    }
}

}  // namespace
}  // namespace pelagic
