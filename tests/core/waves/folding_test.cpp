// How much of a sea folds over itself, against counting it on a grid, and the warning of it.
#include "core/waves/folding.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/plan/random_tiling.h"
#include "core/scene/validate.h"
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

// A swell is held to its depth, but several together aren't. Unit: Rayleigh's deepest of a thousand troughs, 0.93 Hs.
TEST(SeaWarnings, SayThatTroughsReachTheBed) {
    Scene shallow;
    shallow.sea.wind_speed_mps = 0.0;
    shallow.sea.depth_m = 4.0;
    shallow.waves.choppiness = 0.0;
    shallow.sea.swell = {{2.4, 12.0, 0.0}, {2.4, 11.0, 30.0}, {2.4, 10.0, 60.0}};  // 4.16 m together
    const auto of = [&] { return sea_warnings(*prepare(shallow)); };
    EXPECT_TRUE(of().empty());
    shallow.sea.swell.push_back({2.4, 9.0, 90.0});  // 4.8 m
    ASSERT_EQ(of().size(), 1u);
    EXPECT_NE(of()[0].find("4.5 m deep and would lie under the bed"), std::string::npos) << of()[0];
    EXPECT_NE(of()[0].find("sea.depth_m"), std::string::npos);
    shallow.sea.depth_m = 4.6;
    EXPECT_TRUE(of().empty());
}

// The peak of 9 s: 13 % shorter in 8 m than in 12.
TEST(SeaWarnings, SayThatAMapsEdgeIsNotAsDeepAsTheSea) {
    const auto warnings = [](double edge_m, double size_m, float ashore = 1.0f) {
        std::vector<float> depths;
        for (int y = 0; y < 10; ++y)
            for (int x = 0; x < 10; ++x)
                depths.push_back(static_cast<float>(edge_m) + ashore * (-0.1f * static_cast<float>(x)));
        Scene scene;
        scene.sea.wind_speed_mps = 0.0;
        scene.sea.depth_m = 12.0;
        scene.sea.depth_file = "bay.exr";
        scene.sea.swell = {{.height_m = 0.6, .period_s = 9.0, .direction_deg = 50.0}};
        scene.waves.model = WaveModel::Trochoid;
        scene.waves.coast = true;
        scene.waves.coast_depths = std::make_shared<const DepthMap>(glm::ivec2(10), std::move(depths),
                                                                    glm::dvec2(0.0), glm::dvec2(size_m));
        return sea_warnings(*prepare(scene));
    };
    EXPECT_TRUE(warnings(12.0, 400.0).empty());
    EXPECT_TRUE(warnings(11.0, 400.0).empty());
    const auto shallow = warnings(8.0, 400.0);
    ASSERT_EQ(shallow.size(), 1u);
    EXPECT_NE(shallow[0].find("sea.depth_m = 8"), std::string::npos) << shallow[0];
    EXPECT_EQ(warnings(20.0, 400.0).size(), 1u);
    ASSERT_EQ(warnings(-1.0, 400.0).size(), 1u);
    EXPECT_NE(warnings(-1.0, 400.0)[0].find("dry"), std::string::npos);
    const auto coarse = warnings(12.0, 20e3);
    ASSERT_EQ(coarse.size(), 1u);
    EXPECT_NE(coarse[0].find("cells of 78 m"), std::string::npos) << coarse[0];
    // With a beach to the east they come over the western edge.
    const auto eastern = warnings(8.0, 400.0, 8.0f);
    ASSERT_EQ(eastern.size(), 1u);
    EXPECT_NE(eastern[0].find("western"), std::string::npos) << eastern[0];
}

