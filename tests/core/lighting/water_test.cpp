// The colour of the water, as plankton and rivers change it.
#include "core/lighting/water.h"

#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>
#include <limits>
#include <stdexcept>

namespace pelagic {
namespace {

// What rivers add, or nothing.
struct Rivers {
    double yellow_per_m = 0.0, minerals_g_m3 = 0.0;
};
constexpr Rivers kNone, kCoast{0.1, 0.7}, kEstuary{0.5, 6.0};

WaterBody body_of(const Rivers& rivers, double chlorophyll) {
    return water_body({.chlorophyll_mg_m3 = chlorophyll,
                       .yellow_per_m = rivers.yellow_per_m,
                       .minerals_g_m3 = rivers.minerals_g_m3});
}
glm::vec3 colour(const Rivers& rivers, double chlorophyll) {
    return body_of(rivers, chlorophyll).reflectance;
}

// Case 1 waters, from Jerlov and Morel: the clearest oceans reflect some 5 … 12 % of the blue, a few per cent
// of the green, and hardly any red, which water absorbs within metres.
TEST(WaterBody, ClearOceanIsDeepBlue) {
    const glm::vec3 c = colour(kNone, 0.03);
    EXPECT_GT(c.b, 0.05f);
    EXPECT_LT(c.b, 0.12f);
    EXPECT_GT(c.b, 2.0f * c.g);
    EXPECT_LT(c.r, 0.1f * c.b);
}

// Plankton absorbs blue: the more plankton, the greener.
TEST(WaterBody, PlanktonTurnsBlueIntoGreen) {
    float last = 0.0f;
    for (double chlorophyll : {0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0}) {
        const glm::vec3 c = colour(kNone, chlorophyll);
        EXPECT_GT(c.g / c.b, last) << chlorophyll;
        last = c.g / c.b;
    }
    EXPECT_GT(last, 1.2f);
}

TEST(WaterBody, RiversMakeItBrighterAndBrowner) {
    const glm::vec3 ocean = colour(kNone, 1.0), coastal = colour(kCoast, 1.0), turbid = colour(kEstuary, 1.0);
    EXPECT_GT(coastal.g, coastal.b);
    EXPECT_GT(coastal.g, coastal.r);
    EXPECT_GT(turbid.g, turbid.b);
    EXPECT_GT(turbid.r, turbid.b);
    EXPECT_GT(turbid.g, coastal.g);
    EXPECT_GT(coastal.g, ocean.g);
}

// Pope and Fry 1997 at 610 nm: 0.2644 1/m, all but alone in clear water; in blue the light goes on for tens of metres.
// Rivers dim it within metres. At each wavelength 0.33 b_b/(a + b_b) is near the reflectance's channel.
TEST(WaterBody, CoefficientsAreThoseOfTheReflectance) {
    const WaterBody clear = body_of(kNone, 0.03), turbid = body_of(kEstuary, 3.0);
    EXPECT_NEAR(clear.absorption_per_m.r, 0.2644f, 0.01f);
    EXPECT_LT(clear.absorption_per_m.b, 0.03f);
    EXPECT_GT(turbid.absorption_per_m.b, 0.3f);
    for (int i = 0; i < 3; ++i) {
        EXPECT_GT(turbid.backscatter_per_m[i], 10.0f * clear.backscatter_per_m[i]);
        const float b = turbid.backscatter_per_m[i];
        EXPECT_NEAR(0.33f * b / (turbid.absorption_per_m[i] + b) / turbid.reflectance[i], 1.0f, 0.35f);
    }
}

// 0.33 b_b/(a + b_b) is below 0.33 for any content, and no component is negative.
TEST(WaterBody, StaysAReflectance) {
    for (const Rivers& rivers : {kNone, kCoast, kEstuary}) {
        for (double chlorophyll : {0.0, 1e-300, 1e-3, 1.0, 30.0, 100.0}) {
            const glm::vec3 c = colour(rivers, chlorophyll);
            for (int i = 0; i < 3; ++i) {
                EXPECT_GE(c[i], 0.0f);
                EXPECT_LT(c[i], 0.33f);
            }
        }
    }
}

TEST(WaterBody, RefusesWhatIsNoChlorophyll) {
    for (double c :
         {-1e-9, 100.1, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        EXPECT_THROW(colour(kNone, c), std::invalid_argument);
    }
}

}  // namespace
}  // namespace pelagic
