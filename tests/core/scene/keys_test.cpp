// The table of keys: each is described, reaches its member, is checked, and counts where it says it does.
#include "core/scene/keys.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <set>

#include "core/scene/canonical.h"
#include "core/scene/member_count.h"
#include "core/scene/shot_text.h"
#include "core/scene/validate.h"
#include "key_samples.h"

namespace pelagic {
namespace {

using test::another_value;
using test::good_entry;
using test::value_at;

// A key and, inside the entries of lists, theirs.
template <class Visit>
void for_each_key(const Visit& visit) {
    for (const Key& key : keys()) {
        visit(key);
        for (const Key& inner : key.entry_keys) visit(inner);
    }
}

TEST(Keys, EachIsDescribed) {
    std::set<std::string> paths;
    for_each_key([&](const Key& key) {
        SCOPED_TRACE(key.path);
        EXPECT_TRUE(paths.insert(key.path).second) << "twice";
        EXPECT_TRUE(key.path == key.name || key.path.ends_with('.' + key.name));
        EXPECT_FALSE(key.help.empty() || key.label.empty());
        const bool is_inner = key.path.find("[]") != std::string::npos;
        EXPECT_TRUE(is_inner || !key.is_required) << "an empty file is a sea";
        EXPECT_EQ(key.key_parts.any(), !is_inner);
        EXPECT_EQ(key.get == nullptr, is_inner);
        EXPECT_FALSE(key.accepted.empty());
        EXPECT_EQ(std::holds_alternative<std::monostate>(key.fallback), key.is_optional) << "its default";
        const bool is_choice = key.type == KeyType::Word || key.type == KeyType::Words;
        EXPECT_EQ(is_choice, !key.choices.empty());
        EXPECT_EQ(key.type == KeyType::Entries, !key.entry_keys.empty());
        EXPECT_EQ(key.type == KeyType::Entries, !key.entry_name.empty());
        const bool has_suffix = [&] {
            for (const char* suffix : {"_m", "_deg", "_mps", "_s", "_px", "_mg_m3"})
                if (key.name.ends_with(suffix)) return true;
            return false;
        }();
        EXPECT_TRUE(!has_suffix || !key.unit.empty());
        if (key.soft) {
            EXPECT_TRUE(key.range->holds(key.soft->low) && key.range->holds(key.soft->high));
            EXPECT_LT(key.soft->low, key.soft->high);
            EXPECT_TRUE(!key.soft->is_logarithmic || key.soft->low > 0.0);
        }
    });
}

TEST(Keys, PathsAreFound) {
    for_each_key([](const Key& key) { EXPECT_EQ(find_key(key.path), &key); });
    for (const char* none : {"", "sea", "sea.", "sea.wind", "sea.swell[]", "sea.swell[].",
                             "sea.swell[x].height_m", "sea.swell[-1].height_m", "sea.swell[0]"})
        EXPECT_EQ(find_key(none), nullptr) << none;
    EXPECT_EQ(find_key("sea.swell[12].height_m"), find_key("sea.swell[].height_m"));
    EXPECT_THROW(key_of("sea.wind"), std::logic_error);
    std::size_t count = 0;
    for (const KeyTable& table : key_tables())
        for (const Key& key : table.keys) {
            EXPECT_EQ(key.path, table.is_list() ? table.name : table.name + '.' + key.name);
            EXPECT_EQ(&key, &keys()[count++]);
        }
    EXPECT_EQ(count, keys().size());
    EXPECT_EQ(key_tables().size() + 1, member_count<Scene>());  // and the numbers that have keys
}

TEST(Keys, LabelsAreTheNamesWithoutUnits) {
    EXPECT_EQ(key_of("sea.wind_speed_mps").label, "Wind speed");
    EXPECT_EQ(key_of("water.chlorophyll_mg_m3").label, "Chlorophyll");
    EXPECT_EQ(key_of("camera.position_m").label, "Position");
    EXPECT_EQ(key_of("effects.whitecaps").label, "Whitecaps");
}

// Each member stands behind its own key: what is written is read, and nothing else has changed.
TEST(Keys, EachReachesAMemberOfItsOwn) {
    for (const Key& key : keys()) {
        if (!key.set) continue;
        SCOPED_TRACE(key.path);
        Scene scene;
        const KeyValue wanted = another_value(key, key.fallback);
        EXPECT_FALSE(set_value(scene, key, wanted).has_value());
        EXPECT_EQ(value_of(scene, key), wanted);
        for (const Key& other : keys()) {
            if (other.path == key.path) continue;
            EXPECT_EQ(value_of(scene, other), other.fallback) << other.path;
        }
        Scene copied;
        for (const KeyTable& table : key_tables()) table.copy(scene, copied);
        EXPECT_EQ(value_of(copied, key), wanted);
    }
}

TEST(Keys, ValuesOfAnotherTypeAreRefusedAndChangeNothing) {
    const std::vector<KeyValue> values{KeyValue(),
                                       true,
                                       std::int64_t{3},
                                       2.5,
                                       std::string("x"),
                                       std::vector<double>{1.0},
                                       std::vector<std::int64_t>{1},
                                       std::vector<std::string>{"x"},
                                       std::vector<KeyEntry>(1)};
    for (const Key& key : keys()) {
        if (!key.set) continue;
        for (const KeyValue& value : values) {
            Scene scene;
            const std::optional<Problem> problem = set_value(scene, key, value);
            const bool integer_for_number =
                key.type == KeyType::Number && std::holds_alternative<std::int64_t>(value);
            const bool same_type = value.index() == key.fallback.index() ||
                                   (key.is_optional && std::holds_alternative<double>(value));
            const bool is_fitting =
                integer_for_number || (same_type && key.choices.empty() && key.type != KeyType::Point &&
                                       key.type != KeyType::Pair && key.type != KeyType::Entries);
            EXPECT_EQ(problem.has_value(), !is_fitting) << key.path << ' ' << value.index();
            if (!problem) continue;
            EXPECT_TRUE(problem->key.starts_with(key.path)) << problem->key;
            EXPECT_FALSE(problem->accepted.empty());
            EXPECT_EQ(value_of(scene, key), key.fallback) << key.path;
        }
    }
    Scene scene;
    const auto problem = set_value(scene, key_of("sea.spectrum"), std::string("jonsvap"));
    ASSERT_TRUE(problem);
    EXPECT_NE(problem->problem.find("nearest is \"jonswap\""), std::string::npos);
}

// A scene whose only unusual value is this one. Keys of wave trains mean nothing without them.
Scene scene_with(const Key& key, const KeyValue& value) {
    Scene scene;
    if (key.path == kObjectsKey) scene = test::scene_with_body();
    if (key.path == "waves.trains" || key.path == "waves.shortest_m" || key.path == "waves.longest_m" ||
        key.path == kCoastKey)
        scene.waves.model = WaveModel::Trochoid;
    if (!key.of_picture.empty()) {
        EXPECT_FALSE(set_value(scene, key_of(key.of_picture), std::string("noon.exr")));
    }
    EXPECT_FALSE(set_value(scene, key, value).has_value()) << key.path;
    return scene;
}

std::string text_of(const std::vector<Problem>& problems) {
    std::string text;
    for (const Problem& problem : problems) text += pelagic::text_of(problem) + '\n';
    return text;
}

TEST(Keys, RangesAreCheckedEndsIncluded) {
    int checked = 0;
    const auto check = [&](const Key& key, const std::string& path, const auto& problems_with) {
        if (!key.range) return;
        ++checked;
        SCOPED_TRACE(path);
        const auto [low, high] = *key.range;
        for (const double end : {low, high}) EXPECT_EQ(text_of(problems_with(value_at(key, end))), "") << end;
        const bool is_whole = key.type == KeyType::Integer || key.type == KeyType::Pair;
        constexpr double kInfinity = std::numeric_limits<double>::infinity();
        for (const double bad : {is_whole ? low - 1 : std::nextafter(low, -kInfinity),
                                 is_whole ? high + 1 : std::nextafter(high, kInfinity)}) {
            const std::vector<Problem> problems = problems_with(value_at(key, bad));
            ASSERT_EQ(problems.size(), 1u) << bad << '\n' << text_of(problems);
            EXPECT_EQ(problems[0].key, path);
            EXPECT_NE(problems[0].accepted.find(pelagic::text_of(*key.range)), std::string::npos);
        }
    };
    for (const Key& key : keys()) {
        check(key, key.path, [&](const KeyValue& value) { return validate(scene_with(key, value)); });
        for (std::size_t i = 0; i < key.entry_keys.size(); ++i)
            check(key.entry_keys[i], key.path + "[0]." + key.entry_keys[i].name, [&](const KeyValue& value) {
                KeyEntry entry = good_entry(key);
                entry.values[i].second = value;
                return validate(scene_with(key, std::vector<KeyEntry>{entry}));
            });
    }
    EXPECT_GT(checked, 20);
}

// The whole point of the parts: a key changes the texts of those that it key_parts, and of no other.
TEST(Keys, EachChangesTheCanonicalTextOfWhatItFeeds) {
    for (const Key& key : keys()) {
        if (!key.set) continue;
        const Scene changed = [&] {
            Scene scene;
            set_value(scene, key, another_value(key, key.fallback));
            return scene;
        }();
        for (std::size_t part = 0; part < kKeyParts; ++part) {
            const KeyPartSet only(1ull << part);
            EXPECT_EQ(canonical(changed, only) != canonical(Scene{}, only), key.key_parts[part])
                << key.path << " and " << pelagic::text_of(only);
        }
        EXPECT_EQ(canonical(changed) != canonical(Scene{}), key.path != "shot.frames") << key.path;
        // Wave trains have no lean and no pairs; bodies that aren't there are no line, nor is what nobody says off.
        const std::size_t without = key.path == "waves.model" ? 2 : 0;
        const bool is_added = key.is_optional || key.is_silent_off;
        EXPECT_EQ(described(changed, key.key_parts).size() + without,
                  described(Scene{}, key.key_parts).size() + (is_added ? 1u : 0u))
            << key.path;
    }
}

// A header says what its fingerprint counts, and nothing else: a file is kept by the one and read by the other.
TEST(Keys, AreInHeadersAsInFingerprints) {
    for (const WaveModel model : {WaveModel::Fft, WaveModel::Trochoid}) {
        Scene scene;
        scene.waves.model = model;
        const std::string text = canonical(scene, ~KeyPartSet());
        for (const DescribedKey& key : described(scene, ~KeyPartSet()))
            EXPECT_NE(text.find(key.path + " = "), std::string::npos) << key.path;
    }
}

// A line for each key, in the order of the table: whoever looks for one finds it by its path.
TEST(Keys, TheCanonicalTextHasALineAKey) {
    Scene scene;
    scene.sea.swell = {{1.0, 9.0, 0.0}, {2.0, 10.0, 1.0}};
    EXPECT_EQ(canonical(scene, key_parts(KeyPart::Foam, KeyPart::Grid)),
              "surface.cell_px = 8\nsurface.earth_curvature = true\neffects.whitecaps = true\n"
              "effects.whitecap_law = \"callaghan-2008\"\neffects.sea_minus_air_c = 0\n"
              "effects.whitecap_amount = 1\neffects.breaking_from_m = 1\n"
              "effects.foam_decay_s = 4\neffects.foam_drift = 0.02\n");
    EXPECT_NE(canonical(scene).find(
                  "\nsea.swell = [{ height_m = 1, period_s = 9, direction_deg = 0 }, { height_m = 2, "),
              std::string::npos);
    EXPECT_EQ(canonical(scene).find("waves.longest_m"), std::string::npos) << "it has no value";
}

// OpenEXR's readers before 2.0 know names of at most 31 bytes; ours begin with "pelagic.".
TEST(Keys, NamesInHeadersAreShort) {
    for (const DescribedKey& key : described(Scene{}, all_key_parts())) {
        EXPECT_LE(("pelagic." + key.path).size(), 31u) << key.path;
        EXPECT_EQ(key.identifier().find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_"),
                  std::string::npos);
    }
}

TEST(Keys, AMeasuredSpectrumIsDescribedByItsStationAndCountsByItsContent) {
    Scene scene;
    scene.sea.spectrum = SpectrumKind::File;
    scene.sea.measured = MeasuredSpectrum{
        {{0.1, 1.0, 0.5, 0.1, 0.2, 0.3, true}}, "41010", "2019-02-06T00:40:00Z", "folder/41010w2019.txt"};
    std::map<std::string, std::string> said;
    for (const DescribedKey& key : described(scene, key_parts(KeyPart::Waves))) said[key.path] = key.text;
    EXPECT_EQ(said.at("sea.spectrum_station"), "\"41010\"");
    EXPECT_EQ(said.at("sea.spectrum_time"), "2019-02-06T00:40:00Z");
    EXPECT_FALSE(said.contains("sea.spectrum_file"));
    Scene elsewhere = scene;
    elsewhere.sea.measured->file = "another/41010w2019.txt";
    EXPECT_EQ(canonical(elsewhere), canonical(scene));
    elsewhere.sea.measured->bins[0].c1_im = 0.11;
    EXPECT_NE(canonical(elsewhere, key_parts(KeyPart::Waves)), canonical(scene, key_parts(KeyPart::Waves)));
}

TEST(Keys, ACageCountsAndIsDescribedByItsContent) {
    CageMesh mesh;
    mesh.points_m = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}};
    mesh.face_counts = {3};
    mesh.indices = {0, 1, 2};
    Scene scene;
    scene.surface.cage = std::make_shared<const Cage>(mesh);
    scene.surface.cage_file = "folder/pool.obj";
    std::map<std::string, std::string> said;
    for (const DescribedKey& key : described(scene, key_parts(KeyPart::Cage))) said[key.path] = key.text;
    EXPECT_TRUE(said.at("surface.cage").starts_with("\"1 face, 3 points, ")) << said.at("surface.cage");
    EXPECT_FALSE(said.contains("surface.cage_file") || said.contains("sea.spectrum_station"));
    Scene elsewhere = scene;
    elsewhere.surface.cage_file = "pool.obj";
    EXPECT_EQ(canonical(elsewhere), canonical(scene));
    mesh.points_m[0].z = 1e-9;
    elsewhere.surface.cage = std::make_shared<const Cage>(mesh);
    EXPECT_NE(canonical(elsewhere, key_parts(KeyPart::Cage)), canonical(scene, key_parts(KeyPart::Cage)));
    EXPECT_EQ(canonical(elsewhere, ~key_parts(KeyPart::Cage)), canonical(scene, ~key_parts(KeyPart::Cage)));
    EXPECT_EQ(canonical(Scene{}).find("cage_file"), std::string::npos);
}

