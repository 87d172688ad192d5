// A camera under water: it is refused, by the surface that its picture would show there, where the water has no body; otherwise it sees
// what is in the water and the surface from below.
#include "plugin/render/under_water.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/evaluate/evaluate.h"
#include "core/surface/footprint_levels.h"
#include "plugin/light/light.h"
#include "plugin/render/layers.h"
#include "plugin/render/render.h"
#include "plugin/render/waterline.h"
#include "tests/plugin/render/uniform_sky.h"

namespace pelagic {
namespace {

Scene sea_of(WaveModel model) {
    Scene scene;
    scene.sea.wind_speed_mps = 15.0;
    scene.waves.model = model;
    scene.waves.choppiness = 0.5;  // nothing folds: each place has one height
    scene.water.body = false;
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
            EXPECT_NE(why.find("water.body = true"), std::string::npos) << why;
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

// ---- From below

Scene with_body(Scene scene) {
    scene.water.body = true;
    scene.surface.earth_curvature = false;
    return scene;
}

// A sea without a wave.
Scene level(glm::dvec3 position_m, glm::dvec3 direction) {
    Scene scene = with_body(sea_of(WaveModel::Fft));
    scene.sea.wind_speed_mps = 0.0;
    scene.camera.position_m = position_m;
    scene.camera.look_at_m = position_m + direction;
    return scene;
}

RenderOptions all_layers(const Scene& scene) {
    RenderOptions options = render_options(scene);
    options.layers.set();
    options.alpha = true;
    return options;
}

Picture picture_under(const Scene& scene, const Sky& sky, int frame = 1) {
    Renderer renderer(scene, all_layers(scene), sky, std::array{frame});
    Picture picture;
    renderer.check_cameras(std::array{frame});
    renderer.render(frame, picture);
    for (const SeaRadiance& of : picture.layers)
        for (const glm::vec3& light : {of.sun, of.sky, of.sea, of.foam, of.air})
            for (int c = 0; c < 3; ++c) EXPECT_TRUE(std::isfinite(light[c]) && light[c] >= 0.0f);
    for (const std::vector<float>& layer : picture.data)
        for (const float value : layer) EXPECT_TRUE(std::isfinite(value));
    for (const float alpha : picture.alpha) EXPECT_TRUE(alpha >= 0.0f && alpha <= 1.0f);
    return picture;
}

// All of the sky is in a circle, half as wide as arcsin(1/n).
TEST(FromBelow, TheSkyIsInSnellsWindow) {
    Scene scene = level({0.0, 0.0, -3.0}, {0.0, 0.0, 1.0});
    scene.camera.fov_deg = 104.0;
    scene.camera.resolution = {300, 300};
    const Picture picture = picture_under(scene, uniform_sky());
    std::size_t lit = 0;
    for (const SeaRadiance& of : picture.layers) lit += of.sky.y > 0.0f;
    const double tangent = 2.0 * std::tan(52.0 * kPi / 180.0) / 300.0;
    const double half_deg = std::atan(tangent * std::sqrt(static_cast<double>(lit) / kPi)) * 180.0 / kPi;
    EXPECT_NEAR(half_deg, std::asin(1.0 / 1.34) * 180.0 / kPi, 0.1);
}

// Nothing is brighter than the sky: its light in the water is n² of that above it, of which a camera behind its glass, in air, sees 1/n².
// Through a metre of water most of it comes.
TEST(FromBelow, NothingIsBrighterThanTheSky) {
    for (const bool is_calm : {true, false}) {
        Scene scene = is_calm ? level({0.0, 0.0, -1.0}, {0.0, 0.0, 1.0})
                              : seen_from(with_body(sea_of(WaveModel::Fft)), {0.0, 0.0, -6.0});
        scene.camera.fov_deg = 100.0;
        scene.camera.look_at_m = scene.camera.position_m + glm::dvec3(0.0, 0.1, 1.0);
        scene.camera.resolution = {64, 64};
        float brightest = 0.0f;
        for (const SeaRadiance& of : picture_under(scene, uniform_sky()).layers)
            brightest = std::max(brightest, (of.sky + of.sea).y);
        EXPECT_LT(brightest, kSkyRadiance);
        EXPECT_GT(brightest, (is_calm ? 0.8 : 0.5) * kSkyRadiance);
    }
}

// The line between water and air is where the front glass meets the surface: of a level camera as far below its middle as the camera is
// above the water, over how far the glass is before the eye.
TEST(FromBelow, HalfUnderShowsBoth) {
    constexpr double kHeight_m = 0.02;
    Scene scene = level({0.0, 0.0, kHeight_m}, {0.0, 1.0, 0.0});
    scene.camera.fov_deg = 90.0;
    scene.camera.resolution = {80, 80};
    const Picture picture = picture_under(scene, uniform_sky());
    const int line = 40 + static_cast<int>(std::lround(kHeight_m / kFrontGlass_m * 40.0));
    const auto at = [&](int row) { return picture.layers[static_cast<std::size_t>(row) * 80 + 40]; };
    EXPECT_GT(at(line - 2).sky.y, 0.0f);  // the sea from above mirrors the sky
    for (const int row : {line + 1, 79}) {
        EXPECT_EQ(at(row).sky, glm::vec3(0.0f)) << row;
        EXPECT_GT(at(row).sea.y, 0.0f) << row;
        EXPECT_EQ(picture.alpha[static_cast<std::size_t>(row) * 80 + 40], 1.0f);
    }
    EXPECT_EQ(picture.alpha[10 * 80 + 40], 0.0f);
}

// Water climbs the glass: a little over the line there is already no sky in the picture, and over that it comes back softly.
TEST(FromBelow, WaterClimbsTheGlass) {
    constexpr double kHeight_m = 0.005;
    Scene scene = level({0.0, 0.0, kHeight_m}, {0.0, 1.0, 0.0});
    scene.camera.fov_deg = 3.0;
    scene.camera.resolution = {20, 200};
    const Picture picture = picture_under(scene, uniform_sky());
    const double pixel_m = kFrontGlass_m * 2.0 * std::tan(1.5 * kPi / 180.0) / 20.0;
    const auto above_the_line = [&](double height_m) {
        const auto row = static_cast<std::size_t>(100.0 + (kHeight_m - height_m) / pixel_m);
        return row * 20 + 10;
    };
    const auto of_sky = [&](double height_m) { return picture.layers[above_the_line(height_m)].sky.y; };
    for (const double height_m : {-1e-3, 5e-4, 1.5e-3}) {
        EXPECT_EQ(of_sky(height_m), 0.0f) << height_m;
        EXPECT_EQ(picture.alpha[above_the_line(height_m)], 1.0f);
    }
    EXPECT_GT(of_sky(5e-3), 0.9f * kSkyRadiance);  // mirrored at a glance
    double before = 0.0;
    for (double height_m = 1.5e-3; height_m < 4e-3; height_m += pixel_m) {
        const double here = of_sky(height_m) / kSkyRadiance;
        EXPECT_GE(here, before - 0.01) << height_m;
        EXPECT_LT(here, before + 0.25) << height_m;
        before = here;
    }
}

// Before the sky, too: it hides as much as it shows, so that a picture with alpha lies over any other.
TEST(FromBelow, WaterThatClimbsTheGlassHasAlpha) {
    constexpr double kHeight_m = 0.002;
    Scene scene = level({0.0, 0.0, kHeight_m}, {0.0, 1.0, 0.5});  // the line lies before the sky
    scene.camera.fov_deg = 6.0;
    scene.camera.resolution = {20, 400};
    const Picture picture = picture_under(scene, uniform_sky());
    ASSERT_FALSE(picture.alpha.empty());
    float before = 0.0f;
    int between = 0;
    for (std::size_t row = 0; row < 400; ++row) {
        const std::size_t at = row * 20 + 10;
        const float alpha = picture.alpha[at];
        EXPECT_GE(alpha, before - 1e-6f) << row;
        between += alpha > 0.05f && alpha < 0.95f;
        const SeaRadiance& light = picture.layers[at];
        EXPECT_LE((light.sky + light.sea + light.sun + light.air).y, 1.01f * alpha * kSkyRadiance) << row;
        before = alpha;
    }
    EXPECT_EQ(before, 1.0f);
    EXPECT_GT(between, 2) << "it begins with an edge";
}

// Waves cross the glass, too: some columns have more water than others.
TEST(FromBelow, TheLineFollowsTheWaves) {
    Scene scene = with_body(sea_of(WaveModel::Fft));
    const glm::dvec3 p = surface_at(scene, 1, {3.0, 4.0});
    scene = seen_from(scene, p);
    scene.camera.look_at_m = p + glm::dvec3(1.0, 0.0, 0.0);
    scene.camera.fov_deg = 90.0;
    scene.camera.resolution = {96, 64};
    const Picture picture = picture_under(scene, uniform_sky());
    // Water has no air before it, and what is in air has.
    int least = 64, most = 0;
    for (int x = 0; x < 96; ++x) {
        int water = 0;
        for (int y = 0; y < 64; ++y) {
            const auto at = static_cast<std::size_t>(y) * 96 + x;
            water += picture.sea[at] && picture.layers[at].sky == glm::vec3(0.0f);
        }
        least = std::min(least, water);
        most = std::max(most, water);
    }
    EXPECT_GT(least, 5);
    EXPECT_LT(most, 59);
    EXPECT_GT(most, least + 2);
}

// Each fifth of their combinations.
TEST(FromBelow, HostileViewsAreFinite) {
    int number = 0;
    for (const double wind_mps : {0.0, 15.0})
        for (const double depth_m : {30.0, 5000.0})
            for (const double z_m : {-29.9, -5.0, -0.05, 0.0, 0.05})
                for (const glm::dvec3 direction :
                     {glm::dvec3(0.0, 0.0, 1.0), {0.0, 0.0, -1.0}, {0.0, 1.0, 0.0}, {1.0, 1.0, -1e-9}})
                    for (const double sun_deg : {-20.0, 0.0, 50.0}) {
                        if (number++ % 5 != 0) continue;
                        Scene scene = level({5.0, 3.0, z_m}, direction);
                        scene.sea.wind_speed_mps = wind_mps;
                        scene.sea.depth_m = depth_m;
                        scene.camera.fov_deg = 120.0;
                        scene.camera.resolution = {12, 12};
                        Sky sky = uniform_sky();
                        const double sun = sun_deg * kPi / 180.0;
                        sky.sun_direction = glm::vec3(0.0, std::cos(sun), std::sin(sun));
                        if (sun > 0.0) {
                            sky.sun_radiance = glm::vec3(1e6f);
                            sky.sun_irradiance = glm::vec3(1e6f * 6.8e-5f * sky.sun_direction.z);
                        }
                        picture_under(scene, sky);
                    }
}

// Shafts move the sun's light in the water about and keep it. A picture has few of them: the mean is over many places.
TEST(FromBelow, ShaftsKeepTheLightsMean) {
    Scene scene = with_body(sea_of(WaveModel::Fft));
    scene.sea.wind_speed_mps = 4.0;
    scene.sea.fetch_m = 20e3;
    scene.waves.cascades = {{60.0, 128}, {11.0, 128}, {2.3, 128}};
    scene.camera.fov_deg = 80.0;
    scene.camera.resolution = {32, 18};
    const Sky sky = make_sky(scene);
    const glm::dvec2 to_sun = glm::normalize(glm::dvec2(sky.sun_direction));
    std::vector<int> frames;
    for (int frame = 1; frame <= 24; ++frame) {
        const glm::dvec3 eye_m(517.0 * frame, -310.0 * frame, -4.0);
        frames.push_back(frame);
        scene.camera.keys.push_back({.frame = frame,
                                     .position_m = eye_m,
                                     .look_at_m = eye_m + glm::dvec3(-to_sun.y, to_sun.x, -0.1)});
    }
    RenderOptions options = render_options(scene);
    options.samples = 1;
    Renderer shafts(scene, options, sky, frames);
    scene.water.caustics = 0.0;
    Renderer none(scene, options, sky, frames);
    double even = 0.0, gathered = 0.0, squares = 0.0;
    int pixels = 0;
    Picture with, without;
    for (const int frame : frames) {
        shafts.render(frame, with);
        none.render(frame, without);
        for (std::size_t i = 0; i < with.layers.size(); ++i) {
            const auto a = static_cast<double>(without.layers[i].sea.y),
                       b = static_cast<double>(with.layers[i].sea.y);
            even += a;
            gathered += b;
            squares += (b / a - 1.0) * (b / a - 1.0);
            ++pixels;
        }
    }
    std::printf("    shafts: mean %.4f, rms %.4f\n", gathered / even, std::sqrt(squares / pixels));
    EXPECT_NEAR(gathered / even, 1.0, 0.01);
    EXPECT_GT(std::sqrt(squares / pixels), 0.02);
}

// The floor is seen where it is, and a camera in it is refused.
TEST(FromBelow, TheFloorIsWhereTheSeaEnds) {
    Scene scene = level({0.0, 0.0, -3.0}, {0.0, 0.0, -1.0});
    scene.sea.depth_m = 10.0;
    scene.water.floor_colour = glm::dvec3(0.5);
    const Picture picture = picture_under(scene, uniform_sky());
    for (const float depth_m : picture.data[index(PictureLayer::Depth)]) EXPECT_NEAR(depth_m, 7.0f, 1e-4f);
    for (std::size_t i = 2; i < picture.data[index(PictureLayer::Position)].size(); i += 3)
        EXPECT_NEAR(picture.data[index(PictureLayer::Position)][i], -10.0f, 1e-4f);
    scene.sea.depth_m = 3.0;
    const std::string why = why_refused(scene, 1);
    EXPECT_TRUE(why.starts_with("camera.position_m: at frame 1 the camera is in the sea's floor")) << why;
    EXPECT_NE(why.find("sea.depth_m"), std::string::npos) << why;
}

// Not a shot among Pelagic's own would pay for it.
TEST(UnderWater, AnUsualShotIsAboveEveryCrest) {
    const Scene scene;
    const auto prepared = prepare(scene);
    EXPECT_FALSE(is_among_waves(view_at(scene.camera, 1), projected_grid_options(*prepared)));
}

}  // namespace
}  // namespace pelagic
