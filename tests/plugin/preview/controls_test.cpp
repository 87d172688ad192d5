// What the panel shows, and how it begins.
#include "plugin/preview/controls.h"

#include <gtest/gtest.h>

#include "core/scene/keys.h"

namespace pelagic {
namespace {

// What the panel shows is in the table of keys, and each slider moves within what its key accepts.
TEST(Panel, ShowsKeysOfTheTable) {
    for (const PanelSection& section : panel_sections()) {
        EXPECT_FALSE(section.paths.empty()) << section.title;
        for (const std::string_view path : section.paths) {
            const Key* key = find_key(path);
            ASSERT_NE(key, nullptr) << path;
            EXPECT_TRUE(key->is_built && key->set) << path;
            EXPECT_FALSE(key->help.empty() || key->label.empty()) << path;
            const auto expect_slider = [](const Key& k) {
                ASSERT_TRUE(k.soft && k.range) << k.path;
                EXPECT_TRUE(k.range->holds(k.soft->low) && k.range->holds(k.soft->high)) << k.path;
                EXPECT_LT(k.soft->low, k.soft->high) << k.path;
                EXPECT_TRUE(!k.soft->is_logarithmic || k.soft->low > 0.0) << k.path;
            };
            if (key->type == KeyType::Number || key->type == KeyType::Integer) expect_slider(*key);
            for (const Key& inner : key->entry_keys) expect_slider(inner);
        }
    }
}

TEST(Controls, BeginAsTheShotHasIt) {
    Scene scene;
    scene.shot.first_frame = 25;
    scene.effects.whitecaps = false;
    const Controls still = controls_for(scene);
    EXPECT_EQ(still.frame, 25.0);
    EXPECT_FALSE(still.draw.lighting.whitecaps);
    EXPECT_FALSE(still.repeat) << "a sea to be watched";
    scene.camera.keys = {{}, {.frame = 40}};
    EXPECT_TRUE(controls_for(scene).repeat) << "a shot to be watched";
}

}  // namespace
}  // namespace pelagic
