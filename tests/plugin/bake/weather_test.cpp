// Bakes of a sea that changes: a frame alone is that of a run, byte for byte, and a changed key makes the files anew that it can change.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/scene/keys.h"
#include "plugin/bake/bake.h"

namespace pelagic {
namespace {

namespace fs = std::filesystem;

class WeatherBakes : public ::testing::Test {
  protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / ("pelagic-weather-" + std::to_string(getpid()));
        fs::remove_all(folder_);
    }
    void TearDown() override { fs::remove_all(folder_); }

    struct File {
        std::string fingerprint, content;  // the content without the fingerprint
    };
    // The files of a bake, by frame and path.
    std::map<int, std::map<std::string, File>> baked(const Scene& scene,
                                                     const std::vector<int>& frames = {}) {
        const fs::path out = folder_ / std::to_string(++made_);
        const RunReport report =
            bake(scene, {.out = out, .frames = frames, .progress = {}, .cancel = nullptr});
        std::ifstream record(report.record);
        const nlohmann::json json = nlohmann::json::parse(record);
        std::map<int, std::map<std::string, File>> files;
        for (const auto& [frame, entry] : json.at("frames").items())
            for (const auto& [path, about] : entry.at("files").items()) {
                std::ifstream stream(out / path, std::ios::binary);
                File file{about.at("fingerprint"), {std::istreambuf_iterator<char>(stream), {}}};
                for (std::size_t at; (at = file.content.find(file.fingerprint)) != std::string::npos;)
                    file.content.replace(at, file.fingerprint.size(), "made of");
                files[std::stoi(frame)][path] = file;
            }
        return files;
    }

    static Scene shot() {
        Scene scene;
        scene.shot.last_frame = 12;
        scene.waves.cascades = {{250.0, 96}, {60.0, 64}};
        scene.surface.size_m = 60.0;
        scene.surface.resolution = 16;
        scene.output.mesh = MeshFormat::Usda;
        scene.output.attributes = {MeshAttribute::Normal, MeshAttribute::Velocity,
                                   MeshAttribute::SlopeVariance, MeshAttribute::Whitecaps};
        return scene;
    }
    static void give(Scene& scene, std::vector<NumberKeys::Key> keys) {
        ASSERT_FALSE(set_value(scene, key_of("sea.wind_speed_mps"), NumberKeys{std::move(keys)}));
    }

