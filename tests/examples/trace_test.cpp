// Pictures by rays: where rays only decide what hides what they are those of `pelagic render`; a boat keeps the water out.
#include <gtest/gtest.h>
#include <oneapi/tbb/task_arena.h>

#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>

#include "examples/trace/tracer.h"
#include "plugin/format/shot/shot.h"
#include "plugin/light/light.h"
#include "tests/examples/compare.h"

namespace pelagic {
namespace {

const std::string kRoot = PELAGIC_SOURCE_DIR;

// The first shot, small, and with foam that doesn't live, which would take most of the time.
Scene small_scene() {
    Scene scene = load_shot(kRoot + "/examples/first-shot.toml", check_scene);
    scene.camera.resolution = {160, 90};
    scene.effects.foam_decay_s = 0.0;
    return scene;
}
constexpr trace::Placement kByCamera{.at_m = {-17.0, -66.0}, .heading_rad = 2.6};

RenderOptions options_of(const Scene& scene) {
    RenderOptions options = render_options(scene);
    options.samples = 2;
    return options;
}

trace::TracedPicture traced(const Scene& scene, bool mirrors, const trace::FloatingObject* object) {
    const trace::TraceOptions options{
        .picture = options_of(scene), .traced = mirrors, .object = object, .placement = kByCamera};
    return trace::Tracer(scene, options, make_sky(scene), 1).render();
}

trace::FloatingObject boat() {
    return trace::read_obj(kRoot + "/examples/trace/boat.obj");
}

std::size_t count_of(const std::vector<std::uint8_t>& marks) {
    return static_cast<std::size_t>(std::count(marks.begin(), marks.end(), 1));
}

TEST(Trace, RaysThatDecideWhatHidesWhatGiveTheRenderedPicture) {
    Scene scene = small_scene();
    scene.surface.cell_px = 1.0;  // of the mesh: rays have the surface itself
    Picture rendered;
    Renderer(scene, options_of(scene), make_sky(scene), std::array{1}).render(1, rendered);
    const trace::TracedPicture by_rays = traced(scene, false, nullptr);
    ASSERT_EQ(by_rays.picture.layers.size(), rendered.layers.size());
    const auto all = test::differences(by_rays.picture, rendered, [](std::size_t) { return true; });
    EXPECT_LE(test::at_share(all, 0.5),
              0.03f);  // the picture's samples stand elsewhere in a pixel than rays: 0.025
    const auto is_sea = [&](std::size_t i) { return rendered.sea[i] && by_rays.picture.sea[i]; };
    double sum = 0.0, sum_rendered = 0.0;
    for (std::size_t i = 0; i < rendered.layers.size(); ++i)
        if (is_sea(i)) {
            sum += test::luminance_of(by_rays.picture.layers[i]);
            sum_rendered += test::luminance_of(rendered.layers[i]);
        }
    EXPECT_NEAR(sum / sum_rendered, 1.0, 0.04);
    EXPECT_EQ(count_of(by_rays.object), 0u);
    std::size_t other = 0;
    for (std::size_t i = 0; i < rendered.sea.size(); ++i) other += rendered.sea[i] != by_rays.picture.sea[i];
    EXPECT_LE(other, 160u);  // the skyline, by a pixel
}

// Rays end elsewhere than on the mesh by less than a pixel: the spray before both is the same.
TEST(Trace, RaysGoThroughTheRenderedPicturesSpray) {
    Scene scene = small_scene();
    scene.sea.wind_speed_mps = 22.0;
    scene.effects.spray = true;
    scene.effects.spray_gain = 30.0;
    scene.camera.position_m.z = 14.0;
    scene.surface.cell_px = 1.0;
    Picture rendered;
    Renderer(scene, options_of(scene), make_sky(scene), std::array{1}).render(1, rendered);
    const trace::FloatingObject object = boat();
    const trace::TracedPicture by_rays = traced(scene, false, &object),
                               mirrored = traced(scene, true, &object);
    double sum = 0.0, expected = 0.0;
    std::vector<float> off;
    for (std::size_t i = 0; i < rendered.layers.size(); ++i) {
        if (by_rays.object[i]) continue;
        const float of = rendered.layers[i].air.y;
        sum += static_cast<double>(by_rays.picture.layers[i].air.y);
        expected += static_cast<double>(of);
        off.push_back(std::abs(by_rays.picture.layers[i].air.y - of) / std::max(of, 1e-3f));
        ASSERT_EQ(mirrored.picture.layers[i].air, by_rays.picture.layers[i].air);
    }
    std::sort(off.begin(), off.end());
    EXPECT_NEAR(sum / expected, 1.0, 0.01);
    EXPECT_LE(test::at_share(off, 0.5), 2e-3f);
    scene.effects.spray = false;
    Picture clear;
    Renderer(scene, options_of(scene), make_sky(scene), std::array{1}).render(1, clear);
    double without = 0.0;
    for (const SeaRadiance& light : clear.layers) without += static_cast<double>(light.air.y);
    EXPECT_GT(expected, 1.5 * without);
}

TEST(Trace, NoWaterIsSeenInAHull) {
    Scene scene = small_scene();
    scene.camera.position_m = glm::dvec3(kByCamera.at_m - glm::dvec2(0.0, 8.0), 10.0);  // looks into it
    scene.camera.look_at_m = glm::dvec3(kByCamera.at_m, 0.0);
    trace::FloatingObject object = boat();
    ASSERT_FALSE(object.dry.triangles.empty());
    const std::size_t dry = count_of(traced(scene, false, &object).object);
    object.dry.triangles.clear();
    const std::size_t flooded = count_of(traced(scene, false, &object).object);
    EXPECT_GT(flooded, 100u);
    EXPECT_GT(dry, flooded + flooded / 10);
}

TEST(Trace, WhatIsMirroredDependsOnNoThreads) {
    const Scene scene = small_scene();
    const trace::FloatingObject object = boat();
    trace::TracedPicture all, alone;
    all = traced(scene, true, &object);
    tbb::task_arena(1).execute([&] { alone = traced(scene, true, &object); });
    EXPECT_EQ(std::memcmp(all.picture.layers.data(), alone.picture.layers.data(),
                          all.picture.layers.size() * sizeof(SeaRadiance)),
              0);
    // The boat shadows and mirrors in the water beside it.
    const trace::TracedPicture visible = traced(scene, false, &object);
    const auto beside = [&](std::size_t i) {
        return visible.picture.sea[i] && !visible.object[i] &&
               !test::is_away_from(visible.object, visible.picture.resolution, i, 4);
    };
    const auto far = [&](std::size_t i) {
        return visible.picture.sea[i] &&
               test::is_away_from(visible.object, visible.picture.resolution, i, 20);
    };
    const float near_boat = test::at_share(test::differences(all.picture, visible.picture, beside), 0.8),
                elsewhere = test::at_share(test::differences(all.picture, visible.picture, far), 0.8);
    EXPECT_GT(near_boat, 0.05f);
    EXPECT_GT(near_boat, 2.0f * elsewhere);
    for (const SeaRadiance& light : all.picture.layers) EXPECT_TRUE(std::isfinite(test::luminance_of(light)));
}

// Without width it floats as well, and what it hides of the water's light is no more than there is.
TEST(Trace, ABlackBoardFloatsAndTakesNoMoreLightThanThereIs) {
    trace::FloatingObject board;
    for (const float z : {-3.0f, 3.0f})
        for (const float y : {-6.0f, 6.0f}) board.shown.points.emplace_back(0.0f, y, z);
    board.shown.colours.assign(4, glm::vec3(0.0f));
    board.shown.triangles = {{0, 1, 3}, {0, 3, 2}};
    const trace::TracedPicture all = traced(small_scene(), true, &board);
    EXPECT_GT(count_of(all.object), 20u);
    for (const SeaRadiance& light : all.picture.layers) {
        const glm::vec3 sum = radiance_of(light);
        ASSERT_GE(std::min({sum.x, sum.y, sum.z}), -1e-6f * (1.0f + sum.z));
    }
}

TEST(Trace, RefusesWhatItCannotTrace) {
    Scene scene = small_scene();
    scene.quality.level = QualityLevel::Reference;
    EXPECT_THROW(traced(scene, false, nullptr), std::invalid_argument);
    scene = small_scene();
    scene.camera.position_m.z = -30.0;
    EXPECT_THROW(traced(scene, false, nullptr), std::invalid_argument);
}

TEST(Trace, AnObjThatCannotBeReadSaysWhere) {
    const auto file = std::filesystem::temp_directory_path() / "pelagic_trace_test.obj";
    const auto message_of = [&](const char* text) -> std::string {
        std::ofstream(file) << text;
        try {
            trace::read_obj(file);
        } catch (const std::runtime_error& error) {
            return error.what();
        }
        return {};
    };
    EXPECT_NE(message_of("v 0 0 0\nv 1 0 0\nf 1 2 3\n").find(":3:"), std::string::npos);
    EXPECT_NE(message_of("v 0 0\n").find(":1:"), std::string::npos);
    EXPECT_NE(message_of("v 0 nan 0\n").find(":1:"), std::string::npos);
    EXPECT_NE(message_of("# nothing\n").find("no faces"), std::string::npos);
    EXPECT_EQ(message_of("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2//1 3/1\n"), "");
    std::filesystem::remove(file);
}

}  // namespace
}  // namespace pelagic
