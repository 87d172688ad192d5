// The metered exposure, by the pictures that it gives.
#include "plugin/light/exposure.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/lighting/tone.h"
#include "plugin/light/light.h"
#include "plugin/render/render.h"

namespace pelagic {
namespace {

struct Case {
    double elevation_deg, turbidity;
};

Scene scene_in(Case light) {
    Scene scene;
    scene.light.sun_elevation_deg = light.elevation_deg;
    scene.light.turbidity = light.turbidity;
    scene.camera.resolution = {64, 36};
    scene.quality.level = QualityLevel::Draft;
    return scene;
}

// The first frame's pixels as they are shown.
std::vector<glm::vec3> displayed(const Scene& scene) {
    Renderer renderer(scene, render_options(scene), make_sky(scene), std::vector<int>{1});
    Picture picture;
    renderer.render(1, picture);
    const float exposure = shot_exposure(scene, renderer.sky());
    std::vector<glm::vec3> colours;
    for (const SeaRadiance& pixel : picture.layers)
        colours.push_back(display_colour(radiance_of(pixel), exposure));
    return colours;
}

// Deep dusk, the last light, a hazy low sun, the empty shot and noon: none is black, none is white. Before, with the
// exposure of the sky's irradiance alone: 0.01 at −4° in haze, 0.11 at 2°, 0.93 for the empty shot.
TEST(Exposure, NoLightGivesABlackOrAWhitePicture) {
    for (const Case light :
         {Case{-4, 2}, Case{-4, 8}, Case{-1, 2}, Case{0.2, 8}, Case{2, 8}, Case{20, 3}, Case{60, 2}}) {
        const std::vector<glm::vec3> colours = displayed(scene_in(light));
        double sum = 0.0;
        int white = 0;
        for (const glm::vec3 shown : colours) {
            sum += static_cast<double>(std::max({shown.x, shown.y, shown.z}));
            white += std::min({shown.x, shown.y, shown.z}) > 0.97f;
        }
        const auto pixels = static_cast<double>(colours.size());
        const std::string which = std::to_string(light.elevation_deg) + " " + std::to_string(light.turbidity);
        EXPECT_GT(sum / pixels, 0.25) << which;
        EXPECT_LT(sum / pixels, 0.80) << which;
        EXPECT_LT(white / pixels, 0.15) << which;
    }
}

// The mean display value from high up, of the pixels that aren't black, as space is.
double shown_from(double height_m, Case light, bool down) {
    Scene scene = scene_in(light);
    scene.camera.position_m = {0.0, 0.0, height_m};
    scene.camera.look_at_m = {0.0, height_m, down ? 0.0 : 0.9 * height_m};
    double sum = 0.0;
    int shown = 0;
    for (const glm::vec3 colour : displayed(scene)) {
        const auto value = static_cast<double>(std::max({colour.x, colour.y, colour.z}));
        sum += value;
        shown += value > 0.02;
    }
    return sum / shown;
}

// The air before the sea and the earth's curve are in the meter: the haze seen from an aeroplane, and the earth beside
// black space. Before, a hazy low sun was burnt out: 0.97 from 8 km, 0.99 from 100 km.
TEST(Exposure, MetersAirAndTheRoundEarth) {
    for (const double height_m : {8e3, 100e3, 400e3})
        for (const bool down : {false, true}) {
            const double shown = shown_from(height_m, {5, 8}, down);
            EXPECT_GT(shown, 0.35) << height_m << ' ' << down;
            EXPECT_LT(shown, 0.8) << height_m << ' ' << down;
        }
}

// A shot has one exposure, whatever frames are asked for: that of its camera, or of all of its keys.
TEST(Exposure, BelongsToTheShot) {
    Scene scene = scene_in({10.0, 3.0});
    const Sky sky = make_sky(scene);
    const float still = shot_exposure(scene, sky);
    EXPECT_FLOAT_EQ(shot_exposure(scene, sky, 3.0), 8.0f * still);
    scene.shot.first_frame = 17;
    scene.shot.last_frame = 40;
    EXPECT_EQ(shot_exposure(scene, sky), still);

    const CameraKey into_the_sun{.frame = 1, .position_m = {0, -60, 4}, .look_at_m = {0, 0, 4}};
    const CameraKey away{.frame = 900, .position_m = {0, -60, 4}, .look_at_m = {0, -120, 4}};
    scene.camera.keys = {into_the_sun};
    const float towards = shot_exposure(scene, sky);
    scene.camera.keys = {away};
    const float from = shot_exposure(scene, sky);
    EXPECT_GT(from, 1.2f * towards);
    scene.camera.keys = {into_the_sun, away};
    EXPECT_GT(shot_exposure(scene, sky), towards);
    EXPECT_LT(shot_exposure(scene, sky), from);
    // A key a frame, as Blender exports them, costs no more than a few.
    scene.camera.keys.clear();
    for (int frame = 1; frame <= 1000; ++frame) {
        scene.camera.keys.push_back(away);
        scene.camera.keys.back().frame = frame;
    }
    EXPECT_EQ(metered_views(scene).size(), 16u);
    EXPECT_NEAR(shot_exposure(scene, sky) / from, 1.0, 1e-5);
}

// Stops count on top of the meter, and of a fixed exposure, which doesn't look at the scene.
TEST(Exposure, MayBeFixed) {
    Scene scene = scene_in({30.0, 3.0});
    const Sky sky = make_sky(scene);
    const float metered = shot_exposure(scene, sky);
    scene.camera.exposure_ev = -1.5;
    EXPECT_NEAR(shot_exposure(scene, sky) / metered, std::exp2(-1.5), 1e-6);
    scene.camera.ev100 = 14.0;
    EXPECT_NEAR(static_cast<double>(shot_exposure(scene, sky)) / exposure_of_ev100(15.5), 1.0, 1e-6);
    EXPECT_NEAR(shot_exposure(scene, make_sky(scene_in({-5.0, 3.0}))) / shot_exposure(scene, sky), 1.0, 1e-6);
}

// Seen from above a storm is dark water and white foam, which keeps its shades; without foam the water alone counts.
TEST(Exposure, DoesNotBurnFoam) {
    Scene scene = scene_in({50.0, 2.0});
    scene.sea.wind_speed_mps = 24.0;
    scene.camera.position_m = {0.0, 0.0, 300.0};
    scene.camera.look_at_m = {0.0, 100.0, 0.0};
    const Sky sky = make_sky(scene);
    const float foam = 0.55f / 3.14159f * (sky.sun_irradiance + sky.sky_irradiance).y;
    const float with = shot_exposure(scene, sky);
    scene.effects.whitecaps = false;
    EXPECT_GT(shot_exposure(scene, sky) * foam, 2.5f);
    EXPECT_LT(with * foam, 1.25f);
    EXPECT_GT(with * foam, 0.9f);
}

// Whichever way it looks: down, to the side, up. Deep blue has all of its light in one channel, which is a good deal brighter then than a sea's:
// 0.87 after the curve, where the light's mean is that of any picture.
TEST(Exposure, MetersWhatAnEyeInTheWaterSees) {
    for (const double z_m : {-3.0, -10.0, -25.0})
        for (const double up : {-2.0, 0.0, 2.0}) {
            Scene scene = scene_in({50.0, 3.0});
            scene.sea.wind_speed_mps = 5.0;
            scene.camera.position_m = {0.0, 0.0, z_m};
            scene.camera.look_at_m = {0.0, 1.0, z_m + up};
            double sum = 0.0;
            const std::vector<glm::vec3> colours = displayed(scene);
            for (const glm::vec3 shown : colours)
                sum += static_cast<double>(std::max({shown.x, shown.y, shown.z}));
            EXPECT_GT(sum / static_cast<double>(colours.size()), 0.25) << z_m << ' ' << up;
            EXPECT_LT(sum / static_cast<double>(colours.size()), 0.88) << z_m << ' ' << up;
        }
}

// Night, and a sky that is black or very bright: finite.
TEST(Exposure, IsFinite) {
    Scene scene = scene_in({-30.0, 3.0});
    const float night = shot_exposure(scene, make_sky(scene));
    EXPECT_TRUE(std::isfinite(night) && night > 0.0f);
    Sky bright = make_sky(scene_in({60.0, 3.0}));
    bright.sun_radiance *= 1e25f;
    EXPECT_GT(shot_exposure(scene, bright), 0.0f);
    scene.camera.look_at_m = {0.0, 1e3, 1e5};  // nothing but sky
    EXPECT_TRUE(std::isfinite(shot_exposure(scene, bright)));
}

}  // namespace
}  // namespace pelagic
