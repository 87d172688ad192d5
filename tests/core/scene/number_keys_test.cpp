// Numbers that change over the shot: which may, what they are at a frame, and what is refused.
#include "core/scene/number_keys.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "core/scene/canonical.h"
#include "core/scene/shot_text.h"
#include "core/scene/validate.h"

namespace pelagic {
namespace {

constexpr auto kLinear = CameraInterpolation::Linear, kSmooth = CameraInterpolation::Smooth;

TEST(NumberKeys, AreTheirOwnValuesAtTheirFramesAndConstantOutside) {
    for (const auto interpolation : {kLinear, kSmooth}) {
        const NumberKeys number{{{-3, 0.1}, {10, 7.3}, {11, -2.0}}, interpolation};
        for (const bool is_angle : {false, true}) {
            for (const auto& [frame, value] : number.keys)
                EXPECT_EQ(value_at(number, is_angle, frame), value);
            EXPECT_EQ(value_at(number, is_angle, -1e8), 0.1);
            EXPECT_EQ(value_at(number, is_angle, 1e8), -2.0);
        }
    }
    EXPECT_DOUBLE_EQ(value_at(NumberKeys{{{0, 1.0}, {8, 5.0}}, kLinear}, false, 2.5), 2.25);
    EXPECT_DOUBLE_EQ(value_at(NumberKeys{{{0, 1.0}, {8, 5.0}}, kSmooth}, false, 2.0),
                     1.0 + 4.0 * 10.0 / 64.0);  // smoothstep(1/4)
}

TEST(NumberKeys, GoTheShortWayRound) {
    for (const auto interpolation : {kLinear, kSmooth}) {
        EXPECT_DOUBLE_EQ(value_at(NumberKeys{{{1, 350.0}, {3, 10.0}}, interpolation}, true, 2.0), 360.0);
        EXPECT_DOUBLE_EQ(value_at(NumberKeys{{{1, -170.0}, {3, 170.0}}, interpolation}, true, 2.0), -180.0);
        EXPECT_DOUBLE_EQ(value_at(NumberKeys{{{1, 350.0}, {3, 10.0}}, interpolation}, false, 2.0), 180.0);
    }
}

TEST(NumberKeys, OfAnAngleStayInItsRange) {
    const Key& key = key_of("light.sun_azimuth_deg");
    for (const double sign : {1.0, -1.0}) {
        Scene scene;
        ASSERT_FALSE(
            set_value(scene, key, NumberKeys{{{1, sign * 999990.0}, {6, sign * 999720.0}}, kLinear}));
        for (const double frame : {1.0, 2.0, 3.5, 5.9, 6.0}) {
            EXPECT_TRUE(validate(scene_at(scene, frame)).empty()) << frame;
            EXPECT_NEAR(std::remainder(scene_at(scene, frame).light.sun_azimuth_deg -
                                           sign * (999990.0 + 18.0 * (frame - 1.0)),
                                       360.0),
                        0.0, 1e-6)
                << frame;
        }
    }
}

// Smooth: monotone between keys, so never beyond them, and without a jump of its slope, the ends' frames included.
TEST(NumberKeys, AreSmoothAndNeverBeyondTheirValues) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> value(-5.0, 5.0);
    std::uniform_int_distribution<int> gap(1, 40);
    for (int trial = 0; trial < 50; ++trial) {
        NumberKeys number{{}, kSmooth};
        for (int frame = 0, i = 0; i < 7; ++i, frame += gap(random))
            number.keys.push_back({frame, i == 3 ? number.keys[2].value : value(random)});
        for (std::size_t i = 0; i + 1 < number.keys.size(); ++i) {
            const auto [a, b] = std::pair(number.keys[i], number.keys[i + 1]);
            double before = a.value;
            for (int step = 1; step <= 64; ++step) {
                const double now = value_at(number, false, a.frame + (b.frame - a.frame) * step / 64.0);
                EXPECT_TRUE(a.value <= b.value ? now >= before : now <= before);
                before = now;
            }
        }
        constexpr double h = 1e-5;
        for (const auto& [frame, at] : number.keys) {
            const double left = (at - value_at(number, false, frame - h)) / h,
                         right = (value_at(number, false, frame + h) - at) / h;
            EXPECT_NEAR(left, right, 1e-3);
        }
    }
}

// Against central differences, also at keys, where straight lines turn, and beyond them.
TEST(NumberKeys, SayHowFastTheyChange) {
    constexpr double h = 1e-6;
    for (const auto interpolation : {kLinear, kSmooth}) {
        const NumberKeys number{{{-3, 350.0}, {4, 2.0}, {20, 40.0}, {21, 40.0}, {90, 200.0}}, interpolation};
        for (const double frame : {-9.0, -3.0, -1.2, 4.0, 11.0, 20.0, 20.5, 21.0, 60.0, 90.0, 100.0})
            EXPECT_NEAR(rate_at(number, frame),
                        (value_at(number, false, frame + h) - value_at(number, false, frame - h)) / (2.0 * h),
                        1e-4)
                << frame;
    }
    EXPECT_EQ(rate_at({{{1, 2.0}}, kLinear}, 1.0), 0.0);
}

NumberKeys two(double first, double last) {
    return {{{1, first}, {9, last}}, kLinear};
}

// What can't ever have keys says why; "yet" is of what only nobody has built.
TEST(NumberKeys, SayWhyThereAreNone) {
    for (const Key& key : keys()) {
        if (key.may_have_keys || key.type != KeyType::Number || !key.set) continue;
        const bool is_of_all = key.path.starts_with("shot.") || key.path.starts_with("quality.") ||
                               key.path.starts_with("output.");
        EXPECT_EQ(why_no_keys(key.path) == ": it is one for the whole shot", is_of_all) << key.path;
    }
    EXPECT_EQ(why_no_keys("waves.vessels[].length_m"), ": it is one for the whole shot");
    EXPECT_NE(why_no_keys("sea.gust_size_m").find("race"), std::string::npos);
    EXPECT_EQ(why_no_keys("camera.shift_x"), " yet");
}

// Every key of the table: those that may have keys take and give them, and a frame's scene is that of its plain number; the others say
// that they can't.
TEST(NumberKeys, OfTheWholeTable) {
    int taken = 0;
    for (const Key& key : keys()) {
        SCOPED_TRACE(key.path);
        Scene scene;
        if (!key.may_have_keys) {
            const std::string before = canonical(scene);
            const auto problem = set_value(scene, key, two(1.0, 2.0));
            ASSERT_TRUE(problem);
            EXPECT_TRUE(!key.set || problem->problem.find("can't have any") != std::string::npos)
                << problem->problem;
            EXPECT_EQ(canonical(scene), before);
            continue;
        }
        ++taken;
        ASSERT_EQ(key.type, KeyType::Number);
        EXPECT_NE(key.accepted.find("{ keys = "), std::string::npos);
        const double low = std::max(key.range->low, -1e3), high = std::min(key.range->high, 1e3);
        ASSERT_FALSE(set_value(scene, key, two(low, high)));
        EXPECT_EQ(value_of(scene, key), KeyValue(two(low, high)));
        EXPECT_THROW(refuse_keys(scene), std::invalid_argument);
        const double middle = value_at(two(low, high), key.is_angle, 4.0);
        Scene plain;
        ASSERT_FALSE(set_value(plain, key, middle));
        EXPECT_EQ(canonical(scene_at(scene, 4.0)), canonical(plain));
        EXPECT_TRUE(scene_at(scene, 4.0).keyed.empty());
        // What depends on it sees it, and a frame's fingerprint nothing of other frames.
        EXPECT_NE(canonical(scene, key.key_parts), canonical(Scene{}, key.key_parts));
        EXPECT_EQ(canonical(without_keyed(scene)), canonical(Scene{}));
        Scene other;
        set_value(other, key, NumberKeys{{{1, low}, {4, middle}, {9, low}}, kLinear});
        EXPECT_EQ(keyed_text(scene, key.key_parts, 4), keyed_text(other, key.key_parts, 4));
        EXPECT_NE(keyed_text(scene, key.key_parts, 9), keyed_text(other, key.key_parts, 9));
        EXPECT_EQ(keyed_text(scene, ~key.key_parts, 4), "");
        // Two equal values are that value, and a plain number takes the keys away.
        Scene equal;
        set_value(equal, key, two(middle, middle));
        for (const double frame : {-7.0, 1.0, 4.0, 9.0, 100.0})
            EXPECT_EQ(canonical(scene_at(equal, frame)), canonical(plain));
        set_value(equal, key, middle);
        EXPECT_TRUE(equal.keyed.empty());
        // A table takes its keys along, and no others.
        for (const KeyTable& table : key_tables()) {
            Scene copy;
            table.copy(scene, copy);
            const bool is_its = key.path.starts_with(table.name + '.');
            EXPECT_EQ(copy.keyed.size(), is_its ? 1u : 0u);
            bool is_refused = false;
            try {
                refuse_keys(scene, table.name);
            } catch (const std::invalid_argument&) {
                is_refused = true;
            }
            EXPECT_EQ(is_refused, is_its) << table.name;
        }
    }
    EXPECT_EQ(taken, 31);
}

// The same in the entries of lists: a number's path has its entry's index.
TEST(NumberKeys, OfEntriesOverTheWholeTable) {
    int taken = 0;
    for (const Key& list : keys())
        for (std::size_t k = 0; k < list.entry_keys.size(); ++k) {
            const Key& key = list.entry_keys[k];
            SCOPED_TRACE(key.path);
            KeyEntry entry;
            for (const Key& each : list.entry_keys) {
                KeyValue value = each.fallback;
                if (each.is_required && each.type == KeyType::Number)
                    value = std::clamp(1.0, each.range->low, each.range->high);
                if (each.is_required && each.type == KeyType::Integer) value = std::int64_t{64};
                entry.values.emplace_back(each.name, value);
            }
            const auto with = [&](KeyValue value) {
                std::vector<KeyEntry> entries{entry, entry};
                entries[1].values[k].second = std::move(value);
                return entries;
            };
            Scene scene;
            if (!key.may_have_keys) {
                const std::string before = canonical(scene);
                const auto problem = set_value(scene, list, with(two(1.0, 2.0)));
                ASSERT_TRUE(problem);
                EXPECT_NE(problem->problem.find("can't have any"), std::string::npos) << problem->problem;
                EXPECT_EQ(problem->key, list.path + "[1]." + key.name);
                EXPECT_EQ(canonical(scene), before);
                continue;
            }
            ++taken;
            const std::string path = list.path + "[1]." + key.name;
            EXPECT_EQ(&key_of(path), &key);
            const double low = std::max(key.range->low, 1.0), high = std::min(key.range->high, 9.0);
            ASSERT_FALSE(set_value(scene, list, with(two(low, high))));
            EXPECT_TRUE(value_of(scene, list) == KeyValue(with(two(low, high))));
            ASSERT_EQ(scene.keyed.size(), 1u);
            EXPECT_EQ(scene.keyed[0].path, path);
            EXPECT_EQ(table_key(scene.keyed[0]), list.path);
            const double middle = value_at(two(low, high), key.is_angle, 4.0);
            Scene plain, other, still;
            ASSERT_FALSE(set_value(plain, list, with(middle)));
            EXPECT_EQ(canonical(scene_at(scene, 4.0)), canonical(plain));
            EXPECT_EQ(number_of(scene_at(scene, 4.0), path), middle);
            EXPECT_TRUE(scene_at(scene, 4.0).keyed.empty());
            EXPECT_NE(canonical(scene, list.key_parts), canonical(plain, list.key_parts));
            set_value(other, list, with(NumberKeys{{{1, low}, {4, middle}, {9, low}}, kLinear}));
            EXPECT_EQ(canonical(without_keyed(scene)), canonical(without_keyed(other)));
            EXPECT_EQ(keyed_text(scene, list.key_parts, 4), keyed_text(other, list.key_parts, 4));
            EXPECT_NE(keyed_text(scene, list.key_parts, 9), keyed_text(other, list.key_parts, 9));
            EXPECT_EQ(keyed_text(scene, ~list.key_parts, 4), "");
            set_value(still, list, with(two(middle, middle)));
            EXPECT_EQ(canonical(without_still_keys(still)), canonical(plain));
            // A list that is shorter has no keys of what is gone, and other numbers' stay.
            set_value(scene, key_of("light.turbidity"), two(2.0, 3.0));
            set_value(scene, list, std::vector<KeyEntry>{entry});
            ASSERT_EQ(scene.keyed.size(), 1u);
            EXPECT_EQ(scene.keyed[0].path, "light.turbidity");
            EXPECT_TRUE(set_value(scene, list, with(NumberKeys{})));
        }
    EXPECT_EQ(taken, 4);
}

// Whoever fills Scene::keyed by hand may name what isn't there.
TEST(NumberKeys, OfAnEntryThatIsNotThereAreRefused) {
    Scene scene;
    scene.sea.swell = {{1.0, 9.0, 0.0}};
    scene.keyed = {{"sea.swell[1].height_m", two(1.0, 2.0)}};
    const std::vector<Problem> problems = validate(scene);
    ASSERT_EQ(problems.size(), 1u);
    EXPECT_NE(text_of(problems[0]).find("sea.swell[1].height_m"), std::string::npos);
    EXPECT_NE(problems[0].problem.find("no such entry"), std::string::npos);
}

std::string problem_of(const Scene& scene) {
    const std::vector<Problem> problems = validate(scene);
    return problems.size() == 1 ? text_of(problems.front()) : std::to_string(problems.size()) + " problems";
}

TEST(NumberKeys, ThatMakeNoSenseAreRefusedWithTheirPlace) {
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN(),
                     kInf = std::numeric_limits<double>::infinity();
    Scene scene;
    const auto of = [&](std::vector<NumberKeys::Key> keys) {
        scene.keyed = {{"light.turbidity", {std::move(keys), kLinear}}};
        return problem_of(scene);
    };
    EXPECT_EQ(of({{1, 2.0}, {5, 3.0}}), "0 problems");
    EXPECT_EQ(
        of({{1, 2.0}, {1, 3.0}}),
        "light.turbidity.keys[1] = [1, 3]: does not come after the key before, of frame 1; accepted: rising frames, "
        "each once");
    EXPECT_NE(of({{5, 2.0}, {1, 3.0}}).find("does not come after"), std::string::npos);
    EXPECT_NE(of({{1, 2.0}, {2, 1.0}}).find("keys[1] = [2, 1]: is outside the range; accepted: 1.7 … 10"),
              std::string::npos);
    EXPECT_NE(of({{1, kNan}}).find("keys[0] = [1, nan]: is not a number"), std::string::npos);
    EXPECT_NE(of({{1, kInf}}).find("is outside the range"), std::string::npos);
    EXPECT_NE(of({{-200000000, 2.0}}).find("is at a frame outside the range"), std::string::npos);
    scene.shot.loop_s = 2.0;
    EXPECT_NE(of({{1, 2.0}, {5, 3.0}}).find("a loop has no beginning"), std::string::npos);
    Scene none;
    EXPECT_TRUE(set_value(none, key_of("light.turbidity"), NumberKeys{}));
}

}  // namespace
}  // namespace pelagic
