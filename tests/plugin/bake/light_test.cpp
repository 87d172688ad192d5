// The light of a baked stage, from the files that a bake leaves: NAME.usda as text and NAME.sky.exr, read as UsdLux
// and MaterialX say, give the sun, the sky and the water that core/lighting lights pictures with.
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <iterator>
#include <map>
#include <optional>
#include <random>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/constants.h"
#include "core/lighting/background.h"
#include "core/lighting/lighting.h"
#include "core/scene/keys.h"
#include "core/scene/number_keys.h"
#include "plugin/bake/bake.h"
#include "plugin/files/files.h"
#include "plugin/format/exr/exr.h"
#include "plugin/format/exr/read.h"
#include "plugin/light/light.h"

namespace {

using namespace pelagic;
namespace fs = std::filesystem;

std::string text_of(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

// ---- What the stage says

// A prim's attributes, by what stands before " = ": "float inputs:intensity" → "69.3". Empty: there is no such prim.
using Prim = std::map<std::string, std::string>;
Prim prim_of(const std::string& stage, const std::string& head) {
    Prim prim;
    const std::size_t at = stage.find(head + "\n");
    if (at == std::string::npos) return prim;
    std::istringstream lines(stage.substr(at));
    std::string line;
    std::getline(lines, line);
    while (std::getline(lines, line) && line.find_first_not_of(' ') != line.find('}')) {
        const std::size_t equals = line.find(" = "), begin = line.find_first_not_of(' ');
        if (equals != std::string::npos) prim[line.substr(begin, equals - begin)] = line.substr(equals + 3);
    }
    return prim;
}

std::vector<double> numbers_in(std::string text) {
    for (char& c : text)
        if (c == '(' || c == ')' || c == ',') c = ' ';
    std::istringstream stream(text);
    return {std::istream_iterator<double>(stream), {}};
}

glm::dvec3 vector_in(const std::string& text) {
    const std::vector<double> numbers = numbers_in(text);
    return {numbers.at(0), numbers.at(1), numbers.at(2)};
}

// USD's rotateXYZ [deg]: about x first, then y, then z.
glm::dvec3 rotated(glm::dvec3 angles_deg, glm::dvec3 v) {
    for (int axis = 0; axis < 3; ++axis) {
        const double angle = angles_deg[axis] * kPi / 180.0;
        const int i = (axis + 1) % 3, j = (axis + 2) % 3;
        const glm::dvec3 before = v;
        v[i] = before[i] * std::cos(angle) - before[j] * std::sin(angle);
        v[j] = before[i] * std::sin(angle) + before[j] * std::cos(angle);
    }
    return v;
}

// The factor of intensity, exposure and colour.
glm::dvec3 emission_of(const Prim& light) {
    const auto number = [&](const char* name, double fallback) {
        const auto found = light.find(name);
        return found == light.end() ? fallback : std::stod(found->second);
    };
    return number("float inputs:intensity", 1.0) * std::exp2(number("float inputs:exposure", 0.0)) *
           vector_in(light.at("color3f inputs:color"));
}

struct SunOfStage {
    glm::dvec3 towards{0.0}, irradiance{0.0};  // across its rays
};

// UsdLux: a distant light shines along its −z, and where it is normalised its emission is divided by
// π sin²(angle/2): what falls on a surface that faces it is intensity · colour.
std::optional<SunOfStage> sun_in(const std::string& stage) {
    const Prim light = prim_of(stage, "def DistantLight \"Sun\"");
    if (light.empty()) return {};
    EXPECT_EQ(light.at("bool inputs:normalize"), "1");
    EXPECT_NEAR(std::stod(light.at("float inputs:angle")), 2.0 * 0.00465 * 180.0 / kPi, 1e-6);
    EXPECT_EQ(light.at("uniform token[] xformOpOrder"), "[\"xformOp:rotateXYZ\"]");
    return SunOfStage{rotated(vector_in(light.at("float3 xformOp:rotateXYZ")), {0, 0, 1}),
                      emission_of(light)};
}

// Calls take(direction in the world, solid angle, radiance) for each pixel of the dome's image. OpenEXR's lat-long
// map, which UsdLux refers to: column 0 begins at longitude π, row 0 at latitude π/2; longitude 0 is +z, π/2 is +x,
// latitude π/2 is +y, in the light's own axes.
template <class Take>
void for_each_pixel(const std::string& stage, const fs::path& folder, Take take) {
    const Prim light = prim_of(stage, "def DomeLight \"Sky\"");
    ASSERT_TRUE(light.contains("asset inputs:texture:file")) << "a dome without a picture";
    EXPECT_EQ(light.at("token inputs:texture:format"), "\"latlong\"");
    const std::string asset = light.at("asset inputs:texture:file");
    const exr::RgbPixels image = exr::read_rgb(folder / asset.substr(1, asset.size() - 2));
    ASSERT_EQ(image.width, 2 * image.height);
    const glm::dvec3 angles = vector_in(light.at("float3 xformOp:rotateXYZ")), factor = emission_of(light);
    const double pixel = kPi / image.height;
    for (int row = 0; row < image.height; ++row)
        for (int column = 0; column < image.width; ++column) {
            const double latitude = 0.5 * kPi - pixel * (row + 0.5), longitude = kPi - pixel * (column + 0.5);
            const glm::dvec3 local(std::cos(latitude) * std::sin(longitude), std::sin(latitude),
                                   std::cos(latitude) * std::cos(longitude));
            const auto& [r, g, b] = image.pixels[static_cast<std::size_t>(row) * image.width + column];
            take(rotated(angles, local), pixel * pixel * std::cos(latitude), factor * glm::dvec3(r, g, b));
        }
}

double largest(glm::dvec3 v) {
    return std::max({v.x, v.y, v.z});
}

// ---- Bakes

Scene small_scene() {
    Scene scene;
    scene.shot.name = "a-b";
    scene.shot.last_frame = 1;
    scene.waves.cascades = {{.size_m = 80.0, .resolution = 32}};
    scene.surface.size_m = 80.0;
    scene.surface.resolution = 4;
    return scene;
}

// A haze that is brighter to the north (+y) than anywhere else, and a sun at azimuth 130°, elevation 30°.
void write_sky(const fs::path& file, float brightness, bool has_sun = true) {
    constexpr int kWidth = 256, kHeight = 128;
    std::vector<glm::vec3> pixels;
    for (int row = kHeight - 1; row >= 0; --row)  // the encoder's rows rise
        for (int column = 0; column < kWidth; ++column) {
            const double azimuth = kPi - 2.0 * kPi * (column + 0.5) / kWidth;
            const double elevation = kPi * (0.5 - (row + 0.5) / kHeight);
            const glm::dvec3 to(std::cos(elevation) * std::cos(azimuth),
                                std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
            const double e = kPi / 6.0, a = 130.0 / 180.0 * kPi;
            const glm::dvec3 sun(std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e));
            const glm::vec3 sky(1.0f + static_cast<float>(to.y), 1.0f, 1.5f);
            const bool in_sun = has_sun && glm::distance(to, sun) < 0.02;
            pixels.push_back(brightness * (in_sun ? glm::vec3(50000.0f, 40000.0f, 30000.0f) : sky));
        }
    exr::Image image{.width = kWidth, .height = kHeight, .channels = {}};
    for (int c = 0; c < 3; ++c)
        image.channels.push_back({.name = std::string(1, "RGB"[c]),
                                  .data = &pixels[0].x + c,
                                  .pixel_stride_bytes = sizeof(glm::vec3),
                                  .type = exr::PixelType::Float});
    files::write_atomically(file, exr::encode_scanline({}, image));
}

class StageLightTest : public ::testing::Test {
  protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / ("pelagic-light-" + std::to_string(getpid()));
        fs::remove_all(folder_);
        fs::create_directories(folder_);
    }
    void TearDown() override { fs::remove_all(folder_); }

    std::string baked(const Scene& scene, const std::vector<int>& frames = {}) const {
        const RunReport report =
            bake(scene, {.out = folder_, .frames = frames, .progress = {}, .cancel = nullptr});
        EXPECT_EQ(report.foreign, std::vector<std::string>{});
        return text_of(report.root);
    }

    // The files' light and the core's.
    void expect_light_of(const Scene& scene) const {
        const std::string stage = baked(scene);
        const Sky sky = make_sky(scene);
        const glm::dvec3 core_sun(sky.sun_irradiance), core_sky(sky.sky_irradiance);

        const std::optional<SunOfStage> sun = sun_in(stage);
        ASSERT_EQ(sun.has_value(), sky.sun_radiance != glm::vec3(0.0f));
        if (sun) {
            EXPECT_LT(glm::distance(sun->towards, glm::dvec3(sky.sun_direction)), 1e-6);
            EXPECT_LT(largest(glm::abs(sun->irradiance * sun->towards.z - core_sun)),
                      0.001 * largest(core_sun));
        }

        glm::dvec3 irradiance(0.0), brightest_towards(0.0);
        double brightest = 0.0;
        bool finite = true;
        int compared = 0, off = 0;
        for_each_pixel(stage, folder_, [&](glm::dvec3 towards, double solid_angle, glm::dvec3 radiance) {
            finite = finite && std::isfinite(largest(radiance)) &&
                     std::min({radiance.x, radiance.y, radiance.z}) >= 0.0;
            irradiance += radiance * (solid_angle * std::max(towards.z, 0.0));
            if (towards.z < 0.03) return;
            if (largest(radiance) > brightest) brightest = largest(radiance), brightest_towards = towards;
            const glm::dvec3 core(background(sky, glm::vec3(towards), 1.0f).sky);
            ++compared;
            off += largest(glm::abs(radiance - core)) > 0.02 * largest(core);
        });
        EXPECT_LE(largest(glm::abs(irradiance - core_sky)), 0.01 * largest(core_sky));
        EXPECT_TRUE(finite);
        EXPECT_GT(compared, 100);
        EXPECT_LT(off, compared / 1000) << "pixels that aren't the sky's of their direction";
        // By daylight the aureole is the brightest, a little below the sun, where the haze is deeper.
        if (scene.light.sky == Light{}.sky && sky.sun_direction.z > 0.1f) {
            EXPECT_GT(glm::dot(brightest_towards, glm::dvec3(sky.sun_direction)),
                      std::cos(3.0 * kPi / 180.0));
        }
    }

    fs::path folder_;
};

TEST_F(StageLightTest, DaylightIsTheCores) {
    double azimuth_deg = -170.0;
    for (const double elevation_deg : {90.0, 50.0, 20.0, 5.0, 0.1, -0.2, -3.0, -12.0, -60.0}) {
        Scene scene = small_scene();
        scene.light.sun_elevation_deg = elevation_deg;
        scene.light.sun_azimuth_deg = azimuth_deg += 70.0;
        scene.light.turbidity = elevation_deg == 50.0 ? 1.7 : elevation_deg == 5.0 ? 10.0 : 3.0;
        SCOPED_TRACE(elevation_deg);
        expect_light_of(scene);
    }
}

// Also of a brightness that no half holds.
TEST_F(StageLightTest, APicturesSunAndSkyAreTheCores) {
    const fs::path file = folder_ / "a picture.exr";
    for (const float brightness : {1.0f, 1e-6f, 1e8f}) {
        write_sky(file, brightness);
        Scene scene = small_scene();
        scene.light.sky = file.string();
        SCOPED_TRACE(brightness);
        expect_light_of(scene);
        // It has a side: right and left aren't swapped.
        const std::optional<SunOfStage> sun = sun_in(text_of(folder_ / "a-b.usda"));
        ASSERT_TRUE(sun);
        EXPECT_LT(glm::distance(glm::normalize(glm::dvec2(sun->towards)),
                                {std::cos(130.0 / 180.0 * kPi), std::sin(130.0 / 180.0 * kPi)}),
                  0.01);
        double north = 0.0, south = 0.0;
        for_each_pixel(text_of(folder_ / "a-b.usda"), folder_,
                       [&](glm::dvec3 towards, double solid_angle, glm::dvec3 radiance) {
                           if (towards.z > 0.0) (towards.y > 0.0 ? north : south) += radiance.x * solid_angle;
                       });
        EXPECT_GT(north, 2.0 * south);
    }
    write_sky(file, 1.0f, false);
    Scene overcast = small_scene();
    overcast.light.sky = file.string();
    expect_light_of(overcast);
    EXPECT_FALSE(sun_in(text_of(folder_ / "a-b.usda")));
}

TEST_F(StageLightTest, ANewPictureUnderTheSameNameIsNoticed) {
    const fs::path file = folder_ / "a picture.exr";
    write_sky(file, 1.0f);
    Scene scene = small_scene();
    scene.light.sky = file.string();
    const std::string before = baked(scene), dome = text_of(folder_ / "a-b.sky.exr");
    write_sky(file, 1.5f);
    EXPECT_NE(baked(scene), before);  // the sun
    EXPECT_TRUE(text_of(folder_ / "a-b.sky.exr") != dome);
    expect_light_of(scene);
    write_sky(file, 1.0f);
    EXPECT_EQ(baked(scene), before);
    EXPECT_TRUE(text_of(folder_ / "a-b.sky.exr") == dome);
}

std::string part_of(const std::string& text, const std::string& from, const std::string& to) {
    const std::size_t begin = text.find(from);
    return begin == std::string::npos ? "" : text.substr(begin, text.find(to, begin) - begin);
}

// Headers say which frame's they are.
auto pixels_of(const fs::path& file) {
    return exr::read_rgb(file.string()).pixels;
}

// A light that changes: sun and dome of each frame are those of a stage of its plain numbers.
TEST_F(StageLightTest, OfNumbersThatHaveKeysIsEachFramesOwn) {
    Scene scene = small_scene();
    scene.shot.first_frame = 1;
    scene.shot.last_frame = 5;
    set_value(scene, key_of("light.sun_elevation_deg"), NumberKeys{{{2, 10.0}, {4, -1.0}}});
    set_value(scene, key_of("light.sun_azimuth_deg"), NumberKeys{{{2, 170.0}, {4, -160.0}}});
    set_value(scene, key_of("camera.exposure_ev"), NumberKeys{{{1, 0.0}, {5, 3.0}}});
    const std::string stage = baked(scene), sun = part_of(stage, "def DistantLight", "def DomeLight");
    const std::string intensity = part_of(sun, "inputs:intensity.timeSamples", "}"),
                      turn = part_of(sun, "rotateXYZ.timeSamples", "}"),
                      dome = part_of(stage, "def DomeLight", "rotateXYZ");
    std::map<int, decltype(pixels_of(folder_))> domes;
    for (int frame = 1; frame <= 5; ++frame) {
        const std::string file = "a-b.sky.000" + std::to_string(frame) + ".exr",
                          at = std::to_string(frame) + ": ";
        EXPECT_NE(dome.find(at + "@./" + file + "@"), std::string::npos) << dome;
        domes[frame] = pixels_of(folder_ / file);
        fs::remove(folder_ / file);  // of another shot than those below
    }
    EXPECT_FALSE(fs::exists(folder_ / "a-b.sky.exr"));
    EXPECT_NE(turn.find("3: (0, 85.49"), std::string::npos) << turn;
    EXPECT_NE(turn.find("4: (0, 91, 200),"), std::string::npos) << turn;  // the short way on
    EXPECT_NE(intensity.find("4: 0,"), std::string::npos) << intensity;
    EXPECT_NE(intensity.find("2: "), std::string::npos) << "on a straight line from 1 to 3\n" << intensity;
    for (const int frame : {1, 2, 3}) {
        Scene plain = scene_at(scene, frame);
        const std::string of_plain = baked(plain);
        const std::string told = part_of(part_of(of_plain, "def DistantLight", "def DomeLight"),
                                         "float inputs:intensity = ", "\n");
        EXPECT_NE(intensity.find(std::to_string(frame) + ": " +
                                 told.substr(std::string("float inputs:intensity = ").size()) + ","),
                  std::string::npos)
            << intensity << told;
        EXPECT_TRUE(pixels_of(folder_ / "a-b.sky.exr") == domes[frame]);
    }
}

TEST_F(StageLightTest, KeysThatABakeCantSayAreRefused) {
    const auto refusal = [&](const char* path, bool has_floor) {
        Scene scene = small_scene();
        if (has_floor) scene.sea.depth_m = 5.0, scene.output.maps = {MapKind::Floor};
        set_value(scene, key_of(path), NumberKeys{{{1, 0.5}, {4, 0.6}}});
        try {
            baked(scene);
        } catch (const std::invalid_argument& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    for (const char* path : {"water.chlorophyll_mg_m3", "effects.foam_old_opaque", "effects.foam_new_albedo"})
        EXPECT_NE(refusal(path, false).find(std::string(path) + " = { keys = "), std::string::npos) << path;
    EXPECT_EQ(refusal("water.caustics", false), "");
    EXPECT_EQ(refusal("camera.exposure_ev", true), "");
    EXPECT_NE(refusal("water.caustics", true).find("a map of the floor has one light for all frames"),
              std::string::npos);
    EXPECT_NE(refusal("light.sun_elevation_deg", true).find("a map of the floor"), std::string::npos);
}

// A frame costs its own sky, however long its light changes.
TEST_F(StageLightTest, KeysOverALongRangeCostTheirFrame) {
    Scene scene = small_scene();
    scene.shot.first_frame = -10'000'000;
    scene.shot.last_frame = 10'000'000;
    set_value(scene, key_of("light.turbidity"), NumberKeys{{{1, 2.0}, {3, 4.0}}});
    set_value(scene, key_of("light.sun_elevation_deg"), NumberKeys{{{-10'000'000, 5.0}, {10'000'000, 60.0}}});
    const std::string stage = baked(scene, {2});
    EXPECT_NE(stage.find("2: @./a-b.sky.0002.exr@"), std::string::npos);
    EXPECT_EQ(stage.find("a-b.sky.0003.exr"), std::string::npos);
    const auto skies = [&] {
        return std::ranges::count_if(fs::directory_iterator(folder_), [](const fs::directory_entry& entry) {
            return entry.path().filename().string().starts_with("a-b.sky.");
        });
    };
    EXPECT_EQ(skies(), 1);
    baked(scene, {2, 7});
    EXPECT_EQ(skies(), 2);
}

// What is there is kept, and what the light of a frame has become is made again: of that frame alone.
TEST_F(StageLightTest, AFrameIsMadeAgainWhereItsOwnLightChanges) {
    Scene scene = small_scene();
    scene.shot.first_frame = 1;
    scene.shot.last_frame = 4;
    const auto bake_it = [&](double last_deg) {
        set_value(scene, key_of("light.sun_elevation_deg"),
                  NumberKeys{{{1, 30.0}, {3, 20.0}, {4, last_deg}}});
        const RunReport report = bake(scene, {.out = folder_, .frames = {}, .progress = {}});
        EXPECT_TRUE(report.damaged.empty());
        return report.done;
    };
    EXPECT_EQ(bake_it(10.0), 4);
    EXPECT_EQ(bake_it(10.0), 0);
    const std::string third = text_of(folder_ / "a-b.sky.0003.exr"),
                      fourth = text_of(folder_ / "a-b.sky.0004.exr");
    EXPECT_EQ(bake_it(12.0), 1);
    scene.camera.exposure_ev = 2.0;  // of pictures alone
    EXPECT_EQ(bake_it(12.0), 0);
    EXPECT_TRUE(text_of(folder_ / "a-b.sky.0003.exr") == third);
    EXPECT_FALSE(text_of(folder_ / "a-b.sky.0004.exr") == fourth);
    fs::remove(folder_ / "a-b.sky.0002.exr");
    EXPECT_EQ(bake_it(12.0), 1);
}

// A picture of a sky that turns and darkens: its sun as the picture that is read with these numbers has it.
TEST_F(StageLightTest, OfAPictureThatTurnsIsEachFramesOwn) {
    Scene scene = small_scene();
    scene.shot.first_frame = 1;
    scene.shot.last_frame = 3;
    write_sky(folder_ / "noon.exr", 1.0f);
    scene.light.sky = (folder_ / "noon.exr").string();
    set_value(scene, key_of("light.sky_rotation_deg"), NumberKeys{{{1, 10.0}, {3, 50.0}}});
    set_value(scene, key_of("light.sky_gain"), NumberKeys{{{1, 1.0}, {3, 0.25}}});
    const std::string stage = baked(scene);
    const auto number_after = [](const std::string& text, const std::string& name) {
        const std::size_t at = text.find(name);
        return at == std::string::npos ? std::nan("") : std::strtod(text.c_str() + at + name.size(), nullptr);
    };
    std::map<int, decltype(pixels_of(folder_))> domes;
    for (const int frame : {1, 2, 3}) {
        const fs::path file = folder_ / ("a-b.sky.000" + std::to_string(frame) + ".exr");
        domes[frame] = pixels_of(file);
        fs::remove(file);
    }
    for (const int frame : {1, 2, 3}) {
        const std::string plain = baked(scene_at(scene, frame));
        EXPECT_TRUE(pixels_of(folder_ / "a-b.sky.exr") == domes[frame]) << frame;
        const std::string at = '\n' + std::string(12, ' ') + std::to_string(frame) + ": ";
        const std::string sun = part_of(plain, "def DistantLight", "def DomeLight"),
                          samples = part_of(stage, "inputs:intensity.timeSamples", "}"),
                          turns = part_of(part_of(stage, "def DistantLight", "def DomeLight"),
                                          "rotateXYZ.timeSamples", "}");
        const double intensity = number_after(sun, "float inputs:intensity = ");
        EXPECT_GT(intensity, 0.0);
        EXPECT_NEAR(number_after(samples, at), intensity, 1e-5 * intensity) << frame;
        const auto azimuth = [&](const std::string& text, const std::string& from) {
            const std::size_t place = text.find(from);
            const std::size_t comma = text.find(", ", text.find(", ", place) + 1);
            return std::strtod(text.c_str() + comma + 2, nullptr);
        };
        EXPECT_NEAR(std::remainder(azimuth(turns, at) - azimuth(sun, "rotateXYZ = ("), 360.0), 0.0, 1e-3)
            << frame;
    }
}

TEST_F(StageLightTest, DoesNotReplaceThePictureThatItsSkiesAreMadeOf) {
    Scene scene = small_scene();
    scene.light.sky = folder_ / "a-b.sky.0003.exr";
    write_sky(scene.light.sky, 1.0f);
    set_value(scene, key_of("light.sky_gain"), NumberKeys{{{1, 1.0}, {4, 0.5}}});
    const std::string before = text_of(scene.light.sky);
    EXPECT_THROW(baked(scene), std::invalid_argument);
    EXPECT_TRUE(text_of(scene.light.sky) == before);
}

// What the last light was made of is asked before it is used again: all that makes it must be in the answer.
TEST(StageLightKeys, EveryKeyOfTheLightFeedsIt) {
    int count = 0;
    for (const Key& key : keys()) {
        if (!key.path.starts_with("light.")) continue;
        EXPECT_TRUE((key.key_parts & key_parts(KeyPart::Light)).any()) << key.path;
        ++count;
    }
    EXPECT_GE(count, 4);
}

// The dome says its primaries and, in daylight, the luminance of (1, 1, 1), as pictures do; a picture of a sky has its own
// unit. By the names and types in OpenEXR's header.
TEST_F(StageLightTest, TheDomeSaysWhatItsRadianceIs) {
    using namespace std::string_literals;
    Scene scene = small_scene();
    baked(scene);
    const std::string daylight = text_of(folder_ / "a-b.sky.exr");
    EXPECT_NE(daylight.find("chromaticities\0chromaticities\0"s), std::string::npos);
    EXPECT_NE(daylight.find("whiteLuminance\0float\0"s), std::string::npos);
    write_sky(folder_ / "noon.exr", 1.0f);
    scene.light.sky = (folder_ / "noon.exr").string();
    baked(scene);
    const std::string picture = text_of(folder_ / "a-b.sky.exr");
    EXPECT_NE(picture.find("chromaticities\0chromaticities\0"s), std::string::npos);
    EXPECT_EQ(picture.find("whiteLuminance"), std::string::npos);
}

TEST_F(StageLightTest, ABakeNeverWritesOverThePictureOfItsSky) {
    const fs::path file = folder_ / "a-b.sky.exr";
    write_sky(file, 1.0f);
    const std::string before = text_of(file);
    Scene scene = small_scene();
    scene.light.sky = (folder_ / ".." / folder_.filename() / "a-b.sky.exr").string();
    EXPECT_THROW(baked(scene), std::invalid_argument);
    EXPECT_TRUE(text_of(file) == before);
}

TEST_F(StageLightTest, WhatIsNoSkyIsRefusedBeforeAnythingIsDone) {
    files::write_atomically(folder_ / "a picture.exr", std::string("no picture"));
    Scene scene = small_scene();
    scene.light.sky = (folder_ / "a picture.exr").string();
    int building = 0;
    EXPECT_THROW(
        bake(scene, {.out = folder_ / "out",
                     .frames = {},
                     .progress = [&](const RunProgress& p) { building += p.stage != RunStage::Planning; },
                     .cancel = nullptr}),
        std::invalid_argument);
    EXPECT_EQ(building, 0);
    EXPECT_FALSE(fs::exists(folder_ / "out"));
}

TEST_F(StageLightTest, AShotWithoutAMeshHasNoSky) {
    Scene scene = small_scene();
    scene.output.mesh = MeshFormat::None;
    scene.output.maps = {MapKind::Normal};
    bake(scene, {.out = folder_, .frames = {}, .progress = {}, .cancel = nullptr});
    EXPECT_FALSE(fs::exists(folder_ / "a-b.sky.exr"));
    EXPECT_TRUE(fs::exists(folder_ / "maps"));
}

// ---- Water

glm::dvec3 water_color(const std::string& stage) {
    return vector_in(prim_of(stage, "def Shader \"Preview\"").at("color3f inputs:diffuseColor"));
}

TEST_F(StageLightTest, WaterAndFoamHaveTheCoresColours) {
    for (const WaterType type : {WaterType::Ocean, WaterType::Coastal, WaterType::Turbid})
        for (const double chlorophyll : {0.01, 0.1, 3.0, 100.0}) {
            Scene scene = small_scene();
            scene.water = {.type = type, .chlorophyll_mg_m3 = chlorophyll, .body = chlorophyll > 1.0};
            scene.sea.depth_m = 4.0;
            const std::string stage = baked(scene);
            const WaterBody water = make_water(scene);
            const Prim mixed = prim_of(stage, "def Shader \"BaseColor\"");
            const glm::dvec3 below(water.reflectance), color = water_color(stage);
            const glm::dvec3 foam = vector_in(mixed.at("color3f inputs:fg"));
            EXPECT_EQ(vector_in(mixed.at("color3f inputs:bg")), color);
            // Through the surface, the water and its underside, and into the narrower cone below; of a body the surface is rough, and what
            // it sends down again is told by that.
            const glm::dvec3 expected = below * (1.0 - 0.06751) / (1.0 - 0.48 * below) / (1.34 * 1.34);
            EXPECT_LT(largest(glm::abs(color - expected)),
                      scene.water.body ? 0.05 * largest(expected) : 1e-6);
            const glm::dvec3 white = 0.22 * glm::dvec3(0.94, 1.0, 1.0);  // water between bubbles takes red
            EXPECT_LT(largest(glm::abs(foam - (white + 0.6 * color))), 1e-6);
            for (const char* shader : {"def Shader \"Preview\"", "def Shader \"Surface\""}) {
                const Prim prim = prim_of(stage, shader);
                const auto ior = prim.find(prim.contains("float inputs:ior") ? "float inputs:ior"
                                                                             : "float inputs:specular_IOR");
                EXPECT_EQ(ior->second, "1.34");
            }

            // And they are what the core shades: a calm sea from 45°, under a sky of radiance 1.
            Sky even;
            even.map = SkyMap(4, std::vector<glm::vec3>(16, glm::vec3(1.0f)));
            even.sky_irradiance = glm::vec3(static_cast<float>(kPi));
            std::array<SeaRadiance, 3> seen;
            const glm::vec3 from = glm::normalize(glm::vec3(1.0f, 0.0f, 1.0f));
            const std::array<SeaPoint, 3> points{
                SeaPoint{.to_eye = from, .slope_variance = glm::vec3(1e-9f, 1e-9f, 0.0f)},
                SeaPoint{.to_eye = from, .slope_variance = glm::vec3(1e-9f, 1e-9f, 0.0f), .coverage = 1.0f},
                SeaPoint{.coverage = 1.0f}};
            WaterBody without_bubbles = water;
            without_bubbles.bubbles = 0.0f;
            shade_sea({}, even, without_bubbles, points, seen);
            // At 45° the parallel part is the square of the other one.
            const double below_rad = std::asin(std::sqrt(0.5) / 1.34), above_rad = kPi / 4.0,
                         across =
                             std::pow(std::sin(above_rad - below_rad) / std::sin(above_rad + below_rad), 2.0),
                         fresnel = 0.5 * across * (1.0 + across);
            EXPECT_LT(largest(glm::abs(glm::dvec3(seen[0].sea) - (1.0 - fresnel) * color)), 1e-5);
            // The core's foam is rough: its facets see 0.956 of the sky.
            EXPECT_LT(largest(glm::abs(glm::dvec3(seen[2].foam) - 0.9564 * white)), 1e-4);
            EXPECT_LT(largest(glm::abs(glm::dvec3(seen[1].sea - 0.6f * seen[0].sea))), 1e-6);
        }
}

// ---- The material's network

// The values of MaterialX's nodes in a stage, computed from a vertex's primvars. As vectors; a float is the first
// component. Nodes are those of MaterialX's standard library, in single precision.
class Network {
  public:
    Network(const std::string& stage, glm::vec3 slope_variance, float coverage)
        : stage_(stage), slope_variance_(slope_variance), coverage_(coverage) {}

    // Of an input of the surface.
    glm::vec3 surface(const std::string& type, const std::string& name) {
        return input(prim_of(stage_, "def Shader \"Surface\""), type, name);
    }

  private:
    glm::vec3 input(const Prim& prim, const std::string& type, const std::string& name) {
        const std::string key = type + " inputs:" + name;
        if (const auto link = prim.find(key + ".connect"); link != prim.end()) {
            const std::size_t dot = link->second.find(".outputs:out>"), slash = link->second.rfind('/');
            EXPECT_NE(dot, std::string::npos) << link->second;
            return value(link->second.substr(slash + 1, dot - slash - 1));
        }
        if (!prim.contains(key)) ADD_FAILURE() << "no input " << key;
        const std::vector<double> numbers = numbers_in(prim.at(key));
        const auto at = [&](std::size_t i) {
            return i < numbers.size() ? static_cast<float>(numbers[i]) : 0.0f;
        };
        return {at(0), at(1), at(2)};
    }

    glm::vec3 value(const std::string& node) {
        const auto [known, is_new] = values_.try_emplace(node);
        if (is_new) known->second = computed(prim_of(stage_, "def Shader \"" + node + "\""), node);
        return values_.at(node);
    }

    glm::vec3 computed(const Prim& prim, const std::string& node) {
        const std::string& id = prim.at("uniform token info:id");
        const auto of = [&](const char* name) { return input(prim, "float", name).x; };
        const auto number = [](float x) { return glm::vec3(x, 0.0f, 0.0f); };
        if (id == "\"ND_geompropvalue_vector3\"" || id == "\"ND_geompropvalue_float\"") {
            if (prim.at("string inputs:geomprop") == "\"slopeVariance\"") return slope_variance_;
            if (prim.at("string inputs:geomprop") == "\"whitecapCoverage\"") return number(coverage_);
        }
        if (id == "\"ND_dotproduct_vector3\"")
            return number(glm::dot(input(prim, "float3", "in1"), input(prim, "float3", "in2")));
        if (id == "\"ND_magnitude_vector3\"") return number(glm::length(input(prim, "float3", "in")));
        if (id == "\"ND_combine3_vector3\"") return {of("in1"), of("in2"), of("in3")};
        if (id == "\"ND_add_float\"") return number(of("in1") + of("in2"));
        if (id == "\"ND_subtract_float\"") return number(of("in1") - of("in2"));
        if (id == "\"ND_multiply_float\"") return number(of("in1") * of("in2"));
        if (id == "\"ND_divide_float\"") return number(of("in1") / of("in2"));
        if (id == "\"ND_max_float\"") return number(std::max(of("in1"), of("in2")));
        if (id == "\"ND_power_float\"") return number(std::pow(of("in1"), of("in2")));
        if (id == "\"ND_sqrt_float\"") return number(std::sqrt(of("in")));
        if (id == "\"ND_sign_float\"")
            return number(static_cast<float>((of("in") > 0.0f) - (of("in") < 0.0f)));
        if (id == "\"ND_mix_float\"") return number(of("bg") * (1.0f - of("mix")) + of("fg") * of("mix"));
        if (id == "\"ND_mix_color3\"")
            return input(prim, "color3f", "bg") * (1.0f - of("mix")) +
                   input(prim, "color3f", "fg") * of("mix");
        ADD_FAILURE() << node << ": MaterialX has no " << id << " that this test knows";
        return glm::vec3(0.0f);
    }

    const std::string& stage_;
    glm::vec3 slope_variance_;
    float coverage_;
    std::map<std::string, glm::vec3> values_;
};

// MaterialX's roughness_anisotropy, of which standard_surface makes its microfacets: α along the tangent and across.
glm::dvec2 alphas(double roughness, double anisotropy) {
    const double alpha = std::clamp(roughness * roughness, 1e-8, 1.0);
    if (!(anisotropy > 0.0)) return {alpha, alpha};
    const double aspect = std::sqrt(1.0 - std::min(anisotropy, 0.98));
    return {std::min(alpha / aspect, 1.0), alpha * aspect};
}

TEST_F(StageLightTest, MicrofacetsHaveTheTensorsAxes) {
    const std::string stage = baked(small_scene());
    std::mt19937 random(5);
    const auto uniform = [&] { return std::uniform_real_distribution<double>()(random); };
    struct Tensor {
        double large, small, angle;
    };
    std::vector<Tensor> tensors{{0.02, 0.02, 0.0},        {0.02, 0.01, 0.0}, {0.02, 0.01, 0.5 * kPi},
                                {0.02, 0.01, 0.25 * kPi}, {0.02, 0.0, 1.0},  {0.02, 0.0, 0.5 * kPi},
                                {0.0, 0.0, 0.0},          {1e-5, 1e-6, 2.0}};
    for (int i = 0; i < 300; ++i) {
        const double large = std::pow(10.0, -4.0 + 3.5 * uniform());
        tensors.push_back({large, large * uniform(), kPi * uniform()});
    }
    for (const auto& [large, small, angle] : tensors) {
        const double x = std::cos(angle), y = std::sin(angle);
        const glm::dvec3 sigma(large * x * x + small * y * y, large * y * y + small * x * x,
                               (large - small) * x * y);
        SCOPED_TRACE(::testing::Message() << large << " " << small << " at " << angle);
        Network network(stage, glm::vec3(sigma), 0.0f);
        const double roughness = network.surface("float", "specular_roughness").x;
        const double anisotropy = network.surface("float", "specular_anisotropy").x;
        const glm::dvec3 tangent(network.surface("float3", "tangent"));
        ASSERT_TRUE(std::isfinite(roughness) && std::isfinite(anisotropy) &&
                    std::isfinite(glm::length(tangent)));
        EXPECT_NEAR(glm::length(tangent), 1.0, 1e-5);
        EXPECT_EQ(tangent.z, 0.0);
        const glm::dvec2 alpha = alphas(roughness, anisotropy);
        // No smoother than the sun's disc is wide, and no narrower than MaterialX can be.
        const double along = std::sqrt(2.0 * std::max(large, 1e-6));
        EXPECT_NEAR(alpha.x, along, 1e-3 * along);
        EXPECT_NEAR(alpha.y, std::max(std::sqrt(2.0 * small), 0.02 * along), 2e-3 * along);
        // Along the axis of the larger variance, as far as there is one.
        const double seen = tangent.x * tangent.x * sigma.x + tangent.y * tangent.y * sigma.y +
                            2.0 * tangent.x * tangent.y * sigma.z;
        EXPECT_NEAR(seen, large, 1e-6 + 1e-5 * large);
    }
}

// A metre of it, as the surface's words put it, takes what the coefficients do; the scattered part goes all ways alike.
TEST_F(StageLightTest, WaterLetsThroughWhatItsCoefficientsLeave) {
    Scene scene = small_scene();
    for (const WaterType type : {WaterType::Ocean, WaterType::Jerlov5C}) {
        scene.water.type = type;
        const std::string stage = baked(scene);
        Network network(stage, glm::vec3(0.0f), 0.0f);
        const WaterBody water = make_water(scene);
        EXPECT_EQ(network.surface("float", "transmission_depth").x, 1.0f);
        const glm::vec3 scattered = network.surface("color3f", "transmission_scatter"),
                        left = network.surface("color3f", "transmission_color");
        for (int c = 0; c < 3; ++c) {
            EXPECT_GT(left[c], 0.0f);
            EXPECT_NEAR(-std::log(left[c]) - scattered[c], water.absorption_per_m[c], 1e-5);
            EXPECT_NEAR(0.5f * scattered[c], water.backscatter_per_m[c], 1e-6);
        }
    }
}

TEST_F(StageLightTest, FoamCoversTheWater) {
    const std::string stage = baked(small_scene());
    const glm::dvec3 foam = vector_in(prim_of(stage, "def Shader \"BaseColor\"").at("color3f inputs:fg"));
    for (const float coverage : {0.0f, 0.25f, 1.0f}) {
        Network network(stage, glm::vec3(0.01f, 0.01f, 0.0f), coverage);
        const glm::dvec3 expected = glm::mix(water_color(stage), foam, static_cast<double>(coverage));
        EXPECT_LT(largest(glm::abs(glm::dvec3(network.surface("color3f", "base_color")) - expected)), 1e-6);
        EXPECT_EQ(network.surface("float", "specular").x, 1.0f - coverage);
    }
}

// A bake shows nothing of it, and doesn't read it.
TEST_F(StageLightTest, NeedsNoPictureOfFoam) {
    Scene scene = small_scene();
    scene.effects.foam_pattern = folder_ / "none.exr";
    EXPECT_FALSE(check_scene(scene).empty());
    EXPECT_NE(baked(scene), "");
}

// A scene needn't come from a shot file, whose paths are looked at with it.
TEST_F(StageLightTest, APipeInTheSkysPlaceIsNotWaitedFor) {
    Scene scene = small_scene();
    scene.light.sky = folder_ / "pipe.exr";
    ASSERT_EQ(mkfifo(scene.light.sky.c_str(), 0600), 0);
    EXPECT_EQ(check_sky(scene).size(), 1u);
    EXPECT_THROW(make_sky(scene), std::invalid_argument);
    EXPECT_THROW(picture_content(scene), std::invalid_argument);
    EXPECT_THROW(baked(scene), std::invalid_argument);
}

}  // namespace
