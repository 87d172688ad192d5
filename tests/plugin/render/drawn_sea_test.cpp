// Pictures of seas that end: a patch in nothing, and cages (surface.beyond).
#include "plugin/render/drawn_sea.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <vector>

#include "core/surface/view.h"
#include "pelagic/cage.h"
#include "plugin/render/picture_files.h"
#include "plugin/render/render.h"
#include "tests/plugin/render/uniform_sky.h"

namespace pelagic {
namespace {

Scene small_scene() {
    Scene scene;
    scene.shot.last_frame = 1;
    scene.camera.resolution = {64, 40};
    scene.quality.level = QualityLevel::Draft;
    scene.waves.cascades = {{250.0, 64}, {30.0, 64}};
    scene.surface.earth_curvature = false;
    scene.surface.beyond = Beyond::Nothing;
    return scene;
}

Scene calm(Scene scene) {
    scene.sea.wind_speed_mps = 0.0;
    return scene;
}

// A pool of one face: its limit surface is the quad itself.
Scene pool(Scene scene, const std::array<glm::dvec3, 4>& corners_m) {
    CageMesh mesh;
    mesh.points_m.assign(corners_m.begin(), corners_m.end());
    mesh.face_counts = {4};
    mesh.indices = {0, 1, 2, 3};
    scene.surface.kind = SurfaceKind::Cage;
    scene.surface.cage_file = "pool.obj";
    scene.surface.cage = std::make_shared<const Cage>(mesh);
    scene.surface.beyond = Beyond::ByKind;
    return scene;
}
constexpr std::array<glm::dvec3, 4> kPool{
    glm::dvec3(-6.0, -5.0, 8.0), {6.0, -5.0, 8.0}, {6.0, 5.0, 8.0}, {-6.0, 5.0, 8.0}};

std::array<glm::dvec3, 4> square(double half_m) {
    return {glm::dvec3(-half_m, -half_m, 0.0),
            {half_m, -half_m, 0.0},
            {half_m, half_m, 0.0},
            {-half_m, half_m, 0.0}};
}

RenderOptions with_alpha(const Scene& scene, int samples) {
    RenderOptions options = render_options(scene);
    options.samples = samples;
    options.alpha = true;
    options.layers.set();
    return options;
}

Picture picture_of(const Scene& scene, const RenderOptions& options) {
    Renderer renderer(scene, options, uniform_sky(), std::array{1});
    Picture picture;
    renderer.render(1, picture);
    return picture;
}
Picture picture_of(const Scene& scene, int samples = 1) {
    return picture_of(scene, with_alpha(scene, samples));
}

std::size_t pixels_of_sea(const Picture& picture) {
    return static_cast<std::size_t>(std::count(picture.sea.begin(), picture.sea.end(), std::uint8_t{1}));
}

bool same_light(const SeaRadiance& a, const SeaRadiance& b) {
    return std::memcmp(&a, &b, sizeof(SeaRadiance)) == 0;
}

void expect_finite(const Picture& picture) {
    for (const SeaRadiance& light : picture.layers)
        for (int c = 0; c < 3; ++c) ASSERT_TRUE(std::isfinite(radiance_of(light)[c]));
    for (const float alpha : picture.alpha) ASSERT_TRUE(alpha >= 0.0f && alpha <= 1.0f);
    for (const std::vector<float>& layer : picture.data)
        for (const float value : layer) ASSERT_TRUE(std::isfinite(value));
}

// Where the corners are in the picture [pixels].
struct Outline {
    std::array<glm::dvec2, 4> corners{};
    Outline(const View& view, const std::array<glm::dvec3, 4>& at_m) {
        const glm::dmat4 clip_from = view.clip_from(glm::dvec3(0.0), 1e-3);
        for (std::size_t i = 0; i < 4; ++i) {
            const glm::dvec4 p = clip_from * glm::dvec4(at_m[i], 1.0);
            corners[i] = 0.5 * glm::dvec2(view.resolution) * glm::dvec2(1.0 + p.x / p.w, 1.0 - p.y / p.w);
        }
    }
    double area() const {
        double twice = 0.0;
        for (std::size_t i = 0; i < 4; ++i) {
            const glm::dvec2 a = corners[i], b = corners[(i + 1) % 4];
            twice += a.x * b.y - a.y * b.x;
        }
        return 0.5 * std::abs(twice);
    }
    // Of a place to the nearest edge's line, above 0 inside [pixels].
    double depth(glm::dvec2 place) const {
        double least = 1e9;
        for (std::size_t i = 0; i < 4; ++i) {
            const glm::dvec2 a = corners[i], along = corners[(i + 1) % 4] - a, from = place - a;
            least = std::min(least, (along.y * from.x - along.x * from.y) / std::hypot(along.x, along.y));
        }
        return least;
    }
};

// A pixel's share of water is within a pixel's edge the outline's, and so is the sum: 64 × 40 pixels of 4 × 4 samples, whose
// rows and columns each err by half a sample at an edge at most.
void expect_outline(const Scene& scene, const std::array<glm::dvec3, 4>& corners_m) {
    constexpr int kSamples = 4;
    const Picture picture = picture_of(scene, kSamples);
    const Outline outline(view_at(scene.camera, 1), corners_m);
    double sum = 0.0;
    for (int y = 0; y < picture.resolution.y; ++y)
        for (int x = 0; x < picture.resolution.x; ++x) {
            const std::size_t i = static_cast<std::size_t>(y) * picture.resolution.x + x;
            const double depth = outline.depth({x + 0.5, y + 0.5});
            if (std::abs(depth) > 0.75) {
                ASSERT_EQ(picture.alpha[i], depth > 0.0 ? 1.0f : 0.0f) << x << ", " << y;
            }
            sum += static_cast<double>(picture.alpha[i]);
        }
    for (const glm::dvec2& corner : outline.corners)
        ASSERT_TRUE(corner.x > 0.0 && corner.y > 0.0 && corner.x < 64.0 && corner.y < 40.0);
    EXPECT_GT(outline.area(), 100.0);
    EXPECT_NEAR(sum, outline.area(), 2.0);
}

TEST(DrawnSea, APatchInNothingIsItsSquare) {
    Scene scene = calm(small_scene());
    scene.surface.size_m = 20.0;
    for (const glm::dvec3& from : {glm::dvec3(0.0, 0.0, 60.0), {14.0, -48.0, 26.0}, {-40.0, 3.0, 6.0}}) {
        scene.camera.position_m = from;
        scene.camera.look_at_m = {0.5, 0.3, 0.0};
        expect_outline(scene, square(10.0));
    }
}

// Behind it is what is behind the sea; in the mean of a pixel at its edge both.
TEST(DrawnSea, BesideAPatchIsTheSky) {
    Scene scene = calm(small_scene());
    scene.surface.size_m = 20.0;
    scene.camera.position_m = {0.0, -20.0, 30.0};
    const Picture picture = picture_of(scene, render_options(scene));
    ASSERT_EQ(picture.sea.front(), 0);
    EXPECT_NEAR(radiance_of(picture.layers.front()).y, kSkyRadiance, 1e-5f * kSkyRadiance);
}

// Whole triangles keep their bits; those that the square's sides cut are as good.
TEST(DrawnSea, InAPatchIsTheOpenSea) {
    Scene scene = small_scene();
    scene.surface.size_m = 60.0;
    scene.camera.position_m = {0.0, -30.0, 45.0};
    const Picture patch = picture_of(scene);
    scene.surface.beyond = Beyond::Sea;
    const Picture open = picture_of(scene);
    std::size_t others = 0;
    for (std::size_t i = 0; i < patch.sea.size(); ++i) {
        if (patch.sea[i] == 0) continue;
        others += !same_light(patch.layers[i], open.layers[i]);
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(radiance_of(patch.layers[i])[c], radiance_of(open.layers[i])[c],
                        0.02f * kSkyRadiance);
    }
    EXPECT_GT(pixels_of_sea(patch), 800u);
    EXPECT_EQ(pixels_of_sea(open), open.sea.size());
    EXPECT_LT(others, pixels_of_sea(patch) / 10);
}

TEST(DrawnSea, KindsThatReachTheHorizonAreTheOpenSea) {
    Scene scene = small_scene();
    scene.surface.earth_curvature = true;
    scene.surface.beyond = Beyond::ByKind;
    const Picture open = picture_of(scene);
    const auto fingerprint = [](const Scene& of) {
        return PictureFingerprint({.scene = of, .options = render_options(of), .picture_content = ""}).of(1);
    };
    const std::string made_of = fingerprint(scene);
    scene.surface.size_m = 20.0;
    EXPECT_EQ(fingerprint(scene), made_of);
    for (const SurfaceKind kind : {SurfaceKind::ProjectedGrid, SurfaceKind::NearFar, SurfaceKind::Planet}) {
        scene.surface.kind = kind;
        scene.surface.beyond = Beyond::Nothing;
        EXPECT_EQ(fingerprint(scene), made_of);
        const Picture picture = picture_of(scene);
        for (std::size_t i = 0; i < open.layers.size(); ++i)
            ASSERT_TRUE(same_light(picture.layers[i], open.layers[i]));
    }
    scene.surface.kind = SurfaceKind::Patch;
    const std::string bounded = fingerprint(scene);
    EXPECT_NE(bounded, made_of);
    scene.surface.size_m = 21.0;
    EXPECT_NE(fingerprint(scene), bounded);
    const std::string of_pool = fingerprint(pool(scene, kPool));
    EXPECT_NE(of_pool, made_of);
    EXPECT_NE(fingerprint(pool(scene, square(5.0))), of_pool);
}

TEST(DrawnSea, APoolIsSeenAtItsHeight) {
    Scene scene = pool(calm(small_scene()), kPool);
    for (const bool is_adaptive : {false, true}) {
        scene.surface.cage_level.is_adaptive = is_adaptive;
        for (const glm::dvec3& from : {glm::dvec3(0.0, 0.0, 40.0), {10.0, -32.0, 24.0}}) {
            scene.camera.position_m = from;
            scene.camera.look_at_m = {0.5, 0.3, 8.0};
            expect_outline(scene, kPool);
        }
    }
    const Picture picture = picture_of(scene);
    const std::vector<float>& position = picture.data[index(PictureLayer::Position)];
    for (std::size_t i = 0; i < picture.sea.size(); ++i) {
        if (picture.sea[i] != 0) {
            ASSERT_NEAR(position[3 * i + 2], 8.0f, 1e-5f);
        }
    }
}

// Waves on a slope, too: on average its normal is the cage's.
TEST(DrawnSea, APoolHasItsOwnNormals) {
    Scene scene = small_scene();
    const glm::dvec3 normal = glm::normalize(glm::dvec3(-0.5, 0.0, 1.0));
    std::array<glm::dvec3, 4> corners = kPool;
    for (glm::dvec3& corner : corners) corner.z += 0.5 * corner.x;
    scene = pool(scene, corners);
    scene.sea.wind_speed_mps = 3.0;
    scene.sea.fetch_m = 300.0;
    scene.camera.position_m = {0.0, 0.0, 30.0};
    scene.camera.look_at_m = {0.0, 0.0, 8.0};
    const Picture picture = picture_of(scene);
    const std::vector<float>& of = picture.data[index(PictureLayer::Normal)];
    glm::dvec3 mean(0.0);
    bool varies = false;
    for (std::size_t i = 0; i < picture.sea.size(); ++i) {
        if (picture.sea[i] == 0) continue;
        const glm::dvec3 here(of[3 * i], of[3 * i + 1], of[3 * i + 2]);
        mean += here;
        varies = varies || glm::distance(here, normal) > 0.005;
    }
    EXPECT_TRUE(varies);
    EXPECT_LT(glm::distance(glm::normalize(mean), normal), 0.02);
}

// The open sea lies round a pool, below it, and hides what lies below the sea.
TEST(DrawnSea, APoolInTheSeaIsNearerOrFarther) {
    Scene scene = calm(small_scene());
    scene.camera.position_m = {0.0, -8.0, 30.0};
    scene.camera.look_at_m = {0.0, 0.0, 0.0};
    for (const double height_m : {8.0, -2.0}) {
        std::array<glm::dvec3, 4> corners = kPool;
        for (glm::dvec3& corner : corners) corner.z = height_m;
        Scene both = pool(scene, corners);
        both.surface.beyond = Beyond::Sea;
        const Picture picture = picture_of(both);
        EXPECT_EQ(pixels_of_sea(picture), picture.sea.size());
        const std::vector<float>& position = picture.data[index(PictureLayer::Position)];
        const Outline outline(view_at(scene.camera, 1), corners);
        for (int y = 0; y < picture.resolution.y; ++y)
            for (int x = 0; x < picture.resolution.x; ++x) {
                const std::size_t i = static_cast<std::size_t>(y) * picture.resolution.x + x;
                const double depth = outline.depth({x + 0.5, y + 0.5});
                if (std::abs(depth) < 0.01) continue;
                ASSERT_NEAR(position[3 * i + 2], depth > 0.0 && height_m > 0.0 ? height_m : 0.0, 1e-4);
            }
    }
}

TEST(DrawnSea, IsFiniteInHardCases) {
    struct Pose {
        glm::dvec3 from, to;
    };
    const std::array poses{Pose{{10.0, 0.0, 12.0}, {10.0, 0.0, 0.0}},     // above an edge
                           Pose{{10.0, 10.0, 12.0}, {10.0, 10.0, 0.0}},   // above a corner
                           Pose{{0.0, -40.0, 14.0}, {0.0, -90.0, 14.0}},  // with it behind
                           Pose{{0.0, -40.0, -3.0}, {0.0, 0.0, 0.0}},     // lower, where no sea is
                           Pose{{0.0, -400.0, 9.0}, {0.0, 0.0, 0.0}}};
    for (const bool is_pool : {false, true})
        for (const Pose& pose : poses) {
            Scene scene = small_scene();
            scene.surface.size_m = 20.0;
            if (is_pool) scene = pool(scene, square(10.0));
            scene.camera.position_m = pose.from;
            scene.camera.look_at_m = pose.to;
            scene.camera.resolution = {24, 16};
            scene.camera.f_stop = 0.5;
            RenderOptions options = with_alpha(scene, 2);
            options.shutter_frames = 0.5;
            const Picture picture = picture_of(scene, options);
            expect_finite(picture);
            if (pose.to.y < -80.0) {
                EXPECT_EQ(pixels_of_sea(picture), 0u);
            }
        }
    // On the water itself, and a patch smaller than any cell.
    Scene scene = calm(small_scene());
    scene.surface.size_m = 0.1;
    expect_finite(picture_of(scene));
    scene = pool(scene, kPool);
    scene.camera.position_m = {0.0, 0.0, 8.0};
    scene.camera.look_at_m = {0.0, 3.0, 8.0};
    expect_finite(picture_of(scene));
}

TEST(DrawnSea, WhereNoSeaIsACameraMayBeLow) {
    Scene scene = small_scene();
    scene.surface.size_m = 20.0;
    scene.camera.look_at_m = {0.0, 0.0, -4.0};
    scene.camera.position_m = {0.0, -9.0, -8.0};
    EXPECT_THROW(picture_of(scene), std::invalid_argument);
    scene.camera.position_m = {0.0, -19.0, -8.0};
    EXPECT_NO_THROW(picture_of(scene));
    scene.surface.beyond = Beyond::Sea;
    scene.water.body = false;
    EXPECT_THROW(picture_of(scene), std::invalid_argument);
    scene.water.body = true;  // it is seen from below
    EXPECT_NO_THROW(picture_of(scene));
}

// A camera below the pool is in it; beside it, or under a lip whose lower side is the first that it meets, it is not.
TEST(DrawnSea, ACameraInThePoolIsRefused) {
    Scene scene = pool(calm(small_scene()), kPool);
    const auto is_refused = [&](const glm::dvec3& from) {
        scene.camera.position_m = from;
        scene.camera.look_at_m = from + glm::dvec3(1.0, 0.0, 0.0);
        const DrawnSea drawn(*prepare(scene), true);
        EXPECT_EQ(drawn.cage_above(view_at(scene.camera, 1)).has_value(), [&] {
            try {
                picture_of(scene);
                return false;
            } catch (const std::invalid_argument& error) {
                EXPECT_NE(std::string(error.what()).find("under water"), std::string::npos);
                return true;
            }
        }());
        return drawn.cage_above(view_at(scene.camera, 1)).has_value();
    };
    EXPECT_TRUE(is_refused({1.0, 1.0, 7.9}));
    EXPECT_FALSE(is_refused({1.0, 1.0, 8.1}));
    EXPECT_FALSE(is_refused({7.0, 1.0, 7.9}));
    std::array<glm::dvec3, 4> lower_side = kPool;
    std::swap(lower_side[1], lower_side[3]);
    scene = pool(scene, lower_side);
    EXPECT_FALSE(is_refused({1.0, 1.0, 7.9}));
}

// Sides that two triangles share are cut in the same points, and the area is what is left of the square.
TEST(DrawnSea, ACutLeavesNoGaps) {
    SeaMesh mesh;
    const ProjectedGridSize size{16, 16};
    mesh.points.columns = size.columns, mesh.points.rows = size.rows;
    mesh.points.origin_m = {3.0, -1.0};
    for (int y = 0; y <= size.rows; ++y)
        for (int x = 0; x <= size.columns; ++x)
            mesh.points.rest_m.emplace_back(1.3f * static_cast<float>(x - 8) + 0.1f * static_cast<float>(y),
                                            0.9f * static_cast<float>(y - 8));
    const std::size_t count = mesh.points.rest_m.size();
    mesh.points.cell_m.assign(count, 1.0f);
    mesh.points.pixel_m.assign(count, 1.0f);
    mesh.points.cell_axis_m.assign(count, glm::vec2(0.0f));
    mesh.points.pixel_axis_m.assign(count, glm::vec2(0.0f));
    mesh.triangles = projected_grid_triangles(size);
    cut_to_square(4.5, mesh);
    double area = 0.0;
    std::vector<std::uint64_t> open_sides;
    for (std::size_t t = 0; t < mesh.triangles.size(); t += 3) {
        const auto at = [&](int i) { return glm::dvec2(mesh.points.rest_m[mesh.triangles[t + i]]); };
        const glm::dvec2 a = at(1) - at(0), b = at(2) - at(0);
        area += 0.5 * std::abs(a.x * b.y - a.y * b.x);
        for (int i = 0; i < 3; ++i) {
            const std::uint64_t from = mesh.triangles[t + i], to = mesh.triangles[t + (i + 1) % 3];
            const std::uint64_t side = (std::min(from, to) << 32) | std::max(from, to);
            if (const auto found = std::find(open_sides.begin(), open_sides.end(), side);
                found != open_sides.end())
                open_sides.erase(found);
            else
                open_sides.push_back(side);
        }
    }
    EXPECT_NEAR(area, 81.0, 1e-4);
    // What no other triangle has lies on the square.
    for (const std::uint64_t side : open_sides)
        for (const std::uint64_t i : {side >> 32, side & 0xffffffffu}) {
            const glm::dvec2 place = glm::dvec2(mesh.points.rest_m[i]) + mesh.points.origin_m;
            EXPECT_NEAR(std::max(std::abs(place.x), std::abs(place.y)), 4.5, 1e-5);
        }
}

}  // namespace
}  // namespace pelagic
