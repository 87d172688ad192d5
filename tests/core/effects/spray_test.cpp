// What breaks now on average, against what evaluate() says of a patch of the sea, whether foam lives or not.
#include "core/effects/spray.h"

#include <gtest/gtest.h>

#include <vector>

#include "core/plan/spray.h"
#include "core/waves/whitecaps.h"
#include "tests/core/waves/samples.h"

namespace pelagic {
namespace {

using namespace test;

std::shared_ptr<const Sea<float>> spray_sea(const Scene& scene) {
    return std::make_shared<const Sea<float>>(
        make_plan(scene, {filtered(products(Product::Breaking, Product::JacobianMoments), 1.0)}));
}

Scene spray_scene(double wind_mps, double decay_s = 0.0) {
    Scene scene;
    scene.sea.wind_speed_mps = wind_mps;
    scene.effects.foam_decay_s = decay_s;
    scene.effects.spray = true;
    return scene;
}

double seen_over_area(const std::shared_ptr<const Sea<float>>& sea) {
    Frame<float> frame(sea);
    double foam = 0.0, area = 0.0;
    for (int time = 0; time < 4; ++time) {
        frame.set(1000.0 * time);
        std::vector<glm::vec2> rest_m;
        for (int i = 0; i < 400; ++i)
            for (int j = 0; j < 400; ++j) rest_m.emplace_back(5.3 * i, 5.3 * j);
        Values values;
        QueryRunner<float>().run(frame, 0, Points<float>{.count = rest_m.size(), .rest_m = {rest_m.data()}},
                                 values);
        for (std::size_t i = 0; i < rest_m.size(); ++i) {
            const glm::vec3 j = values.vectors(Product::JacobianMoments)[i];
            const double of = sea_area(pelagic::JacobianMoments<double>{j.x, j.y, j.z}, true);
            foam += of * static_cast<double>(values.numbers(Product::Breaking)[i]);
            area += of;
        }
    }
    return foam / area;
}

TEST(Spray, TheMeanOfWhatBreaksIsTheSeasOwn) {
    for (const double decay_s : {0.0, 4.0}) {
        const auto sea = spray_sea(spray_scene(15.0, decay_s));
        // Four patches of 2 km: they hold some 4 % more or less than the whole sea.
        EXPECT_NEAR(seen_over_area(sea) / mean_breaking(*sea), 1.0, 0.08) << decay_s;
    }
}

TEST(Spray, FoamThatStaysIsNoneThatBreaks) {
    const Scene scene = spray_scene(15.0);
    EXPECT_NEAR(mean_breaking(*spray_sea(scene)) / law_coverage(scene), 1.0, 1e-6);
    EXPECT_LT(mean_breaking(*spray_sea(spray_scene(15.0, 4.0))), 0.6 * law_coverage(scene));
}

TEST(Spray, ThereIsNoneWhereNoWaveBreaks) {
    Scene scene = spray_scene(0.0);
    EXPECT_EQ(mean_breaking(*spray_sea(scene)), 0.0);
    EXPECT_EQ(spray_extinction_per_coverage(*spray_sea(scene)), 0.0);
    scene = spray_scene(15.0);
    const auto sea = spray_sea(scene);
    EXPECT_NEAR(spray_extinction_per_coverage(*sea) * mean_breaking(*sea), spray_law(15.0).extinction_per_m,
                1e-12);
    scene.effects.spray = false;
    EXPECT_EQ(spray_extinction_per_coverage(*spray_sea(scene)), 0.0);
}

}  // namespace
}  // namespace pelagic
