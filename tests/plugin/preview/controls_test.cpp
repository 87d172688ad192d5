// What the panel gives back as a shot file.
#include "plugin/preview/controls.h"

#include <gtest/gtest.h>

namespace pelagic {
namespace {

TEST(ChangedKeys, NothingChangedIsNoText) {
    EXPECT_EQ(changed_keys(Scene{}, Scene{}), "");
}

TEST(ChangedKeys, OnlyWhatDiffersInTheTablesOfAShotFile) {
    Scene now;
    now.sea.wind_speed_mps = 12.5;
    now.sea.fetch_m = 1e5;
    now.sea.swell = {{.height_m = 1.5, .period_s = 11.0, .direction_deg = 80.0}};
    now.camera.position_m = {1e6, -2.5, 0.5};
    now.water.type = WaterType::Turbid;
    now.effects.whitecaps = false;
    EXPECT_EQ(changed_keys(Scene{}, now),
              "[sea]\n"
              "wind_speed_mps = 12.5\n"
              "fetch_m = 100000\n"
              "swell = [{ height_m = 1.5, period_s = 11, direction_deg = 80 }]\n"
              "\n[camera]\n"
              "position_m = [1000000, -2.5, 0.5]\n"
              "\n[water]\n"
              "type = \"turbid\"\n"
              "\n[effects]\n"
              "whitecaps = false\n");
}

TEST(Controls, BeginAsTheShotHasIt) {
    Scene scene;
    scene.shot.first_frame = 25;
    scene.effects.whitecaps = false;
    const Controls still = controls_for(scene);
    EXPECT_EQ(still.time_s, 1.0);  // frame 25 at 24 frames a second
    EXPECT_FALSE(still.draw.lighting.whitecaps);
    EXPECT_FALSE(still.repeat) << "a sea to be watched";
    scene.camera.keys = {{}, {.frame = 40}};
    EXPECT_TRUE(controls_for(scene).repeat) << "a shot to be watched";
}

}  // namespace
}  // namespace pelagic
