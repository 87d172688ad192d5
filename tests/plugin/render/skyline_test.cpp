// The skyline of pictures is the sea's own.
#include "tests/plugin/render/skyline.h"

#include <gtest/gtest.h>

#include "plugin/light/light.h"

namespace pelagic {
namespace {

// A gale and a fresh wind, from the height of somebody's eyes in a boat and on a deck. It was a straight line for all
// but the nearest crests: 26 % of the columns of the first were right.
TEST(Skyline, IsTheQuerys) {
    for (const auto& [wind_mps, eye_m, frame] :
         {std::tuple{20.0, 2.0, 9}, std::tuple{26.0, 4.0, 1}, std::tuple{14.0, 2.0, 1}}) {
        Scene scene;
        scene.sea.wind_speed_mps = wind_mps;
        scene.camera.position_m = {0.0, -60.0, eye_m};
        scene.camera.look_at_m = {0.0, 0.0, eye_m};
        scene.camera.resolution = {480, 120};
        scene.quality.level = QualityLevel::Draft;
        RenderOptions options = render_options(scene);
        options.samples = 1;
        options.lighting = {.sun = false, .sky = false, .water = false, .whitecaps = false};
        Renderer renderer(scene, options, daylight_sky({.sun_elevation_deg = 20.0}), std::span(&frame, 1));
        Picture picture;
        renderer.render(frame, picture);
        const std::vector<double> query = skyline_of_query(scene, frame);
        // Crests, of which the horizon would miss many.
        EXPECT_LE(agreement(query, std::vector<double>(query.size(), 60.0)), 0.9);
        EXPECT_GE(agreement(query, skyline_of(picture)), 0.95) << wind_mps << " m/s from " << eye_m << " m";
    }
}

}  // namespace
}  // namespace pelagic
