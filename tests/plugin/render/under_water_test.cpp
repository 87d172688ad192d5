// A camera under water is refused, by the surface that its picture would show there.
#include "plugin/render/under_water.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/evaluate/evaluate.h"
#include "plugin/light/light.h"
#include "plugin/render/render.h"

namespace pelagic {
namespace {

Scene sea_of(WaveModel model) {
    Scene scene;
    scene.sea.wind_speed_mps = 15.0;
    scene.waves.model = model;
    scene.waves.choppiness = 0.5;  // nothing folds: each place has one height
    if (model == WaveModel::Fft) scene.waves.cascades = {{250.0, 64}, {30.0, 64}};
    scene.camera.resolution = {32, 20};
    scene.quality.level = QualityLevel::Draft;
    return scene;
}

// Points of the surface at a frame, as a camera there would see it.
std::vector<glm::dvec3> surface_points(const Scene& scene, int frame, glm::dvec2 origin_m, int count) {
    const Plan plan = picture_plan(scene, std::array{frame});
    Frame<float> state(std::make_shared<const Sea<float>>(plan));
    state.set(scene.shot.time_s(frame));
    std::vector<glm::vec2> rest(count);
    for (int i = 0; i < count; ++i)
        rest[i] = {60.0f * std::sin(1.7f * static_cast<float>(i)),
                   60.0f * std::cos(2.3f * static_cast<float>(i))};
    std::vector<glm::vec3> positions(count);
    Results<float> results;
    results.set(Product::Position, {positions.data()});
    evaluate(state, 0, Points<float>{.origin_m = origin_m, .count = rest.size(), .rest_m = {rest.data()}},
             results);
    std::vector<glm::dvec3> world;
    for (const glm::vec3& p : positions) world.push_back(glm::dvec3(p) + glm::dvec3(origin_m, 0.0));
    return world;
}

// Why a picture of the frame is refused; empty if it isn't, and then all of it is finite.
std::string why_refused(const Scene& scene, int frame) {
    Renderer renderer(scene, render_options(scene), make_sky(scene), std::array{frame});
    Picture picture;
    try {
        EXPECT_TRUE(renderer.render(frame, picture));
    } catch (const std::invalid_argument& error) {
        return error.what();
    }
    for (const SeaRadiance& layers : picture.layers)
        for (int c = 0; c < 3; ++c) EXPECT_TRUE(std::isfinite(radiance_of(layers)[c]));
    return {};
}

Scene seen_from(Scene scene, glm::dvec3 position_m) {
    scene.camera.position_m = position_m;
    scene.camera.look_at_m = position_m + glm::dvec3(10.0, 3.0, 0.5);
    return scene;
}

class UnderWater : public testing::TestWithParam<WaveModel> {};

TEST_P(UnderWater, ACentimetreDecidesOnCrestsAndInTroughs) {
    const Scene scene = sea_of(GetParam());
    for (const glm::dvec2 origin_m : {glm::dvec2(0.0), glm::dvec2(1e6, 1e6)}) {
        std::vector<glm::dvec3> points = surface_points(scene, 7, origin_m, 200);
        std::sort(points.begin(), points.end(), [](auto a, auto b) { return a.z < b.z; });
        ASSERT_LT(points.front().z, -0.5);
        ASSERT_GT(points.back().z, 0.5);
        for (const glm::dvec3 p : {points.front(), points[50], points[100], points[150], points.back()}) {
            EXPECT_EQ(why_refused(seen_from(scene, p + glm::dvec3(0.0, 0.0, 0.01)), 7), "") << p.z;
            const std::string why = why_refused(seen_from(scene, p - glm::dvec3(0.0, 0.0, 0.01)), 7);
            EXPECT_NE(why.find("camera.position_m: at frame 7 the camera is under water"), std::string::npos)
                << p.z << why;
        }
    }
}

TEST_P(UnderWater, TheFirstOfTheFramesAskedForIsNamed) {
    Scene scene = sea_of(GetParam());
    const glm::dvec3 crest = surface_points(scene, 5, {}, 1).front();
    for (const auto& [frame, z_m] :
         {std::pair(1, 30.0), std::pair(4, 30.0), std::pair(5, crest.z - 0.02), std::pair(6, 30.0)})
        scene.camera.keys.push_back({.frame = frame, .position_m = {crest.x, crest.y, z_m}});
    const std::vector<int> all{1, 2, 3, 4, 5, 6}, others{1, 2, 3, 4, 6};
    Renderer renderer(scene, render_options(scene), make_sky(scene), all);
    EXPECT_TRUE(renderer.check_cameras(others));
    try {
        renderer.check_cameras(all);
        ADD_FAILURE() << "frame 5 is under water";
    } catch (const std::invalid_argument& error) {
        EXPECT_TRUE(std::string(error.what()).starts_with("camera.keys: at frame 5 ")) << error.what();
    }
}

// Only they are looked at: the others cost nothing.
TEST_P(UnderWater, FramesWhoseCameraIsAboveEveryCrestArentLookedAt) {
    Scene scene = sea_of(GetParam());
    scene.camera.keys = {{.frame = 1, .position_m = {0.0, 0.0, 30.0}},
                         {.frame = 10, .position_m = {0.0, 0.0, 30.0}}};
    std::vector<int> frames{1, 2, 3, 4, 5, 6, 7, 8, 9, 10};
    Renderer renderer(scene, render_options(scene), make_sky(scene), frames);
    int looks = 0;
    const RenderWatch watch{.progress = [&](double) { ++looks; }};
    EXPECT_TRUE(renderer.check_cameras(frames, watch));
    EXPECT_EQ(looks, 0);
    const Scene low =
        seen_from(sea_of(GetParam()), surface_points(scene, 1, {}, 1).front() + glm::dvec3(0.0, 0.0, 0.5));
    Renderer among(low, render_options(low), make_sky(low), std::array{1});
    EXPECT_TRUE(among.check_cameras(std::array{1}, watch));
    EXPECT_EQ(looks, 1);
}

INSTANTIATE_TEST_SUITE_P(Cameras, UnderWater, testing::Values(WaveModel::Fft, WaveModel::Trochoid),
                         [](const auto& model) { return model.param == WaveModel::Fft ? "fft" : "trains"; });

// Not a shot among Pelagic's own would pay for it.
TEST(UnderWater, AnUsualShotIsAboveEveryCrest) {
    const Scene scene;
    const auto prepared = prepare(scene);
    EXPECT_FALSE(is_among_waves(view_at(scene.camera, 1), projected_grid_options(*prepared)));
}

}  // namespace
}  // namespace pelagic
