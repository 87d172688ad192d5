// The law of spray against its integrals, taken independently: a plain sum over radii, in steps of 0.46 nm.
#include "core/plan/spray.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/base/constants.h"
#include "core/scene/limits.h"

namespace pelagic {
namespace {

TEST(Spray, FluxesAndExtinctionAreTheSourceFunctionsIntegrals) {
    for (const double wind_mps : {3.0, 10.0, 25.0, 80.0}) {
        double number = 0.0, mass = 0.0, section = 0.0;
        constexpr int kSteps = 20000;
        const double step_um = (10.0 - 0.8) / kSteps;
        for (int i = 0; i < kSteps; ++i) {
            const double r_um = 0.8 + (i + 0.5) * step_um, r_m = r_um * 1e-6;
            const double b = (0.380 - std::log10(r_um)) / 0.650;
            const double flux = step_um * 1.373 * std::pow(wind_mps, 3.41) / (r_um * r_um * r_um) *
                                (1.0 + 0.057 * std::pow(r_um, 1.05)) *
                                std::pow(10.0, 1.19 * std::exp(-b * b));
            number += flux;
            mass += flux * 4.0 / 3.0 * kPi * r_m * r_m * r_m * 1025.0;
            section += flux * 2.0 * kPi * r_m * r_m;
        }
        const SprayLaw law = spray_law(wind_mps);
        EXPECT_NEAR(law.number_flux_per_m2_s / number, 1.0, 1e-6);
        EXPECT_NEAR(law.mass_flux_kg_per_m2_s / mass, 1.0, 1e-6);
        EXPECT_NEAR(law.extinction_per_m / (section / 0.01), 1.0, 1e-6);
    }
}

TEST(Spray, SaysFromWhichGainOnAPictureShowsIt) {
    Scene scene;
    scene.sea.wind_speed_mps = 20.0;
    EXPECT_EQ(spray_warning(scene), "");
    scene.effects.spray = true;
    const std::string warning = spray_warning(scene);
    Scene breeze = scene;
    breeze.sea.wind_speed_mps = 10.0;  // two digits, whatever doubles make of them
    EXPECT_NE(spray_warning(breeze).find("takes 0.013 % of the light"), std::string::npos)
        << spray_warning(breeze);
    const std::string key = "effects.spray_gain = ";
    const std::size_t at = warning.find(key);
    ASSERT_NE(at, std::string::npos) << warning;
    EXPECT_NE(warning.find("takes 0.14 % of the light"), std::string::npos) << warning;
    scene.effects.spray_gain = std::stod(warning.substr(at + key.size()));
    EXPECT_EQ(spray_warning(scene), "");
    scene.effects.spray_gain *= 0.8;
    EXPECT_NE(spray_warning(scene), "");
    scene.sea.wind_speed_mps = 0.0;
    EXPECT_EQ(spray_warning(scene), "");
}

// In any wind the gain that is named is enough, is accepted, and half of it isn't enough.
TEST(Spray, NamesAGainThatIsEnoughInAnyWind) {
    Scene scene;
    scene.effects.spray = true;
    int named = 0, beyond = 0;
    for (double wind_mps = 0.02; wind_mps < 80.0; wind_mps *= 1.037) {
        scene.sea.wind_speed_mps = wind_mps;
        scene.effects.spray_gain = 1.0;
        const std::string warning = spray_warning(scene);
        if (warning.empty()) {
            EXPECT_GT(wind_mps, 30.0) << "nature's own is seen in a hurricane";
            continue;
        }
        const std::string key = "effects.spray_gain = ";
        if (const std::size_t at = warning.find(key); at != std::string::npos) {
            const double gain = std::stod(warning.substr(at + key.size()));
            EXPECT_TRUE(limits::kSprayGain.holds(gain)) << warning;
            scene.effects.spray_gain = gain;
            EXPECT_EQ(spray_warning(scene), "") << wind_mps;
            scene.effects.spray_gain = 0.49 * gain;
            EXPECT_NE(spray_warning(scene), "") << wind_mps;
            ++named;
        } else {
            EXPECT_NE(warning.find("no effects.spray_gain shows it"), std::string::npos)
                << wind_mps << warning;
            ++beyond;
        }
    }
    EXPECT_GT(named, 50);
    EXPECT_GT(beyond, 20);
    scene.effects.spray_gain = 0.0;
    EXPECT_EQ(spray_warning(scene), "effects.spray_gain = 0 leaves no spray");
}

// 1e-4 at 10 m/s and 3e-3 at 25: far too thin to be seen.
TEST(Spray, TheWholeLayerIsThin) {
    EXPECT_NEAR(spray_law(10.0).optical_thickness(), 1.31e-4, 0.01e-4);
    EXPECT_NEAR(spray_law(25.0).optical_thickness(), 2.98e-3, 0.01e-3);
}

TEST(Spray, ThereIsNoneWithoutWindOrWhereItIsOff) {
    EXPECT_EQ(spray_law(0.0).extinction_per_m, 0.0);
    Scene scene;
    EXPECT_EQ(spray_law(scene).mass_flux_kg_per_m2_s, 0.0);
    scene.effects.spray = true;
    scene.effects.spray_gain = 300.0;
    EXPECT_NEAR(spray_law(scene).extinction_per_m, 300.0 * spray_law(10.0).extinction_per_m, 1e-12);
    scene.effects.whitecaps = false;
    EXPECT_EQ(spray_law(scene).extinction_per_m, 0.0);
}

}  // namespace
}  // namespace pelagic