// Nothing but pictures depends on bodies, and a scene without any has no line of them.
TEST(Keys, BodiesCountByTheirMeshesAndNames) {
    EXPECT_EQ(canonical(Scene{}, all_key_parts()).find("objects"), std::string::npos);
    EXPECT_TRUE(described(Scene{}, key_parts(KeyPart::Objects)).empty());
    const Scene scene = test::scene_with_body();
    const std::string content = scene.objects[0].mesh->content(), text = canonical(scene);
    Scene without;
    without.waves = scene.waves;
    EXPECT_EQ(canonical(scene, ~key_parts(KeyPart::Objects)),
              canonical(without, ~key_parts(KeyPart::Objects)));
    EXPECT_NE(text.find("objects = [{ file = \"" + content + "\", name = \"boat\", path = \"\", "),
              std::string::npos)
        << text;
    EXPECT_EQ(described(scene, key_parts(KeyPart::Objects)).at(0).text.find("folder"), std::string::npos);
    Scene other = scene;
    other.objects[0].file = "elsewhere/boat.obj";
    EXPECT_EQ(canonical(other), text);
    other.objects[0].file = "skiff.obj";  // it is called so then
    EXPECT_NE(canonical(other), text);
    other.objects[0].name = "boat";
    EXPECT_EQ(canonical(other), text);
    ObjectMeshData data = scene.objects[0].mesh->data();
    data.points_m[0].z = 0.25f;
    other.objects[0].mesh = std::make_shared<const ObjectMesh>(data);
    EXPECT_NE(canonical(other), text);
    const std::function<void(SceneObject&)> changes[]{
        [](SceneObject& o) { o.name = "b"; },
        [](SceneObject& o) { o.path = "1 0 0"; },
        [](SceneObject& o) { o.interpolation = CameraInterpolation::Linear; },
        [](SceneObject& o) { o.vessel = 1; },
        [](SceneObject& o) { o.east_m = 1.0; },
        [](SceneObject& o) { o.north_m = 1.0; },
        [](SceneObject& o) { o.up_m = 1.0; },
        [](SceneObject& o) { o.heading_deg = 1.0; },
        [](SceneObject& o) { o.pitch_deg = 1.0; },
        [](SceneObject& o) { o.roll_deg = 1.0; },
        [](SceneObject& o) { o.scale = 2.0; },
        [](SceneObject& o) { o.floats = true; },
        [](SceneObject& o) { o.foam = 0.5; },
        [](SceneObject& o) { o.colour.y = 0.5; },
        [](SceneObject& o) { o.glow_cd_m2 = 1.0; },
        [](SceneObject& o) { o.caustics = 1.0; },
        [](SceneObject& o) { o.holdout = true; }};
    for (const auto& change : changes) {
        other = scene;
        change(other.objects[0]);
        EXPECT_NE(canonical(other, key_parts(KeyPart::Objects)),
                  canonical(scene, key_parts(KeyPart::Objects)));
        EXPECT_EQ(canonical(other, ~key_parts(KeyPart::Objects)),
                  canonical(scene, ~key_parts(KeyPart::Objects)));
    }
    // What records without it say of a body is said of one whose pattern is off.
    EXPECT_EQ(text.find("caustics", text.find("objects = [")), std::string::npos) << text;
    other = scene;
    other.objects[0].caustics = 0.5;
    EXPECT_NE(canonical(other).find("caustics = 0.5", text.find("objects = [")), std::string::npos);
    // Set as values, bodies keep the meshes of their files.
    const Key& key = key_of("objects");
    EXPECT_FALSE(set_value(other, key, value_of(scene, key)).has_value());
    EXPECT_EQ(other.objects[0].mesh, scene.objects[0].mesh);
    other.objects.clear();
    EXPECT_FALSE(set_value(other, key, value_of(scene, key)).has_value());
    EXPECT_EQ(other.objects.at(0).mesh, nullptr);
}

