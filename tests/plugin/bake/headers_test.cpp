// What the files of a bake say about themselves: the keys that they depend on, by the table of keys.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <glm/vec3.hpp>
#include <sstream>

#include "core/scene/keys.h"
#include "plugin/bake/bake.h"

namespace pelagic {
namespace {

std::string bytes_of_header(const std::filesystem::path& file) {
    std::ostringstream bytes;
    bytes << std::ifstream(file, std::ios::binary).rdbuf();
    return bytes.str();
}

TEST(Headers, NameTheKeysThatTheFilesDependOn) {
    Scene scene;
    scene.shot.last_frame = 1;
    scene.sea.swell = {{1.0, 9.0, 10.0}};
    scene.waves.cascades = {{100.0, 32}};
    scene.surface.resolution = 4;
    scene.output.maps = {MapKind::Displacement};
    scene.output.map_resolution = 16;
    const std::filesystem::path folder =
        std::filesystem::temp_directory_path() / ("pelagic-headers-" + std::to_string(getpid()));
    bake(scene, {.out = folder, .frames = {}, .progress = {}, .cancel = nullptr});
    const std::string stage = bytes_of_header(folder / "sea.usda");
    std::string map;
    for (const auto& entry : std::filesystem::directory_iterator(folder / "maps"))
        map = bytes_of_header(entry.path());
    std::filesystem::remove_all(folder);

    for (const Key& key : keys()) {
        const KeyValue value = value_of(scene, key);
        // A sea that doesn't feel its floor, and one without rain or gusts' fronts, have the files that they had before any did.
        const bool is_given = !std::holds_alternative<std::monostate>(value) && key.path != kCoastKey &&
                              key.path != kRainKey && key.path != kFrontsKey;
        const bool is_in_map =
            (key.key_parts & key_parts(KeyPart::Clock, KeyPart::Waves, KeyPart::Maps)).any();
        // OpenEXR ends names with a zero.
        EXPECT_EQ(map.find("pelagic." + key.path + '\0') != std::string::npos, is_given && is_in_map)
            << key.path;
        const bool is_in_stage =
            (key.key_parts & key_parts(KeyPart::Clock, KeyPart::Waves, KeyPart::Foam, KeyPart::Gusts)).any();
        std::string identifier = key.path;
        std::ranges::replace(identifier, '.', '_');
        EXPECT_EQ(stage.find(' ' + identifier + " = ") != std::string::npos, is_given && is_in_stage)
            << key.path;
    }
    EXPECT_NE(stage.find("string sea_swell = \"[{ height_m = 1, period_s = 9, direction_deg = 10 }]\""),
              std::string::npos);
    EXPECT_NE(stage.find("double sea_depth_m = inf"), std::string::npos);
    EXPECT_NE(stage.find("bool effects_whitecaps = true"), std::string::npos);
}

// The three floats that follow a place in a text, "(x, y, z".
glm::vec3 point_at(const std::string& text, std::size_t at) {
    glm::vec3 point(0.0f);
    std::sscanf(text.c_str() + at, "(%f, %f, %f", &point.x, &point.y, &point.z);
    return point;
}

// Round the sea at every frame, on surfaces that stay where they are; others have none.
TEST(Headers, HintOfExtentsHoldsEachFrame) {
    const std::filesystem::path folder =
        std::filesystem::temp_directory_path() / ("pelagic-extents-" + std::to_string(getpid()));
    for (const SurfaceKind kind : {SurfaceKind::Patch, SurfaceKind::ProjectedGrid}) {
        Scene scene;
        scene.shot.last_frame = 4;
        scene.sea.wind_speed_mps = 20.0;
        scene.waves.choppiness = 1.3;
        scene.surface.kind = kind;
        scene.surface.resolution = 32;
        scene.surface.cell_px = 64.0;
        scene.surface.size_m = 150.0;
        scene.output.mesh = MeshFormat::Usda;
        bake(scene, {.out = folder, .frames = {}, .progress = {}, .cancel = nullptr});
        const std::string stage = bytes_of_header(folder / "sea.usda");
        const std::size_t hint = stage.find("extentsHint = [");
        EXPECT_EQ(hint != std::string::npos, kind == SurfaceKind::Patch);
        for (int frame = 1; frame <= 4 && hint != std::string::npos; ++frame) {
            const std::string mesh =
                bytes_of_header(folder / ("mesh/sea.000" + std::to_string(frame) + ".usda"));
            const std::size_t low = mesh.find('(', mesh.find("extent.timeSamples")),
                              high = mesh.find('(', low + 1);
            ASSERT_NE(high, std::string::npos);
            const std::size_t hint_low = stage.find('(', hint), hint_high = stage.find('(', hint_low + 1);
            for (int axis = 0; axis < 3; ++axis) {
                EXPECT_LE(point_at(stage, hint_low)[axis], point_at(mesh, low)[axis]) << frame;
                EXPECT_GE(point_at(stage, hint_high)[axis], point_at(mesh, high)[axis]) << frame;
            }
            EXPECT_GT(point_at(mesh, high).z, 0.2f * point_at(stage, hint_high).z)
                << "the hint is far too large";
        }
        std::filesystem::remove_all(folder);
    }
}

}  // namespace
}  // namespace pelagic