// Long waves without choppiness beside ripples with it: nothing that breaks is pressed together.
TEST(SeaWarnings, SayThatNothingBreaksForLackOfChoppiness) {
    Scene scene = choppy(1.0);
    scene.waves.tiling = Tiling::Random;
    scene.waves.cascades = {{.size_m = 2000.0, .resolution = 1024, .choppiness = 0.0},
                            {.size_m = 5.0, .resolution = 64, .choppiness = 1.0}};
    const auto told = [&] {
        const std::vector<std::string> warnings = sea_warnings(*prepare(scene));
        return std::any_of(warnings.begin(), warnings.end(), [](const std::string& warning) {
            return warning.find("there is no foam") != std::string::npos;
        });
    };
    EXPECT_TRUE(told());
    scene.effects.whitecaps = false;
    EXPECT_FALSE(told());
    scene.effects.whitecaps = true;
    scene.waves.cascades[0].choppiness = 0.5;
    EXPECT_FALSE(told());
    scene.waves.cascades.clear();
    EXPECT_FALSE(told());
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

// Of explicit periodic tiles alone: where the patch is larger or, as far as one sees, a tile holds few waves of the peak.
TEST(Repeats, OfExplicitTilesAreToldOf) {
    Scene scene;
    scene.waves.tiling = Tiling::Periodic;
    const auto tells = [&] {
        for (const std::string& warning : sea_warnings(*prepare(scene)))
            if (warning.find("repeats after") != std::string::npos) return true;
        return false;
    };
    EXPECT_FALSE(tells());
    scene.waves.cascades = {{1000.0, 128}, {200.0, 128}};
    EXPECT_FALSE(tells());
    scene.surface.size_m = 1001.0;
    EXPECT_TRUE(tells());
    scene.waves.tiling = Tiling::Random;
    EXPECT_FALSE(tells());
    scene.waves.tiling = Tiling::Periodic;
    scene.surface.size_m = 100.0;
    scene.waves.cascades = {{200.0, 128}};
    EXPECT_FALSE(tells());
    scene.surface.kind = SurfaceKind::ProjectedGrid;
    EXPECT_TRUE(tells());
}

// What copies add to the slopes of the largest tile, of the energies that its modes have.
double gain_of(const Scene& scene) {
    Query query;
    query.name = "tile";
    query.products = products(Product::SlopeVariance);
    query.only_cascade = 0;
    const Sea<double> sea(make_plan(scene, {query}));
    const SpectralMoments& own = sea.statistics(0).resolved.front();
    const double size_m = scene.waves.cascades.front().size_m;
    return 2.0 * kBlendSlopes * own.m0 / (size_m * size_m * own.mss());
}

// Of any sea and any explicit sizes, where it is more than 5 %, with what it is and a size that helps.
TEST(BlendingGains, IsToldOfWithWhatHelps) {
    const std::string of_share = "which adds ", of_size = "size_m = ";
    std::vector<Scene> seas(4);
    seas[1].sea.wind_speed_mps = 3.0;
    seas[2].sea.wind_speed_mps = 0.0;
    seas[2].sea.swell = {{2.0, 12.0, 40.0}};
    seas[3].sea.directionality = 5.0;
    int told = 0, untold = 0;
    for (Scene scene : seas) {
        const double peak_m = kTwoPi / prepare(scene)->spectrum.longest_peak_wavenumber();
        EXPECT_TRUE(sea_warnings(*prepare(scene)).empty());
        for (const double waves : {0.7, 1.5, 3.0, 5.0, 10.0, 20.0})
            for (const bool has_second : {false, true}) {
                scene.waves.tiling = Tiling::Random;
                scene.waves.cascades = {{waves * peak_m, 128}};
                if (has_second) scene.waves.cascades.push_back({0.2 * waves * peak_m, 128});
                const double gain = gain_of(scene);
                const std::vector<std::string> warnings = sea_warnings(*prepare(scene));
                SCOPED_TRACE(std::to_string(waves) + " waves: " + std::to_string(gain));
                if (gain < 0.045) {
                    EXPECT_TRUE(warnings.empty());
                    ++untold;
                }
                if (gain < 0.055) continue;
                ++told;
                ASSERT_EQ(warnings.size(), 1u);
                const std::size_t share = warnings[0].find(of_share), size = warnings[0].find(of_size);
                ASSERT_NE(share, std::string::npos) << warnings[0];
                ASSERT_NE(size, std::string::npos) << warnings[0];
                EXPECT_NEAR(std::stod(warnings[0].substr(share + of_share.size())), 100.0 * gain,
                            25.0 * gain);
                scene.waves.cascades[0].size_m = std::stod(warnings[0].substr(size + of_size.size()));
                const std::string of_resolution = "resolution = ";
                if (const std::size_t more = warnings[0].find(of_resolution); more != std::string::npos)
                    scene.waves.cascades[0].resolution =
                        std::stoi(warnings[0].substr(more + of_resolution.size()));
                EXPECT_TRUE(validate(scene).empty()) << warnings[0];
                EXPECT_TRUE(sea_warnings(*prepare(scene)).empty());
                EXPECT_LT(gain_of(scene), 0.055);
                scene.waves.cascades[0] = {waves * peak_m, 128};
                scene.waves.tiling = Tiling::Periodic;
                for (const std::string& warning : sea_warnings(*prepare(scene)))
                    EXPECT_EQ(warning.find(of_share), std::string::npos);
            }
    }
    EXPECT_GT(told, 5);
    EXPECT_GT(untold, 5);
}

}  // namespace
}  // namespace pelagic