// Two masks of one picture, each with cells of its own: neither makes the other's anew.
TEST(Keys, AMaskPicturesCellsAreMadeOnceForAllWhoHoldThem) {
    const MaskPicture picture(4, 4, std::vector<float>(16, 0.5f));
    const auto four = picture.cells({4, 4});
    auto two = picture.cells({2, 2});
    EXPECT_EQ(picture.cells({4, 4}), four);
    EXPECT_EQ(picture.cells({2, 2}), two);
    EXPECT_EQ(two->count, glm::ivec2(2, 2));
    // Those that nobody holds go, but for the last.
    const std::weak_ptr<const MaskCells> gone = two;
    two.reset();
    EXPECT_FALSE(gone.expired());
    EXPECT_EQ(picture.cells({4, 4}), four);
    EXPECT_TRUE(gone.expired());
}

TEST(Keys, AMasksPictureCountsAndIsDescribedByItsContent) {
    const auto of = [](std::vector<float> shares, const std::string& file) {
        Scene scene;
        scene.waves.masks = {{.waves = 0.5, .picture = file}};
        scene.waves.mask_pictures[file] = std::make_shared<const MaskPicture>(2, 2, std::move(shares));
        return scene;
    };
    const Scene here = of({0.0f, 1.0f, 0.5f, 0.0f}, "lee.exr"),
                there = of({0.0f, 1.0f, 0.5f, -0.0f}, "elsewhere/lee.exr"),
                other = of({0.0f, 1.0f, 0.5f, 0.1f}, "lee.exr");
    EXPECT_EQ(canonical(here), canonical(there));
    EXPECT_NE(canonical(here, key_parts(KeyPart::Waves)), canonical(other, key_parts(KeyPart::Waves)));
    EXPECT_EQ(canonical(here, ~key_parts(KeyPart::Waves)), canonical(other, ~key_parts(KeyPart::Waves)));
    EXPECT_NE(canonical(here).find("picture = \"2 x 2 texels, "), std::string::npos) << canonical(here);
    for (const DescribedKey& key : described(here, key_parts(KeyPart::Waves))) {
        if (key.path != "waves.masks") continue;
        EXPECT_NE(key.text.find("picture = \"2 x 2 texels, "), std::string::npos) << key.text;
    }
    EXPECT_NE(shot_text(there).find("picture = \"elsewhere/lee.exr\""), std::string::npos)
        << shot_text(there);
    Scene ellipse = here;
    ellipse.waves.masks[0].picture.reset();
    EXPECT_EQ(canonical(ellipse).find("picture"), std::string::npos);
}

