// Surfaces as points at rest: what they say about themselves, and that a frame needs no other frame.
#include "core/surface/rest_surface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

#include "core/scene/validate.h"

namespace pelagic {
namespace {

constexpr Extent kExtent{.height_m = 3.0, .reach_m = 2.0, .significant_height_m = 2.0};

Scene camera_scene() {
    Scene scene;
    scene.surface.kind = SurfaceKind::ProjectedGrid;
    scene.camera.resolution = {160, 90};
    scene.camera.keys = {{.frame = 1, .position_m = {0.0, -60.0, 200.0}, .look_at_m = {0.0, 0.0, 2.0}},
                         {.frame = 20, .position_m = {0.0, -60.0, 3.0}, .look_at_m = {0.0, 0.0, 2.0}}};
    scene.shot.last_frame = 30;
    return scene;
}

TEST(RestSurface, APatchIsOneSquareForAllFrames) {
    Scene scene;
    scene.surface.resolution = 8;
    scene.surface.size_m = 40.0;
    const auto surface = make_surface(scene, kExtent);
    EXPECT_EQ(surface->describe(), "a patch of 8 × 8 quads over 40 m");
    EXPECT_TRUE(surface->is_constant());
    const std::array frames{1};
    const SurfaceNeeds needs = surface->needs(frames);
    EXPECT_EQ(needs.points, 81u);
    EXPECT_EQ(needs.finest_cell_m, 5.0);
    RestPoints<double> points;
    surface->points_at(7, points);
    ASSERT_EQ(points.rest_m.size(), 81u);
    EXPECT_EQ(points.rest_m.front(), glm::dvec2(-20.0, -20.0));
    EXPECT_EQ(points.rest_m.back(), glm::dvec2(20.0, 20.0));
    EXPECT_FALSE(surface->shaped_by(7));
    Faces faces;
    surface->faces_at(7, faces);
    EXPECT_EQ(faces.counts.size(), 64u);
}

// What a frame of the camera's grid is follows from that frame's pose, whatever else the shot has.
TEST(RestSurface, TheCamerasGridOfAFrameDependsOnItsPoseAlone) {
    Scene scene = camera_scene(), other = scene;
    other.shot.first_frame = 5;
    other.shot.last_frame = 9;
    other.camera.keys.push_back({.frame = 40, .position_m = {0.0, 0.0, 900.0}, .look_at_m = {9.0, 0.0, 0.0}});
    const auto a = make_surface(scene, kExtent), b = make_surface(other, kExtent);
    EXPECT_FALSE(a->is_constant());
    EXPECT_TRUE(a->origin_follows_camera());
    std::size_t sizes = 0, last = 0;
    for (const int frame : {2, 12, 19}) {
        RestPoints<float> ours, theirs;
        a->points_at(frame, ours);
        b->points_at(frame, theirs);
        EXPECT_EQ(ours.rest_m, theirs.rest_m);
        EXPECT_EQ(ours.cell_m, theirs.cell_m);
        EXPECT_EQ(a->shaped_by(frame), b->shaped_by(frame));
        Faces faces;
        a->faces_at(frame, faces);
        EXPECT_EQ(faces.st.size(), ours.rest_m.size());
        sizes += ours.rest_m.size() != last;
        last = ours.rest_m.size();
        const std::array alone{frame};
        for (const float cell_m : ours.cell_m)
            ASSERT_GE(cell_m, static_cast<float>(a->needs(alone).finest_cell_m) * 0.999f);
    }
    EXPECT_GT(sizes, 1u);  // the camera descends: grids of several sizes were compared
}

TEST(RestSurface, NeedsOfFramesTogetherAreThoseOfEach) {
    const auto surface = make_surface(camera_scene(), kExtent);
    const std::array all{3, 11, 19, 25, 30};
    const SurfaceNeeds together = surface->needs(all);
    double finest_m = 1e9;
    std::size_t points = 0;
    for (const int frame : all) {
        const std::array alone{frame};
        finest_m = std::min(finest_m, surface->needs(alone).finest_cell_m);
        points = std::max(points, surface->needs(alone).points);
    }
    EXPECT_EQ(together.finest_cell_m, finest_m);
    EXPECT_GE(together.points, points);
}

TEST(RestSurface, ARestingCameraIsLookedAtOnceAndALongPathInSteps) {
    Scene scene = camera_scene();
    scene.shot.last_frame = 2'000'000;
    EXPECT_EQ(representative_frames(scene, 64).front(), 1);
    EXPECT_EQ(representative_frames(scene, 64).back(), 20);
    scene.camera.keys.back().frame = 3'000'000;
    const auto frames = representative_frames(scene, 64);
    EXPECT_EQ(frames.size(), 64u);
    EXPECT_EQ(frames.front(), 1);
    EXPECT_EQ(frames.back(), 2'000'000);
    scene.camera.keys.clear();
    EXPECT_EQ(representative_frames(scene, 64), std::vector<int>{1});
}

// Every kind of surface is either a part or refused with its word; none is silently another.
TEST(RestSurface, KindsWithoutAPartAreRefused) {
    for (const SurfaceKind kind : {SurfaceKind::Patch, SurfaceKind::ProjectedGrid, SurfaceKind::NearFar,
                                   SurfaceKind::Cage, SurfaceKind::Planet}) {
        Scene scene;
        scene.surface.kind = kind;
        if (validate(scene).empty())
            EXPECT_NO_THROW(make_surface(scene, kExtent));
        else
            EXPECT_THROW(make_surface(scene, kExtent), std::invalid_argument);
    }
}

TEST(GridFaces, CoverTheirSquareOnceAndLookUp) {
    // Powers of two, so that every st and every area below is exact.
    for (const auto& [columns, rows] : {std::pair{8, 8}, {8, 4}, {2, 16}}) {
        const Faces grid = grid_faces(columns, rows);
        ASSERT_EQ(grid.counts.size(), std::size_t(columns * rows));
        ASSERT_EQ(grid.st.size(), std::size_t((columns + 1) * (rows + 1)));
        EXPECT_EQ(grid.st.front(), glm::vec2(0, 0));
        EXPECT_EQ(grid.st[std::size_t(columns)], glm::vec2(1, 0));  // columns fastest
        EXPECT_EQ(grid.st.back(), glm::vec2(1, 1));
        for (std::size_t face = 0; face < grid.counts.size(); ++face) {
            EXPECT_EQ(grid.counts[face], 4);
            // The shoelace formula: the signed area is positive for a counter-clockwise face.
            float area = 0.0f;
            for (std::size_t i = 0; i < 4; ++i) {
                const glm::vec2 a = grid.st[static_cast<std::size_t>(grid.indices[4 * face + i])];
                const glm::vec2 b = grid.st[static_cast<std::size_t>(grid.indices[4 * face + (i + 1) % 4])];
                area += 0.5f * (a.x * b.y - b.x * a.y);
            }
            EXPECT_EQ(area, 1.0f / static_cast<float>(columns * rows));
            // The faces come in the order of their lowest corners.
            const auto lowest = static_cast<std::size_t>(grid.indices[4 * face]), n = std::size_t(columns);
            EXPECT_EQ(lowest, face / n * (n + 1) + face % n);
        }
    }
    // Into memory that another grid has used.
    Faces again = grid_faces(7, 5);
    const std::int32_t* const memory = again.indices.data();
    set_grid_faces(4, 6, again);
    EXPECT_EQ(again.counts, grid_faces(4, 6).counts);
    EXPECT_EQ(again.indices, grid_faces(4, 6).indices);
    EXPECT_EQ(again.st, grid_faces(4, 6).st);
    EXPECT_EQ(again.indices.data(), memory);
    EXPECT_THROW(grid_faces(0, 4), std::invalid_argument);
    EXPECT_THROW(grid_faces(4, 0), std::invalid_argument);
    EXPECT_THROW(grid_faces(1 << 15, 1 << 14), std::invalid_argument);  // 2^29
    EXPECT_THROW(grid_faces(1000000000, 1000000000), std::invalid_argument);
}

}  // namespace
}  // namespace pelagic
