// Seas that can't be are refused, with the height that could be.
#include "core/spectrum/possible.h"

#include <gtest/gtest.h>

#include "core/scene/presets.h"

namespace pelagic {
namespace {

void expect_refused(const SeaState& sea, const std::string& key, const std::string& words) {
    const std::vector<Problem> problems = impossible_waves(sea);
    ASSERT_EQ(problems.size(), 1u) << key;
    EXPECT_EQ(problems[0].key, key);
    EXPECT_NE(text_of(problems[0]).find(words), std::string::npos) << text_of(problems[0]);
    // What it says is accepted is.
    SeaState mended = sea;
    const std::string accepted = problems[0].accepted;
    const double height = std::stod(accepted.substr(accepted.find("… ") + std::string("… ").size()));
    (mended.swell.empty() ? *mended.significant_height_m : mended.swell[0].height_m) = height;
    EXPECT_TRUE(impossible_waves(mended).empty()) << height;
}

TEST(ImpossibleWaves, AreSwellsThatBreak) {
    SeaState sea;
    sea.swell = {{50.0, 1.0, 0.0}};
    expect_refused(sea, "sea.swell[0].height_m", "1.5 m long: they break; accepted: 0 … 0.22");
    sea.swell = {{8.0, 6.0, 0.0}};  // 56 m long
    expect_refused(sea, "sea.swell[0].height_m", "they break");
    sea.depth_m = 4.0;
    sea.swell = {{2.5, 12.0, 0.0}};
    expect_refused(sea, "sea.swell[0].height_m",
                   "water of 4 m can carry: higher waves have broken; accepted: 0 … 2.4");
}

TEST(ImpossibleWaves, AreHeightsBeyondTheWindsWaves) {
    SeaState sea;
    sea.wind_speed_mps = 3.0;
    sea.significant_height_m = 5.0;
    EXPECT_TRUE(
        impossible_waves(sea).empty());  // its peak goes with the height: a long sea under little wind
    sea.growth = GrowthLaw::Height;
    expect_refused(sea, "sea.significant_height_m", "or more wind or fetch");
    sea.wind_speed_mps = 20.0;
    sea.depth_m = 3.0;
    expect_refused(sea, "sea.significant_height_m", "accepted: 0 … 1.8");
}

// It would be left out in silence.
TEST(ImpossibleWaves, AreHeightsOfNoWaves) {
    SeaState sea;
    sea.wind_speed_mps = 0.0;
    sea.significant_height_m = 1.0;
    sea.swell = {{2.0, 12.0, 0.0}};
    const std::vector<Problem> problems = impossible_waves(sea);
    ASSERT_EQ(problems.size(), 1u);
    EXPECT_NE(text_of(problems.front()).find("without wind there are no waves"), std::string::npos);
    sea.significant_height_m = 0.0;
    EXPECT_TRUE(impossible_waves(sea).empty());
    sea.significant_height_m = 1.0;
    sea.spectrum = SpectrumKind::File;
    sea.measured =
        MeasuredSpectrum{.bins = {{0.1, 0.0, 1.0, 0.0, 1.0, 0.0, true}, {0.2, 0.0, 1.0, 0.0, 1.0, 0.0, true}},
                         .station = "41010",
                         .time = "2019-02-06T00:40:00Z"};
    EXPECT_EQ(impossible_waves(sea).size(), 1u);
}

TEST(ImpossibleWaves, AreNoPresets) {
    for (const Preset& preset : presets()) {
        Scene scene;
        apply(preset, scene);
        EXPECT_TRUE(problems_of(scene).empty()) << preset.name;
    }
}

// What wind, fetch and depth give is never refused: the hardest of each.
TEST(ImpossibleWaves, AreNoWindSeas) {
    for (double wind : {0.0, 0.1, 10.0, 80.0})
        for (double fetch : {1.0, 1e7})
            for (double depth : {0.01, 20.0}) {
                Scene scene;
                scene.sea.wind_speed_mps = wind;
                scene.sea.fetch_m = fetch;
                scene.sea.depth_m = depth;
                EXPECT_TRUE(problems_of(scene).empty());
            }
}

}  // namespace
}  // namespace pelagic
