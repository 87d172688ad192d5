// What the files of a picture hold, read back by OpenEXR's own reader.
#include "plugin/render/picture_files.h"

#include <ImfChannelList.h>
#include <ImfChromaticitiesAttribute.h>
#include <ImfFloatAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <gtest/gtest.h>
#include <unistd.h>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <tuple>
#include <utility>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/lighting/primaries.h"
#include "core/plan/fingerprint.h"
#include "core/plan/plan.h"
#include "core/scene/keys.h"
#include "core/surface/view.h"
#include "plugin/run/seals.h"

namespace pelagic {
namespace {

class MemoryStream : public Imf::IStream {
  public:
    explicit MemoryStream(const std::string& bytes) : IStream("memory"), bytes_(bytes) {}
    bool read(char to[], int count) override {
        if (at_ + static_cast<std::size_t>(count) > bytes_.size()) throw std::runtime_error("past the end");
        std::memcpy(to, bytes_.data() + at_, static_cast<std::size_t>(count));
        at_ += static_cast<std::size_t>(count);
        return at_ < bytes_.size();
    }
    std::uint64_t tellg() override { return at_; }
    void seekg(std::uint64_t at) override { at_ = at; }

  private:
    const std::string& bytes_;
    std::size_t at_ = 0;
};

struct Read {
    std::map<std::string, std::vector<float>> channels;
    std::map<std::string, Imf::PixelType> types;
    std::string fingerprint;
};

Read read(const std::string& bytes, glm::ivec2 resolution) {
    MemoryStream stream(bytes);
    Imf::InputFile file(stream);
    Read result;
    Imf::FrameBuffer buffer;
    const auto pixels = static_cast<std::size_t>(resolution.x) * resolution.y;
    for (auto c = file.header().channels().begin(); c != file.header().channels().end(); ++c) {
        std::vector<float>& values = result.channels[c.name()];
        values.resize(pixels);
        result.types[c.name()] = c.channel().type;
        buffer.insert(c.name(), Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(values.data()), sizeof(float),
                                           sizeof(float) * resolution.x));
    }
    file.setFrameBuffer(buffer);
    file.readPixels(0, resolution.y - 1);
    result.fingerprint = file.header().typedAttribute<Imf::StringAttribute>("fingerprint").value();
    return result;
}

Picture pattern(glm::ivec2 resolution) {
    Picture picture{.resolution = resolution, .layers = {}, .sea = {}};
    for (int i = 0; i < resolution.x * resolution.y; ++i) {
        const auto f = static_cast<float>(i);
        picture.layers.push_back({.sun = glm::vec3(100.0f + f, 0.0f, 3.0f),
                                  .sky = glm::vec3(0.1f * f, 1.0f, 2.0f),
                                  .sea = glm::vec3(0.01f, 0.02f, 0.03f * f),
                                  .foam = glm::vec3(0.5f, 0.25f * f, 0.125f),
                                  .air = glm::vec3(0.25f, 0.5f, 0.125f * f)});
        picture.sea.push_back(1);
    }
    return picture;
}

Sky some_sky(float sun_radiance) {
    Sky sky;
    sky.map = SkyMap(4, std::vector<glm::vec3>(16, glm::vec3(2.0f)));
    sky.sky_irradiance = glm::vec3(6.0f);
    sky.sun_radiance = glm::vec3(sun_radiance);
    return sky;
}

// Of row vectors, after the division.
glm::dvec3 through(const Imath::M44f& matrix, const glm::dvec3& p) {
    Imath::V3d from(p.x, p.y, p.z), to;
    Imath::M44d(matrix).multVecMatrix(from, to);
    return {to.x, to.y, to.z};
}

// What OpenEXR's standard attributes promise: a place that a pixel shows comes out at that pixel, and the camera's axes are x, y and z.
TEST(PictureFiles, SayTheirCameraTimeAndRateAsTheStandardHasIt) {
    Scene scene;
    scene.shot.fps = 23.976;
    scene.camera.position_m = {120.0, -40.0, 9.0};
    scene.camera.look_at_m = {150.0, 30.0, 2.0};
    scene.camera.shift_x = 0.1;
    scene.camera.shift_y = -0.2;
    scene.camera.resolution = {64, 36};
    const RenderOptions options;
    const Sky sky = some_sky(100.0f);
    const PictureContext context{scene, options, sky, "0123456789abcdef", 1.0f};
    const Picture picture = pattern(scene.camera.resolution);
    const std::string bytes = encode_exr(context, picture, 91);
    MemoryStream stream(bytes);
    Imf::InputFile file(stream);
    const Imf::Header& header = file.header();
    const View view = view_at(scene.camera, 91);
    for (const glm::dvec2 pixel : {glm::dvec2(0.5, 0.5), glm::dvec2(63.5, 20.5), glm::dvec2(31.0, 36.0)}) {
        const glm::dvec3 place = view.position_m + 37.0 * view.direction(pixel);
        const glm::dvec3 ndc = through(Imf::worldToNDC(header), place);
        EXPECT_NEAR(ndc.x * 64.0, pixel.x, 2e-3);
        EXPECT_NEAR(ndc.y * 36.0, pixel.y, 2e-3);
    }
    const glm::dvec3 seen = through(Imf::worldToCamera(header),
                                    view.position_m + 2.0 * view.right + 3.0 * view.up + 5.0 * view.forward);
    EXPECT_NEAR(seen.x, 2.0, 1e-4);
    EXPECT_NEAR(seen.y, 3.0, 1e-4);
    EXPECT_NEAR(seen.z, 5.0, 1e-4);
    EXPECT_EQ(Imf::framesPerSecond(header).n, 24000);
    EXPECT_EQ(Imf::framesPerSecond(header).d, 1001u);
    const Imf::TimeCode code = Imf::timeCode(header);  // 91 = 3 · 24 + 19
    EXPECT_EQ(code.seconds(), 3);
    EXPECT_EQ(code.frame(), 19);
    for (const int frame : {-1, 24 * 24 * 3600}) {
        const std::string other = encode_exr(context, picture, frame);
        MemoryStream other_stream(other);
        EXPECT_FALSE(Imf::hasTimeCode(Imf::InputFile(other_stream).header())) << frame;
    }
}

// The first row of the file is the picture's top one, each layer is where it belongs, and they add up: to a
// half's rounding, 2^-11 of each, and of the sum.
TEST(PictureFiles, LayersAreInPlaceAndAddUp) {
    const glm::ivec2 resolution(7, 5);
    const Picture picture = pattern(resolution);
    const Scene scene;
    const RenderOptions options;
    for (const float sun : {100.0f, 1e6f}) {
        const Sky sky = some_sky(sun);
        const PictureContext context{scene, options, sky, "0123456789abcdef", 1.0f};
        const Read file = read(encode_exr(context, picture, 12), resolution);
        EXPECT_EQ(file.channels.size(), 18u);
        EXPECT_EQ(file.fingerprint, "0123456789abcdef");
        // The sun's own radiance is beyond a half's range.
        EXPECT_EQ(file.types.at("sky.G"), sun > 65504.0f ? Imf::FLOAT : Imf::HALF);
        EXPECT_EQ(file.types.at("foam.G"), Imf::HALF);
        constexpr double kHalf = 1.0 / 2048.0;
        constexpr std::array<const char*, 3> kNames{"R", "G", "B"};
        for (std::size_t i = 0; i < picture.layers.size(); ++i)
            for (int c = 0; c < 3; ++c) {
                const std::string name = kNames[c];
                const auto value = [&](const std::string& layer) {
                    return static_cast<double>(file.channels.at(layer + name).at(i));
                };
                const SeaRadiance& layers = picture.layers[i];
                const auto near = [&](double got, float asked) {
                    EXPECT_NEAR(got, static_cast<double>(asked), kHalf * static_cast<double>(asked))
                        << name << i;
                };
                near(value("sun."), layers.sun[c]);
                near(value("sky."), layers.sky[c]);
                near(value("sea."), layers.sea[c]);
                near(value("foam."), layers.foam[c]);
                near(value("air."), layers.air[c]);
                const double sum =
                    value("sun.") + value("sky.") + value("sea.") + value("foam.") + value("air.");
                EXPECT_NEAR(value(""), sum, 2.0 * kHalf * sum);
            }
    }
}

// The header names each layer that R, G, B are the sum of.
TEST(PictureFiles, SayWhichLayersAddUp) {
    const Picture picture = pattern({7, 5});
    const Scene scene;
    const RenderOptions options;
    const Sky sky = some_sky(100.0f);
    const std::string bytes = encode_exr({scene, options, sky, "", 1.0f}, picture, 1);
    MemoryStream stream(bytes);
    const std::string content =
        Imf::InputFile(stream).header().typedAttribute<Imf::StringAttribute>("content").value();
    for (const PictureLayerRow& row : kPictureLayers)
        EXPECT_EQ(content.find(std::string(row.name)) != std::string::npos, is_light(row) && !row.of_objects)
            << row.name << ": " << content;
}

// A low sun's upper limb is brighter than its mean, which may still fit into halves: such pictures were refused.
TEST(PictureFiles, HoldTheDiscsUpperLimb) {
    const glm::ivec2 resolution(7, 5);
    Picture picture = pattern(resolution);
    Sky sky = some_sky(6e4f);
    sky.limb_high = glm::vec3(1.3f, 1.4f, 1.5f);
    for (SeaRadiance& pixel : picture.layers) pixel.sky = sky.limb_high * sky.sun_radiance;
    const Scene scene;
    const RenderOptions options;
    const Read file = read(encode_exr({scene, options, sky, "", 1.0f}, picture, 1), resolution);
    EXPECT_EQ(file.types.at("sky.G"), Imf::FLOAT);
}

// From high up the sun glitters where it stands higher than below the eye: night there says nothing of it.
TEST(PictureFiles, HoldTheSunOfPlacesFarAway) {
    const glm::ivec2 resolution(7, 5);
    Picture picture = pattern(resolution);
    for (SeaRadiance& pixel : picture.layers) pixel.sun = glm::vec3(1.3e5f);
    const Sky sky = daylight_sky({.sun_elevation_deg = -2.0}, 64);
    const RenderOptions options;
    Scene scene;
    scene.camera.position_m.z = 400e3;
    EXPECT_NO_THROW(encode_exr({scene, options, sky, "", 1.0f}, picture, 1));
    scene.camera.position_m.z = 4.0;
    scene.camera.keys = {{.frame = 1, .position_m = {0.0, 0.0, 4.0}},
                         {.frame = 9, .position_m = {0.0, 0.0, 1e5}}};
    EXPECT_NO_THROW(encode_exr({scene, options, sky, "", 1.0f}, picture, 1));
    scene.camera.keys.clear();
    EXPECT_THROW(encode_exr({scene, options, sky, "", 1.0f}, picture, 1), std::invalid_argument);
}

// Whole is a picture with this fingerprint and all of its bytes: one that was cut short is made again.
TEST(PictureFiles, AreWholeWithTheirFingerprintAndTheirEnd) {
    const Picture picture = pattern({64, 48});
    const Scene scene;
    const RenderOptions options;
    const Sky sky = some_sky(100.0f);
    const PictureContext context{scene, options, sky, "0123456789abcdef", 1.0f};
    const std::filesystem::path folder =
        std::filesystem::temp_directory_path() / ("pelagic-pictures-" + std::to_string(getpid()));
    std::filesystem::create_directory(folder);
    for (const auto& [name, bytes] : {std::pair{"sea.0001.exr", encode_exr(context, picture, 1)},
                                      {"sea.0001.png", encode_png(context, picture, 1)}}) {
        const std::filesystem::path file = folder / name;
        const auto write = [&](const std::string& content) {
            std::ofstream(file, std::ios::binary).write(content.data(), std::ssize(content));
        };
        const auto is_whole = [&](const std::string& made_of) {
            const BuildWatch watch;
            CheckProgress progress(watch, 0);
            const bool seems = seems_whole(file, made_of);
            EXPECT_LE(seems, picture_problem(file, progress).empty()) << name;
            return seems;
        };
        EXPECT_FALSE(is_whole("0123456789abcdef")) << name << " isn't there";
        write(bytes);
        EXPECT_TRUE(is_whole("0123456789abcdef")) << name;
        EXPECT_FALSE(is_whole("fedcba9876543210")) << name;
        for (const std::size_t cut : {std::size_t{1}, std::size_t{30}, bytes.size() / 2, bytes.size() - 9}) {
            write(bytes.substr(0, bytes.size() - cut));
            EXPECT_FALSE(is_whole("0123456789abcdef")) << name << " less " << cut;
        }
    }
    std::filesystem::remove_all(folder);
}

// Every byte of a picture counts: a bit of another value, a block of zeros, an end that is cut off or longer, and the
// bytes of another frame.
TEST(PictureFiles, ShowEveryDamage) {
    const Picture picture = pattern({24, 13});
    const Scene scene;
    const RenderOptions options;
    const Sky sky = some_sky(100.0f);
    const PictureContext context{scene, options, sky, "0123456789abcdef", 1.0f};
    const std::filesystem::path folder =
        std::filesystem::temp_directory_path() / ("pelagic-damaged-" + std::to_string(getpid()));
    std::filesystem::create_directory(folder);
    const BuildWatch watch;
    for (const auto& [extension, bytes, other] :
         {std::tuple{"exr", encode_exr(context, picture, 1), encode_exr(context, picture, 2)},
          {"png", encode_png(context, picture, 1), encode_png(context, picture, 2)}}) {
        const std::filesystem::path file = folder / picture_file(scene.shot, 1, extension);
        const auto problem_of = [&](const std::string& content) {
            std::ofstream(file, std::ios::binary).write(content.data(), std::ssize(content));
            CheckProgress progress(watch, 0);
            return picture_problem(file, progress);
        };
        EXPECT_EQ(problem_of(bytes), "") << extension;
        EXPECT_NE(problem_of(other), "") << "another frame's";
        EXPECT_NE(problem_of(""), "");
        EXPECT_NE(problem_of(bytes + '\0'), "") << extension;
        EXPECT_NE(problem_of(bytes + bytes), "") << extension;
        for (std::size_t at = 0; at < bytes.size(); ++at) {
            std::string damaged = bytes;
            damaged[at] = static_cast<char>(damaged[at] ^ (1 << at % 8));
            EXPECT_NE(problem_of(damaged), "") << extension << ": a bit of byte " << at;
            if (at % 16 != 0) continue;
            EXPECT_NE(problem_of(bytes.substr(0, at)), "") << extension << " cut to " << at;
            std::string zeros = bytes;
            zeros.replace(at, 64, std::min<std::size_t>(64, bytes.size() - at), '\0');
            if (zeros != bytes) {
                EXPECT_NE(problem_of(zeros), "") << extension << ": zeros from " << at;
            }
        }
    }
    std::filesystem::remove_all(folder);
}

// Files say which pictures of sky and foam they show, wherever these lie.
TEST(PictureFiles, AreOfAPictureWhateverItsFolder) {
    Scene here, there;
    here.effects.foam_pattern = "foam/lace.exr";
    there.effects.foam_pattern = "/mnt/foam/lace.exr";
    here.light.sky = "skies/noon.exr";
    there.light.sky = "/mnt/skies/noon.exr";
    const RenderOptions options;
    const auto of = [&](const Scene& scene, const char* content) {
        return PictureFingerprint({.scene = scene, .options = options, .picture_content = content}).of(1);
    };
    EXPECT_EQ(of(here, "one"), of(there, "one"));
    EXPECT_NE(of(here, "one"), of(here, "another"));
}

TEST(PictureFiles, ScreensShowTheSumWithTheExposure) {
    const glm::ivec2 resolution(3, 2);
    Picture picture{.resolution = resolution, .layers = std::vector<SeaRadiance>(6), .sea = {}};
    const Scene scene;
    const RenderOptions options;
    const Sky sky = some_sky(0.0f);
    const auto png = [&](float exposure) {
        return encode_png({scene, options, sky, "", exposure}, picture, 1);
    };
    const std::string black = png(1.0f);
    picture.layers[4].foam = glm::vec3(1.0f);
    const std::string foam = png(1.0f);
    EXPECT_NE(foam, black);
    EXPECT_NE(png(2.0f), foam);
    picture.layers[4] = {
        .sun = glm::vec3(0.25f), .sky = glm::vec3(0.25f), .sea = glm::vec3(0.5f), .foam = {}};
    EXPECT_EQ(png(1.0f), foam);
}

// Where a pixel shows sea and a sky brighter than white, it is the mean of what is shown of them; of their mean light it would be white.
TEST(PictureFiles, SkylinesAreMeansOfWhatIsShown) {
    Picture picture{.resolution = {1, 1}, .layers = std::vector<SeaRadiance>(1), .sea = {}};
    Scene scene;
    scene.camera.white_balance_k = 6500.0;  // as they are
    const RenderOptions options;
    const Sky sky = some_sky(0.0f);
    const PictureColours cut{.show =
                                 [](std::span<glm::vec3> lights) {
                                     for (glm::vec3& light : lights) light = glm::min(light, 1.0f);
                                 },
                             .shown_by = "cut"};
    const auto png = [&](float light) {
        picture.layers[0] = {.sun = {}, .sky = glm::vec3(light), .sea = {}, .foam = {}};
        return encode_png(
            {.scene = scene, .options = options, .sky = sky, .made_of = "", .exposure = 1.0f, .colours = cut},
            picture, 1);
    };
    const std::string white = png(1.0f), mean = png(0.1f + 0.9f * 0.25f);
    EXPECT_EQ(png(0.075f + 2.5f), white);
    picture.skyline = {{.pixel = 0, .sky = 0.25f, .light = glm::vec3(2.5f)}};
    EXPECT_EQ(png(0.075f + 2.5f), mean);
    scene.camera.glare = 0.1;  // of one pixel nothing goes elsewhere but out of the picture
    EXPECT_NE(png(0.075f + 2.5f), white);
    // What the sun's glint in a pixel's sea scatters isn't taken from its sky, which would be black.
    EXPECT_EQ(png(1e4f), white);
}

// A studio's display transform gets exposed light, and its values are those of the PNG; the EXR's primaries say what it holds.
TEST(PictureFiles, HaveTheColoursThatAreAskedFor) {
    const glm::ivec2 resolution(2, 1);
    Picture picture{.resolution = resolution, .layers = std::vector<SeaRadiance>(2), .sea = {}};
    picture.layers[0].sky = glm::vec3(0.25f, 0.5f, 0.0f);
    picture.layers[1].foam = glm::vec3(0.3f);
    Scene scene;
    scene.camera.white_balance_k = 6500.0;  // as they are
    const RenderOptions options;
    const Sky sky = some_sky(0.0f);
    std::vector<glm::vec3> asked;
    const PictureColours inverted{.show =
                                      [&](std::span<glm::vec3> lights) {
                                          asked.assign(lights.begin(), lights.end());
                                          for (glm::vec3& light : lights) light = glm::vec3(1.0f) - light;
                                      },
                                  .shown_by = "inverted"},
        acescg{.acescg = true};
    const auto png = [&](const PictureColours& colours) {
        return encode_png({.scene = scene,
                           .options = options,
                           .sky = sky,
                           .made_of = "",
                           .exposure = 2.0f,
                           .colours = colours},
                          picture, 1);
    };
    EXPECT_NE(png(inverted), png({}));
    ASSERT_EQ(asked.size(), 2u);
    EXPECT_EQ(asked[0], glm::vec3(0.5f, 1.0f, 0.0f));
    EXPECT_EQ(png(acescg), png({}));

    const std::string bytes = encode_exr(
        {.scene = scene, .options = options, .sky = sky, .made_of = "", .exposure = 2.0f, .colours = acescg},
        picture, 1);
    MemoryStream stream(bytes);
    const Imf::InputFile file(stream);
    EXPECT_EQ(file.header().typedAttribute<Imf::ChromaticitiesAttribute>("chromaticities").value().red,
              Imath::V2f(0.713f, 0.293f));
    EXPECT_EQ(file.header().typedAttribute<Imf::StringAttribute>("unit").value(), "kcd/m2, ACEScg");
    // Rows of the matrix add up to 1: white stays. Green of Rec. 709 is (0.3395, 0.9164, 0.1096) (Bradford), red (0.6131, 0.0702, 0.0206).
    const glm::dvec3 expected = conversion(kRec709, kAcesCg) * glm::dvec3(0.25, 0.5, 0.0);
    EXPECT_NEAR(expected.x, 0.25 * 0.6131 + 0.5 * 0.3395, 2e-4);
    EXPECT_NEAR(expected.y, 0.25 * 0.0702 + 0.5 * 0.9164, 2e-4);
    EXPECT_NEAR(expected.z, 0.25 * 0.0206 + 0.5 * 0.1096, 2e-4);
    Read found = read(bytes, resolution);
    for (const char* prefix : {"", "sky."})
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(found.channels[prefix + std::string(1, "RGB"[c])][0], expected[c], 1e-3 * expected[c])
                << prefix << c;
    EXPECT_NEAR(found.channels["foam.G"][1], 0.3f, 3e-4f);

    std::vector<std::string> made_of;
    for (const PictureColours& colours : {PictureColours{}, inverted, acescg})
        made_of.push_back(PictureFingerprint(
                              {.scene = scene, .options = options, .picture_content = "", .colours = colours})
                              .of(1));
    EXPECT_NE(made_of[0], made_of[1]);
    EXPECT_NE(made_of[0], made_of[2]);
    EXPECT_NE(made_of[1], made_of[2]);
}

// The keys that a picture depends on, by the table of keys; the camera is said as it is at the frame.
TEST(PictureFiles, NameTheKeysThatTheyDependOn) {
    const glm::ivec2 resolution(2, 2);
    const Scene scene;
    const RenderOptions options;
    const Sky sky = some_sky(1.0f);
    const std::string bytes = encode_exr({scene, options, sky, "", 1.0f}, pattern(resolution), 1);
    for (const Key& key : keys()) {
        // A sea that doesn't feel its floor, and one without rain or gusts' fronts, have the header that they had before any did.
        const bool is_given = !std::holds_alternative<std::monostate>(value_of(scene, key)) &&
                              key.path != kCoastKey && key.path != kRainKey && key.path != kFrontsKey;
        const bool is_said =
            (key.key_parts & key_parts(KeyPart::Clock, KeyPart::Waves, KeyPart::Foam, KeyPart::Gusts,
                                       KeyPart::Grid, KeyPart::Light, KeyPart::Water))
                .any();
        // OpenEXR ends names with a zero.
        EXPECT_EQ(bytes.find("pelagic." + key.path + '\0') != std::string::npos, is_given && is_said)
            << key.path;
    }
}

// By what is in their meshes, and only where there are some; nothing that is baked does.
TEST(PictureFiles, DependOnBodies) {
    Scene scene;
    scene.camera.resolution = {8, 6};
    scene.waves.cascades = {{.size_m = 50.0, .resolution = 32}};
    scene.output.maps = {MapKind::Displacement, MapKind::Floor};
    scene.output.volumes = {VolumeKind::LevelSet};
    const auto picture = [](const Scene& of) {
        return PictureFingerprint({.scene = of, .options = RenderOptions{}, .picture_content = ""}).of(1);
    };
    const auto baked = [](const Scene& of) {
        const Plan plan = plan_bake(of);
        std::string all;
        for (const PlannedOutput& output : plan.outputs) all += output_fingerprint(plan, output) + ' ';
        return all;
    };
    const glm::vec3 up(0.0f, 0.0f, 1.0f);
    ObjectMeshData mesh{.points_m = {{0.0f, 0.0f, 0.0f}, {1.0f, 0.0f, 0.0f}, {0.0f, 1.0f, 0.0f}},
                        .triangles = {0, 1, 2},
                        .normals = {up, up, up},
                        .material = {0},
                        .materials = {{.name = "paint"}}};
    Scene with = scene;
    with.objects = {{.file = "a/boat.obj", .mesh = std::make_shared<const ObjectMesh>(mesh)}};
    EXPECT_NE(picture(with), picture(scene));
    EXPECT_EQ(baked(with), baked(scene));
    Scene elsewhere = with;
    elsewhere.objects[0].file = "b/boat.obj";
    EXPECT_EQ(picture(elsewhere), picture(with));
    mesh.materials[0].colour.x = 0.5f;
    elsewhere.objects[0].mesh = std::make_shared<const ObjectMesh>(mesh);
    EXPECT_NE(picture(elsewhere), picture(with));
    elsewhere = with;
    elsewhere.objects[0].floats = true;
    EXPECT_NE(picture(elsewhere), picture(with));
}

// Every layer of the table under its channels' names, and no other; alpha; and what the numbers mean, in OpenEXR's own
// words.
TEST(PictureFiles, HoldTheLayersThatAreAskedFor) {
    const glm::ivec2 resolution(5, 3);
    Picture picture = pattern(resolution);
    const std::size_t pixels = picture.layers.size();
    for (const PictureLayerRow& row : kPictureLayers)
        for (std::size_t i = 0; !row.light && i < pixels * row.components; ++i)
            picture.data[index(row.layer)].push_back(static_cast<float>(i) / 64.0f);
    picture.alpha.assign(pixels, 0.5f);
    Scene scene;
    const Sky sky = some_sky(100.0f);
    for (const PictureLayerRow& asked : kPictureLayers) {
        RenderOptions options;
        options.layers.reset().set(index(asked.layer));
        scene.objects.resize(asked.of_objects ? 1 : 0);
        const std::string bytes = encode_exr({scene, options, sky, "", 1.0f}, picture, 1);
        const Read file = read(bytes, resolution);
        EXPECT_EQ(file.channels.size(), 4 + asked.components) << asked.name;  // with R, G, B and A
        EXPECT_EQ(file.channels.at("A").at(7), 0.5f);
        for (std::size_t c = 0; c < asked.components; ++c) {
            const std::vector<float>& values = file.channels.at(asked.channels[c]);
            for (std::size_t i = 0; i < pixels; ++i) {
                const float expected = asked.light
                                           ? (picture.layers[i].*asked.light)[static_cast<int>(c)]
                                           : picture.data[index(asked.layer)][i * asked.components + c];
                ASSERT_NEAR(values[i], expected, 5e-4f * expected) << asked.channels[c] << i;
            }
        }
    }
    scene.objects.clear();
    for (const char* light : {"daylight", "skies/noon.exr"}) {
        scene.light.sky = light;
        const RenderOptions options;
        const std::string bytes = encode_exr({scene, options, sky, "", 1.0f}, picture, 1);
        MemoryStream stream(bytes);
        const Imf::InputFile file(stream);
        const auto& primaries =
            file.header().typedAttribute<Imf::ChromaticitiesAttribute>("chromaticities").value();
        EXPECT_EQ(primaries.red, Imath::V2f(0.64f, 0.33f));
        EXPECT_EQ(primaries.white, Imath::V2f(0.3127f, 0.329f));
        // 1 is a thousand cd/m²; the unit of somebody's picture isn't known.
        const auto* white = file.header().findTypedAttribute<Imf::FloatAttribute>("whiteLuminance");
        ASSERT_EQ(white != nullptr, scene.light.sky == Light{}.sky);
        if (white) {
            EXPECT_EQ(white->value(), 1000.0f);
        }
    }
}

// What is asked for is a part of what a picture is made of.
TEST(PictureFiles, AreOfTheirShutterAlphaAndLayers) {
    const Scene scene;
    const auto of = [&](const auto& change) {
        RenderOptions options;
        change(options);
        return PictureFingerprint({.scene = scene, .options = options, .picture_content = ""}).of(1);
    };
    std::vector<std::string> all{
        of([](RenderOptions&) {}), of([](RenderOptions& o) { o.shutter_frames = 0.5; }),
        of([](RenderOptions& o) { o.shutter_frames = 0.25; }), of([](RenderOptions& o) { o.alpha = true; })};
    for (const PictureLayerRow& row : kPictureLayers) {
        const std::string flipped = of([&](RenderOptions& o) { o.layers.flip(index(row.layer)); });
        if (row.of_objects)
            EXPECT_EQ(flipped, all.front());  // there are none
        else
            all.push_back(flipped);
    }
    std::sort(all.begin(), all.end());
    EXPECT_EQ(std::adjacent_find(all.begin(), all.end()), all.end());
}

TEST(PictureFiles, NamesHaveFourDigits) {
    Shot shot;
    shot.name = "storm";
    EXPECT_EQ(picture_file(shot, 12, "exr"), "storm.0012.exr");
    EXPECT_EQ(picture_file(shot, 12345, "png"), "storm.12345.png");
}

}  // namespace
}  // namespace pelagic
