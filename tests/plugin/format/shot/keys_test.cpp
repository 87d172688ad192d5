// Every key of the table in a shot file: read at both ends of its range, refused beyond, and written back.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <set>

#include "core/scene/canonical.h"
#include "core/scene/keys.h"
#include "core/scene/shot_text.h"
#include "core/scene/validate.h"
#include "plugin/format/shot/shot.h"
#include "tests/core/scene/key_samples.h"
#include "tests/plugin/format/shot/no_check.h"

namespace pelagic {
namespace {

const std::filesystem::path kKeysData =
    std::filesystem::path(PELAGIC_SOURCE_DIR) / "tests/plugin/format/shot/data";

// Keys of wave trains mean nothing without them, nor do those of a picture.
std::string shot_with(const Key& key, const std::string& value) {
    const bool of_trains = key.path == "waves.trains" || key.path == "waves.shortest_m" ||
                           key.path == "waves.longest_m" || key.path == kCoastKey;
    // Waves of any height need a wind that makes them long.
    const bool is_height = key.path == "sea.significant_height_m";
    // A body may be any of so many vessels'.
    std::string vessels;
    for (int i = 0; key.path == kObjectsKey && i < limits::kVessels; ++i)
        vessels += (i > 0 ? ", " : "waves.vessels = [") + std::string("{ path = \"1 0 0, 48 10 0\" }");
    if (!vessels.empty()) vessels += "]\n";
    return vessels + (key.of_picture.empty() ? "" : key.of_picture + " = \"sky.exr\"\n") +
           std::string(of_trains ? "waves.model = \"trochoid\"\n" : "") +
           (is_height ? "sea.wind_speed_mps = 80\nsea.fetch_m = 1e8\n" : "") + key.path + " = " + value +
           '\n';
}

std::string key_refusal(const std::string& text) {
    try {
        parse_shot(text, kKeysData / "s.toml", no_check);
    } catch (const ShotError& error) {
        return error.what();
    }
    return "";
}

TEST(ShotKeys, AreReadAtTheEndsOfTheirRangesAndRefusedBeyond) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    int checked = 0;
    const auto check = [&](const Key& key, const std::string& path, const auto& text_of_value) {
        if (!key.range) return;
        ++checked;
        SCOPED_TRACE(path);
        const auto [low, high] = *key.range;
        for (const double end : {low, high})
            EXPECT_EQ(key_refusal(text_of_value(test::value_at(key, end))), "");
        const bool is_whole = key.type == KeyType::Integer || key.type == KeyType::Pair;
        for (const double bad : {is_whole ? low - 1 : std::nextafter(low, -kInfinity),
                                 is_whole ? high + 1 : std::nextafter(high, kInfinity)}) {
            const std::string message = key_refusal(text_of_value(test::value_at(key, bad)));
            EXPECT_NE(message.find(": " + path + " = "), std::string::npos) << message;
            EXPECT_NE(message.find("is outside the range; accepted: "), std::string::npos) << message;
        }
    };
    for (const Key& key : keys()) {
        check(key, key.path, [&](const KeyValue& value) { return shot_with(key, value_text(key, value)); });
        for (std::size_t i = 0; i < key.entry_keys.size(); ++i)
            check(key.entry_keys[i], key.path + "[0]." + key.entry_keys[i].name, [&](const KeyValue& value) {
                KeyEntry entry = test::good_entry(key);
                entry.values[i].second = value;
                return shot_with(key, value_text(key, std::vector<KeyEntry>{entry}));
            });
    }
    EXPECT_GT(checked, 20);
}

TEST(ShotKeys, OfEveryKeyAValueThatIsNoneOfItsTypeIsRefusedWithWhatIsAccepted) {
    for (const Key& key : keys()) {
        const std::string message = key_refusal(shot_with(key, "12:30:00"));  // no key is a time of day
        EXPECT_NE(message.find(key.path + " = 12:30:00: is a time of day; accepted: " + key.accepted),
                  std::string::npos)
            << message;
    }
}

// Every key: those whose numbers may change over the shot are read and written back, the others refuse keys in words, at their line.
TEST(ShotKeys, TakeKeysWhereTheyMayAndRefuseThemElsewhere) {
    for (const Key& key : keys()) {
        SCOPED_TRACE(key.path);
        const std::string ends = key.range ? value_text(key, test::value_at(key, key.range->low)) : "1";
        const std::string keyed =
            "{ keys = [[-5, " + ends + "], [7, " + ends + "]], interpolation = \"smooth\" }";
        if (key.may_have_keys) {
            const Scene scene = parse_shot(shot_with(key, keyed), kKeysData / "s.toml", no_check);
            EXPECT_EQ(value_text(key, value_of(scene, key)), keyed);
            EXPECT_EQ(canonical(parse_shot(shot_text(scene), kKeysData / "s.toml", no_check)),
                      canonical(scene));
        } else if (key.type == KeyType::Number) {
            const std::string message = key_refusal(shot_with(key, keyed));
            EXPECT_NE(message.find(key.path + " = { "), std::string::npos) << message;
            EXPECT_NE(message.find("has keys, and this number can't change over the shot"), std::string::npos)
                << message;
        } else {
            EXPECT_NE(key_refusal(shot_with(key, keyed)).find(key.path), std::string::npos);
        }
    }
}

TEST(ShotKeys, OfEntriesAreReadAndWrittenBack) {
    const std::string text =
        "[sea]\nswell = [ { height_m = 1.5, period_s = 9.0, direction_deg = 10.0 },\n"
        "  { height_m = { keys = [[1, 0.5], [90, 3.0]], interpolation = \"smooth\" }, period_s = 14.0, "
        "direction_deg = { keys = [[1, 350.0], [90, 20.0]] } } ]\n"
        "[[waves.band_gains]]\nfrom_m = 2.0\nto_m = 9.0\ngain = { keys = [[1, 1.0], [90, 0.2]] }\n";
    const Scene scene = parse_shot(text, kKeysData / "s.toml", no_check);
    ASSERT_EQ(scene.keyed.size(), 3u);
    EXPECT_EQ(scene.keyed[0].path, "sea.swell[1].height_m");
    EXPECT_EQ(scene.sea.swell[1].height_m, 3.0);  // the largest
    EXPECT_EQ(scene.sea.swell[1].direction_deg, 350.0);
    const std::string written = shot_text(scene);
    EXPECT_NE(written.find("height_m = { keys = [[1, 0.5], [90, 3]], interpolation = \"smooth\" }"),
              std::string::npos)
        << written;
    EXPECT_EQ(canonical(parse_shot(written, kKeysData / "s.toml", no_check)), canonical(scene));
    EXPECT_NE(key_refusal("sea.swell = [ { height_m = { keys = [[1, 0.5], [90, 300.0]] }, period_s = 9.0, "
                          "direction_deg = 0.0 } ]")
                  .find("sea.swell[0].height_m.keys[1] = [90, 300]: is outside the range"),
              std::string::npos);
}

TEST(ShotKeys, SayWhyANumberHasNone) {
    const std::string keyed = " = { keys = [[1, 20.0], [9, 30.0]] }\n";
    for (const auto& [text, why] :
         {std::pair{"sea.gust_size_m" + keyed,
                    "over the shot: patches far away would race over the sea as they grow;"},
          {"[[waves.band_gains]]\nfrom_m" + keyed, "over the shot: it is one for the whole shot;"},
          {"surface.size_m" + keyed, "over the shot yet;"}})
        EXPECT_NE(key_refusal(text).find(why), std::string::npos) << key_refusal(text);
}

TEST(ShotKeys, OfNumbersAreRefusedWithLineAndEntry) {
    const auto refusal = [](const std::string& value) {
        return key_refusal("[light]\n\nturbidity = " + value);
    };
    for (const auto& [value, said] :
         {std::pair{"{ keys = [[1, 2.0], [1, 3.0]] }",
                    "s.toml:3:33: light.turbidity.keys[1] = [1, 3]: does not come after"},
          {"{ keys = [[1, 2.0], [0.5, 3.0]] }",
           ":3:33: light.turbidity.keys[1] = [0.5, 3]: is no frame and its number"},
          {"{ keys = [[1, 2.0], [9, 1e9]] }", "light.turbidity.keys[1] = [9, 1e9]: is outside the range"},
          {"{ keys = [[1, 2.0], [9, nan]] }", "light.turbidity.keys[1] = [9, nan]: is not a number"},
          {"{ keys = [[1, 2.0], [9, \"x\"]] }", "light.turbidity.keys[1] = \"x\": is a string"},
          {"{ keys = [[1, 2.0, 3.0]] }", "light.turbidity.keys[0]"},
          {"{ keys = [[9999999999, 2.0]] }", "light.turbidity.keys[0]"},
          {"{ keys = [] }", "has no list of keys in it"},
          {"{ }", "has no list of keys in it"},
          {"{ keys = [[1, 2.0]], interpolation = \"smoth\" }", "the nearest is \"smooth\""},
          {"{ keys = [[1, 2.0]], easing = 1 }", "light.turbidity.easing = 1: is an unknown key"},
          {"{ keys = [[1, 2.0], [2, 3.0]] }\n[shot]\nloop_s = 2.0", "a loop has no beginning"}})
        EXPECT_NE(refusal(value).find(said), std::string::npos) << value << '\n' << refusal(value);
    EXPECT_NE(
        key_refusal("waves.band_gains = [{ from_m = { keys = [[1, 0.1]] }, to_m = 9.0, gain = 0.0 }]")
            .find("waves.band_gains[0].from_m = { keys = [[1, 0.1]] }: has keys, and this number can't"),
        std::string::npos);
}

class RandomValues {
  public:
    explicit RandomValues(unsigned seed) : random_(seed) {}

