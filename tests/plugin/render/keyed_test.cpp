// Pictures of shots whose numbers change: each frame is that of a shot with the plain numbers that it has then.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <vector>

#include "core/scene/keys.h"
#include "core/scene/number_keys.h"
#include "plugin/files/files.h"
#include "plugin/format/exr/exr.h"
#include "plugin/format/exr/read.h"
#include "plugin/light/light.h"
#include "plugin/render/render_files.h"

namespace pelagic {
namespace {

namespace fs = std::filesystem;

class KeyedPictures : public ::testing::Test {
  protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / ("pelagic-keyed-" + std::to_string(getpid()));
        fs::remove_all(folder_);
        fs::create_directories(folder_);
    }
    void TearDown() override { fs::remove_all(folder_); }

    // Foam that lives, seen steeply: whatever may have keys shows, but for caustics.
    Scene shot() const {
        Scene scene;
        scene.shot.last_frame = 3;
        scene.camera.position_m = {0.0, -6.0, 6.0};
        scene.camera.resolution = {32, 20};
        scene.camera.fov_deg = 90.0;
        scene.quality.level = QualityLevel::Draft;
        scene.waves.cascades = {{250.0, 64}, {30.0, 64}};
        scene.sea.wind_speed_mps = 14.0;
        scene.effects.foam_decay_s = 1.0;
        scene.effects.whitecap_amount = 10.0;
        return scene;
    }

    // A sky with a bright side and a sun.
    std::string sky_picture() const {
        constexpr int kWidth = 32, kHeight = 16;
        std::vector<glm::vec3> pixels(kWidth * kHeight, glm::vec3(1.0f, 1.5f, 2.0f));
        for (int i = 0; i < kWidth * kHeight; ++i) pixels[i] *= 1.0f + 0.1f * static_cast<float>(i % kWidth);
        pixels[12 * kWidth + 10] = glm::vec3(5000.0f);
        exr::Image image{.width = kWidth, .height = kHeight, .channels = {}};
        for (int c = 0; c < 3; ++c)
            image.channels.push_back({.name = std::string(1, "RGB"[c]),
                                      .data = &pixels[0].x + c,
                                      .pixel_stride_bytes = sizeof(glm::vec3),
                                      .type = exr::PixelType::Float});
        const fs::path file = folder_ / "sky.exr";
        files::write_atomically(file, exr::encode_scanline({}, image));
        return file.string();
    }

    // What a frame's files show: the light, and the pixels of the PNG as they are packed.
    std::string shown(const Scene& scene, const std::vector<int>& frames, int frame) {
        const fs::path out = folder_ / std::to_string(++made_);
        render_files({.scene = scene, .options = render_options(scene)},
                     {.out = out, .frames = frames, .progress = {}, .cancel = nullptr});
        const exr::RgbPixels light = exr::read_rgb((out / picture_file(scene.shot, frame, "exr")).string());
        std::string bytes(reinterpret_cast<const char*>(light.pixels.data()),
                          light.pixels.size() * sizeof(light.pixels[0]));
        std::ifstream stream(out / picture_file(scene.shot, frame, "png"), std::ios::binary);
        const std::string png{std::istreambuf_iterator<char>(stream), {}};
        const std::size_t begin = png.find("IDAT"), end = png.find("tEXt", begin);
        EXPECT_NE(begin, std::string::npos);
        return bytes + png.substr(begin, end == std::string::npos ? end : end - begin);
    }

