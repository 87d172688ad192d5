// The law of spray against its integrals, taken independently: a plain sum over radii, in steps of 0.46 nm.
#include "core/plan/spray.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/base/constants.h"
#include "core/scene/limits.h"

namespace pelagic {
namespace {

SprayLaw bubbles(double wind_mps) {
    return spray_law(SpraySource::Monahan1986, wind_mps, 0.0);
}
Scene bubbles_scene() {
    Scene scene;
    scene.effects.spray_law = SpraySource::Monahan1986;
    return scene;
}
std::string warning_of(const Scene& scene) {
    return spray_warning(scene, 3.0);
}

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
        const SprayLaw law = bubbles(wind_mps);
        EXPECT_NEAR(law.number_flux_per_m2_s / number, 1.0, 1e-6);
        EXPECT_NEAR(law.mass_flux_kg_per_m2_s / mass, 1.0, 1e-6);
        EXPECT_NEAR(law.extinction_per_m() / (section / 0.01), 1.0, 1e-6);
    }
}

TEST(Spray, SaysFromWhichGainOnAPictureShowsIt) {
    Scene scene = bubbles_scene();
    scene.sea.wind_speed_mps = 20.0;
    EXPECT_EQ(warning_of(scene), "");
    scene.effects.spray = true;
    const std::string warning = warning_of(scene);
    Scene breeze = scene;
    breeze.sea.wind_speed_mps = 10.0;  // two digits, whatever doubles make of them
    EXPECT_NE(warning_of(breeze).find("takes 0.013 % of the light"), std::string::npos) << warning_of(breeze);
    const std::string key = "effects.spray_gain = ";
    const std::size_t at = warning.find(key);
    ASSERT_NE(at, std::string::npos) << warning;
    EXPECT_NE(warning.find("takes 0.14 % of the light"), std::string::npos) << warning;
    scene.effects.spray_gain = std::stod(warning.substr(at + key.size()));
    EXPECT_EQ(warning_of(scene), "");
    scene.effects.spray_gain *= 0.8;
    EXPECT_NE(warning_of(scene), "");
    scene.sea.wind_speed_mps = 0.0;
    EXPECT_EQ(warning_of(scene), "");
}