    double below(double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random_);
    }
    std::size_t index(std::size_t count) {
        return std::uniform_int_distribution<std::size_t>(0, count - 1)(random_);
    }

    KeyValue of(const Key& key) {
        const double low = key.range ? std::max(key.range->low, -1e4) : 0.0;
        const double high = key.range ? std::min(key.range->high, 1e4) : 1e4;
        switch (key.type) {
            case KeyType::Truth:
                return index(2) == 1;
            case KeyType::Integer:
                return static_cast<std::int64_t>(below(low, high + 1.0));
            case KeyType::Number:
                if (key.path == "shot.loop_s")
                    return static_cast<double>(index(100));  // whole at whole rates
                if (key.path == "sea.significant_height_m" || key.path == "sea.swell[].height_m")
                    return below(0.0, 1e-3);  // higher ones may break
                if (key.path == "waves.band_gains[].from_m") return below(low, 1.0);
                if (key.path == "waves.band_gains[].to_m") return below(1.0, high);
                if (key.path == "shot.fps") return static_cast<double>(1 + index(60));
                return below(low, high);
            case KeyType::Word:
                return key.choices[index(key.choices.size())];
            case KeyType::Point:
                return std::vector<double>{below(low, high), below(low, high), below(low, high)};
            case KeyType::Pair: {
                const auto first = static_cast<std::int64_t>(below(low, high));
                return std::vector<std::int64_t>{first, first + static_cast<std::int64_t>(index(100))};
            }
            case KeyType::Words: {
                std::vector<std::string> words;
                for (const std::string& word : key.choices)
                    if (index(2) == 1) words.push_back(word);
                return words;
            }
            case KeyType::Entries: {
                std::vector<KeyEntry> entries;
                for (std::size_t left = index(3); left > 0; --left) {
                    KeyEntry& entry = entries.emplace_back();
                    for (const Key& inner : key.entry_keys) entry.values.emplace_back(inner.name, of(inner));
                }
                return entries;
            }
            case KeyType::Text:
                return key.is_picture || key.name == "path" ? key.fallback : KeyValue(std::string("A-1_b"));
            case KeyType::DataFile:
            case KeyType::DataTime:
                break;
        }
        return {};
    }

