// The mesh from near to far: one mesh without a gap, faces that stay, places that stay.
#include "core/surface/near_far.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <set>
#include <utility>

#include "core/base/constants.h"
#include "core/scene/limits.h"
#include "core/scene/validate.h"
#include "core/surface/earth.h"
#include "core/surface/earth_view.h"

namespace pelagic {
namespace {

constexpr Extent kNearFarExtent{.height_m = 3.0, .reach_m = 2.0, .significant_height_m = 2.0};

Scene near_far_scene(double size_m, int resolution, bool is_round = false) {
    Scene scene;
    scene.surface.kind = SurfaceKind::NearFar;
    scene.surface.size_m = size_m;
    scene.surface.resolution = resolution;
    scene.surface.earth_curvature = is_round;
    return scene;
}

Scene seen_from(Scene scene, glm::dvec3 position_m) {
    scene.camera.position_m = position_m;
    scene.camera.look_at_m = position_m + glm::dvec3(0.0, 1e-3 * std::abs(position_m.z) + 1e-3, -1.0);
    return scene;
}

// In the world.
std::vector<glm::dvec2> places_of(const RestPoints<float>& points) {
    std::vector<glm::dvec2> places;
    for (const glm::vec2 rest : points.rest_m) places.push_back(points.origin_m + glm::dvec2(rest));
    return places;
}

double cross(glm::dvec2 a, glm::dvec2 b) {
    return a.x * b.y - a.y * b.x;
}

const std::vector<std::pair<double, int>> kSizes{
    {200.0, 16}, {200.0, 1}, {200.0, 2}, {200.0, 3},  {0.01, 5}, {30.0, 7},   {100.0, 33},
    {50e3, 12},  {1e6, 1},   {1e6, 64},  {16.0, 128}, {2e4, 3},  {8192.0, 9}, {333.3, 100}};

// Edges as pairs of points, in the way in which a face goes round.
using Edges = std::map<std::pair<std::int32_t, std::int32_t>, int>;

Edges edges_of(const Faces& faces) {
    Edges edges;
    const std::int32_t* corner = faces.indices.data();
    for (const std::int32_t count : faces.counts) {
        for (std::int32_t i = 0; i < count; ++i) ++edges[{corner[i], corner[(i + 1) % count]}];
        corner += count;
    }
    return edges;
}

// A disc: each inner edge has a face on either side, the border is one loop, and no point is anywhere else. Where every
// edge has both its faces no point can lie within an edge: there is no T-junction.
TEST(NearFar, IsOneDiscWhateverItsSize) {
    for (const auto& [size_m, resolution] : kSizes) {
        SCOPED_TRACE(std::to_string(size_m) + " m, " + std::to_string(resolution));
        const NearFarMesh mesh(size_m, resolution);
        Faces faces;
        mesh.set_faces(faces);
        EXPECT_EQ(faces.counts.size(), mesh.quads() + mesh.triangles());
        EXPECT_EQ(faces.indices.size(), 4 * mesh.quads() + 3 * mesh.triangles());
        EXPECT_EQ(faces.st.size(), mesh.points());
        const Edges edges = edges_of(faces);
        std::map<std::int32_t, std::int32_t> border;
        for (const auto& [edge, count] : edges) {
            ASSERT_EQ(count, 1) << "two faces go the same way";
            if (!edges.contains({edge.second, edge.first})) {
                ASSERT_TRUE(border.emplace(edge.first, edge.second).second);
            }
        }
        ASSERT_EQ(border.size(), static_cast<std::size_t>(mesh.columns()));
        std::int32_t at = border.begin()->first;
        for (std::size_t i = 0; i < border.size(); ++i) at = border.at(at);
        EXPECT_EQ(at, border.begin()->first);
        std::set<std::int32_t> seen;
        for (std::size_t i = 0; i < border.size(); ++i) seen.insert(at = border.at(at));
        EXPECT_EQ(seen.size(), border.size());
        const std::set<std::int32_t> used(faces.indices.begin(), faces.indices.end());
        ASSERT_EQ(used.size(), mesh.points());
        EXPECT_EQ(*used.begin(), 0);
        EXPECT_EQ(*used.rbegin() + 1, static_cast<std::int64_t>(mesh.points()));
        const auto undirected = static_cast<std::int64_t>((edges.size() + border.size()) / 2);
        EXPECT_EQ(static_cast<std::int64_t>(mesh.points()) - undirected +
                      static_cast<std::int64_t>(faces.counts.size()),
                  1);
        // The texture's plane is covered once, too.
        double area = 0.0;
        const std::int32_t* corner = faces.indices.data();
        for (const std::int32_t count : faces.counts) {
            double own = 0.0;
            for (std::int32_t i = 0; i < count; ++i)
                own += 0.5 *
                       cross(glm::dvec2(faces.st[corner[i]]), glm::dvec2(faces.st[corner[(i + 1) % count]]));
            ASSERT_GT(own, 0.0);
            area += own;
            corner += count;
        }
        EXPECT_NEAR(area, 1.0, 1e-4);  // st are floats
    }
}

// The largest that is accepted has no more corners than an int counts, with the smallest patch, which has most rings.
TEST(NearFar, TheLargestCanBeCounted) {
    const NearFarMesh mesh(limits::kSurfaceSize_m.low, limits::kNearFarResolution);
    EXPECT_LT(4 * mesh.quads() + 3 * mesh.triangles(), std::size_t{1} << 31);
    const NearFarMesh more(limits::kSurfaceSize_m.low, 2 * limits::kNearFarResolution);
    EXPECT_GT(4 * more.quads() + 3 * more.triangles(), std::size_t{1} << 31);
}

// From above all faces are convex and go round counter-clockwise: with one border, they cover its inside once.
void expect_upright(const NearFarMesh& mesh, const std::vector<glm::dvec2>& places) {
    Faces faces;
    mesh.set_faces(faces);
    const std::int32_t* corner = faces.indices.data();
    double least = 1.0;
    for (const std::int32_t count : faces.counts) {
        for (std::int32_t i = 0; i < count; ++i) {
            const glm::dvec2 a = places[corner[i]], b = places[corner[(i + 1) % count]],
                             c = places[corner[(i + 2) % count]];
            const double sine = cross(b - a, c - b) / (glm::length(b - a) * glm::length(c - b));
            ASSERT_GT(sine, 0.0) << corner[i];
            least = std::min(least, sine);
        }
        corner += count;
    }
    EXPECT_GT(least, 1e-3);  // and none is a needle
}

TEST(NearFar, CoversItsDiscOnceFromEveryHeightAndPlace) {
    for (const auto& [size_m, resolution] : kSizes)
        for (const bool is_round : {false, true})
            for (const double height_m : {0.0, 0.1, 4.0, -3.0, 99.0, 2e3, 1e5, 1e9})
                for (const glm::dvec2 at_m : {glm::dvec2(0.0), glm::dvec2(-0.26, 77.7),
                                              glm::dvec2(1e6, -1e6 + 0.3), glm::dvec2(-1e9, 1e9 - 50.0)}) {
                    SCOPED_TRACE(std::to_string(size_m) + " m, " + std::to_string(resolution) + ", from " +
                                 std::to_string(height_m) + " m at " + std::to_string(at_m.x) +
                                 ", round: " + std::to_string(is_round));
                    const Scene scene =
                        seen_from(near_far_scene(size_m, resolution, is_round), glm::dvec3(at_m, height_m));
                    const NearFar surface(scene, kNearFarExtent);
                    RestPoints<float> points;
                    surface.points_at(1, points);
                    ASSERT_EQ(points.rest_m.size(), surface.mesh().points());
                    const std::vector<glm::dvec2> places = places_of(points);
                    ASSERT_NO_FATAL_FAILURE(expect_upright(surface.mesh(), places));

                    // It reaches the horizon, and the last crest over it, in all directions.
                    const NearFarMesh& mesh = surface.mesh();
                    const int last = mesh.rows() - 1;
                    double nearest_m = 1e300;
                    for (int i = 0; i < mesh.columns(); ++i) {
                        const glm::dvec2 a = places[mesh.far_point(last, i)] - at_m,
                                         b = places[mesh.far_point(last, (i + 1) % mesh.columns())] - at_m;
                        nearest_m = std::min(nearest_m, cross(a, b) / glm::length(b - a));
                    }
                    const EarthView earth(height_m, is_round ? kEarthCurvature_per_m : 0.0,
                                          kNearFarExtent.height_m);
                    const double horizon_m =
                        is_round ? earth.farthest_m() : std::min(std::abs(height_m) * 0x1p20, 1e15);
                    EXPECT_GT(nearest_m, 0.999 * horizon_m);
                    if (is_round) {
                        EXPECT_LT(nearest_m, 1.1e7);  // the earth's functions are exact so far
                    }
                    // The camera is over the near patch, in the middle.
                    const NearFarMesh::Level& near = mesh.levels().front();
                    const double cell_m = surface.place_of({at_m, height_m}).cell_m;
                    const glm::dvec2 low = places[0] - at_m,
                                     high = places[near.point(near.cells, near.cells)] - at_m;
                    for (const double off_m : {low.x + high.x, low.y + high.y})
                        EXPECT_LE(0.5 * std::abs(off_m), 1.01 * cell_m + 1e-6);
                }
}

// Of a camera that goes along and rises: where a place of one frame has a vertex in the next one, too, it has the same
// bits; and there are many of those.
TEST(NearFar, PlacesStayWhenTheCameraMoves) {
    for (const bool is_round : {false, true})
        for (const auto& [size_m, resolution] : {std::pair{200.0, 64}, {100.0, 33}, {20.0, 48}, {1e6, 64}}) {
            Scene scene = near_far_scene(size_m, resolution, is_round);
            scene.shot.last_frame = 40;
            const double way_m = 0.3 * size_m;
            scene.camera.keys = {
                {.frame = 1, .position_m = {1e6, -2e6, 3.0}, .look_at_m = {1e6 + 9.0, -2e6, 0.0}},
                {.frame = 40,
                 .position_m = {1e6 + way_m, -2e6 - 0.7 * way_m, 3.0 + 1.5 * size_m},
                 .look_at_m = {1e6 + 2.0 * way_m, -2e6, 0.0}}};
            ASSERT_TRUE(validate(scene).empty());
            const NearFar surface(scene, kNearFarExtent);
            std::map<std::pair<double, double>, std::array<double, 3>> before;
            std::size_t kept = 0, of = 0, steps = 0;
            std::set<double> cells_m;
            NearFarPlace last{};
            const std::size_t near = surface.mesh().far_point(0, 0);
            for (int frame = 1; frame <= 40; ++frame) {
                RestPoints<float> points;
                surface.points_at(frame, points);
                const std::vector<glm::dvec2> places = places_of(points);
                const NearFarPlace place = surface.place_of(view_at(scene.camera, frame).position_m);
                cells_m.insert(place.cell_m);
                std::map<std::pair<double, double>, std::array<double, 3>> now;
                for (std::size_t i = 0; i < near; ++i) {
                    // On the lattice of its cells, exactly; and of powers of two of them.
                    const glm::dvec2 on = places[i] / place.cell_m;
                    ASSERT_EQ(on, glm::round(on));
                    now[{places[i].x, places[i].y}] = {static_cast<double>(points.cell_m[i]),
                                                       points.origin_m.x, points.origin_m.y};
                }
                ASSERT_EQ(now.size(), near);  // no place twice
                if (frame > 1) {
                    for (const auto& [at, value] : now) kept += before.contains(at);
                    of += near;
                    steps += place != last;
                    EXPECT_EQ(place == last, surface.shaped_by(frame) == surface.shaped_by(frame - 1));
                }
                before = std::move(now);
                last = place;
            }
            EXPECT_GT(kept, of * 9 / 10);
            EXPECT_GT(steps, 2u);
            EXPECT_GE(cells_m.size(), is_round && size_m < 50.0 ? 1u : 2u);
        }
}

// Footprints belong to cells: one level for each, the finest those of the needs; far away the long way between rows.
TEST(NearFar, FootprintsAreThoseOfTheCells) {
    const Scene scene = seen_from(near_far_scene(200.0, 64), {3.0, 5.0, 4.0});
    const NearFar surface(scene, kNearFarExtent);
    RestPoints<double> points;
    surface.points_at(1, points);
    const std::array frames{1};
    const SurfaceNeeds needs = surface.needs(frames);
    EXPECT_TRUE(needs.own_footprints);
    EXPECT_EQ(needs.points, surface.mesh().points());
    EXPECT_EQ(*std::min_element(points.cell_m.begin(), points.cell_m.end()), needs.finest_cell_m);
    EXPECT_EQ(needs.finest_cell_m, 4.0);  // the level nearest to 200/64
    double cell_m = 4.0;
    for (const NearFarMesh::Level& level : surface.mesh().levels()) {
        level.for_each_point([&](int x, int y) {
            const std::size_t i = level.point(x, y);
            EXPECT_EQ(points.cell_m[i], level.is_on_border(x, y) ? 2.0 * cell_m : cell_m);
            EXPECT_EQ(points.cell_axis_m[i], glm::dvec2(0.0));
        });
        cell_m *= 2.0;
    }
    const NearFarMesh& mesh = surface.mesh();
    for (int row = 1; row + 1 < mesh.rows(); ++row)
        for (int column = 0; column < mesh.columns(); ++column) {
            const std::size_t i = mesh.far_point(row, column);
            const double long_m = glm::length(points.cell_axis_m[i]);
            EXPECT_GE(long_m, points.cell_m[i]);
            for (const std::size_t neighbour :
                 {mesh.far_point(row - 1, column), mesh.far_point(row + 1, column),
                  mesh.far_point(row, (column + 1) % mesh.columns())})
                EXPECT_LE(glm::length(points.rest_m[neighbour] - points.rest_m[i]), 1.01 * long_m);
        }
    EXPECT_EQ(points.pixel_m, points.cell_m);
}

// Rings grow with the distance: an angle in all of them.
TEST(NearFar, DetailFollowsTheHeightInOctaves) {
    const auto cell_m = [](double height_m, bool is_round) {
        return NearFar(near_far_scene(200.0, 100, is_round), kNearFarExtent)
            .place_of({0.0, 0.0, height_m})
            .cell_m;
    };
    for (const double height_m : {0.0, 4.0, 99.0, 199.9}) EXPECT_EQ(cell_m(height_m, false), 2.0);
    EXPECT_EQ(cell_m(200.0, false), 4.0);
    EXPECT_EQ(cell_m(-399.0, false), 4.0);
    EXPECT_EQ(cell_m(400.0, false), 8.0);
    EXPECT_EQ(cell_m(100e3, false), 1024.0);
    // On the earth the horizon comes nearer: its rings stay within it, and so their cells finer.
    EXPECT_EQ(cell_m(4.0, true), 2.0);
    EXPECT_LT(cell_m(100e3, true), 1024.0);
    EXPECT_GT(cell_m(100e3, true), 16.0);
}

// What a frame is follows from the camera's place, in steps; from nothing else of the shot.
TEST(NearFar, DependsOnThePlaceAlone) {
    Scene scene = seen_from(near_far_scene(200.0, 16, true), {3.0, 5.0, 4.0}), other = scene;
    other.camera.look_at_m = {900.0, 5.0, 100.0};
    other.camera.fov_deg = 3.0;
    other.camera.resolution = {17, 1001};
    other.shot.last_frame = 900;
    other.camera.position_m += glm::dvec3(0.01, 0.01, 0.1);
    const NearFar a(scene, kNearFarExtent), b(other, kNearFarExtent);
    EXPECT_EQ(a.shaped_by(1), b.shaped_by(1));
    RestPoints<float> ours, theirs;
    a.points_at(1, ours);
    b.points_at(1, theirs);
    EXPECT_EQ(ours.rest_m, theirs.rest_m);
    EXPECT_EQ(ours.origin_m, theirs.origin_m);
    EXPECT_EQ(ours.touches_at_m, theirs.touches_at_m);
    EXPECT_EQ(ours.cell_m, theirs.cell_m);
    EXPECT_EQ(ours.cell_axis_m, theirs.cell_axis_m);
}

// The earth touches z = 0 below the camera, nearly.
TEST(NearFar, TheEarthIsNoLowerBelowTheCamera) {
    for (const auto& [size_m, resolution] : kSizes)
        for (const double height_m : {4.0, 3e4})
            for (double x_m = 0.0; x_m < 700.0; x_m += 61.3) {
                const Scene scene =
                    seen_from(near_far_scene(size_m, resolution, true), {x_m, -3e5 - 2.0 * x_m, height_m});
                RestPoints<float> points;
                NearFar(scene, kNearFarExtent).points_at(1, points);
                const glm::dvec2 from_m = glm::dvec2(scene.camera.position_m) - points.touches_at_m;
                EXPECT_GT(on_earth(glm::dvec3(from_m, 0.0), kEarthCurvature_per_m).z, -7e-4);
            }
}

}  // namespace
}  // namespace pelagic
