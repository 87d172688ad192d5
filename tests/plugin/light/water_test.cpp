// What a shot's water is.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "core/lighting/lighting.h"
#include "core/scene/validate.h"
#include "plugin/light/light.h"

namespace pelagic {
namespace {

Scene with_type(WaterType type) {
    Scene scene;
    scene.water.type = type;
    return scene;
}

// Jerlov's K_d (1976) [1/m] at the six wavelengths, the sun 30° from the zenith, by what each type absorbs and scatters (Lee et al. 2005). How far apart
// they may be is how far the fit was.
TEST(Water, OfJerlovsTypesDimsLightAsHeSaw) {
    struct Row {
        WaterType type;
        std::array<double, 6> k_per_m;
        double rms;  // of ln K
    };
    const Row rows[] = {{WaterType::JerlovI, {.020, .020, .040, .068, .177, .316}, 0.18},
                        {WaterType::JerlovIA, {.028, .026, .045, .072, .182, .322}, 0.12},
                        {WaterType::JerlovIB, {.038, .035, .052, .077, .187, .327}, 0.09},
                        {WaterType::JerlovII, {.073, .064, .075, .094, .202, .348}, 0.07},
                        {WaterType::JerlovIII, {.145, .116, .116, .126, .236, .389}, 0.06},
                        {WaterType::Jerlov1C, {.29, .16, .13, .13, .24, .39}, 0.06},
                        {WaterType::Jerlov3C, {.45, .28, .20, .19, .28, .41}, 0.05},
                        {WaterType::Jerlov5C, {.65, .42, .32, .31, .37, .49}, 0.07},
                        {WaterType::Jerlov7C, {1.0, .68, .51, .46, .47, .56}, 0.06},
                        {WaterType::Jerlov9C, {1.7, 1.2, .82, .62, .59, .67}, 0.05}};
    for (const Row& row : rows) {
        const WaterBody water = make_water(with_type(row.type));
        double sum = 0.0;
        for (int i = 0; i < 6; ++i) {
            const double a = i < 3 ? water.absorption.shorter[i] : water.absorption.longer[i - 3],
                         b = i < 3 ? water.backscatter.shorter[i] : water.backscatter.longer[i - 3];
            const double k = (1.0 + 0.005 * 30.0) * a + 4.18 * (1.0 - 0.52 * std::exp(-10.8 * a)) * b;
            sum += std::pow(std::log(k / row.k_per_m[static_cast<std::size_t>(i)]), 2.0);
        }
        EXPECT_LT(std::sqrt(sum / 6.0), row.rms + 0.04) << static_cast<int>(row.type);
    }
}

// In all directions: sea water twice its backscatter, particles 55 to 200 times theirs, at most minerals' 1/0.018.
TEST(Water, ScattersMostlyAhead) {
    for (const WaterType type :
         {WaterType::Ocean, WaterType::JerlovI, WaterType::Jerlov5C, WaterType::Turbid}) {
        const WaterBody water = make_water(with_type(type));
        for (int i = 0; i < 3; ++i) {
            const float own = 0.00144f * std::pow((i == 0   ? 440.0f
                                                   : i == 1 ? 480.0f
                                                            : 520.0f) /
                                                      500.0f,
                                                  -4.32f);
            const float particles = water.scattering.shorter[i] - 2.0f * own,
                        back = water.backscatter.shorter[i] - own;
            EXPECT_GT(particles, 54.0f * back) << i;
            EXPECT_LT(particles, 200.0f * back) << i;
        }
    }
}

TEST(Water, OfJerlovsTypesHasItsOwnPlankton) {
    Scene scene = with_type(WaterType::JerlovII);
    EXPECT_TRUE(validate(scene).empty());
    scene.water.chlorophyll_mg_m3 = 1.0;
    const auto problems = validate(scene);
    ASSERT_EQ(problems.size(), 1u);
    EXPECT_EQ(problems[0].key, "water.chlorophyll_mg_m3");
}

// Hosts that have one colour of water see a floor in it.
TEST(Water, HasTheColourOfItsFloor) {
    Scene deep, lagoon, off;
    lagoon.sea.depth_m = 3.0;
    off.sea.depth_m = 3.0;
    off.water.body = false;
    EXPECT_GT(make_water(lagoon).reflectance.g, 3.0f * make_water(deep).reflectance.g);
    EXPECT_FALSE(make_water(off).has_body);
    off.sea.depth_m = deep.sea.depth_m;
    const auto constant = make_water(off).reflectance;
    off.sea.depth_m = 3.0;
    EXPECT_EQ(make_water(off).reflectance, constant);
}

// What the sea's waves say: crests are longer in a storm, bubbles deeper, and the surface rougher; a calm has none of it.
TEST(Water, HasTheSeasWaves) {
    Scene breeze, storm, calm;
    breeze.sea.wind_speed_mps = 6.0;
    storm.sea.wind_speed_mps = 25.0;
    calm.sea.wind_speed_mps = 0.0;
    const WaterBody a = make_water(breeze), b = make_water(storm), none = make_water(calm);
    EXPECT_GT(a.crest_per_m, 1.5f * b.crest_per_m);
    EXPECT_GT(b.crest_per_m, 0.02f);
    EXPECT_GT(b.bubbles_m, 4.0f * a.bubbles_m);
    EXPECT_GT(b.waves.x + b.waves.y, 1.5f * (a.waves.x + a.waves.y));
    EXPECT_EQ(none.crest_per_m, 0.0f);
    EXPECT_EQ(none.bubbles_m, 0.0f);
    EXPECT_LT(none.waves.x, 1e-9f);
}

}  // namespace
}  // namespace pelagic
