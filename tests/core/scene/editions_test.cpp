// Editions: what a shot means where it doesn't say.
#include "core/scene/editions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>

#include "core/scene/presets.h"
#include "core/scene/shot_text.h"
#include "core/scene/validate.h"

namespace pelagic {
namespace {

TEST(Editions, ChangeDefaultsOfKeysAndNothingElse) {
    int before = 1;
    std::set<std::string> seen;
    for (const EditionChange& change : edition_changes()) {
        EXPECT_GE(change.edition, std::max(before, 2)) << change.path;
        EXPECT_LE(change.edition, kNewestEdition) << change.path;
        before = change.edition;
        const Key& key = key_of(change.path);
        EXPECT_NE(fallback_in(change.edition - 1, key), fallback_in(change.edition, key)) << change.path;
        EXPECT_EQ(fallback_in(kNewestEdition, key), key.fallback) << change.path;
        EXPECT_TRUE(seen.insert(std::to_string(change.edition) + std::string(change.path)).second)
            << change.path;
    }
    EXPECT_EQ(shot_text(scene_of_edition(kNewestEdition), Scene{}), "");
    for (int edition = 1; edition <= kNewestEdition; ++edition) {
        const Scene scene = scene_of_edition(edition);
        EXPECT_TRUE(validate(scene).empty()) << edition;
        EXPECT_EQ(shot_text(scene), "[shot]\nedition = " + std::to_string(edition) + "\n");
    }
}

// The first edition's defaults, as they were when editions came.
TEST(Editions, TheFirstIsKept) {
    const Scene first = scene_of_edition(1);
    EXPECT_EQ(first.sea.growth, GrowthLaw::Height);
    EXPECT_EQ(first.waves.trains, 60);
    EXPECT_EQ(first.light.turbidity, 3.0);
    EXPECT_EQ(first.effects.whitecap_law, WhitecapLaw::Monahan1980);
    EXPECT_EQ(first.effects.spray_law, SpraySource::Monahan1986);
    EXPECT_FALSE(first.water.body);
}

// A preset in a scene of the first edition is what it was then: no camera, and Beaufort's are the wind sea alone.
TEST(Editions, PresetsAreThoseOfTheirTime) {
    for (const Preset& preset : presets()) {
        Scene scene = scene_of_edition(1);
        apply(preset, scene);
        EXPECT_TRUE(validate(scene).empty()) << preset.name;
        EXPECT_EQ(scene.sea.growth, GrowthLaw::Height) << preset.name;
        EXPECT_EQ(scene.waves.trains, 60) << preset.name;
        EXPECT_EQ(scene.light.turbidity, 3.0) << preset.name;
        EXPECT_EQ(scene.camera.position_m, Camera{}.position_m) << preset.name;
        EXPECT_EQ(scene.effects.whitecap_amount, 1.0) << preset.name;
        EXPECT_FALSE(scene.water.body) << preset.name;
        if (preset.group == PresetGroup::Beaufort) {
            Scene wind = scene_of_edition(1);
            wind.sea = scene.sea;
            EXPECT_EQ(shot_text(scene), shot_text(wind)) << preset.name;
        }
    }
}

// Parts of a look are taken by themselves, and together are all of it.
TEST(Presets, HaveParts) {
    const Preset& gale = *find_preset("north-sea-storm");
    Scene whole, light, rest;
    apply(gale, whole);
    apply(gale, light, PresetParts().set(static_cast<std::size_t>(PresetPart::Light)));
    EXPECT_EQ(light.light.sun_elevation_deg, whole.light.sun_elevation_deg);
    EXPECT_EQ(light.sea.wind_speed_mps, Scene{}.sea.wind_speed_mps);
    EXPECT_EQ(light.camera.position_m, Scene{}.camera.position_m);
    EXPECT_EQ(light.water.type, Scene{}.water.type);
    rest = light;
    apply(gale, rest, ~PresetParts().set(static_cast<std::size_t>(PresetPart::Light)));
    EXPECT_EQ(shot_text(rest), shot_text(whole));
}

// A storm's amount of foam is more than its bubbles are of, so that who takes one takes the other.
TEST(Presets, HaveBubblesWithTheirFoam) {
    const Preset& storm = *find_preset("beaufort-10");
    Scene whole, sea, water;
    apply(storm, whole);
    apply(storm, sea, PresetParts().set(static_cast<std::size_t>(PresetPart::Sea)));
    apply(storm, water, PresetParts().set(static_cast<std::size_t>(PresetPart::Water)));
    ASSERT_NE(whole.water.bubbles, Scene{}.water.bubbles);
    EXPECT_EQ(sea.water.bubbles, whole.water.bubbles);
    EXPECT_EQ(sea.effects.whitecap_amount, whole.effects.whitecap_amount);
    EXPECT_EQ(water.water.bubbles, Scene{}.water.bubbles);
    EXPECT_EQ(water.effects.whitecap_amount, Scene{}.effects.whitecap_amount);
}

}  // namespace
}  // namespace pelagic