    fs::path folder_;
    int made_ = 0;
};

// A number of each key that shows in that shot, at its first and last frame.
const std::map<std::string, std::pair<double, double>> kValues{{"camera.exposure_ev", {-1.0, 2.0}},
                                                               {"camera.ev100", {10.0, 15.0}},
                                                               {"camera.white_balance_k", {3000, 9000}},
                                                               {"camera.glare", {0.05, 0.3}},
                                                               {"light.sun_elevation_deg", {30.0, 50.0}},
                                                               {"light.sun_azimuth_deg", {70.0, 130.0}},
                                                               {"light.turbidity", {3.0, 6.0}},
                                                               {"light.visibility_km", {0.1, 0.3}},
                                                               {"light.sky_rotation_deg", {30.0, 120.0}},
                                                               {"light.sky_gain", {0.5, 4.0}},
                                                               {"water.chlorophyll_mg_m3", {1.0, 9.0}},
                                                               {"water.crest_light", {0.0, 3.0}},
                                                               {"water.bubbles", {2.0, 8.0}},
                                                               {"water.caustics", {0.0, 1.0}},
                                                               {"effects.foam_structure", {0.0, 0.6}},
                                                               {"effects.foam_streaks", {0.0, 0.4}},
                                                               {"effects.foam_new_albedo", {0.1, 0.4}},
                                                               {"effects.foam_old_albedo", {0.1, 0.4}},
                                                               {"effects.foam_new_opaque", {0.2, 0.6}},
                                                               {"effects.foam_old_opaque", {0.2, 0.9}}};

// Over the whole table: a frame of a run, the frame alone, the frame between two equal keys and that of the plain number are the same to
// the bit, and each number shows.
TEST_F(KeyedPictures, AreThoseOfThePlainNumbers) {
    const std::string sky = sky_picture();
    Scene pictured = shot();  // its light is read in a moment, where daylight takes most of a second
    pictured.light.sky = sky;
    const std::string in_daylight = shown(shot(), {2}, 2), under_picture = shown(pictured, {2}, 2);
    for (const Key& key : keys()) {
        if (!key.may_have_keys || key.path.starts_with("sea.") || key.path.starts_with("waves.")) continue;
        SCOPED_TRACE(key.path);
        const bool is_daylight = key.path.starts_with("light.sun_") || key.path == "light.turbidity";
        Scene plain = is_daylight ? shot() : pictured;
        std::string without = is_daylight ? in_daylight : under_picture;
        if (key.path == "water.caustics") {  // which take a second a frame
            plain.sea.depth_m = 4.0;
            plain.sea.significant_height_m = 0.5;
            without = shown(plain, {2}, 2);
        }
        Scene keyed = plain, equal = plain;
        const auto [first, last] = kValues.at(key.path);
        const NumberKeys number{{{1, first}, {3, last}}};
        const double now = value_at(number, key.is_angle, 2);
        ASSERT_FALSE(set_value(plain, key, now));
        ASSERT_FALSE(set_value(keyed, key, number));
        ASSERT_FALSE(set_value(equal, key, NumberKeys{{{1, now}, {3, now}}, CameraInterpolation::Smooth}));
        const std::string wanted = shown(plain, {2}, 2);
        EXPECT_TRUE(wanted != without) << "doesn't show";
        EXPECT_TRUE(shown(keyed, {1, 2}, 2) == wanted) << "of a run";
        EXPECT_TRUE(shown(keyed, {2}, 2) == wanted) << "alone";
        if (key.path.starts_with(
                "camera.")) {  // all are read by one function: a few keys stand for the others
            EXPECT_TRUE(shown(equal, {2}, 2) == wanted) << "between equal keys";
        }
        // A frame's picture is kept while its own value is the same, whatever the others are.
        const auto made_of = [&](const NumberKeys& of, int frame) {
            Scene scene = keyed;
            set_value(scene, key, of);
            const RenderOptions options = render_options(scene);
            return PictureFingerprint({.scene = scene, .options = options, .picture_content = {}}).of(frame);
        };
        const NumberKeys other{{{1, last}, {2, now}, {3, last}}};
        EXPECT_EQ(made_of(number, 2), made_of(other, 2));
        EXPECT_NE(made_of(number, 1), made_of(other, 1));
    }
}

// The sea's: between keys no plain number has its waves. Foam with a past, the water's waves and the exposure are those of the frame.
TEST_F(KeyedPictures, OfASeaThatChangesStandForThemselves) {
    Scene scene = shot(), equal = scene;
    scene.light.sky = equal.light.sky = sky_picture();
    const Key& wind = key_of("sea.wind_speed_mps");
    const NumberKeys rising{{{1, 8.0}, {3, 20.0}}};
    ASSERT_FALSE(set_value(scene, wind, rising));
    const std::string second = shown(scene, {1, 2, 3}, 2);
    EXPECT_TRUE(shown(scene, {2}, 2) == second) << "alone";
    Scene middle = equal;
    middle.sea.wind_speed_mps = 14.0;
    EXPECT_FALSE(shown(middle, {2}, 2) == second);
    ASSERT_FALSE(set_value(equal, wind, NumberKeys{{{1, 14.0}, {3, 14.0}}}));
    EXPECT_TRUE(shown(equal, {2}, 2) == shown(middle, {2}, 2)) << "between equal keys";
    // A key changes the fingerprints of the frames between its neighbours, and no others.
    scene.waves.second_order = 0.0;  // which is of all keys
    scene.effects.foam_decay_s = 0.0;
    scene.effects.breaking_from_m = 1.0;
    const auto made_of = [&](std::vector<NumberKeys::Key> keys, int frame) {
        set_value(scene, wind, NumberKeys{std::move(keys)});
        const RenderOptions options = render_options(scene);
        return PictureFingerprint({.scene = scene, .options = options, .picture_content = {}}).of(frame);
    };
    const std::vector<NumberKeys::Key> keys{{1, 8.0}, {10, 20.0}, {20, 10.0}, {30, 10.0}};
    std::vector<NumberKeys::Key> other = keys;
    other[2].value = 12.0;
    for (const int frame : {1, 5, 10}) EXPECT_EQ(made_of(keys, frame), made_of(other, frame)) << frame;
    for (const int frame : {11, 20, 25}) EXPECT_NE(made_of(keys, frame), made_of(other, frame)) << frame;
}

// Under a calm, where no wave could tell: of each frame that of its depth.
TEST_F(KeyedPictures, OfAFloorThatRisesAreThoseOfTheFramesDepth) {
    Scene plain = shot();
    plain.light.sky = sky_picture();
    plain.sea.wind_speed_mps = plain.waves.second_order = plain.water.caustics = 0.0;
    plain.sea.depth_m = 6.0;
    Scene scene = plain;
    const std::string deeper = shown(plain, {2}, 2);
    ASSERT_FALSE(set_value(scene, key_of("sea.depth_m"), NumberKeys{{{1, 6.0}, {3, 2.0}}}));
    plain.sea.depth_m = 4.0;
    const std::string second = shown(plain, {2}, 2);
    EXPECT_FALSE(second == deeper);
    EXPECT_TRUE(shown(scene, {1, 2}, 2) == second) << "of a run";
    EXPECT_TRUE(shown(scene, {2}, 2) == second) << "alone";
}

// Spray is the moment's: a frame alone is that of a run, and a key before it shows in it, by how far the wind has blown.
TEST_F(KeyedPictures, OfSprayInAWindThatRises) {
    Scene scene = shot();
    scene.light.sky = sky_picture();
    scene.effects.spray = true;
    // But for spray, what is of all keys is left out.
    scene.waves.second_order = 0.0;
    scene.effects.foam_decay_s = 0.0;
    scene.effects.breaking_from_m = 1.0;
    const Key& wind = key_of("sea.wind_speed_mps");
    ASSERT_FALSE(set_value(scene, wind, NumberKeys{{{1, 14.0}, {2, 20.0}, {3, 22.0}}}));
    const std::string third = shown(scene, {1, 2, 3}, 3);
    EXPECT_TRUE(shown(scene, {3}, 3) == third) << "alone";
    Scene calm = scene, other = scene;
    calm.effects.spray = false;
    EXPECT_FALSE(shown(calm, {3}, 3) == third);
    ASSERT_FALSE(set_value(other, wind, NumberKeys{{{1, 10.0}, {2, 20.0}, {3, 22.0}}}));
    EXPECT_FALSE(shown(other, {3}, 3) == third);
    const auto made_of = [](const Scene& of, int frame) {
        const RenderOptions options = render_options(of);
        return PictureFingerprint({.scene = of, .options = options, .picture_content = {}}).of(frame);
    };
    EXPECT_NE(made_of(other, 3), made_of(scene, 3));
    other.effects.spray = false;
    EXPECT_TRUE(shown(other, {3}, 3) == shown(calm, {3}, 3));
}

// Of what has no frame.
TEST_F(KeyedPictures, OneMomentsLightWantsAFrame) {
    Scene scene;
    set_value(scene, key_of("light.turbidity"), NumberKeys{{{1, 2.0}, {9, 5.0}}});
    try {
        make_sky(scene);
        FAIL();
    } catch (const std::invalid_argument& error) {
        EXPECT_EQ(std::string(error.what()).find("light.turbidity has keys, and this shows one moment"), 0u);
    }
    EXPECT_NO_THROW(make_water(scene));
    set_value(scene, key_of("water.bubbles"), NumberKeys{{{1, 0.0}}});
    set_value(scene, key_of("effects.foam_streaks"), NumberKeys{{{1, 0.0}}});
    EXPECT_THROW(make_water(scene), std::invalid_argument);
    EXPECT_THROW(make_foam(scene, nullptr), std::invalid_argument);
}

}  // namespace
}  // namespace pelagic
