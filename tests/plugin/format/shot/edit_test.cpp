// A shot file with other values: they are there, and everything else stays.
#include "plugin/format/shot/edit_shot.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/scene/keys.h"
#include "core/scene/shot_text.h"
#include "plugin/format/shot/shot.h"
#include "tests/plugin/format/shot/no_check.h"

namespace pelagic {
namespace {

Scene read(const std::string& text) {
    return parse_shot(text, "edited.toml", no_check);
}

constexpr const char* kText = R"(# Größe ünd Wellen: ein Sturm
[shot]
edition = 2
name = "edited" # its name

[sea]
swell = [
    { height_m = 2.0, period_s = 11.0, direction_deg = 30.0 }, # from afar
]
wind_speed_mps = 14.0   # Böen bis 20
depth_m = 30.0
water = { type = "coastal" }
)";

std::string usual_text() {
    std::string text(kText);
    text.replace(text.find("water ="), std::string::npos, "[light] # sun\r\nturbidity = 3.0\r\n[effects]");
    return text;
}

void expect_edited(const std::string& text, const Scene& wanted, const std::string& edited) {
    EXPECT_EQ(shot_text(read(edited), wanted), "") << edited;
    EXPECT_EQ(shot_text(wanted, read(edited)), "") << edited;
    // All comments are still there, each once.
    for (std::size_t at = text.find('#'); at != std::string::npos; at = text.find('#', at + 1)) {
        const std::string comment = text.substr(at, text.find_first_of("\r\n", at) - at);
        const std::size_t found = edited.find(comment);
        const bool is_in_a_value = comment == "# from afar";
        EXPECT_TRUE(is_in_a_value || found != std::string::npos) << comment << " in\n" << edited;
        EXPECT_EQ(edited.find(comment, found + 1), std::string::npos) << comment << " in\n" << edited;
    }
}

// What was read without an edition means the newest, and says so from then on.
TEST(EditShot, TheEditionIsWritten) {
    const Scene base = read("[sea]\nfetch_m = 1e5\n");
    EXPECT_EQ(edited_shot("[sea]\nfetch_m = 1e5\n", base, base),
              "[sea]\nfetch_m = 1e5\n\n[shot]\nedition = 3\n");
    const std::string old = "[shot]\nedition = 1\n";
    Scene scene = read(old);
    EXPECT_EQ(edited_shot(old, scene, read(old)), old);
    scene.light.turbidity = 2.0;
    expect_edited(old, scene, edited_shot(old, scene, read(old)));
}

TEST(EditShot, ValuesAreReplacedWhereTheyStandAndOthersAreAdded) {
    const std::string text = usual_text();
    const Scene base = read(text);
    EXPECT_EQ(edited_shot(text, base, base), text);
    Scene scene = base;
    scene.sea.wind_speed_mps = 9.25;
    scene.sea.depth_m = std::numeric_limits<double>::infinity();
    scene.sea.swell = {{1.5, 9.0, 200.0}, {0.5, 17.0, 10.0}};
    scene.sea.spreading = SpreadingKind::DonelanBanner;
    scene.shot.seed = 77;
    scene.light.turbidity = 5.0;
    scene.effects.whitecaps = false;
    scene.camera.position_m = {1.0, 2.0, 3.5};
    scene.waves.choppiness = 0.5;
    expect_edited(text, scene, edited_shot(text, scene, base));
    scene.sea.swell.clear();
    expect_edited(text, scene, edited_shot(text, scene, base));
}

TEST(EditShot, InlineTablesAndEmptyFilesTakeKeys) {
    for (const std::string text : {"", "sea = {}", "sea = { fetch_m = 1e4 } # é", "[sea]"}) {
        const Scene base = read(text);
        Scene scene = base;
        scene.sea.wind_speed_mps = 9.25;
        scene.shot.seed = 77;
        expect_edited(text, scene, edited_shot(text, scene, base));
    }
}

// Each key that a number, a truth or a word can change, by itself.
TEST(EditShot, EveryKeyComesBack) {
    const std::string text = usual_text();
    const Scene base = read(text);
    int changed = 0;
    for (const KeyTable& table : key_tables())
        for (const Key& key : table.keys) {
            if (!key.set) continue;
            Scene scene = base;
            KeyValue value = value_of(scene, key);
            if (auto* number = std::get_if<double>(&value); number && key.soft)
                *number = 0.3 * key.soft->low + 0.7 * key.soft->high;
            else if (auto* truth = std::get_if<bool>(&value))
                *truth = !*truth;
            else if (auto* integer = std::get_if<std::int64_t>(&value); integer && key.soft)
                *integer = static_cast<std::int64_t>(key.soft->high);
            else
                continue;
            set_value(scene, key, value);
            const std::string edited = edited_shot(text, scene, base);
            try {
                expect_edited(text, scene, edited);
                ++changed;
            } catch (const ShotError&) {  // refused together with other keys, wherever it is written
            }
        }
    EXPECT_GT(changed, 15);
}

}  // namespace
}  // namespace pelagic
