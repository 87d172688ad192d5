// The drops of spray that a bake writes. That other programs read them is tested by bake.three_reads_drops.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <utility>

#include "plugin/bake/bake.h"

namespace pelagic {
namespace {

namespace fs = std::filesystem;

Scene scene_of_drops() {
    Scene scene;
    scene.shot.name = "gale";
    scene.shot.last_frame = 3;
    scene.sea.wind_speed_mps = 18.0;
    scene.waves.cascades = {{200.0, 128}, {31.0, 64}};
    scene.surface.size_m = 40.0;
    scene.surface.resolution = 8;
    scene.effects.foam_decay_s = 0.0;
    scene.effects.spray = scene.effects.spray_drops = true;
    scene.output.drops = true;
    return scene;
}

RunReport baked(const Scene& scene, const fs::path& out, std::vector<int> frames = {}) {
    RunReport report =
        bake(scene, {.out = out, .frames = std::move(frames), .progress = {}, .cancel = nullptr});
    EXPECT_EQ(report.done + report.kept, report.total);
    return report;
}

std::string drops_bytes(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

TEST(BakedDrops, AFrameAloneHasTheBytesOfARun) {
    const fs::path folder = fs::path(testing::TempDir()) / "baked_drops";
    fs::remove_all(folder);
    Scene scene = scene_of_drops();
    baked(scene, folder / "run");
    const std::string frame = "drops/gale.0003.usdc";
    const std::string run = drops_bytes(folder / "run" / frame);
    EXPECT_GT(run.size(), 5000u);
    EXPECT_NE(drops_bytes(folder / "run/gale.usda").find("@./gale.drops.usda@"), std::string::npos);
    EXPECT_NE(drops_bytes(folder / "run/gale.drops.usda").find("\"./drops/gale.####.usdc\""),
              std::string::npos);
    EXPECT_TRUE(fs::exists(folder / "run/drops/gale.manifest.usda"));
    // Without a mesh, alone.
    scene.output.mesh = MeshFormat::None;
    baked(scene, folder / "alone", {3});
    EXPECT_TRUE(drops_bytes(folder / "alone" / frame) == run);
    EXPECT_FALSE(fs::exists(folder / "alone" / "drops/gale.0002.usdc"));
    // What is whole is kept, and with another sea made anew.
    EXPECT_EQ(baked(scene, folder / "alone", {3}).kept, 1);
    scene.effects.spray_gain = 2.0;
    EXPECT_EQ(baked(scene, folder / "alone", {3}).kept, 0);
    EXPECT_FALSE(drops_bytes(folder / "alone" / frame) == run);
}

TEST(BakedDrops, NoneIsAFileWithoutPoints) {
    const fs::path folder = fs::path(testing::TempDir()) / "baked_no_drops";
    fs::remove_all(folder);
    Scene scene = scene_of_drops();
    scene.shot.last_frame = 1;
    scene.sea.wind_speed_mps = 0.0;
    baked(scene, folder);
    const std::size_t bytes = drops_bytes(folder / "drops/gale.0001.usdc").size();
    EXPECT_GT(bytes, 200u);
    EXPECT_LT(bytes, 4000u);
}

}  // namespace
}  // namespace pelagic
