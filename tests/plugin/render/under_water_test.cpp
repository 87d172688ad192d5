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
#include "core/surface/footprint_levels.h"
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

Scene seen_from(Scene scene, glm::dvec3 position_m) {
    scene.camera.position_m = position_m;
    scene.camera.look_at_m = position_m + glm::dvec3(10.0, 3.0, 0.5);
    return scene;
}

// Where a point at rest is displaced to at a frame, as a camera that is there sees it: how fine it sees follows from
// its height, and that from how fine it sees.
glm::dvec3 surface_at(const Scene& scene, int frame, glm::dvec2 rest_m) {
    glm::dvec3 place_m(rest_m, 0.0);
    for (int i = 0; i < 4; ++i) {
        const Scene seen = seen_from(scene, place_m);
        Frame<float> state(std::make_shared<const Sea<float>>(picture_plan(seen, std::array{frame})));
        state.set(scene.shot.time_s(frame));
        const bool has_levels = state.sea().plan().queries.front().query.pixel_m.size() > 1;
        const double finest_m = projected_grid_needs(view_at(seen.camera, frame),
                                                     projected_grid_options(*state.sea().plan().from))
                                    .finest_cell_m;
        const auto cell_m = static_cast<float>(has_levels ? first_level_m(finest_m) : finest_m);
        const glm::vec2 rest(0.0f);
        glm::vec3 position(0.0f);
        Results<float> results;
        results.set(Product::Position, {&position});
        evaluate(state, 0,
                 Points<float>{.origin_m = rest_m, .count = 1, .rest_m = {&rest}, .cell_m = {&cell_m}},
                 results);
        place_m = glm::dvec3(position) + glm::dvec3(rest_m, 0.0);
    }
    return place_m;
}

const Sky& sky_under_water() {
    static const Sky sky = make_sky(Scene());
    return sky;
}

// Why a picture of the frame is refused; empty if it isn't, and then all of it is finite.
std::string why_refused(const Scene& scene, int frame) {
    Renderer renderer(scene, render_options(scene), sky_under_water(), std::array{frame});
    Picture picture;
    try {
        renderer.render(frame, picture);
    } catch (const std::invalid_argument& error) {
        return error.what();
    }
    for (const SeaRadiance& layers : picture.layers)
        for (int c = 0; c < 3; ++c) EXPECT_TRUE(std::isfinite(radiance_of(layers)[c]));
    return {};
}

class UnderWater : public testing::TestWithParam<WaveModel> {};

TEST_P(UnderWater, ACentimetreDecidesOnCrestsAndInTroughs) {
    const Scene scene = sea_of(GetParam());
    double lowest_m = 0.0, highest_m = 0.0;
    for (const glm::dvec2 rest_m :
         {glm::dvec2(3.0, 4.0), glm::dvec2(-21.0, 8.0), glm::dvec2(1e6, 1e6 + 30.0)}) {
        // A wave passes: a crest, a trough, and what is between.
        for (const int frame : {1, 40}) {
            const glm::dvec3 p = surface_at(scene, frame, rest_m);
            lowest_m = std::min(lowest_m, p.z);
            highest_m = std::max(highest_m, p.z);
            EXPECT_EQ(why_refused(seen_from(scene, p + glm::dvec3(0.0, 0.0, 0.01)), frame), "") << p.z;
            const std::string why = why_refused(seen_from(scene, p - glm::dvec3(0.0, 0.0, 0.01)), frame);
            EXPECT_TRUE(why.starts_with("camera.position_m: at frame " + std::to_string(frame) +
                                        " the camera is under water"))
                << p.z << why;
        }
    }
    EXPECT_LT(lowest_m, -0.2);
    EXPECT_GT(highest_m, 0.2);
}

TEST_P(UnderWater, TheFirstOfTheFramesAskedForIsNamed) {
    Scene scene = sea_of(GetParam());
    const glm::dvec3 crest = surface_at(scene, 5, {3.0, 4.0});
    for (const auto& [frame, z_m] :
         {std::pair(1, 30.0), std::pair(4, 30.0), std::pair(5, crest.z - 0.3), std::pair(6, 30.0)})
        scene.camera.keys.push_back({.frame = frame, .position_m = {crest.x, crest.y, z_m}});
    const std::vector<int> all{1, 2, 3, 4, 5, 6}, others{1, 2, 3, 4, 6};
    Renderer renderer(scene, render_options(scene), sky_under_water(), all);
    renderer.check_cameras(others);
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
    Renderer renderer(scene, render_options(scene), sky_under_water(), frames);
    int looks = 0;
    const BuildWatch watch{.progress = [&](double) { ++looks; }};
    renderer.check_cameras(frames, watch);
    EXPECT_EQ(looks, 0);
    const Scene low =
        seen_from(sea_of(GetParam()), surface_at(scene, 1, {3.0, 4.0}) + glm::dvec3(0.0, 0.0, 0.5));
    Renderer among(low, render_options(low), sky_under_water(), std::array{1});
    among.check_cameras(std::array{1}, watch);
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
