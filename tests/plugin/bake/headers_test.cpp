// What the files of a bake say about themselves: the keys that they depend on, by the table of keys.
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
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
        const bool is_given = !std::holds_alternative<std::monostate>(value);
        const bool is_in_map =
            (key.key_parts & key_parts(KeyPart::Clock, KeyPart::Waves, KeyPart::Maps)).any();
        // OpenEXR ends names with a zero.
        EXPECT_EQ(map.find("pelagic." + key.path + '\0') != std::string::npos, is_given && is_in_map)
            << key.path;
        const bool is_in_stage =
            (key.key_parts & key_parts(KeyPart::Clock, KeyPart::Waves, KeyPart::Foam, KeyPart::Gusts)).any();
        std::string identifier = key.path;
        identifier.replace(identifier.find('.'), 1, "_");
        EXPECT_EQ(stage.find(' ' + identifier + " = ") != std::string::npos, is_given && is_in_stage)
            << key.path;
    }
    EXPECT_NE(stage.find("string sea_swell = \"[{ height_m = 1, period_s = 9, direction_deg = 10 }]\""),
              std::string::npos);
    EXPECT_NE(stage.find("double sea_depth_m = inf"), std::string::npos);
    EXPECT_NE(stage.find("bool effects_whitecaps = true"), std::string::npos);
}

}  // namespace
}  // namespace pelagic
