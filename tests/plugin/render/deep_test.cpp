// Deep pixels: laid over each other they are the picture, in rising distance, with the identifiers of a Cryptomatte.
#include "plugin/render/deep.h"

#include <ImfDeepFrameBuffer.h>
#include <ImfDeepScanLineInputFile.h>
#include <ImfHeader.h>
#include <ImfStringAttribute.h>
#include <gtest/gtest.h>
#include <oneapi/tbb/task_arena.h>

#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "plugin/render/cryptomatte.h"
#include "plugin/render/picture_files.h"
#include "plugin/render/render.h"
#include "tests/plugin/render/uniform_sky.h"

namespace pelagic {
namespace {

std::shared_ptr<const ObjectMesh> deep_box(glm::vec3 least, glm::vec3 most) {
    ObjectMeshData mesh;
    mesh.materials = {ObjectMaterial{.name = "paint", .colour = glm::vec3(0.6f, 0.3f, 0.1f)}};
    for (int i = 0; i < 8; ++i)
        mesh.points_m.emplace_back(i & 1 ? most.x : least.x, i & 2 ? most.y : least.y,
                                   i & 4 ? most.z : least.z);
    constexpr std::array<std::array<std::uint32_t, 4>, 6> kFaces{
        {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
    for (const auto& face : kFaces)
        for (const auto& corners : {std::array{0, 1, 2}, std::array{0, 2, 3}}) {
            const glm::vec3 across = glm::cross(mesh.points_m[face[1]] - mesh.points_m[face[0]],
                                                mesh.points_m[face[2]] - mesh.points_m[face[0]]);
            for (const int corner : corners) {
                mesh.triangles.push_back(face[static_cast<std::size_t>(corner)]);
                mesh.normals.push_back(glm::normalize(across));
            }
            mesh.material.push_back(0);
        }
    return std::make_shared<const ObjectMesh>(std::move(mesh));
}

// A gale with spray and its drops, a barge, a buoy and one that is held out.
Scene deep_scene() {
    Scene scene;
    scene.sea.wind_speed_mps = 24.0;
    scene.waves.cascades = {{600.0, 64}, {90.0, 64}};
    scene.quality.level = QualityLevel::Draft;
    scene.effects.spray = scene.effects.spray_drops = true;
    scene.effects.spray_gain = 20.0;
    scene.camera.resolution = {48, 28};
    scene.camera.position_m = {0.0, -45.0, 9.0};
    scene.camera.look_at_m = {0.0, 0.0, 8.0};
    SceneObject object;
    object.name = "barge";
    object.mesh = deep_box({-9, -3, -8}, {-1, 3, 12});
    scene.objects.push_back(object);
    object.name = "buoy";
    object.mesh = deep_box({2, -1, -8}, {3, 1, 11});
    scene.objects.push_back(object);
    object.name = "held out";
    object.mesh = deep_box({5, -3, -8}, {11, 3, 12});
    object.holdout = true;
    scene.objects.push_back(object);
    return scene;
}

RenderOptions deep_options(const Scene& scene) {
    RenderOptions options = render_options(scene);
    options.samples = 3;
    options.alpha = options.deep = true;
    options.layers = parse_picture_layers("object,reflection,cryptomatte,depth");
    return options;
}

Picture deep_picture(const Scene& scene, const RenderOptions& options) {
    Picture picture;
    Renderer(scene, options, uniform_sky(), std::array{1}).render(1, picture);
    return picture;
}

struct Flat {
    glm::dvec3 light{0.0};
    double alpha = 0.0;
    std::map<float, double> shares;
};
Flat flattened(std::span<const DeepSample> samples) {
    Flat flat;
    for (const DeepSample& sample : samples) {
        const double left = 1.0 - flat.alpha;
        flat.light += left * glm::dvec3(sample.light);
        flat.alpha += left * static_cast<double>(sample.alpha);
        flat.shares[sample.id] += left * static_cast<double>(sample.alpha);
    }
    return flat;
}

// The samples of a file, as another program reads them.
DeepPixels read_deep(const std::string& bytes, const std::string& name) {
    const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / name;
    std::ofstream(file, std::ios::binary) << bytes;
    DeepPixels pixels;
    {
        Imf::DeepScanLineInputFile in(file.c_str(), 0);
        const Imath::Box2i window = in.header().dataWindow();
        const int width = window.max.x - window.min.x + 1;
        EXPECT_NE(in.header().findTypedAttribute<Imf::StringAttribute>("manifest"), nullptr);
        for (int y = window.min.y; y <= window.max.y; ++y) {
            std::vector<std::uint32_t> counts(static_cast<std::size_t>(width));
            Imf::DeepFrameBuffer buffer;
            const auto base = [&](auto* first) {
                return reinterpret_cast<char*>(first) -
                       window.min.x * static_cast<std::ptrdiff_t>(sizeof(*first));
            };
            buffer.insertSampleCountSlice(
                Imf::Slice(Imf::UINT, base(counts.data()), sizeof(std::uint32_t), 0));
            std::array<std::vector<float*>, 7> at;
            constexpr std::array kNames{"R", "G", "B", "A", "Z", "ZBack", "id"};
            for (std::size_t c = 0; c < at.size(); ++c) {
                at[c].resize(counts.size());
                buffer.insert(kNames[c], Imf::DeepSlice(Imf::FLOAT, base(at[c].data()), sizeof(float*), 0,
                                                        sizeof(DeepSample)));
            }
            in.setFrameBuffer(buffer);
            in.readPixelSampleCounts(y);
            std::size_t samples = 0;
            for (const std::uint32_t count : counts) samples += count;
            std::vector<DeepSample> row(samples);
            DeepSample* next = row.data();
            for (std::size_t x = 0; x < counts.size(); next += counts[x], ++x) {
                const std::array<float*, 7> members{&next->light.x, &next->light.y, &next->light.z,
                                                    &next->alpha,   &next->z_m,     &next->z_back_m,
                                                    &next->id};
                for (std::size_t c = 0; c < at.size(); ++c) at[c][x] = members[c];
            }
            in.readPixels(y);
            pixels.counts.insert(pixels.counts.end(), counts.begin(), counts.end());
            pixels.samples.insert(pixels.samples.end(), row.begin(), row.end());
        }
    }
    std::filesystem::remove(file);
    return pixels;
}

bool same_bits(const DeepPixels& a, const DeepPixels& b) {
    return a.counts == b.counts && a.samples.size() == b.samples.size() &&
           std::memcmp(a.samples.data(), b.samples.data(), a.samples.size() * sizeof(DeepSample)) == 0;
}

// Of the file itself, whose light is in halves.
TEST(Deep, LaidOverEachOtherIsThePicture) {
    const Scene scene = deep_scene();
    const RenderOptions options = deep_options(scene);
    const Picture picture = deep_picture(scene, options);
    const Sky sky = uniform_sky();
    const DeepPixels deep = read_deep(
        encode_deep(
            {.scene = scene, .options = options, .sky = sky, .made_of = "0123456789abcdef", .exposure = 1.0f},
            picture, 1),
        "deep.exr");
    ASSERT_EQ(deep.counts.size(), picture.layers.size());
    double most = 0.0, brightest = 0.0;
    std::size_t first = 0, veils = 0, drops = 0, held = 0, mixed = 0;
    for (std::size_t i = 0; i < deep.counts.size(); ++i) {
        const std::span samples(deep.samples.data() + first, deep.counts[i]);
        first += deep.counts[i];
        float end_m = 0.0f;
        for (const DeepSample& sample : samples) {
            ASSERT_GE(sample.z_m, end_m);
            ASSERT_GE(sample.z_back_m, sample.z_m);
            ASSERT_TRUE(sample.alpha > 0.0f && sample.alpha <= 1.0f);
            end_m = sample.z_back_m;
            veils += sample.z_back_m > sample.z_m;
            drops += sample.id == 0.0f && sample.z_back_m == sample.z_m;
        }
        const Flat flat = flattened(samples);
        const glm::dvec3 beauty(light_of(picture, i));
        const double peak = std::max({beauty.x, beauty.y, beauty.z});
        brightest = std::max(brightest, peak);
        ASSERT_NEAR(flat.alpha, static_cast<double>(picture.alpha[i]), 1e-3) << i;
        for (int c = 0; c < 3; ++c) {
            ASSERT_NEAR(flat.light[c], beauty[c], 1e-3 * std::abs(beauty[c]) + 1e-4 * peak + 1e-7) << i;
            most = std::max(most, std::abs(flat.light[c] - beauty[c]) / std::max(beauty[c], 1e-6));
        }
        // What spray leaves of each is no more than the Cryptomatte's share, in whose ranks the one that is held out is, too.
        const float* const ranks = picture.data[index(PictureLayer::Cryptomatte)].data() + kMatteFloats * i;
        for (const auto& [id, share] : flat.shares) {
            if (id == 0.0f) continue;
            double ranked = 0.0;
            for (std::size_t rank = 0; rank < kMatteRanks; ++rank)
                if (ranks[2 * rank] == id) ranked += static_cast<double>(ranks[2 * rank + 1]);
            ASSERT_LE(share, ranked + kLeastVeil);  // of a veil that is too thin to be told
            ASSERT_NE(id, matte_id("held out"));
        }
        mixed += flat.shares.contains(kSeaMatte) && flat.shares.size() > 2;
        held += ranks[0] == matte_id("held out") && ranks[1] > 0.99f;
    }
    EXPECT_EQ(first, deep.samples.size());
    EXPECT_GT(veils, 500u);
    EXPECT_GT(drops, 20u);
    EXPECT_GT(held, 20u);
    EXPECT_GT(mixed, 5u);
    EXPECT_GT(brightest, 0.0);
    RecordProperty("most_error", std::to_string(most));
}

// A surface lies where the layer of depth has it, by the identifier of what is there.
TEST(Deep, SurfacesLieAtTheirDepth) {
    Scene scene = deep_scene();
    scene.effects.spray = scene.effects.spray_drops = false;
    RenderOptions options = deep_options(scene);
    options.samples = 1;
    const Picture picture = deep_picture(scene, options);
    std::size_t first = 0, seen = 0;
    for (std::size_t i = 0; i < picture.deep.counts.size(); ++i) {
        const float depth_m = picture.data[index(PictureLayer::Depth)][i];
        const float id = picture.data[index(PictureLayer::Cryptomatte)][kMatteFloats * i];
        const bool is_there = depth_m < 1e9f && id != matte_id("held out");
        ASSERT_EQ(picture.deep.counts[i], is_there ? 1u : 0u);
        if (!is_there) continue;
        const DeepSample& sample = picture.deep.samples[first++];
        ASSERT_NEAR(sample.z_m, depth_m, 1e-4f * depth_m);
        ASSERT_EQ(sample.z_back_m, sample.z_m);
        ASSERT_EQ(sample.alpha, 1.0f);
        ASSERT_EQ(sample.id, id);
        seen += id == matte_id("barge");
    }
    EXPECT_GT(seen, 50u);
}

TEST(Deep, IsTheSameOnAnyThreadsInPartsAndAlone) {
    Scene scene = deep_scene();
    scene.effects.spray_drops = false;  // each renderer would let them fly anew
    RenderOptions options = deep_options(scene);
    options.samples = 2;
    DeepPixels one;
    tbb::task_arena(1).execute([&] { one = deep_picture(scene, options).deep; });
    Picture after;
    Renderer renderer(scene, options, uniform_sky(), std::array{1, 2});
    renderer.render(2, after);
    renderer.render(1, after);
    EXPECT_TRUE(same_bits(one, after.deep));

    options.region = PixelWindow{{10, 8}, {30, 20}};
    const DeepPixels part = deep_picture(scene, options).deep;
    std::vector<std::size_t> begins{0};
    for (const std::uint32_t count : one.counts) begins.push_back(begins.back() + count);
    std::size_t at = 0, pixel = 0;
    for (int y = 8; y < 20; ++y)
        for (int x = 10; x < 30; ++x, ++pixel) {
            const auto of_all = static_cast<std::size_t>(48 * y + x);
            ASSERT_EQ(part.counts[pixel], one.counts[of_all]);
            ASSERT_EQ(std::memcmp(part.samples.data() + at, one.samples.data() + begins[of_all],
                                  part.counts[pixel] * sizeof(DeepSample)),
                      0);
            at += part.counts[pixel];
        }
    options.region.reset();
    options.overscan_px = {4, 3};
    const Picture wide = deep_picture(scene, options);
    EXPECT_EQ(wide.deep.counts.size(), 56u * 34u);
    options.deep = false;
    const Picture flat = deep_picture(scene, options);
    EXPECT_TRUE(flat.deep.counts.empty());
    EXPECT_EQ(std::memcmp(flat.layers.data(), wide.layers.data(), flat.layers.size() * sizeof(SeaRadiance)),
              0);
}

TEST(Deep, IsRefusedWithoutAlphaAndWithBlur) {
    Scene scene = deep_scene();
    RenderOptions options = deep_options(scene);
    check_render(scene, options);
    options.shutter_frames = 0.5;
    EXPECT_THROW(check_render(scene, options), std::invalid_argument);
    options.shutter_frames = 0.0;
    scene.camera.f_stop = 2.8;
    EXPECT_THROW(check_render(scene, options), std::invalid_argument);
    options.samples = 1;
    check_render(scene, options);
    options.alpha = false;
    EXPECT_THROW(check_render(scene, options), std::invalid_argument);
}

// Two kinds that take turns behind each other stay as many samples as a pixel may have, and none of their light is lost.
TEST(Deep, APixelHasNoMoreSamplesThanItMay) {
    std::vector<DeepSight> sights;
    for (int i = 0; i < 256; ++i)
        sights.push_back({.id = i % 2 ? 1.0f : 2.0f,
                          .z_m = 10.0f + 3.0f * static_cast<float>((37 * i) % 256),
                          .alpha = 0.9f / 256,
                          .light = glm::vec3(static_cast<float>(i)),
                          .veil = 0.05f / 256,
                          .veil_light = glm::vec3(1.0f)});
    std::vector<DeepSample> samples;
    const std::uint32_t count = add_deep_pixel(
        sights, [](float z_m) { return 1.0f - std::exp(-z_m / 300.0f); }, samples);
    ASSERT_EQ(count, samples.size());
    EXPECT_LE(samples.size(), most_deep_samples(256, 2, true));
    const Flat flat = flattened(samples);
    EXPECT_NEAR(flat.alpha, 0.95, 1e-5);
    EXPECT_NEAR(flat.light.x, 256.0 * 255.0 / 2.0 + 256.0, 0.1);
    // Surfaces take along what of the veil before them is too thin to be told.
    EXPECT_NEAR(flat.shares.at(1.0f), 0.45, kLeastVeil);
    EXPECT_NEAR(flat.shares.at(0.0f), 0.05, kLeastVeil);
    // By the profile some of the veil lies before 64 m, and more behind.
    double nearer = 0.0, left = 1.0;
    for (const DeepSample& sample : samples) {
        if (sample.id == 0.0f && sample.z_back_m <= 64.0f) nearer += left * static_cast<double>(sample.alpha);
        left *= 1.0 - static_cast<double>(sample.alpha);
    }
    EXPECT_GT(nearer, 0.1 * 0.05);
    EXPECT_LT(nearer, 0.6 * 0.05);
}

}  // namespace
}  // namespace pelagic
