// Overscan and regions: which pixels are computed, and that they are those of the picture without.
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfStandardAttributes.h>
#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <glm/geometric.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/surface/view.h"
#include "plugin/render/picture_files.h"
#include "plugin/render/render.h"
#include "tests/plugin/render/uniform_sky.h"

namespace pelagic {
namespace {

constexpr int kWindowFrame = 5;

// Foam that lives, spray, glare and a shifted lens on its way: all that depends on a view.
Scene everything() {
    Scene scene;
    scene.quality.level = QualityLevel::Draft;
    scene.sea.wind_speed_mps = 16.0;
    scene.waves.cascades = {{250.0, 64}, {30.0, 64}};
    scene.effects.foam_decay_s = 1.5;
    scene.effects.spray = true;
    scene.camera.resolution = {80, 48};
    scene.camera.shift_x = 0.1;
    scene.camera.glare = 0.1;
    scene.camera.keys = {{.frame = 1, .position_m = {0.0, -60.0, 12.0}, .look_at_m = {0.0, 0.0, 4.0}},
                         {.frame = 9, .position_m = {8.0, -56.0, 13.0}, .look_at_m = {20.0, 0.0, 8.0}}};
    return scene;
}

RenderOptions options_of(const Scene& scene, int samples, double shutter_frames) {
    RenderOptions options = render_options(scene);
    options.samples = samples;
    options.shutter_frames = shutter_frames;
    options.layers.set();
    return options;
}

Picture windowed_picture(const Scene& scene, const RenderOptions& options,
                         std::vector<double>* told = nullptr) {
    Renderer renderer(scene, options, uniform_sky(), std::array{kWindowFrame});
    Picture picture;
    BuildWatch watch;
    if (told) watch.progress = [&](double done) { told->push_back(done); };
    renderer.render(kWindowFrame, picture, watch);
    return picture;
}

PixelWindow window_of(const Picture& picture) {
    return {picture.low, picture.low + picture.resolution};
}

std::size_t index_of(const Picture& picture, glm::ivec2 at) {
    at -= picture.low;
    return static_cast<std::size_t>(at.y) * static_cast<std::size_t>(picture.resolution.x) +
           static_cast<std::size_t>(at.x);
}

// Bit for bit, whatever is known of each of the window's pixels.
void expect_same(const Picture& a, const Picture& b, const PixelWindow& window) {
    int differ = 0;
    std::vector<SkylinePixel> of_a, of_b;
    const auto on_skyline = [&](const Picture& picture, std::size_t pixel) {
        for (const SkylinePixel& both : picture.skyline)
            if (both.pixel == pixel) return std::array{both.sky, both.light.x, both.light.y, both.light.z};
        return std::array{-1.0f, 0.0f, 0.0f, 0.0f};
    };
    for (int y = window.low.y; y < window.high.y; ++y)
        for (int x = window.low.x; x < window.high.x; ++x) {
            const std::size_t i = index_of(a, {x, y}), j = index_of(b, {x, y});
            bool is_same = std::memcmp(&a.layers[i], &b.layers[j], sizeof(SeaRadiance)) == 0 &&
                           a.sea[i] == b.sea[j] && on_skyline(a, i) == on_skyline(b, j);
            for (const PictureLayerRow& row : kPictureLayers) {
                if (row.light || (a.data[index(row.layer)].empty() && b.data[index(row.layer)].empty()))
                    continue;
                const auto &of = a.data[index(row.layer)], &other = b.data[index(row.layer)];
                is_same = is_same && std::memcmp(&of[i * row.components], &other[j * row.components],
                                                 row.components * sizeof(float)) == 0;
            }
            if (!a.alpha.empty()) is_same = is_same && a.alpha[i] == b.alpha[j];
            differ += !is_same;
        }
    EXPECT_EQ(differ, 0) << "of " << window.size().x * window.size().y << " pixels";
}

TEST(PictureWindow, PixelsAreThoseOfThePictureWithout) {
    const Scene scene = everything();
    struct Look {
        int samples;
        double shutter_frames;
        bool alpha;
    };
    for (const Look& look : {Look{2, 0.0, true}, {2, 0.5, false}}) {
        SCOPED_TRACE(testing::Message() << look.samples << " samples, shutter " << look.shutter_frames);
        RenderOptions options = options_of(scene, look.samples, look.shutter_frames);
        options.alpha = look.alpha;
        const Picture whole = windowed_picture(scene, options);
        EXPECT_EQ(window_of(whole), (PixelWindow{.high = {80, 48}}));
        EXPECT_FALSE(whole.display);

        if (look.shutter_frames == 0.0) {  // pictures of many passes take long
            options.region = {{13, 17}, {61, 39}};
            const Picture part = windowed_picture(scene, options);
            EXPECT_EQ(window_of(part), *options.region);
            EXPECT_EQ(display_size(part), glm::ivec2(80, 48));
            expect_same(part, whole, *options.region);
        }

        options.region.reset();
        options.overscan_px = {8, 5};
        const Picture wide = windowed_picture(scene, options);
        EXPECT_EQ(window_of(wide), (PixelWindow{{-8, -5}, {88, 53}}));
        expect_same(whole, wide, window_of(whole));

        options.region = {{-3, 20}, {30, 51}};
        const Picture corner = windowed_picture(scene, options);
        EXPECT_EQ(window_of(corner), *options.region);
        expect_same(corner, wide, *options.region);
    }
}

// Round the display window, too: the place that a pixel shows, seen through the camera, is at that pixel.
TEST(PictureWindow, OverscanIsOfTheSameLens) {
    const Scene scene = everything();
    RenderOptions options = options_of(scene, 1, 0.0);
    options.overscan_px = {20, 12};
    const Picture wide = windowed_picture(scene, options);
    const View view = view_at(scene.camera, kWindowFrame);
    int seen = 0;
    for (int y = -12; y < 60; ++y)
        for (int x = -20; x < 100; ++x) {
            const std::size_t i = index_of(wide, {x, y});
            if (!wide.sea[i] || (x >= 0 && x < 80 && y >= 0 && y < 48)) continue;
            const float* at = &wide.data[index(PictureLayer::Position)][3 * i];
            const glm::dvec3 way = glm::normalize(glm::dvec3(at[0], at[1], at[2]) - view.position_m);
            const glm::dvec3 looked = view.direction(glm::dvec2(x, y) + 0.5);
            ASSERT_LT(glm::length(way - looked), 0.01 * view.pixel_tangent()) << x << ' ' << y;
            ++seen;
        }
    EXPECT_GT(seen, 1500);
}

TEST(PictureWindow, ProgressRisesToTheEnd) {
    const Scene scene = everything();
    RenderOptions options = options_of(scene, 1, 0.0);
    options.overscan_px = {8, 5};
    std::vector<double> told;
    windowed_picture(scene, options, &told);
    for (std::size_t i = 1; i < told.size(); ++i) ASSERT_LE(told[i - 1], told[i] + 1e-12);
    ASSERT_FALSE(told.empty());
    EXPECT_NEAR(told.back(), 1.0, 1e-9);
}

class Bytes : public Imf::IStream {
  public:
    explicit Bytes(const std::string& bytes) : IStream("memory"), bytes_(bytes) {}
    bool read(char to[], int count) override {
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

// The EXR has both windows and the whole picture's camera; the PNG is the display window, with its own glare.
TEST(PictureWindow, FilesSayWhereTheirPixelsAre) {
    const Scene scene = everything();
    const Sky sky = uniform_sky();
    RenderOptions options = options_of(scene, 2, 0.0);
    const auto files = [&](const Picture& picture) {
        const PictureContext context{scene, options, sky, "0123456789abcdef", 1.0f};
        return std::pair(encode_exr(context, picture, kWindowFrame),
                         encode_png(context, picture, kWindowFrame));
    };
    const auto [whole_exr, whole_png] = files(windowed_picture(scene, options));
    options.overscan_px = {8, 5};
    const auto [wide_exr, wide_png] = files(windowed_picture(scene, options));
    EXPECT_TRUE(wide_png == whole_png);
    Bytes whole_bytes(whole_exr), wide_bytes(wide_exr);
    Imf::InputFile whole_file(whole_bytes), wide_file(wide_bytes);
    EXPECT_EQ(whole_file.header().dataWindow(), Imath::Box2i({0, 0}, {79, 47}));
    EXPECT_EQ(whole_file.header().displayWindow(), Imath::Box2i({0, 0}, {79, 47}));
    EXPECT_EQ(wide_file.header().dataWindow(), Imath::Box2i({-8, -5}, {87, 52}));
    EXPECT_EQ(wide_file.header().displayWindow(), Imath::Box2i({0, 0}, {79, 47}));
    EXPECT_EQ(Imf::worldToNDC(wide_file.header()), Imf::worldToNDC(whole_file.header()));

    options.overscan_px = {0, 0};
    options.region = {{13, 17}, {61, 39}};
    const auto [part_exr, part_png] = files(windowed_picture(scene, options));
    Bytes part_bytes(part_exr);
    EXPECT_EQ(Imf::InputFile(part_bytes).header().dataWindow(), Imath::Box2i({13, 17}, {60, 38}));
    // Width and height in the first chunk, big-endian.
    EXPECT_EQ(part_png.substr(16, 8), std::string("\0\0\0\x30\0\0\0\x16", 8));
}

// Other pixels have another fingerprint; without the options it is what it was.
TEST(PictureWindow, IsInTheFingerprint) {
    const Scene scene = everything();
    const auto of = [&](glm::ivec2 overscan_px, std::optional<PixelWindow> region) {
        RenderOptions options = options_of(scene, 1, 0.0);
        options.overscan_px = overscan_px;
        options.region = region;
        return PictureFingerprint({.scene = scene, .options = options, .picture_content = ""})
            .of(kWindowFrame);
    };
    const PixelWindow all{.high = {80, 48}}, part{{13, 17}, {61, 39}};
    EXPECT_EQ(of({0, 0}, all), of({0, 0}, {}));
    const std::vector<std::string> others{of({0, 0}, {}), of({8, 5}, {}), of({8, 0}, {}), of({0, 0}, part),
                                          of({0, 0}, PixelWindow{{13, 17}, {61, 40}})};
    for (std::size_t i = 0; i < others.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) EXPECT_NE(others[i], others[j]) << i << ' ' << j;
}

TEST(PictureWindow, WhatShowsNothingIsRefused) {
    const auto refused = [](glm::ivec2 overscan_px, std::optional<PixelWindow> region) {
        RenderOptions options;
        options.overscan_px = overscan_px;
        options.region = region;
        try {
            check_window({80, 48}, options);
        } catch (const std::invalid_argument& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    for (const glm::ivec2 overscan : {glm::ivec2(-1, 0), glm::ivec2(41, 0), glm::ivec2(0, 25)})
        EXPECT_NE(refused(overscan, {}).find("40,24"), std::string::npos) << overscan.x;
    using W = PixelWindow;
    for (const W& region : {W{{0, 0}, {81, 48}}, W{{-1, 0}, {20, 20}}, W{{5, 5}, {5, 9}}, W{{9, 9}, {5, 12}}})
        EXPECT_NE(refused({0, 0}, region).find("before 80,48"), std::string::npos) << region.low.x;
    EXPECT_NE(refused({8, 5}, W{{-8, 0}, {0, 20}}), "");  // of the overscan alone
    EXPECT_EQ(refused({8, 5}, W{{-8, 0}, {1, 20}}), "");
    EXPECT_EQ(refused({40, 24}, {}), "");
}

TEST(PictureWindow, MemoryIsOfThePixelsThatThereAre) {
    const Scene scene = everything();
    const auto bytes = [&](glm::ivec2 overscan_px, std::optional<PixelWindow> region) {
        RenderOptions options = options_of(scene, 1, 0.0);
        options.overscan_px = overscan_px;
        options.region = region;
        std::size_t of_pictures = 0;
        const MemoryNeed need = render_memory(scene, options, std::array{kWindowFrame}, 2, 2);
        for (const auto& part : need.parts())
            if (part.what == "pictures") of_pictures = part.bytes;
        return of_pictures;
    };
    const std::size_t whole = bytes({0, 0}, {});
    EXPECT_LT(bytes({0, 0}, PixelWindow{{0, 0}, {40, 24}}), whole / 3);
    EXPECT_GT(bytes({40, 24}, {}), 4 * whole);
}

}  // namespace
}  // namespace pelagic
