// What a picture holds for compositors: layers, alpha, motion vectors, and the shutter.
#include "plugin/render/layers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/base/constants.h"
#include "core/evaluate/values.h"
#include "core/surface/view.h"
#include "plugin/render/motion.h"
#include "plugin/render/passes.h"
#include "plugin/render/render.h"
#include "tests/plugin/render/uniform_sky.h"

namespace pelagic {
namespace {

// A camera that travels and turns, over waves.
Scene moving_scene() {
    Scene scene;
    scene.quality.level = QualityLevel::Draft;
    scene.waves.cascades = {{250.0, 64}, {30.0, 64}};
    scene.camera.resolution = {96, 60};
    scene.camera.keys = {{.frame = 1, .position_m = {0.0, -60.0, 12.0}, .look_at_m = {0.0, 0.0, 4.0}},
                         {.frame = 9, .position_m = {8.0, -56.0, 13.0}, .look_at_m = {20.0, 0.0, 2.0}}};
    return scene;
}

Picture layers_of(const Scene& scene, const RenderOptions& options, int frame = 5) {
    Renderer renderer(scene, options, uniform_sky(), std::array{frame});
    Picture picture;
    renderer.render(frame, picture);
    return picture;
}

RenderOptions with_all(const Scene& scene) {
    RenderOptions options = render_options(scene);
    options.layers.set();
    return options;
}

glm::dvec3 vector_of(const std::vector<float>& values, std::size_t pixel) {
    return {values[3 * pixel], values[3 * pixel + 1], values[3 * pixel + 2]};
}

// The middle of a pixel of the moving scene's pictures, or another place in it.
glm::dvec2 place_in(std::size_t pixel, glm::dvec2 offset = glm::dvec2(0.5)) {
    return glm::dvec2(static_cast<int>(pixel % 96), static_cast<int>(pixel / 96)) + offset;
}

// Where a view shows a point [px], y down.
glm::dvec2 seen_at(const View& view, glm::dvec3 point_m) {
    const glm::dvec3 way = point_m - view.position_m;
    const double depth = glm::dot(way, view.forward) * view.pixel_tangent();
    return 0.5 * glm::dvec2(view.resolution) +
           glm::dvec2(glm::dot(way, view.right), -glm::dot(way, view.up)) / depth;
}

TEST(PictureLayers, EachIsAskedForByItsName) {
    PictureLayerSet all;
    for (const PictureLayerRow& row : kPictureLayers) {
        const PictureLayerSet one = parse_picture_layers(std::string(row.name));
        EXPECT_EQ(one.count(), 1u) << row.name;
        EXPECT_TRUE(one[index(row.layer)]) << row.name;
        all |= one;
        for (std::size_t c = 0; c < row.channels.size(); ++c)
            EXPECT_EQ(row.channels[c] != nullptr, c < row.components) << row.name;
    }
    EXPECT_EQ(parse_picture_layers("all"), all);
    EXPECT_TRUE(parse_picture_layers("none").none());
    EXPECT_EQ(parse_picture_layers("sun,sky,sea,foam,air,object,reflection"), light_layers());
    for (const char* wrong : {"", "Depth", "depth,", "depth,,sun", "all,depth", "z"})
        EXPECT_THROW(parse_picture_layers(wrong), std::invalid_argument) << wrong;
}

// The light is the same whatever else is asked for, and what nobody asks for isn't there.
TEST(PictureLayers, ChangeNoLight) {
    const Scene scene = moving_scene();
    const Picture plain = layers_of(scene, render_options(scene)), full = layers_of(scene, with_all(scene));
    ASSERT_EQ(plain.layers.size(), full.layers.size());
    EXPECT_EQ(std::memcmp(plain.layers.data(), full.layers.data(), plain.layers.size() * sizeof(SeaRadiance)),
              0);
    EXPECT_TRUE(plain.alpha.empty());
    for (const PictureLayerRow& row : kPictureLayers) {
        EXPECT_TRUE(plain.data[index(row.layer)].empty()) << row.name;
        const std::size_t values = row.light || row.of_objects ? 0 : row.components * full.layers.size();
        ASSERT_EQ(full.data[index(row.layer)].size(), values) << row.name;
        for (const float value : full.data[index(row.layer)]) ASSERT_TRUE(std::isfinite(value)) << row.name;
    }
}

// The position is what the sample in the pixel's middle shows, and the depth its distance along the axis.
TEST(PictureLayers, PositionAndDepthAreWhatThePixelShows) {
    for (const int samples : {1, 2, 3}) {
        const Scene scene = moving_scene();
        RenderOptions options = with_all(scene);
        options.samples = samples;
        const Picture picture = layers_of(scene, options);
        const View view = view_at(scene.camera, 5);
        const auto& data = picture.data;
        const glm::ivec2 cell(samples / 2);
        const glm::dvec2 offset = (glm::dvec2(cell) + 0.5 + place_in_cell(samples, cell)) /
                                  static_cast<double>(samples);  // of the sample in its pixel
        int sea = 0;
        for (std::size_t i = 0; i < picture.layers.size(); ++i) {
            const glm::dvec3 position = vector_of(data[index(PictureLayer::Position)], i);
            const glm::dvec3 normal = vector_of(data[index(PictureLayer::Normal)], i);
            const double depth = data[index(PictureLayer::Depth)][i];
            if (!picture.sea[i]) {
                ASSERT_EQ(depth, 1e10);
                ASSERT_EQ(position, glm::dvec3(0.0));
                ASSERT_EQ(normal, glm::dvec3(0.0));
                continue;
            }
            ++sea;
            const glm::dvec2 pixel = place_in(i, offset);
            ASSERT_LT(glm::length(seen_at(view, position) - pixel), 0.01) << i;
            ASSERT_NEAR(depth, glm::dot(view.forward, position - view.position_m), 1e-5 * depth) << i;
            ASSERT_NEAR(glm::length(normal), 1.0, 1e-5);
            const float coverage = data[index(PictureLayer::Coverage)][i];
            ASSERT_TRUE(coverage >= 0.0f && coverage <= 1.0f);
            ASSERT_GT(data[index(PictureLayer::SlopeVariance)][3 * i], 0.0f);
        }
        EXPECT_GT(sea, 2000);
    }
}

// A sea that stands still under a moving camera: the vectors lead to where the camera's own view of the next frame
// and of the one before has the point; in the sky, the direction. Blender's have the same two, by its own signs.
TEST(PictureLayers, MotionIsTheCameras) {
    Scene scene = moving_scene();
    scene.shot.time_scale = 1e-9;
    const Picture picture = layers_of(scene, with_all(scene));
    const View now = view_at(scene.camera, 5), next = view_at(scene.camera, 6),
               before = view_at(scene.camera, 4);
    const std::vector<float>&motion = picture.data[index(PictureLayer::Motion)],
          &blender = picture.data[index(PictureLayer::Vector)];
    double longest = 0.0;
    for (std::size_t i = 0; i < picture.layers.size(); ++i) {
        const glm::dvec2 pixel = place_in(i);
        const glm::dvec3 position = picture.sea[i] ? vector_of(picture.data[index(PictureLayer::Position)], i)
                                                   : now.position_m + 1e9 * now.direction(pixel);
        const glm::dvec2 forward = seen_at(next, position) - seen_at(now, position),
                         backward = seen_at(before, position) - seen_at(now, position);
        const float* m = &motion[4 * i];
        const float* b = &blender[4 * i];
        // Positions are rounded to single precision: a thousandth of a pixel near the camera.
        ASSERT_NEAR(m[0], forward.x, 2e-3) << i;
        ASSERT_NEAR(m[1], -forward.y, 2e-3) << i;
        ASSERT_NEAR(m[2], backward.x, 2e-3) << i;
        ASSERT_NEAR(m[3], -backward.y, 2e-3) << i;
        for (int c = 0; c < 2; ++c) {
            ASSERT_EQ(b[c], m[2 + c]);
            ASSERT_EQ(b[2 + c], -m[c]);
        }
        longest = std::max(longest, glm::length(forward));
    }
    EXPECT_GT(longest, 3.0);
}

// A moving sea: the vectors lead to the same water's place in the frames before and after, as the query has it
// then. 0.02 px are what the way bends in a frame.
TEST(PictureLayers, MotionIsTheWaters) {
    Scene scene = moving_scene();
    scene.shot.time_scale = 2.0;
    constexpr int kFrame = 5;
    RenderOptions options;
    options.layers.set();
    Frame<float> frame(std::make_shared<const Sea<float>>(picture_plan(scene, std::array{kFrame}, options)));
    std::vector<glm::vec2> rest;
    for (int i = 0; i < 200; ++i) rest.emplace_back(-20.0 + 0.2 * i, -30.0 + 0.37 * (i * 37 % 200));
    const std::vector<float> cell_m(rest.size(), 1.0f);
    const auto at = [&](int number) {
        frame.set(scene.shot.time_s(number));
        Values values;
        QueryRunner<float>().run(frame, 0,
                                 {.count = rest.size(), .rest_m = {rest.data()}, .cell_m = {cell_m.data()}},
                                 products(Product::Position, Product::Velocity), values);
        return values;
    };
    const Values now = at(kFrame), next = at(kFrame + 1), before = at(kFrame - 1);
    const Motion motion(scene, kFrame, glm::dvec3(0.0));
    const auto place = [&](const Values& values, int number, std::size_t i) {
        return seen_at(view_at(scene.camera, number), glm::dvec3(values.vectors(Product::Position)[i]));
    };
    double moved = 0.0;
    for (std::size_t i = 0; i < rest.size(); ++i) {
        const glm::dvec3 position(now.vectors(Product::Position)[i]);
        const glm::dvec4 way = motion.of({position, 1.0}, glm::dvec3(now.vectors(Product::Velocity)[i]));
        const glm::dvec2 here = place(now, kFrame, i);
        const glm::dvec2 forward = place(next, kFrame + 1, i) - here,
                         backward = place(before, kFrame - 1, i) - here;
        // Half the acceleration times the frame's time squared: half a per cent of ways of up to 6 pixels.
        EXPECT_NEAR(way.x, forward.x, 0.03);
        EXPECT_NEAR(way.y, -forward.y, 0.03);
        EXPECT_NEAR(way.z, backward.x, 0.03);
        EXPECT_NEAR(way.w, -backward.y, 0.03);
        const glm::dvec4 still = motion.of({position, 1.0}, glm::dvec3(0.0));
        moved = std::max(moved, glm::length(glm::dvec2(way - still)));
    }
    EXPECT_GT(moved, 0.2);  // by the waves
}

// What lies behind the camera in a neighbouring frame has no vector.
TEST(PictureLayers, MotionIsFinite) {
    const Scene scene = moving_scene();
    const Motion motion(scene, 5, glm::dvec3(0.0));
    for (const glm::dvec3 point :
         {glm::dvec3(0.0, -1e3, 0.0), view_at(scene.camera, 6).position_m, glm::dvec3(1e9, -58.0, 0.0)})
        for (int c = 0; c < 4; ++c) {
            const double component = motion.of({point, 1.0}, glm::dvec3(100.0))[c];
            EXPECT_TRUE(std::isfinite(component) && std::abs(component) <= 1e6);
        }
    EXPECT_EQ(motion.of({0.0, -1e3, 0.0, 1.0}, glm::dvec3(0.0)), glm::dvec4(0.0));
}

// Over the same sky, a picture with alpha is the picture.
TEST(PictureLayers, AlphaIsTheSeasShare) {
    for (const double shutter : {0.0, 0.5}) {
        const Scene scene = moving_scene();
        RenderOptions options = render_options(scene);
        options.samples = 3;
        options.shutter_frames = shutter;
        const Picture opaque = layers_of(scene, options);
        options.alpha = true;
        const Picture clear = layers_of(scene, options);
        ASSERT_EQ(clear.alpha.size(), opaque.layers.size());
        int edges = 0;
        for (std::size_t i = 0; i < clear.alpha.size(); ++i) {
            const float alpha = clear.alpha[i];
            edges += alpha > 0.0f && alpha < 1.0f;
            const glm::vec3 over = radiance_of(clear.layers[i]) + (1.0f - alpha) * kSkyRadiance;
            for (int c = 0; c < 3; ++c) ASSERT_NEAR(over[c], radiance_of(opaque.layers[i])[c], 1e-5f) << i;
            if (alpha == 0.0f) {
                ASSERT_EQ(radiance_of(clear.layers[i]), glm::vec3(0.0f));
            }
        }
        EXPECT_GT(edges, 30);
    }
}

constexpr int kShutterSamples = 6;

// The mean of many pictures while the shutter is open, of the same shot with more frames a second.
Picture accumulated(const Scene& scene, int frame, double shutter_frames) {
    constexpr int kParts = 32;  // of a frame
    Scene fast = scene;
    fast.shot.fps *= kParts;
    for (CameraKey& key : fast.camera.keys) key.frame = (key.frame - 1) * kParts + 1;
    RenderOptions options = render_options(scene);
    options.samples = kShutterSamples;
    const int half = static_cast<int>(std::lround(0.5 * shutter_frames * kParts));
    std::vector<int> frames;
    for (int i = -half; i < half; ++i) frames.push_back((frame - 1) * kParts + 1 + i);
    Renderer renderer(fast, options, uniform_sky(), frames);
    Picture sum, one;
    for (const int at : frames) {
        renderer.render(at, one);
        if (sum.layers.empty()) {
            sum = one;
            for (SeaRadiance& pixel : sum.layers) pixel = {};
        }
        const float share = 1.0f / static_cast<float>(frames.size());
        for (std::size_t i = 0; i < one.layers.size(); ++i) {
            sum.layers[i].sky += share * one.layers[i].sky;
            sum.layers[i].sea += share * one.layers[i].sea;
            sum.layers[i].foam += share * one.layers[i].foam;
        }
    }
    return sum;
}

double difference(const Picture& a, const Picture& b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < a.layers.size(); ++i) {
        const glm::dvec3 apart(radiance_of(a.layers[i]) - radiance_of(b.layers[i]));
        sum += glm::dot(apart, apart);
    }
    return std::sqrt(sum / (3.0 * static_cast<double>(a.layers.size())));
}

// An open shutter shows the mean of what passes, and what isn't light is that of the frame's own time: the same but
// for pixels whose middle lies on a triangle's rounded edge.
TEST(PictureLayers, ShutterAccumulates) {
    Scene scene = moving_scene();
    scene.camera.resolution = {48, 30};
    // No horizon, where a sample more or less is much light.
    for (CameraKey& key : scene.camera.keys) key.look_at_m.z -= 40.0;
    const Picture mean = accumulated(scene, 5, 0.5);
    RenderOptions options = with_all(scene);
    options.samples = kShutterSamples;
    const Picture sharp = layers_of(scene, options);
    options.shutter_frames = 0.5;
    const Picture blurred = layers_of(scene, options);
    // Each sample is of one moment: what is left is the noise of 36 sharp ones.
    EXPECT_LT(difference(blurred, mean), 0.5 * difference(sharp, mean))
        << difference(blurred, mean) << " against " << difference(sharp, mean);
    const std::vector<float>&depth = blurred.data[index(PictureLayer::Depth)],
          &sharp_depth = sharp.data[index(PictureLayer::Depth)];
    int differ = 0;
    for (std::size_t i = 0; i < depth.size(); ++i)
        differ += std::abs(depth[i] / sharp_depth[i] - 1.0f) > 1e-4f;
    EXPECT_LT(differ, 15);
}

// A shutter of no length and a still world are no blur; out of its range it is refused.
TEST(PictureLayers, ShutterOfAStillWorldIsSharp) {
    Scene scene = moving_scene();
    scene.camera.keys.resize(1);
    scene.shot.time_scale = 1e-9;
    RenderOptions options = render_options(scene);
    options.samples = 2;
    const Picture sharp = layers_of(scene, options);
    options.shutter_frames = 1.0;
    EXPECT_LT(difference(layers_of(scene, options), sharp), 1e-3 * kSkyRadiance);
    for (const double wrong : {-0.5, 4.5, std::nan("")}) {
        options.shutter_frames = wrong;
        EXPECT_THROW(check_render(scene, options), std::invalid_argument);
    }
}

}  // namespace
}  // namespace pelagic