// A number, or the word that may stand in its place.
TEST(Keys, AnIntegerMayHaveAnotherWord) {
    const Key& level = key_of("surface.cage_level");
    Scene scene;
    EXPECT_FALSE(set_value(scene, level, std::string("adaptive")).has_value());
    EXPECT_TRUE(scene.surface.cage_level.is_adaptive);
    EXPECT_EQ(value_text(level, value_of(scene, level)), "\"adaptive\"");
    EXPECT_EQ(shot_text(scene, Scene{}), "[surface]\ncage_level = \"adaptive\"\n");
    const auto problem = set_value(scene, level, std::string("adaptiv"));
    ASSERT_TRUE(problem);
    EXPECT_EQ(problem->problem, "is not the word \"adaptive\"");
    EXPECT_EQ(problem->accepted, "an integer, 0 … 6, or \"adaptive\"");
    EXPECT_FALSE(set_value(scene, level, std::int64_t{5}).has_value());
    EXPECT_EQ(scene.surface.cage_level, (CageLevel{.splits = 5, .is_adaptive = false}));
}

TEST(ShotText, NothingDiffersIsNoText) {
    EXPECT_EQ(shot_text(Scene{}), "[shot]\nedition = 3\n");
    Scene scene;
    scene.sea.fetch_m = 1e5;
    EXPECT_EQ(shot_text(scene, scene), "");
}

