// Foam that lives, in pictures.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <vector>

#include "core/scene/editions.h"
#include "plugin/render/render.h"
#include "tests/plugin/render/uniform_sky.h"

namespace pelagic {
namespace {

// Of the first edition, with more foam.
Scene scene_of(double decay_s) {
    Scene scene = scene_of_edition(1);
    scene.quality.level = QualityLevel::Draft;
    scene.sea.wind_speed_mps = 16.0;
    scene.effects.foam_decay_s = decay_s;
    scene.camera.resolution = {96, 60};
    scene.camera.position_m = {0.0, -60.0, 15.0};
    return scene;
}

RenderOptions options_of(const Scene& scene) {
    RenderOptions options = render_options(scene);
    for (const PictureLayer layer : {PictureLayer::Coverage, PictureLayer::Breaking, PictureLayer::FoamAge})
        options.layers.set(index(layer));
    return options;
}

const std::vector<float>& layer(const Picture& picture, PictureLayer of) {
    return picture.data[index(of)];
}

TEST(FoamInPictures, OfAFrameAloneIsThatOfARunOnAnyNumberOfThreads) {
    const Scene scene = scene_of(2.0);
    const std::array frames{1, 2, 3, 9};
    Renderer run(scene, options_of(scene), uniform_sky(), frames);
    Picture picture, alone;
    for (const int frame : frames) run.render(frame, picture);
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    Renderer single(scene, options_of(scene), uniform_sky(), frames);
    single.render(9, alone);
    for (const PictureLayer of : {PictureLayer::Coverage, PictureLayer::Breaking, PictureLayer::FoamAge})
        EXPECT_EQ(layer(picture, of), layer(alone, of));
    for (std::size_t i = 0; i < picture.layers.size(); ++i)
        EXPECT_EQ(radiance_of(picture.layers[i]), radiance_of(alone.layers[i]));
}

TEST(FoamInPictures, IsAllOfTheLawsThatBreaksOrIsLeft) {
    double total = 0.0, active = 0.0, age_s = 0.0, plain = 0.0;
    for (const double decay_s : {0.0, 2.0}) {
        const Scene scene = scene_of(decay_s);
        Renderer renderer(scene, options_of(scene), uniform_sky(), std::array{4});
        Picture picture;
        renderer.render(4, picture);
        const std::vector<float>&now = layer(picture, PictureLayer::Breaking),
              &all = layer(picture, PictureLayer::Coverage), &age = layer(picture, PictureLayer::FoamAge);
        for (std::size_t i = 0; i < all.size(); ++i) {
            if (decay_s == 0.0) {
                EXPECT_EQ(now[i], all[i]);
                EXPECT_EQ(age[i], 0.0f);
                plain += all[i];
            } else {
                EXPECT_LE(now[i], all[i]);
                total += all[i];
                active += now[i];
                age_s += double(age[i]) * all[i];
            }
        }
    }
    EXPECT_GT(active, 0.0);
    EXPECT_LT(active, 0.5 * total);
    EXPECT_GT(age_s / total, 0.5);
    EXPECT_LT(age_s / total, 2.0);
    EXPECT_NEAR(total / plain, 1.0, 0.35);  // one frame of a small piece of the sea
}

// A shutter that is open for seconds of the sea goes through foam's past once, not once for each sample: a long past tells
// how far it is, beside the rows of each sample.
TEST(FoamInPictures, OfATimeLapseGoesThroughItsPastOnce) {
    Scene scene = scene_of(2.0);
    scene.camera.resolution = {32, 20};
    RenderOptions options = options_of(scene);
    options.samples = 4;
    options.shutter_frames = 1.0;
    const auto told_of = [&](double time_scale) {
        scene.shot.time_scale = time_scale;
        Renderer renderer(scene, options, uniform_sky(), std::array{4});
        Picture picture;
        std::vector<double> told;
        renderer.render(4, picture, {.progress = [&](double done) { told.push_back(done); }});
        EXPECT_TRUE(std::is_sorted(told.begin(), told.end()));
        return told.size();
    };
    const std::size_t brief = told_of(1.0), lapse = told_of(72.0);
    // In seconds the foam drifts far enough to meet new water, a time or two; a past for each sample would be thousands of steps.
    EXPECT_LT(lapse, brief + brief / 3) << brief;
}

// What each sample of a picture reads is asked for before, so that pictures of a run take a few steps each: a long past would tell how
// far it is, beside the batches of rows.
TEST(FoamInPictures, OfARunGoesOnFromThePictureBefore) {
    Scene scene = scene_of(2.0);
    scene.camera.resolution = {96, 54};
    Renderer renderer(scene, options_of(scene), uniform_sky(), std::array{1, 2, 3, 4});
    Picture picture;
    const auto told_of = [&](int frame) {
        int told = 0;
        renderer.render(frame, picture, {.progress = [&](double) { ++told; }});
        return told;
    };
    EXPECT_GT(told_of(1), 10);
    for (const int frame : {2, 3, 4}) EXPECT_EQ(told_of(frame), 1) << frame;
}

// A camera that flies on meets new water at each frame, and goes through its past at few of them, for some of the water ahead as
// well.
TEST(FoamInPictures, OfAFlightGoesThroughThePastOfNewWaterAFewTimes) {
    Scene scene = scene_of(2.0);
    scene.shot.last_frame = 40;
    scene.camera.resolution = {96, 54};
    const glm::dvec3 from = scene.camera.position_m, at = scene.camera.look_at_m, way(0.0, 12.0, 0.0);
    scene.camera.keys = {{.frame = 1, .position_m = from, .look_at_m = at, .fov_deg = {}},
                         {.frame = 40, .position_m = from + way, .look_at_m = at + way, .fov_deg = {}}};
    std::vector<int> frames(40);
    std::iota(frames.begin(), frames.end(), 1);
    Renderer renderer(scene, options_of(scene), uniform_sky(), frames);
    Picture picture;
    int with_past = 0;
    for (const int frame : frames) {
        int told = 0;
        renderer.render(frame, picture, {.progress = [&](double) { ++told; }});
        with_past += told > 1;
    }
    RecordProperty("frames that went through a past", with_past);
    EXPECT_GT(with_past, 1);
    EXPECT_LT(with_past, 14);
    Renderer single(scene, options_of(scene), uniform_sky(), frames);
    Picture alone;
    single.render(40, alone);
    EXPECT_EQ(layer(picture, PictureLayer::Coverage), layer(alone, PictureLayer::Coverage));
    EXPECT_EQ(layer(picture, PictureLayer::FoamAge), layer(alone, PictureLayer::FoamAge));
}

}  // namespace
}  // namespace pelagic