    fs::path folder_;
    int made_ = 0;
};

TEST_F(WeatherBakes, OfAFrameAloneIsThatOfARun) {
    Scene scene = shot();
    scene.effects.foam_decay_s = 1.0;
    scene.output.maps = {MapKind::Displacement, MapKind::Whitecaps};
    give(scene, {{1, 8.0}, {12, 20.0}});
    ASSERT_FALSE(set_value(scene, key_of("waves.choppiness"), NumberKeys{{{1, 0.0}, {12, 1.4}}}));
    const auto run = baked(scene, {6, 7, 8}), alone = baked(scene, {7});
    ASSERT_EQ(run.size(), 3u);
    for (const auto& [path, file] : alone.at(7)) {
        EXPECT_EQ(run.at(7).at(path).fingerprint, file.fingerprint) << path;
        EXPECT_TRUE(run.at(7).at(path).content == file.content) << path;
    }
    EXPECT_FALSE(run.at(6).begin()->second.fingerprint == run.at(7).begin()->second.fingerprint);
}

// Files with the same fingerprint are the same; and without what is of all keys, those with another one are others.
TEST_F(WeatherBakes, AKeyChangesTheFilesThatItCan) {
    for (const double decay_s : {0.0, 0.02})
        for (const double second_order : {0.0, 1.0}) {
            SCOPED_TRACE(std::to_string(decay_s) + ' ' + std::to_string(second_order));
            Scene scene = shot(), other = scene;
            for (Scene* each : {&scene, &other}) {
                each->effects.foam_decay_s = decay_s;
                each->effects.breaking_from_m = 2.0;
                each->waves.second_order = second_order;
            }
            give(scene, {{2, 8.0}, {5, 16.0}, {8, 12.0}, {10, 12.0}});
            give(other, {{2, 8.0}, {5, 16.0}, {8, 14.0}, {10, 12.0}});
            const auto a = baked(scene), b = baked(other);
            int kept = 0;
            for (const auto& [frame, files] : a)
                for (const auto& [path, file] : files) {
                    const File& there = b.at(frame).at(path);
                    const bool is_made_alike = file.fingerprint == there.fingerprint;
                    kept += is_made_alike;
                    if (is_made_alike) {
                        EXPECT_TRUE(file.content == there.content) << frame;
                    }
                    if (second_order == 0.0 && decay_s == 0.0) {
                        EXPECT_EQ(is_made_alike, file.content == there.content) << frame;
                    }
                }
            if (second_order == 0.0 && decay_s == 0.0) {
                EXPECT_EQ(kept, 8);  // of frames 1 … 5 and 10 … 12
            }
        }
}

// Velocities know how fast it changes, at a key on either side.
TEST_F(WeatherBakes, AKeyOfTheDisplacementChangesTheFilesThatItCan) {
    Scene scene = shot(), other = scene;
    for (Scene* each : {&scene, &other}) each->effects.foam_decay_s = each->waves.second_order = 0.0;
    const Key& key = key_of("waves.choppiness");
    ASSERT_FALSE(set_value(scene, key, NumberKeys{{{2, 0.4}, {5, 1.2}, {8, 0.7}, {10, 0.8}}}));
    ASSERT_FALSE(set_value(other, key, NumberKeys{{{2, 0.4}, {5, 1.2}, {8, 0.9}, {10, 0.8}}}));
    const auto a = baked(scene), b = baked(other);
    for (const auto& [frame, files] : a)
        for (const auto& [path, file] : files) {
            const File& there = b.at(frame).at(path);
            EXPECT_EQ(file.fingerprint == there.fingerprint, file.content == there.content) << frame;
            EXPECT_EQ(file.fingerprint == there.fingerprint, frame < 5 || frame > 10) << frame;
        }
}

// Phases are sums over the depths that have been: of a frame alone as well, and whatever comes after the next keys.
TEST_F(WeatherBakes, AKeyOfTheDepthChangesTheFilesThatItCan) {
    for (const auto interpolation : {CameraInterpolation::Linear, CameraInterpolation::Smooth}) {
        Scene scene = shot(), other = scene;
        const Key& key = key_of("sea.depth_m");
        for (Scene* each : {&scene, &other}) {
            each->shot.last_frame = 14;
            each->effects.foam_decay_s = each->waves.second_order = each->waves.lean_deg = 0.0;
            each->effects.breaking_from_m = 2.0;
        }
        ASSERT_FALSE(set_value(
            scene, key, NumberKeys{{{2, 20.0}, {5, 8.0}, {8, 6.0}, {10, 4.0}, {12, 3.0}}, interpolation}));
        ASSERT_FALSE(set_value(
            other, key, NumberKeys{{{2, 20.0}, {5, 8.0}, {8, 6.0}, {10, 5.0}, {12, 3.0}}, interpolation}));
        const auto a = baked(scene), b = baked(other), alone = baked(scene, {11});
        // A smooth way to a key goes by the one after it.
        const int first = interpolation == CameraInterpolation::Smooth ? 6 : 8;
        for (const auto& [frame, files] : a)
            for (const auto& [path, file] : files) {
                const File& there = b.at(frame).at(path);
                EXPECT_EQ(file.fingerprint == there.fingerprint, frame < first) << frame << ' ' << path;
                EXPECT_EQ(file.content == there.content, frame < first) << frame << ' ' << path;
            }
        for (const auto& [path, file] : alone.at(11)) {
            EXPECT_EQ(file.fingerprint, a.at(11).at(path).fingerprint);
            EXPECT_TRUE(file.content == a.at(11).at(path).content) << path;
        }
    }
}

}  // namespace
}  // namespace pelagic