TEST(ShotText, BodiesAreTablesOfTheirOwn) {
    Scene scene = test::scene_with_body();
    scene.waves.vessels.clear();
    scene.objects.push_back(scene.objects[0]);
    scene.objects[1].name = "a \"b\"";
    scene.objects[1].up_m = -0.5;
    scene.objects[1].floats = true;
    const std::string text =
        "[[objects]]\nfile = \"folder/boat.obj\"\n\n[[objects]]\nfile = \"folder/boat.obj\"\nname = \"a \\\"b\\\"\"\n"
        "up_m = -0.5\nfloats = true\n";
    EXPECT_EQ(shot_text(scene, Scene{}), text);
    EXPECT_EQ(shot_text(scene), "[shot]\nedition = " + std::to_string(kNewestEdition) + "\n\n" + text);
    EXPECT_EQ(shot_text(scene, scene), "");
    Scene none;
    EXPECT_EQ(shot_text(none, scene), "objects = []\n");
    none.shot.seed = 7;
    EXPECT_EQ(shot_text(none, scene), "objects = []\n\n[shot]\nseed = 7\n");
}

TEST(ShotText, OnlyWhatDiffersInTheTablesOfAShotFile) {
    Scene now;
    now.sea.wind_speed_mps = 12.5;
    now.sea.fetch_m = 1e5;
    now.sea.swell = {{.height_m = 1.5, .period_s = 11.0, .direction_deg = 80.0}};
    now.camera.position_m = {1e6, -2.5, 0.5};
    now.water.type = WaterType::Turbid;
    now.effects.whitecaps = false;
    EXPECT_EQ(shot_text(now),
              "[shot]\n"
              "edition = 3\n"
              "\n[sea]\n"
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

}  // namespace
}  // namespace pelagic
