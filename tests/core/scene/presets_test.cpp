// Presets: every one is a valid scene, and the Beaufort scale has the wave heights of the world's table.
#include "core/scene/presets.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>

#include "core/plan/prepared_scene.h"
#include "core/scene/shot_text.h"
#include "core/scene/validate.h"

namespace pelagic {
namespace {

double height_m(const Scene& scene) {
    return 4.0 * std::sqrt(prepare(scene)->spectrum.m0());
}

TEST(Presets, EveryOneIsAValidSceneOfItsOwn) {
    std::set<std::string> names, scenes;
    for (const Preset& preset : presets()) {
        Scene scene;
        apply(preset, scene);
        EXPECT_TRUE(validate(scene).empty()) << preset.name << ": " << text_of(validate(scene).front());
        EXPECT_TRUE(names.insert(preset.name).second) << preset.name;
        EXPECT_TRUE(scenes.insert(shot_text(scene, Scene{})).second) << preset.name;
        EXPECT_FALSE(preset.label.empty() || preset.help.empty()) << preset.name;
        EXPECT_EQ(find_preset(preset.name), &preset);
        // Again, over what another one left: nothing of it shows.
        Scene after = scene;
        apply(presets().back(), after);
        apply(preset, after);
        Scene tall;
        tall.sea.significant_height_m = 1.0;
        apply(preset, tall);
        EXPECT_FALSE(tall.sea.significant_height_m) << preset.name;
        if (preset.group == PresetGroup::Sea) {
            EXPECT_EQ(shot_text(after, Scene{}), shot_text(scene, Scene{})) << preset.name;
        }
    }
    EXPECT_EQ(find_preset("beaufort-13"), nullptr);
}

// WMO-No. 306, table 1100: limits of the wind's forces [m/s] and probable wave heights [m].
constexpr std::array<double, 13> kWindBelow_mps{0.3,  1.6,  3.4,  5.5,  8.0,  10.8, 13.9,
                                                17.2, 20.8, 24.5, 28.5, 32.7, 80.0};
constexpr std::array<double, 13> kHeight_m{0.0, 0.1, 0.2, 0.6, 1.0, 2.0, 3.0, 4.0, 5.5, 7.0, 9.0, 11.5, 14.0};

TEST(Presets, TheBeaufortScaleHasTheWorldsWindsAndWaves) {
    double wind_before_mps = -1.0, height_before_m = -1.0;
    for (int force = 0; force <= 12; ++force) {
        const auto i = static_cast<std::size_t>(force);
        const Preset* preset = find_preset("beaufort-" + std::to_string(force));
        ASSERT_NE(preset, nullptr) << force;
        EXPECT_EQ(preset->group, PresetGroup::Beaufort);
        Scene scene;
        apply(*preset, scene);
        EXPECT_LT(scene.sea.wind_speed_mps, kWindBelow_mps[i]) << force;
        EXPECT_GE(scene.sea.wind_speed_mps, force == 0 ? 0.0 : kWindBelow_mps[i - 1]) << force;
        EXPECT_GT(scene.sea.wind_speed_mps, wind_before_mps) << force;
        const double found_m = height_m(scene);
        EXPECT_GT(found_m, height_before_m) << force;
        if (force >= 4)
            EXPECT_NEAR(found_m, kHeight_m[i], 0.05 * kHeight_m[i]) << force;
        else
            EXPECT_LE(found_m, kHeight_m[i]) << force;
        wind_before_mps = scene.sea.wind_speed_mps;
        height_before_m = found_m;
    }
}

// What an edition gave it gives for good: from edition 3 on storms are seen from a trough.
TEST(Presets, StayAsTheirEditionsHadThem) {
    const auto framed = [](int edition) {
        Scene scene;
        scene.shot.edition = edition;
        apply(*find_preset("beaufort-10"), scene);
        return scene;
    };
    const Scene bare, second = framed(2), third = framed(3);
    EXPECT_EQ(framed(1).camera.position_m, bare.camera.position_m);
    EXPECT_EQ(second.camera.position_m, glm::dvec3(0.0, -60.0, 9.0));
    EXPECT_EQ(second.camera.look_at_m, glm::dvec3(0.0, 0.0, 7.5));
    EXPECT_EQ(second.light.sun_azimuth_deg, 195.0);
    EXPECT_LT(third.camera.position_m.z, 4.0);
    EXPECT_EQ(third.light.sun_azimuth_deg, 300.0);
    EXPECT_TRUE(third.effects.spray);
    EXPECT_FALSE(second.effects.spray);
}

TEST(Presets, ABuoysHourGivesWayToAPreset) {
    Scene scene;
    scene.sea.spectrum = SpectrumKind::File;
    scene.sea.measured.emplace();
    apply(*find_preset("beaufort-5"), scene);
    EXPECT_TRUE(validate(scene).empty());
}

}  // namespace
}  // namespace pelagic
