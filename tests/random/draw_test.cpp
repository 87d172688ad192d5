// What is drawn: every key of the table, over its range, and what scenes are made of together. A key that is added to the
// table is asked for here by itself.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "core/spectrum/possible.h"
#include "tests/random/random_scene.h"
#include "tests/random/shrunk_scene.h"

namespace pelagic::test {
namespace {

// As many as the tests make.
constexpr std::uint64_t kDrawnScenes = 1000;

struct Drawn {
    int times = 0;       // with another value than the default, in a shot that is not refused
    int of_entries = 0;  // the most entries at once
    bool is_empty = false;
    std::set<std::string> words;
    std::vector<double> numbers;
};

void take(Drawn& drawn, const KeyValue& value) {
    struct Visitor {
        Drawn& drawn;
        void operator()(std::monostate) const {}
        void operator()(bool truth) const { drawn.words.insert(truth ? "true" : "false"); }
        void operator()(std::int64_t integer) const { drawn.numbers.push_back(static_cast<double>(integer)); }
        void operator()(double number) const { drawn.numbers.push_back(number); }
        void operator()(const std::string& word) const { drawn.words.insert(word); }
        void operator()(const std::vector<double>& list) const {
            drawn.numbers.insert(drawn.numbers.end(), list.begin(), list.end());
        }
        void operator()(const std::vector<std::int64_t>& list) const {
            for (const std::int64_t number : list) drawn.numbers.push_back(static_cast<double>(number));
        }
        void operator()(const std::vector<std::string>& list) const {
            drawn.words.insert(list.begin(), list.end());
            drawn.of_entries = std::max(drawn.of_entries, static_cast<int>(list.size()));
            drawn.is_empty = drawn.is_empty || list.empty();
        }
        void operator()(const NumberKeys& number) const {
            for (const NumberKeys::Key& key : number.keys) drawn.numbers.push_back(key.value);
        }
        void operator()(const std::vector<KeyEntry>& list) const {
            drawn.of_entries = std::max(drawn.of_entries, static_cast<int>(list.size()));
            drawn.is_empty = drawn.is_empty || list.empty();
        }
    };
    std::visit(Visitor{drawn}, value);
}

bool is_good(const RandomScene& scene) {
    const std::optional<Scene> made = scene.scene();
    return made && problems_of(*made).empty();
}

// All that is drawn, by the keys' paths.
const std::map<std::string, Drawn>& all_drawn() {
    static const std::map<std::string, Drawn> all = [] {
        std::map<std::string, Drawn> found;
        for (std::uint64_t seed = 0; seed < kDrawnScenes; ++seed) {
            const RandomScene scene = random_scene(seed);
            const bool counts = is_good(scene);
            for (const auto& [key, value] : scene.keys) {
                Drawn& drawn = found[key->path];
                take(drawn, value);
                drawn.times += counts && value != key->fallback;
                if (const auto* entries = std::get_if<std::vector<KeyEntry>>(&value))
                    for (const KeyEntry& entry : *entries)
                        for (std::size_t i = 0; i < entry.values.size(); ++i) {
                            const Key& inner = key->entry_keys[i];
                            take(found[inner.path], entry.values[i].second);
                            found[inner.path].times += counts && entry.values[i].second != inner.fallback;
                        }
            }
        }
        return found;
    }();
    return all;
}

// Where a number lies within the range, 0 … 1: by its logarithm where that spans decades.
double place_in(const Range& range, double number) {
    const double magnitude = std::max(std::abs(range.low), std::abs(range.high));
    if (range.low > 0.0 && range.high / range.low > 100.0)
        return std::log(number / range.low) / std::log(range.high / range.low);
    // Numbers of either sign, and those from 0 on, are spread over nine decades.
    if (range.low < 0.0 && magnitude > 1e3) return 0.5 + 0.5 * std::copysign(1.0, number);
    return (number - range.low) / (range.high - range.low);
}

void expect_spread(const Key& key, const Drawn& drawn) {
    const Range range = drawn_range(key);
    const bool is_whole = key.type == KeyType::Integer || key.type == KeyType::Pair;
    int low = 0, high = 0, ends = 0;
    for (const double number : drawn.numbers) {
        if (std::isinf(number)) continue;
        EXPECT_TRUE(range.holds(number) || key.path == "shot.loop_s") << key.path << " = " << number;
        const double place = place_in(range, number);
        low += place < 0.25;
        high += place > 0.75;
        ends += number == range.low || number == range.high;
    }
    EXPECT_GT(low, 0) << key.path << " is never near the low end of its range";
    EXPECT_GT(high, 0) << key.path << " is never near the high end of its range";
    EXPECT_TRUE(ends > 0 || (is_whole && range.high - range.low > 1e3))
        << key.path << " is never at an end of its range";
}

void expect_drawn(const Key& key) {
    const auto found = all_drawn().find(key.path);
    ASSERT_NE(found, all_drawn().end()) << key.path << " is never drawn";
    const Drawn& drawn = found->second;
    EXPECT_GE(drawn.times, 4) << key.path
                              << " hardly ever differs from its default in a shot that is not refused";
    EXPECT_TRUE(key.type != KeyType::Truth || drawn.words.size() == 2) << key.path;
    for (const std::string& word : key.choices)
        EXPECT_TRUE(drawn.words.contains(word)) << key.path << " is never " << word;
    const bool has_word = !key.other_word.empty() && key.type == KeyType::Integer;
    EXPECT_TRUE(!has_word || drawn.words.contains(key.other_word))
        << key.path << " is never " << key.other_word;
    const bool is_infinite = std::any_of(drawn.numbers.begin(), drawn.numbers.end(),
                                         [](double number) { return std::isinf(number); });
    EXPECT_EQ(is_infinite, key.may_be_infinite) << key.path;
    if (key.type == KeyType::Words) {
        EXPECT_TRUE(drawn.is_empty) << key.path << " is never empty";
        EXPECT_EQ(drawn.of_entries, static_cast<int>(key.choices.size())) << key.path;
    }
    EXPECT_TRUE(key.type != KeyType::Entries || drawn.of_entries >= 2) << key.path;
    const bool is_numbers = key.type == KeyType::Number || key.type == KeyType::Integer ||
                            key.type == KeyType::Point || key.type == KeyType::Pair;
    if (is_numbers && key.range) expect_spread(key, drawn);
    for (const Key& inner : key.entry_keys) expect_drawn(inner);
}

TEST(RandomScene, DrawsEveryKeyOverItsRange) {
    for (const Key& key : keys())
        if (key.path != "camera.file")
            expect_drawn(key);  // which a host makes camera.keys of: those are drawn
}

TEST(RandomScene, SameSeedSameShot) {
    for (const std::uint64_t seed : {0u, 7u, 123u}) {
        const RandomScene one = random_scene(seed), other = random_scene(seed);
        EXPECT_EQ(one.text(), other.text());
        EXPECT_EQ(one.files, other.files);
    }
    EXPECT_NE(random_scene(1).text(), random_scene(2).text());
}

TEST(RandomScene, CapsNameKeysWithRanges) {
    for (const Cap& cap : caps()) {
        EXPECT_FALSE(cap.why.empty()) << cap.what;
        if (cap.what.find('.') == std::string_view::npos) continue;
        const Key* key = find_key(cap.what);
        ASSERT_TRUE(key && key->range) << cap.what;
        EXPECT_GT(drawn_range(*key).high, drawn_range(*key).low) << cap.what;
    }
}

// What costs a feature its test if it never comes up in a shot that is not refused.
TEST(RandomScene, MeetsEveryKindOfShot) {
    std::map<std::string, int> times;
    for (std::uint64_t seed = 0; seed < kDrawnScenes; ++seed) {
        const RandomScene random = random_scene(seed);
        if (!is_good(random)) continue;
        const Scene scene = *random.scene();
        const auto count = [&](const char* what, bool is) { times[what] += is; };
        count("a shot", true);
        count("a patch", scene.surface.kind == SurfaceKind::Patch);
        count("a projected grid", scene.surface.kind == SurfaceKind::ProjectedGrid);
        count("near to far", scene.surface.kind == SurfaceKind::NearFar);
        count("a cage", scene.surface.kind == SurfaceKind::Cage);
        count("a cage as its camera sees it",
              scene.surface.kind == SurfaceKind::Cage && scene.surface.cage_level.is_adaptive);
        count("a planet", scene.surface.kind == SurfaceKind::Planet);
        count("a patch in nothing",
              scene.surface.kind == SurfaceKind::Patch && scene.surface.beyond == Beyond::Nothing);
        count("a cage in the sea",
              scene.surface.kind == SurfaceKind::Cage && scene.surface.beyond == Beyond::Sea);
        count("a fitted cage", scene.output.mesh_scheme == MeshScheme::CatmullClark);
        const bool has_trains = scene.waves.model == WaveModel::Trochoid;
        count("trains", has_trains && scene.waves.cascades.empty());
        count("trains over cascades", has_trains && !scene.waves.cascades.empty());
        count(
            "trains over cascades, of lengths of their own",
            has_trains && !scene.waves.cascades.empty() && (scene.waves.shortest_m || scene.waves.longest_m));
        count("three cascades", scene.waves.cascades.size() == 3);
        count("automatic cascades", !has_trains && scene.waves.cascades.empty());
        count("a moving camera", scene.camera.keys.size() >= 2);
        count("volumes of spray and sea", scene.output.volumes.size() == 2);
        count("tiles", scene.output.cascade_tiles);
        count("a picture of a sky", scene.light.sky != Light{}.sky);
        count("daylight", scene.light.sky == Light{}.sky);
        count("a buoy", scene.sea.measured.has_value());
        count("a loop", scene.shot.loop_s > 0.0);
        count("gusts", scene.sea.gust_strength > 0.0);
        count("foam that lives", scene.effects.whitecaps && scene.effects.foam_decay_s > 0.0);
    }
    EXPECT_GE(times["a shot"], 8 * static_cast<int>(kDrawnScenes) / 10);
    for (const auto& [what, count] : times) EXPECT_GE(count, 10) << what;
}

// Down to the keys without which it doesn't fail, a list's one entry, and round numbers.
TEST(ShrunkScene, HasOnlyWhatFails) {
    std::uint64_t seed = 0;
    const auto fails = [](const RandomScene& scene) {
        const KeyValue* wind = scene.value("sea.wind_speed_mps");
        const KeyValue* swell = scene.value("sea.swell");
        if (!wind || !swell || std::get<double>(*wind) < 3.3 || !is_good(scene)) return false;
        const auto& entries = std::get<std::vector<KeyEntry>>(*swell);
        return std::any_of(entries.begin(), entries.end(), [](const KeyEntry& entry) {
            return std::get<double>(entry.values[1].second) > 7.0;
        });
    };
    const auto has_more = [&](const RandomScene& scene) {
        const KeyValue* swell = scene.value("sea.swell");
        return fails(scene) && scene.value(kCageFile) && std::get<std::vector<KeyEntry>>(*swell).size() > 1;
    };
    while (!has_more(random_scene(seed))) ++seed;
    const RandomScene simplest = shrunk(random_scene(seed), fails);
    EXPECT_TRUE(fails(simplest));
    EXPECT_EQ(std::get<std::vector<KeyEntry>>(*simplest.value("sea.swell")).size(), 1u);
    // A cage stays where the open sea in its place would cost too much.
    RandomScene open = simplest;
    std::erase_if(open.keys, [](const GivenKey& given) {
        return given.key->path == kCageFile || given.key->path == "surface.kind";
    });
    const bool has_cage = simplest.value(kCageFile) && !is_affordable(open);
    EXPECT_TRUE(simplest.files.empty() || has_cage);
    const std::set<std::string> needed{"sea.wind_speed_mps", "sea.swell"};
    const std::set<std::string> cheap{"waves.cascades", "waves.model"};  // automatic cascades aren't
    for (const auto& [key, value] : simplest.keys)
        EXPECT_TRUE(needed.contains(key->path) || cheap.contains(key->path) || costs_too_much(*key) ||
                    (has_cage && key->path.starts_with("surface.")))
            << key->path;
}

}  // namespace
}  // namespace pelagic::test
