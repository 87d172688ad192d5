// How much of a sea folds over itself, against counting it on a grid, and the warning of it.
#include "core/waves/folding.h"

#include <gtest/gtest.h>

#include "core/waves/frame.h"
#include "core/waves/sea.h"
#include "tests/core/waves/samples.h"

namespace pelagic {
namespace {

Scene choppy(double choppiness) {
    Scene scene;
    scene.sea.wind_speed_mps = 14.0;
    scene.waves.choppiness = choppiness;
    return scene;
}

TEST(Folding, WarnsOfMoreThanTwentiethAndSaysWhatLeavesThat) {
    EXPECT_TRUE(sea_warnings(*prepare(choppy(1.0))).empty());
    const auto prepared = prepare(choppy(4.0));
    const std::vector<std::string> warnings = sea_warnings(*prepared);
    ASSERT_EQ(warnings.size(), 1u);
    const std::string key = "waves.choppiness = ";
    const std::size_t at = warnings[0].find(key);
    ASSERT_NE(at, std::string::npos) << warnings[0];
    const double advised = std::stod(warnings[0].substr(at + key.size()));
    EXPECT_LE(folded_share(prepared->spectrum, advised), 0.05);
    EXPECT_GT(folded_share(prepared->spectrum, advised + 0.02), 0.05);
    EXPECT_TRUE(sea_warnings(*prepare(choppy(advised))).empty());
}

TEST(Folding, GrowsWithChoppinessFromNothing) {
    const auto prepared = prepare(choppy(1.0));
    EXPECT_EQ(folded_share(prepared->spectrum, 0.0), 0.0);
    double before = 0.0;
    for (double choppiness = 0.5; choppiness <= 10.0; choppiness += 0.5) {
        const double share = folded_share(prepared->spectrum, choppiness);
        EXPECT_GE(share, before);
        EXPECT_LE(share, 1.0);
        before = share;
    }
    EXPECT_GT(before, 0.2);
    Scene calm;
    calm.sea.wind_speed_mps = 0.0;
    EXPECT_EQ(folded_share(prepare(calm)->spectrum, 10.0), 0.0);
}

}  // namespace
}  // namespace pelagic