// In any wind the gain that is named is enough, is accepted, and half of it isn't enough.
TEST(Spray, NamesAGainThatIsEnoughInAnyWind) {
    Scene scene = bubbles_scene();
    scene.effects.spray = true;
    int named = 0, beyond = 0;
    for (double wind_mps = 0.02; wind_mps < 80.0; wind_mps *= 1.037) {
        scene.sea.wind_speed_mps = wind_mps;
        scene.effects.spray_gain = 1.0;
        const std::string warning = warning_of(scene);
        if (warning.empty()) {
            EXPECT_GT(wind_mps, 30.0) << "nature's own is seen in a hurricane";
            continue;
        }
        const std::string key = "effects.spray_gain = ";
        if (const std::size_t at = warning.find(key); at != std::string::npos) {
            const double gain = std::stod(warning.substr(at + key.size()));
            EXPECT_TRUE(limits::kSprayGain.holds(gain)) << warning;
            scene.effects.spray_gain = gain;
            EXPECT_EQ(warning_of(scene), "") << wind_mps;
            scene.effects.spray_gain = 0.49 * gain;
            EXPECT_NE(warning_of(scene), "") << wind_mps;
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
    EXPECT_EQ(warning_of(scene), "effects.spray_gain = 0 leaves no spray");
}

// Where the wind tears no crests there is nothing for a gain to multiply.
TEST(Spray, SaysThatAGaleIsNeeded) {
    Scene scene;
    scene.effects.spray = true;
    scene.sea.wind_speed_mps = 7.0;
    EXPECT_NE(warning_of(scene).find("it takes 9 m/s"), std::string::npos) << warning_of(scene);
    scene.sea.wind_speed_mps = 12.0;
    EXPECT_NE(warning_of(scene).find("effects.spray_gain = "), std::string::npos) << warning_of(scene);
    scene.sea.wind_speed_mps = 20.0;
    EXPECT_EQ(warning_of(scene), "") << "gain 1 is seen in a gale";
}

// 1e-4 at 10 m/s and 3e-3 at 25: far too thin to be seen.
TEST(Spray, TheWholeLayerIsThin) {
    EXPECT_NEAR(bubbles(10.0).optical_thickness(), 1.31e-4, 0.01e-4);
    EXPECT_NEAR(bubbles(25.0).optical_thickness(), 2.98e-3, 0.01e-3);
}

// Gunn and Kinzer 1949 [m/s] at radii of 50, 100 and 500 µm, to the 6 % that the drag law is good for.
TEST(Spray, DropsFallAsTheyWereSeenTo) {
    for (const auto& [radius_um, seen_mps] : {std::pair(50.0, 0.27), {100.0, 0.72}, {500.0, 4.03}})
        EXPECT_NEAR(settling_mps(radius_um) / seen_mps, 1.0, 0.07) << radius_um;
    EXPECT_NEAR(settling_mps(1.0) / (2.0 / 9.0 * 1023.8 * 9.81 * 1e-12 / 1.8e-5), 1.0, 2e-3) << "Stokes";
}

// Fluxes, extinctions and thicknesses of a wind over its own waves, by a plain sum in another program.
TEST(Spray, TornOffCrestsItIsAsMuchAsItsPapersSay) {
    struct AndreasCase {
        double wind_mps, height_m, mass, extinction, thickness;
    };
    for (const AndreasCase& of : {AndreasCase{15.0, 4.817, 4.84e-5, 8.90e-4, 4.16e-3},
                                  AndreasCase{20.0, 8.563, 1.88e-4, 3.39e-3, 2.68e-2},
                                  AndreasCase{25.0, 13.38, 6.22e-4, 1.09e-2, 0.124},
                                  AndreasCase{32.0, 21.92, 2.78e-3, 4.67e-2, 0.754}}) {
        const SprayLaw law = spray_law(SpraySource::Andreas1998, of.wind_mps, of.height_m);
        EXPECT_NEAR(law.mass_flux_kg_per_m2_s / of.mass, 1.0, 0.01) << of.wind_mps;
        EXPECT_NEAR(law.extinction_per_m() / of.extinction, 1.0, 0.01) << of.wind_mps;
        EXPECT_NEAR(law.optical_thickness() / of.thickness, 1.0, 0.01) << of.wind_mps;
        double sum = 0.0;
        for (int i = 0; i < 20000; ++i) {
            const double r_um = 10.0 + (i + 0.5) * 240.0 / 20000;
            sum += spray_source(SpraySource::Andreas1998, of.wind_mps, r_um) * 240.0 / 20000;
        }
        EXPECT_NEAR(law.number_flux_per_m2_s / sum, 1.0, 1e-5) << of.wind_mps;
    }
    // Continuous in the radius.
    for (const double r_um : {37.5, 100.0})
        EXPECT_NEAR(spray_source(SpraySource::Andreas1998, 20.0, r_um * (1.0 + 1e-9)) /
                        spray_source(SpraySource::Andreas1998, 20.0, r_um * (1.0 - 1e-9)),
                    1.0, 1e-6);
}

TEST(Spray, IsFiniteAndGrowsUpToWhatHasBeenSeen) {
    double before = 0.0;
    for (double wind_mps = 0.0; wind_mps <= 80.0; wind_mps += 0.25)
        for (const double height_m : {0.0, 0.3, 6.0, 40.0}) {
            const SprayLaw law = spray_law(SpraySource::Andreas1998, wind_mps, height_m);
            ASSERT_TRUE(std::isfinite(law.optical_thickness()) && std::isfinite(law.extinction_per_m()))
                << wind_mps;
            if (wind_mps <= 8.0) {
                EXPECT_EQ(law.optical_thickness(), 0.0);
            }
            if (height_m != 6.0) continue;
            EXPECT_GE(law.optical_thickness(), before) << wind_mps;
            before = law.optical_thickness();
        }
    EXPECT_EQ(spray_law(SpraySource::Andreas1998, 80.0, 6.0).optical_thickness(),
              spray_law(SpraySource::Andreas1998, 32.0, 6.0).optical_thickness());
}

// What drops have, ribbons lack. Their share by a plain sum in another program.
TEST(Spray, VeilAndDropsAreTheLaw) {
    for (const double wind_mps : {12.0, 20.0, 32.0, 60.0})
        for (const double height_m : {0.0, 2.0, 8.0, 20.0}) {
            const SprayLaw whole = spray_law(SpraySource::Andreas1998, wind_mps, height_m),
                           parted = spray_law(SpraySource::Andreas1998, wind_mps, height_m, true);
            EXPECT_EQ(whole.drops.optical_thickness, 0.0);
            EXPECT_EQ(whole.with_drops(), 1.0);
            EXPECT_GT(parted.drops.optical_thickness, 0.0);
            EXPECT_GT(parted.ribbons.extinction_per_m.z, 0.0);
            EXPECT_NEAR(parted.optical_thickness() / whole.optical_thickness(), 1.0, 1e-12);
            EXPECT_NEAR(
                parted.with_drops() * parted.ribbons.optical_thickness() / whole.ribbons.optical_thickness(),
                1.0, 1e-12);
            for (std::size_t i = 0; i < parted.drops.radii_um.size(); ++i) {
                EXPECT_GE(parted.drops.radii_um[i], i > 0 ? parted.drops.radii_um[i - 1] : 80.0);
                EXPECT_LT(parted.drops.radii_um[i], 563.0);
            }
            EXPECT_EQ(spray_law(SpraySource::Monahan1986, wind_mps, height_m, true).drops.optical_thickness,
                      0.0);
        }
    const SprayLaw gale = spray_law(SpraySource::Andreas1998, 20.0, 8.0, true);
    EXPECT_NEAR(gale.drops.optical_thickness / gale.optical_thickness(), 0.175, 0.01);
    Scene scene;
    scene.sea.wind_speed_mps = 20.0;
    scene.effects.spray = scene.effects.spray_drops = true;
    scene.effects.spray_gain = 7.0;
    EXPECT_NEAR(spray_law(scene, 8.0).drops.optical_thickness, 7.0 * gale.drops.optical_thickness, 1e-12);
}

TEST(Spray, ThereIsNoneWithoutWindOrWhereItIsOff) {
    EXPECT_EQ(bubbles(0.0).extinction_per_m(), 0.0);
    for (const SpraySource law : {SpraySource::Monahan1986, SpraySource::Andreas1998}) {
        Scene scene;
        scene.effects.spray_law = law;
        EXPECT_EQ(spray_law(scene, 2.0).mass_flux_kg_per_m2_s, 0.0);
        scene.effects.spray = true;
        scene.effects.spray_gain = 300.0;
        const SprayLaw natural = spray_law(law, scene.sea.wind_speed_mps, 2.0);
        EXPECT_NEAR(spray_law(scene, 2.0).extinction_per_m() / natural.extinction_per_m(), 300.0, 1e-9);
        EXPECT_NEAR(spray_law(scene, 2.0).optical_thickness() / natural.optical_thickness(), 300.0, 1e-9);
        scene.effects.whitecaps = false;
        EXPECT_EQ(spray_law(scene, 2.0).extinction_per_m(), 0.0);
        EXPECT_FALSE(has_spray(scene));
    }
}

}  // namespace
}  // namespace pelagic