  private:
    std::mt19937 random_;
};

// Any scene that validate() accepts comes back from its own shot file, bit by bit, whatever its keys say.
TEST(ShotKeys, AreWrittenAndReadBack) {
    std::set<std::string> changed;
    for (unsigned seed = 0; seed < 120; ++seed) {
        RandomValues random(seed);
        Scene scene;
        for (const Key& key : keys()) {
            if (!key.set) continue;
            // Keys of trains are refused without them, and only then.
            Scene other = scene;
            // One budget at a time.
            if (key.path == "quality.frame_ms" && seed % 2 == 0) other.quality.max_error.reset();
            ASSERT_FALSE(set_value(other, key, random.of(key)).has_value()) << key.path;
            if (!validate(other).empty()) continue;
            scene = other;
            if (value_of(scene, key) != key.fallback) changed.insert(key.path);
        }
        const std::string text = shot_text(scene);
        const Scene read = parse_shot(text, "s.toml", no_check);
        for (const Key& key : keys()) {
            EXPECT_EQ(value_of(read, key), value_of(scene, key)) << key.path << '\n' << text;
        }
        EXPECT_EQ(shot_text(read), text);
    }
    for (const Key& key : keys()) {
        // A picture is no file here, nor is a body, and what is of one is refused without it.
        const bool can_change =
            key.set && !key.is_picture && key.of_picture.empty() && key.path != kObjectsKey;
        EXPECT_EQ(changed.contains(key.path), can_change) << key.path;
    }
}

TEST(ShotKeys, AMeasuredSpectrumIsNamedByItsFileAndTime) {
    const Scene scene = parse_shot(
        "[sea]\nspectrum = \"file\"\nspectrum_file = \"made-99001w2021.txt\"\nspectrum_time = "
        "2021-03-01T02:50:00+02:00\n",
        kKeysData / "s.toml", no_check);
    const std::string text = shot_text(scene);
    EXPECT_NE(text.find("spectrum_time = 2021-03-01T00:50:00Z\n"), std::string::npos) << text;
    EXPECT_EQ(canonical(parse_shot(text, "elsewhere.toml", no_check)), canonical(scene)) << text;
}

TEST(ShotKeys, HelpSaysOfEachWhatDependsOnIt) {
    const std::string help = describe_keys();
    for (const KeyTable& table : key_tables())
        EXPECT_NE(help.find('[' + table.name + (table.is_list() ? "]]  " : "]  ") + table.help),
                  std::string::npos)
            << table.name;
    for (const Key& key : keys()) {
        const std::size_t at = help.find("\n  " + key.path);
        ASSERT_NE(at, std::string::npos) << key.path;
        const std::string part = help.substr(at, help.find("\n  ", help.find("feeds", at)) - at);
        EXPECT_NE(part.find("feeds " + text_of(key.key_parts)), std::string::npos) << part;
        EXPECT_NE(part.find(key.help), std::string::npos) << part;
        for (const Key& inner : key.entry_keys)
            EXPECT_NE(
                help.find("\n  " + inner.path + (inner.is_required || inner.is_optional ? "\n" : " = ")),
                std::string::npos)
                << inner.path;
    }
}

}  // namespace
}  // namespace pelagic
