// Crests without rims: on a silhouette no pixel has a colour that its own surface hasn't beside it.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "core/surface/pixel_footprint.h"
#include "core/surface/view.h"
#include "plugin/light/light.h"
#include "plugin/render/render.h"
#include "tests/plugin/render/rims.h"

namespace pelagic {
namespace {

// A storm from a ship's bridge: crest behind crest, without the sun's glitter among them.
Scene storm() {
    Scene scene;
    scene.quality.level = QualityLevel::Draft;
    scene.sea.wind_speed_mps = 24.0;
    scene.sea.wind_direction_deg = 290.0;
    scene.sea.fetch_m = 400e3;
    scene.waves.choppiness = 1.15;
    scene.camera.position_m = {0.0, -170.0, 12.0};
    scene.camera.look_at_m = {0.0, 0.0, 3.0};
    scene.camera.fov_deg = 45.0;
    scene.camera.resolution = {320, 180};
    scene.light.sun_elevation_deg = 24.0;
    scene.light.sun_azimuth_deg = 35.0;
    return scene;
}

Picture rims_picture(const Scene& scene, const Sky& sky, int frame, int samples) {
    RenderOptions options = render_options(scene);
    options.samples = samples;
    options.layers = parse_picture_layers("depth");
    Renderer renderer(scene, options, sky, std::array{frame});
    Picture picture;
    renderer.render(frame, picture);
    return picture;
}

// No more than where many samples are averaged.
TEST(Rims, AreNoMoreThanInThePictureOfManySamples) {
    const Scene scene = storm();
    const Sky sky = make_sky(scene);
    const double height_m = scene.camera.position_m.z;
    const double tangent = view_at(scene.camera, 1).pixel_tangent();
    const Picture one = rims_picture(scene, sky, 13, 1), many = rims_picture(scene, sky, 13, 4);
    const std::vector<float>& depth_m = one.data[index(PictureLayer::Depth)];
    const Rims of_one = rims(one, depth_m, height_m, tangent),
               of_many = rims(many, depth_m, height_m, tangent);
    EXPECT_GT(of_one.silhouette, 1000);
    // Counts of so few differ by chance, as their root; and one in two thousand is chance.
    EXPECT_LE(of_one.outside,
              std::max(of_many.outside + 2.0 * std::sqrt(of_many.outside), of_one.silhouette / 2000.0))
        << "of " << of_one.silhouette;
    RecordProperty("one_sample", of_one.outside);
    RecordProperty("many_samples", of_many.outside);
    RecordProperty("silhouette", of_one.silhouette);
}

using RimFootprint = PixelFootprint<double>;

// Seen at an angle, a level sea gives back the ellipse that it has: 1/cos longer than wide, away from the eye.
TEST(Rims, FootprintOfALevelTriangleIsTheSeasAtRest) {
    // A camera that looks along +y and down by this angle, and the pixel in its middle.
    const double down = 0.3, sine = std::sin(down), cosine = std::cos(down);
    const RimFootprint at_rest{.width = 2.0, .axis_x = 0.0, .axis_y = 2.0 / sine};
    // 1/w on a level sea is in proportion to the ray's depth below the eye, sin(down) − cos(down)·up.
    const RimFootprint level =
        footprint_on_mesh(at_rest, 1.0, 0.0, 0.0, sine, 0.0, cosine, 0.0, -cosine / sine);
    EXPECT_NEAR(level.width, at_rest.width, 1e-12);
    EXPECT_NEAR(level.axis_x, 0.0, 1e-12);
    EXPECT_NEAR(std::abs(level.axis_y), at_rest.axis_y, 1e-12);
    // A slope that faces the eye is shown finer, one that turns away coarser, and none without end.
    for (const double slope : {-0.2, -0.1, 0.1, 0.5}) {
        const double nearer = -(cosine - slope * sine) / (sine + slope * cosine);
        const RimFootprint tilted = footprint_on_mesh(at_rest, 1.0, 0.0, 0.0, sine, 0.0, cosine, 0.0, nearer);
        EXPECT_NEAR(std::abs(tilted.axis_y), 2.0 / (sine + slope * cosine), 1e-9) << slope;
        EXPECT_NEAR(tilted.width, 2.0, 1e-9) << slope;
    }
    for (const double edge : {1e3, -1e9, std::numeric_limits<double>::infinity()}) {
        const RimFootprint tilted = footprint_on_mesh(at_rest, 1.0, 0.0, 0.0, sine, 0.0, cosine, 0.0, edge);
        EXPECT_NEAR(std::hypot(tilted.axis_x, tilted.axis_y), 4.0 * at_rest.axis_y, 1e-9);
    }
}

// The ellipse of two sides has their area, whichever way they are turned.
TEST(Rims, EllipseHasTheArea) {
    for (double turn = 0.0; turn < 6.3; turn += 0.37) {
        const double c = std::cos(turn), s = std::sin(turn);
        const RimFootprint ellipse = pixel_footprint(3.0 * c, 3.0 * s, 2.0 * c - s, 2.0 * s + c, 100.0);
        EXPECT_NEAR(ellipse.width * std::hypot(ellipse.axis_x, ellipse.axis_y), 3.0, 1e-12) << turn;
    }
    const RimFootprint round = pixel_footprint(0.0, 2.0, -2.0, 0.0, 100.0);
    EXPECT_NEAR(round.width, 2.0, 1e-12);
    EXPECT_NEAR(std::hypot(round.axis_x, round.axis_y), 2.0, 1e-12);
}

}  // namespace
}  // namespace pelagic
