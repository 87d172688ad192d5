// Limit surfaces of cages against subdivision by hand, their meshes, and the sea on them.
#include "core/surface/cage.h"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>
#include <limits>
#include <random>

#include "tests/core/surface/cages.h"

namespace pelagic {
namespace {

using test::cube;
using test::grid_cage;
using test::prism;
using test::tetrahedron;

struct Placed {
    CageMeshing meshing;
    std::vector<glm::dvec3> places_m, normals;
};

Placed placed(const CageMesh& mesh, const CageLimit& limit, const CageRates& rates) {
    Placed out{limit.mesh(rates), {}, {}};
    limit.place(out.meshing, mesh.points_m, out.places_m, out.normals);
    return out;
}

Placed refined(const CageMesh& mesh, int segments) {
    const CageLimit limit(mesh);
    return placed(mesh, limit, limit.uniform_rates(segments));
}

struct Case {
    std::string name;
    CageMesh mesh;
};

std::vector<Case> cases() {
    std::vector<Case> all{{"cube", cube()}, {"tetrahedron", tetrahedron()}, {"prism", prism()}};
    const auto add = [&](const char* name, CageMesh mesh, const auto& change) {
        change(mesh);
        all.push_back({name, std::move(mesh)});
    };
    const auto wavy = [](int x, int y) { return 0.4 * std::sin(1.7 * x + 0.6 * y * y); };
    add("grid with edges and corners", grid_cage(3, 3, wavy), [](CageMesh&) {});
    add("grid with edges", grid_cage(3, 3, wavy), [](CageMesh& m) { m.boundary = CageBoundary::EdgeOnly; });
    add("sharp for ever", cube(), [](CageMesh& m) {
        m.creases = {{4, 5, 10.0}, {5, 6, 10.0}, {6, 7, 10.0}, {7, 4, 10.0}};
    });
    add("sharp for two levels", cube(), [](CageMesh& m) {
        m.creases = {{4, 5, 2.0}, {5, 6, 2.0}, {6, 7, 2.0}, {7, 4, 2.0}};
    });
    add("sharp for a fraction", cube(), [](CageMesh& m) {
        m.creases = {{4, 5, 1.5}, {5, 6, 1.5}, {6, 7, 1.5}, {7, 4, 1.5}};
    });
    add("a crease that ends", cube(), [](CageMesh& m) { m.creases = {{4, 5, 3.0}}; });
    add("a crease that ends on a prism", prism(), [](CageMesh& m) {
        m.creases = {{5, 6, 10.0}, {6, 7, 10.0}};
    });
    add("a corner", cube(), [](CageMesh& m) { m.corners = {{6, 10.0}}; });
    add("a corner for three levels", tetrahedron(), [](CageMesh& m) { m.corners = {{0, 3.0}}; });
    add("a crease from a boundary", grid_cage(3, 2, wavy), [](CageMesh& m) {
        m.creases = {{1, 5, 2.0}, {5, 9, 10.0}};
    });
    return all;
}

// Subdivided so often, a point is no farther from its limit than a few 4⁻ⁿ of the cage (its distance falls to a quarter with each
// level, from that on at which the last edge has become smooth: 3 here); the next point is 2⁻ⁿ away.
constexpr int kLevels = 7;
const double kNear = 5.0 * std::pow(0.25, kLevels);

TEST(Cage, PointsLieWhereSubdivisionByHandEnds) {
    for (const Case& each : cases()) {
        SCOPED_TRACE(each.name);
        test::PlainMesh by_hand = test::plain(each.mesh);
        for (int level = 0; level < kLevels; ++level) by_hand = test::subdivided(by_hand);
        for (const int segments : {1, 4}) {
            const Placed ours = refined(each.mesh, segments);
            ASSERT_EQ(ours.places_m.size(), ours.meshing.points);
            double worst = 0.0;
            for (const glm::dvec3& place : ours.places_m) {
                double least = std::numeric_limits<double>::infinity();
                for (const glm::dvec3& point : by_hand.points)
                    least = std::min(least, glm::distance(place, point));
                worst = std::max(worst, least);
            }
            EXPECT_LT(worst, kNear) << segments;
        }
    }
}

// The other way round: nothing of the surface is left out.
TEST(Cage, FacesAreThoseOfSubdivisionByHand) {
    for (const Case& each : cases()) {
        SCOPED_TRACE(each.name);
        test::PlainMesh by_hand = test::plain(each.mesh);
        for (int level = 1; level <= 3; ++level) {
            by_hand = test::subdivided(by_hand);
            const Placed ours = refined(each.mesh, 1 << level);
            EXPECT_EQ(ours.meshing.points, by_hand.points.size());
            EXPECT_EQ(ours.meshing.faces.counts, std::vector<std::int32_t>(by_hand.faces.size(), 4));
        }
    }
}

// Every edge has two faces that run along it in opposite ways, or lies at a boundary of the cage or a hole.
int edges_with_one_face(const Faces& faces) {
    std::map<std::pair<std::int32_t, std::int32_t>, int> forward;
    const std::int32_t* corner = faces.indices.data();
    for (const std::int32_t count : faces.counts) {
        for (std::int32_t k = 0; k < count; ++k) ++forward[{corner[k], corner[(k + 1) % count]}];
        corner += count;
    }
    int alone = 0;
    for (const auto& [edge, times] : forward) {
        EXPECT_EQ(times, 1) << edge.first << ' ' << edge.second;
        if (!forward.contains({edge.second, edge.first})) ++alone;
    }
    return alone;
}

TEST(Cage, AnyRatesOfEdgesMakeAMeshWithoutCracks) {
    std::mt19937 random(7);
    const auto rate = [&] { return std::uniform_int_distribution<int>(1, 9)(random); };
    for (const Case& each : cases()) {
        SCOPED_TRACE(each.name);
        const CageLimit limit(each.mesh);
        for (int round = 0; round < 20; ++round) {
            CageRates rates = limit.uniform_rates(1);
            for (int& of_edge : rates.edges) of_edge = rate();
            for (auto& of_face : rates.faces) of_face = {rate(), rate()};
            const Placed ours = placed(each.mesh, limit, rates);
            EXPECT_EQ(limit.count_points(rates), ours.meshing.points);
            std::map<std::pair<std::int32_t, std::int32_t>, int> faces_at;
            int expected = 0;
            for (std::size_t face = 0; face < limit.faces(); ++face)
                for (const std::int32_t edge : limit.face_edges(face)) {
                    const auto& ends = limit.edge_points(static_cast<std::size_t>(edge));
                    expected += (++faces_at[{ends[0], ends[1]}] == 1 ? 1 : -1) *
                                rates.edges[static_cast<std::size_t>(edge)];
                }
            EXPECT_EQ(edges_with_one_face(ours.meshing.faces), expected);
            // Each point is used, and none twice: points that lie in one place are one.
            std::set<std::int32_t> used(ours.meshing.faces.indices.begin(), ours.meshing.faces.indices.end());
            EXPECT_EQ(used.size(), ours.meshing.points);
            for (const glm::dvec3& normal : ours.normals) EXPECT_NEAR(glm::length(normal), 1.0, 1e-12);
        }
    }
}

// From a place to the nearest of a mesh's faces, as triangles.
double distance_to_faces(const glm::dvec3& place, const Placed& mesh) {
    double least = std::numeric_limits<double>::infinity();
    const auto to_segment = [&](const glm::dvec3& a, const glm::dvec3& b) {
        const double length2 = std::max(glm::dot(b - a, b - a), 1e-300);
        return glm::distance(place, a + std::clamp(glm::dot(place - a, b - a) / length2, 0.0, 1.0) * (b - a));
    };
    const auto at = [&](std::int32_t i) { return mesh.places_m[static_cast<std::size_t>(i)]; };
    const std::int32_t* corner = mesh.meshing.faces.indices.data();
    for (const std::int32_t count : mesh.meshing.faces.counts) {
        for (std::int32_t k = 2; k < count; ++k) {
            const glm::dvec3 a = at(corner[0]), b = at(corner[k - 1]), c = at(corner[k]);
            const glm::dvec3 normal = glm::cross(b - a, c - a);
            const auto is_inside = [&](const glm::dvec3& from, const glm::dvec3& to) {
                return glm::dot(glm::cross(to - from, place - from), normal) >= 0.0;
            };
            least = std::min({least, to_segment(a, b), to_segment(b, c), to_segment(c, a)});
            if (glm::length(normal) > 0.0 && is_inside(a, b) && is_inside(b, c) && is_inside(c, a))
                least = std::min(least, std::abs(glm::dot(place - a, glm::normalize(normal))));
        }
        corner += count;
    }
    return least;
}

// A mesh with different rates lies on the same surface: its points are among those of a mesh that has all.
TEST(Cage, MixedRatesLieOnTheSameSurface) {
    for (const Case& each : cases()) {
        SCOPED_TRACE(each.name);
        const CageLimit limit(each.mesh);
        const Placed fine = refined(each.mesh, 16);
        CageRates rates = limit.uniform_rates(4);
        for (std::size_t i = 0; i < rates.edges.size(); i += 2) rates.edges[i] = 8;
        for (std::size_t i = 0; i < rates.edges.size(); i += 3) rates.edges[i] = 2;
        const Placed mixed = placed(each.mesh, limit, rates);
        std::size_t same = 0;
        for (std::size_t i = 0; i < mixed.places_m.size(); ++i) {
            double least = std::numeric_limits<double>::infinity();
            std::size_t at = 0;
            for (std::size_t k = 0; k < fine.places_m.size(); ++k)
                if (const double d = glm::distance(mixed.places_m[i], fine.places_m[k]); d < least)
                    least = d, at = k;
            // Inside, points of such a pattern need not be halvings: those are near a facet of the fine mesh, whose sides are up
            // to 2/16 long, by a curvature of less than 16.
            if (least > 1e-9) {
                EXPECT_LT(distance_to_faces(mixed.places_m[i], fine), 16.0 / 8.0 / 64.0);
                continue;
            }
            ++same;
            EXPECT_NEAR(glm::dot(mixed.normals[i], fine.normals[at]), 1.0, 1e-9);
        }
        // Those along the edges are halvings: two in an edge of the cage at least, one but for those of two segments.
        EXPECT_GE(same, each.mesh.points_m.size() + limit.edges());
    }
}

TEST(Cage, AFlatGridStaysFlat) {
    const CageMesh mesh = grid_cage(4, 3, [](int, int) { return 2.5; });
    const Placed ours = refined(mesh, 4);
    EXPECT_EQ(ours.meshing.points, 17u * 13u);
    for (std::size_t i = 0; i < ours.places_m.size(); ++i) {
        EXPECT_NEAR(ours.places_m[i].z, 2.5, 1e-12);
        EXPECT_NEAR(glm::distance(ours.normals[i], glm::dvec3(0.0, 0.0, 1.0)), 0.0, 1e-12);
    }
}

// Tangents are those of the surface: differences of its own points, with a step that leaves half the digits.
TEST(Cage, NormalsAreThoseOfTheSurface) {
    for (const Case& each : cases()) {
        SCOPED_TRACE(each.name);
        const CageLimit limit(each.mesh);
        for (std::size_t face = 0; face < limit.faces(); ++face) {
            if (limit.face_edges(face).size() != 4) continue;
            for (const glm::dvec2 uv : {glm::dvec2(0.3, 0.4), glm::dvec2(0.7, 0.2), glm::dvec2(0.51, 0.93)}) {
                constexpr double kStep = 1e-5;
                Placed ours{limit.mesh(limit.uniform_rates(1)), {}, {}};
                ours.meshing.samples.clear();
                ours.meshing.points = 5;
                ours.meshing.first_samples.assign(limit.faces() + 1, 0);
                for (std::size_t f = face + 1; f <= limit.faces(); ++f) ours.meshing.first_samples[f] = 5;
                std::int32_t point = 0;
                for (const glm::dvec2 step : {glm::dvec2(0, 0), {1, 0}, {-1, 0}, {0, 1}, {0, -1}})
                    ours.meshing.samples.push_back({point++, true, uv + kStep * step});
                limit.place(ours.meshing, each.mesh.points_m, ours.places_m, ours.normals);
                const glm::dvec3 normal = glm::normalize(
                    glm::cross(ours.places_m[1] - ours.places_m[2], ours.places_m[3] - ours.places_m[4]));
                EXPECT_NEAR(glm::distance(normal, ours.normals[0]), 0.0, 1e-6) << face << ' ' << uv.x;
            }
        }
    }
}

TEST(Cage, HolesAreLeftOutAndShapeTheOthers) {
    CageMesh mesh = cube();
    const Placed whole = refined(mesh, 4);
    mesh.holes = {1};
    const Placed ours = refined(mesh, 4);
    EXPECT_EQ(ours.meshing.faces.counts.size(), whole.meshing.faces.counts.size() - 16);
    EXPECT_EQ(ours.meshing.points, whole.meshing.points - 9);
    EXPECT_EQ(edges_with_one_face(ours.meshing.faces), 16);
    for (const glm::dvec3& place : ours.places_m) {
        double least = 1.0;
        for (const glm::dvec3& other : whole.places_m) least = std::min(least, glm::distance(place, other));
        EXPECT_LT(least, 1e-12);
    }
}

TEST(Cage, WithoutABoundaryRuleTheOutermostFacesOnlyShapeTheOthers) {
    CageMesh mesh = grid_cage(4, 4, [](int x, int y) { return 0.1 * x * y; });
    mesh.boundary = CageBoundary::None;
    const Placed ours = refined(mesh, 2);
    EXPECT_EQ(ours.meshing.faces.counts.size(), 4u * 4u);
    for (const glm::dvec3& place : ours.places_m) {
        EXPECT_TRUE(place.x > 0.99 && place.x < 3.01 && place.y > 0.99 && place.y < 3.01);
        EXPECT_NEAR(place.z, 0.1 * place.x * place.y, 1e-12) << "a bicubic B-spline reproduces x y";
    }
}

TEST(Cage, TextureCoordinatesAreLinearOnTheCage) {
    CageMesh mesh = grid_cage(2, 2, [](int, int) { return 0.0; });
    // Without: the box round the points, as seen from above.
    for (const Placed& ours : {refined(mesh, 4)})
        for (std::size_t i = 0; i < ours.places_m.size(); ++i)
            EXPECT_TRUE(ours.meshing.faces.st[i].x >= 0.0f && ours.meshing.faces.st[i].y <= 1.0f);
    mesh.st = {{5, 0}, {6, 0}, {7, 0}, {5, 1}, {6, 1}, {7, 1}, {5, 2}, {6, 2}, {7, 2}};
    mesh.st_indices = mesh.indices;
    const Placed whole = refined(mesh, 2);
    EXPECT_FALSE(whole.meshing.faces.is_st_of_corners);
    ASSERT_EQ(whole.meshing.faces.st.size(), whole.meshing.points);
    std::set<std::pair<float, float>> seen;
    for (const glm::vec2& st : whole.meshing.faces.st) seen.insert({st.x, st.y});
    EXPECT_EQ(seen.size(), 25u) << "halves between 5 … 7 and 0 … 2";
    EXPECT_TRUE(seen.contains({5.5f, 1.5f}));
    // The same point with two: a seam, and values by corner.
    mesh.st.emplace_back(50, 50);
    mesh.st_indices[0] = 9;
    EXPECT_FALSE(refined(mesh, 2).meshing.faces.is_st_of_corners) << "a corner of one face alone";
    mesh.st_indices[2] = 9;
    const Placed cut = refined(mesh, 2);
    EXPECT_TRUE(cut.meshing.faces.is_st_of_corners);
    EXPECT_EQ(cut.meshing.faces.st.size(), cut.meshing.faces.indices.size());
}

// Stencils once, then any places of the points: the same surface.
TEST(Cage, StencilsGiveTheSurfaceOfPointsThatMove) {
    for (const Case& each : cases()) {
        SCOPED_TRACE(each.name);
        const CageLimit limit(each.mesh);
        const CageMeshing meshing = limit.mesh(limit.uniform_rates(4));
        const CageStencils stencils = limit.stencils(meshing);
        std::vector<glm::dvec3> moved = each.mesh.points_m;
        for (std::size_t i = 0; i < moved.size(); ++i) moved[i] += 0.1 * std::sin(static_cast<double>(i));
        std::vector<glm::dvec3> places, normals, expected_places, expected_normals;
        CageLimit::place(meshing, stencils, moved, places, normals);
        limit.place(meshing, moved, expected_places, expected_normals);
        for (std::size_t i = 0; i < places.size(); ++i) {
            EXPECT_LT(glm::distance(places[i], expected_places[i]), 1e-12);
            EXPECT_LT(glm::distance(normals[i], expected_normals[i]), 1e-9);
        }
    }
}

// ---- As a surface of a scene

Scene cage_scene(CageMesh mesh) {
    Scene scene;
    scene.surface.kind = SurfaceKind::Cage;
    scene.surface.cage = std::make_shared<const Cage>(std::move(mesh));
    return scene;
}

constexpr Extent kCageExtent{.height_m = 1.0, .reach_m = 1.0, .significant_height_m = 0.5, .unresolved = {}};

TEST(CageSurface, AUniformOneIsTheSameAtEveryFrame) {
    Scene scene = cage_scene(cube());
    scene.surface.cage_level = {.splits = 3};
    const auto surface = make_surface(scene, kCageExtent);
    EXPECT_TRUE(surface->is_constant());
    EXPECT_FALSE(surface->has_origin() || surface->origin_follows_camera() || surface->is_even());
    EXPECT_FALSE(surface->shaped_by(7));
    RestPoints<double> points;
    surface->points_at(7, points);
    const int frames[] = {7, 8};
    const SurfaceNeeds needs = surface->needs(frames);
    EXPECT_EQ(points.rest_m.size(), 6u * 64u + 2u);
    EXPECT_EQ(needs.points, points.rest_m.size());
    EXPECT_TRUE(needs.own_footprints);
    EXPECT_EQ(points.height_m.size(), needs.points);
    EXPECT_EQ(points.normal.size(), needs.points);
    Faces faces;
    surface->faces_at(8, faces);
    EXPECT_EQ(faces.counts.size(), 6u * 64u);
    // The first level is the nearest power of two.
    for (const double cell_m : points.cell_m) EXPECT_GE(cell_m, needs.finest_cell_m / std::sqrt(2.0));
    EXPECT_NE(surface->describe().find("386 points"), std::string::npos) << surface->describe();
}

TEST(CageSurface, AnAdaptiveOneFollowsTheCamera) {
    Scene scene = cage_scene(grid_cage(8, 8, [](int x, int y) { return 0.2 * std::sin(x) * y; }));
    scene.surface.cage_level.is_adaptive = true;
    scene.camera.resolution = {640, 360};
    scene.camera.keys = {{.frame = 1, .position_m = {4.0, -3.0, 2.0}, .look_at_m = {4.0, 4.0, 0.0}},
                         {.frame = 11, .position_m = {4.0, -300.0, 80.0}, .look_at_m = {4.0, 4.0, 0.0}}};
    const auto surface = make_surface(scene, kCageExtent);
    EXPECT_FALSE(surface->is_constant());
    EXPECT_TRUE(surface->has_origin() && !surface->origin_follows_camera());
    const int all[] = {1, 11, 20};
    std::size_t most = 0, before = 0;
    for (const int frame : all) {
        SCOPED_TRACE(frame);
        RestPoints<double> points;
        Faces faces;
        surface->points_at(frame, points);
        surface->faces_at(frame, faces);
        EXPECT_EQ(surface->needs(std::span(&frame, 1)).points, points.rest_m.size());
        most = std::max(most, points.rest_m.size());
        const View view = *surface->shaped_by(frame);
        // No side of a face is longer than cells are there, but for the curving of a half edge between its ends.
        const std::int32_t* corner = faces.indices.data();
        const auto place = [&](std::int32_t i) {
            const auto at = static_cast<std::size_t>(i);
            return glm::dvec3(points.origin_m + points.rest_m[at], points.height_m[at]);
        };
        double longest_px = 0.0;
        for (const std::int32_t count : faces.counts) {
            for (std::int32_t k = 0; k < count; ++k) {
                const glm::dvec3 a = place(corner[k]), b = place(corner[(k + 1) % count]);
                const double distance_m =
                    std::min(glm::distance(a, view.position_m), glm::distance(b, view.position_m));
                longest_px = std::max(longest_px, glm::distance(a, b) / (distance_m * view.pixel_tangent()));
            }
            corner += count;
        }
        EXPECT_LT(longest_px, 2.5 * scene.surface.cell_px) << "diagonals of cells are the longest";
        // All open edges are the cage's own: a crack would add to the length of the four sides.
        double open_m = 0.0;
        std::map<std::pair<std::int32_t, std::int32_t>, int> sides;
        corner = faces.indices.data();
        for (const std::int32_t count : faces.counts) {
            for (std::int32_t k = 0; k < count; ++k) ++sides[std::minmax(corner[k], corner[(k + 1) % count])];
            corner += count;
        }
        for (const auto& [ends, times] : sides) {
            if (times != 1) continue;
            const glm::dvec3 a = place(ends.first), b = place(ends.second);
            const auto is_side = [](double v, double w) {
                return std::abs(v - w) < 1e-9 && (std::abs(v) < 1e-9 || std::abs(v - 8.0) < 1e-9);
            };
            EXPECT_TRUE(is_side(a.x, b.x) || is_side(a.y, b.y))
                << a.x << ' ' << a.y << ' ' << b.x << ' ' << b.y;
            open_m += glm::distance(glm::dvec2(a), glm::dvec2(b));
        }
        EXPECT_NEAR(open_m, 32.0, 1e-9);
        // From far away a few points to each face, and from nearby no more than the pixels ask for: a cell's side is at least a
        // quarter of what it may be, where each edge is as fine as its nearest place needs.
        if (frame == 1) {
            EXPECT_GT(points.rest_m.size(), 1000u);
            EXPECT_LT(points.rest_m.size(), 16u * static_cast<std::size_t>(640 * 360) / 64u);
        } else {
            EXPECT_LE(points.rest_m.size(), 200u) << "no more than two segments an edge";
        }
        if (frame == 20) {
            EXPECT_EQ(points.rest_m.size(), before) << "the camera stands";
        }
        before = points.rest_m.size();
    }
    EXPECT_EQ(surface->needs(all).points, most);
}

// A camera may be anywhere, in the surface as well.
TEST(CageSurface, ACameraInTheSurfaceIsNoSpecialCase) {
    Scene scene = cage_scene(grid_cage(1, 1, [](int, int) { return 0.0; }));
    scene.surface.cage_level.is_adaptive = true;
    scene.surface.cell_px = 64.0;
    for (const glm::dvec3 position : {glm::dvec3(0.3, 0.6, 0.0), glm::dvec3(1e9, 0.0, 1.0)}) {
        scene.camera.position_m = position;
        scene.camera.look_at_m = position + glm::dvec3(0.0, 1.0, 0.0);
        const auto surface = make_surface(scene, Extent{});
        RestPoints<float> points;
        surface->points_at(1, points);
        EXPECT_GE(points.rest_m.size(), 4u);
        for (std::size_t i = 0; i < points.rest_m.size(); ++i)
            EXPECT_TRUE(std::isfinite(points.rest_m[i].x + points.height_m[i] + points.normal[i].z) &&
                        points.cell_m[i] > 0.0f);
    }
}

// Without waves nothing keeps cells from 0 beside the eye: they are as fine as cells get, and faces without size have one segment.
TEST(CageSurface, AnEyeAtAPointOfACalmCageEnds) {
    CageMesh fan, collapsed = grid_cage(1, 1, [](int, int) { return 0.0; });
    constexpr int kQuads = 8;
    fan.points_m.emplace_back(0.0);
    for (int i = 0; i < 2 * kQuads; ++i) {
        const double turn = i * 3.14159265358979 / kQuads;
        fan.points_m.emplace_back(std::cos(turn), std::sin(turn), 0.0);
    }
    for (std::int32_t i = 0; i < kQuads; ++i) {
        fan.face_counts.push_back(4);
        fan.indices.insert(fan.indices.end(), {0, 2 * i + 1, 2 * i + 2, (2 * i + 2) % (2 * kQuads) + 1});
    }
    for (glm::dvec3& point : collapsed.points_m) point = glm::dvec3(0.0);
    for (const CageMesh& mesh : {fan, collapsed}) {
        Scene scene = cage_scene(mesh);
        scene.surface.cage_level.is_adaptive = true;
        scene.surface.cell_px = 64.0;
        scene.camera.position_m = glm::dvec3(0.0);
        scene.camera.look_at_m = {0.0, 1.0, 0.0};
        const auto surface = make_surface(scene, Extent{});
        RestPoints<double> points;
        surface->points_at(1, points);
        EXPECT_GE(points.rest_m.size(), 4u);
        for (const double cell_m : points.cell_m) EXPECT_TRUE(cell_m > 0.0 && std::isfinite(cell_m));
    }
}

// A value that can't be honoured is refused, with one that can.
TEST(CageSurface, CellsThatMakeTooManyPointsAreRefused) {
    Scene scene = cage_scene(grid_cage(40, 40, [](int, int) { return 0.0; }));
    scene.surface.cage_level.is_adaptive = true;
    scene.surface.cell_px = 0.01;
    scene.camera.position_m = {20.0, 20.0, 1.0};
    scene.camera.look_at_m = {20.0, 30.0, 0.0};
    const std::string key = "raise it to ";
    std::string message;
    try {
        make_surface(scene, Extent{});
    } catch (const std::invalid_argument& error) {
        message = error.what();
    }
    ASSERT_NE(message.find("at frame 1"), std::string::npos) << message;
    ASSERT_NE(message.find(key), std::string::npos) << message;
    EXPECT_GT(std::stod(message.substr(message.find(key) + key.size())), 0.01) << message;
}

// Points that no face uses have no say in where the origin is.
TEST(CageSurface, APointOfNoFaceMovesNothing) {
    CageMesh mesh = grid_cage(2, 2, [](int, int) { return 0.0; });
    for (glm::dvec3& point : mesh.points_m) point *= 0.1;
    mesh.points_m.emplace_back(1e6, 0.0, 0.0);
    const auto surface = make_surface(cage_scene(std::move(mesh)), kCageExtent);
    RestPoints<float> points;
    surface->points_at(1, points);
    EXPECT_EQ(points.origin_m, glm::dvec2(0.0));
    Faces faces;
    surface->faces_at(1, faces);
    float most = 0.0f;
    for (const glm::vec2& st : faces.st) most = std::max(most, st.x);
    EXPECT_EQ(most, 1.0f);
}

TEST(CageSurface, FarFromTheOriginItHasItsOwn) {
    CageMesh mesh = grid_cage(2, 2, [](int, int) { return 0.0; });
    for (glm::dvec3& point : mesh.points_m) point += glm::dvec3(9e5, -9e5, 0.0);
    const auto surface = make_surface(cage_scene(std::move(mesh)), kCageExtent);
    EXPECT_TRUE(surface->is_constant() && surface->has_origin() && !surface->origin_follows_camera());
    RestPoints<float> points;
    surface->points_at(1, points);
    for (const glm::vec2& rest : points.rest_m) EXPECT_LT(glm::length(rest), 4096.0f);
}

// Faces without size: points that all lie in one place.
TEST(CageSurface, ACollapsedCageIsFinite) {
    CageMesh mesh = cube();
    for (glm::dvec3& point : mesh.points_m) point = {1.0, 2.0, 3.0};
    const auto surface = make_surface(cage_scene(std::move(mesh)), kCageExtent);
    RestPoints<double> points;
    surface->points_at(1, points);
    for (std::size_t i = 0; i < points.rest_m.size(); ++i) {
        EXPECT_EQ(points.normal[i], glm::dvec3(0.0, 0.0, 1.0));
        EXPECT_GT(points.cell_m[i], 0.0);
    }
}

}  // namespace
}  // namespace pelagic
