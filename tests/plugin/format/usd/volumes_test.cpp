// The layer of a shot's volumes. That OpenUSD reads it, and that the files are there, is tested by
// bake.openusd_reads_stage.
#include "plugin/format/usd/volumes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>

namespace pelagic::usd {
namespace {

std::string text_of(const VolumeLayer& layer) {
    std::string text;
    write_volumes_text(layer, [&](std::string_view piece) { text += piece; });
    return text;
}

Volume spray() {
    return {.prim = "Spray",
            .file_prefix = "volumes/a-b.spray.",
            .fields = {{"density", "fogVolume"}, {"velocity", "unknown", true}},
            .extent = {glm::vec3(-40, -40.5f, -8), glm::vec3(44, 44, 0.1f)}};
}
Volume level_set() {
    return {.prim = "LevelSet",
            .file_prefix = "volumes/a-b.level-set.",
            .fields = {{"surface", "levelSet"}},
            .extent = {glm::vec3(-1), glm::vec3(1)}};
}

TEST(UsdVolumes, LayerIsThisPage) {
    EXPECT_EQ(volumes_file("a-b"), "a-b.volumes.usda");
    EXPECT_EQ(text_of({.fps = 25.0,
                       .first_frame = -1,
                       .last_frame = 1,
                       .frames = {-1, 0, 1},
                       .volumes = {spray(), level_set()}}),
              R"(#usda 1.0
(
    defaultPrim = "Volumes"
    endTimeCode = 1
    framesPerSecond = 25
    metersPerUnit = 1
    startTimeCode = -1
    timeCodesPerSecond = 25
    upAxis = "Z"
)

def Scope "Volumes"
{
    def Volume "Spray"
    {
        float3[] extent = [(-40, -40.5, -8), (44, 44, 0.1)]
        rel field:density = </Volumes/Spray/density>
        rel field:velocity = </Volumes/Spray/velocity>

        def OpenVDBAsset "density"
        {
            token fieldClass = "fogVolume"
            token fieldDataType = "float"
            token fieldName = "density"
            asset filePath = @./volumes/a-b.spray.-001.vdb@
            asset filePath.timeSamples = {
                -1: @./volumes/a-b.spray.-001.vdb@,
                0: @./volumes/a-b.spray.0000.vdb@,
                1: @./volumes/a-b.spray.0001.vdb@,
            }
        }

        def OpenVDBAsset "velocity"
        {
            token fieldClass = "unknown"
            token fieldDataType = "float3"
            token fieldName = "velocity"
            token vectorDataRoleHint = "Vector"
            asset filePath = @./volumes/a-b.spray.-001.vdb@
            asset filePath.timeSamples = {
                -1: @./volumes/a-b.spray.-001.vdb@,
                0: @./volumes/a-b.spray.0000.vdb@,
                1: @./volumes/a-b.spray.0001.vdb@,
            }
        }
    }

    def Volume "LevelSet"
    {
        float3[] extent = [(-1, -1, -1), (1, 1, 1)]
        rel field:surface = </Volumes/LevelSet/surface>

        def OpenVDBAsset "surface"
        {
            token fieldClass = "levelSet"
            token fieldDataType = "float"
            token fieldName = "surface"
            asset filePath = @./volumes/a-b.level-set.-001.vdb@
            asset filePath.timeSamples = {
                -1: @./volumes/a-b.level-set.-001.vdb@,
                0: @./volumes/a-b.level-set.0000.vdb@,
                1: @./volumes/a-b.level-set.0001.vdb@,
            }
        }
    }
}
)");
}

// Long shots come in pieces.
TEST(UsdVolumes, EveryFrameHasItsFile) {
    constexpr int kFrames = 40000;
    constexpr int kLast = std::numeric_limits<int>::max();
    std::string text;
    int pieces = 0;
    std::vector<int> frames(kFrames);
    std::ranges::generate(frames,
                          [frame = kLast - kFrames]() mutable { return ++frame; });  // iota goes one beyond
    write_volumes_text(
        {.first_frame = frames.front(), .last_frame = kLast, .frames = frames, .volumes = {level_set()}},
        [&](std::string_view piece) {
            text += piece;
            ++pieces;
        });
    EXPECT_GT(pieces, 1);
    int frame = kLast - kFrames, samples = 0;
    for (std::size_t at = text.find(": @./volumes/"); at != std::string::npos;
         at = text.find(": @./volumes/", at + 1)) {
        const std::string number = std::to_string(++frame);
        ASSERT_EQ(text.substr(at - number.size(), text.find(",\n", at) - at + number.size()),
                  number + ": @./volumes/a-b.level-set." + number + ".vdb@");
        ++samples;
    }
    EXPECT_EQ(samples, kFrames);
    EXPECT_TRUE(text.ends_with("            }\n        }\n    }\n}\n"));
}

TEST(UsdVolumes, RefusesWhatNoStageCanSay) {
    const auto refuses = [](const VolumeLayer& layer) {
        bool called = false;
        EXPECT_THROW(write_volumes_text(layer, [&](std::string_view) { called = true; }),
                     std::invalid_argument);
        EXPECT_FALSE(called) << "a part of a layer was handed over";
    };
    refuses({.fps = 0.0, .frames = {1}, .volumes = {level_set()}});
    Volume endless = level_set();
    endless.extent[1].y = std::numeric_limits<float>::infinity();
    refuses({.frames = {1}, .volumes = {endless}});
}

// A fog's material scatters all that its density takes away; a level set has none.
TEST(UsdVolumes, FogHasAMaterial) {
    Volume fog = spray();
    fog.mean_cosine = 0.85f;
    const std::string text = text_of({.frames = {1}, .volumes = {fog, level_set()}});
    for (const char* line :
         {"    def Volume \"Spray\" (\n        prepend apiSchemas = [\"MaterialBindingAPI\"]\n    )\n",
          "        rel material:binding = </Volumes/Spray/Medium>\n",
          "token outputs:mtlx:volume.connect = </Volumes/Spray/Medium/Volume.outputs:out>\n",
          "float inputs:anisotropy = 0.85\n", "float3 inputs:absorption = (0, 0, 0)\n",
          "float3 inputs:scattering.connect = </Volumes/Spray/Medium/Extinction.outputs:out>\n",
          "string inputs:geomprop = \"density\"\n", "    def Volume \"LevelSet\"\n    {\n"})
        EXPECT_NE(text.find(line), std::string::npos) << line << text;
    EXPECT_EQ(text_of({.frames = {1}, .volumes = {level_set()}}).find("Material"), std::string::npos);
    // Brackets of all kinds are closed.
    for (const char* pair : {"{}", "()", "[]", "<>"})
        EXPECT_EQ(std::count(text.begin(), text.end(), pair[0]),
                  std::count(text.begin(), text.end(), pair[1]))
            << pair;
    fog.mean_cosine = std::numeric_limits<float>::quiet_NaN();
    EXPECT_THROW(text_of({.frames = {1}, .volumes = {fog}}), std::invalid_argument);
}

}  // namespace
}  // namespace pelagic::usd
