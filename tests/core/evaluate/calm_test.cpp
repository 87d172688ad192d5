// Seas whose values are known. tests/hard_cases has those that have broken somebody's ocean.
#include <gtest/gtest.h>

#include "tests/core/waves/samples.h"

namespace pelagic {
namespace {

using namespace test;

// Without wind and swell the right limit is known: flat, still, up, no foam, nothing unresolved.
TEST(Calm, IsExactlyFlat) {
    Scene scene;
    scene.sea.wind_speed_mps = 0.0;
    const ProductSet all = ~lasting_products();
    const auto samples =
        sample(frame_of<float>(scene, {filtered(all, 1.0)}, 5.0), 0, random_points<float>(100.0, 50));
    for (std::size_t i = 0; i < samples.vectors(Normal).size(); ++i) {
        EXPECT_EQ(samples.vectors(Displacement)[i], glm::vec3(0.0f));
        EXPECT_EQ(samples.vectors(Velocity)[i], glm::vec3(0.0f));
        EXPECT_EQ(samples.vectors(Normal)[i], glm::vec3(0.0f, 0.0f, 1.0f));
        EXPECT_EQ(samples.vectors(SlopeVariance)[i], glm::vec3(0.0f));
        EXPECT_EQ(samples.vectors(Product::JacobianMoments)[i], glm::vec3(1.0f, 0.0f, 0.0f));
        EXPECT_EQ(samples.numbers(Product::Breaking)[i], 0.0f);
    }
}

// Its foam is where the slightest choppiness would press the surface together.
TEST(NoChoppiness, HasFoamButNoHorizontalMotion) {
    Scene scene;
    scene.waves.choppiness = 0.0;
    const ProductSet all = ~lasting_products();
    const auto samples =
        sample(frame_of<float>(scene, {filtered(all, 1.0)}, 5.0), 0, random_points<float>(100.0, 50));
    for (std::size_t i = 0; i < samples.vectors(Normal).size(); ++i) {
        EXPECT_EQ(samples.vectors(Displacement)[i].x, 0.0f);
        EXPECT_EQ(samples.vectors(Displacement)[i].y, 0.0f);
        EXPECT_NE(samples.vectors(Displacement)[i].z, 0.0f);
        EXPECT_EQ(samples.vectors(Velocity)[i].x, 0.0f);
        EXPECT_NEAR(samples.vectors(Product::JacobianMoments)[i].x, 1.0f, 0.02f);
        EXPECT_NE(samples.vectors(Product::JacobianMoments)[i].x, 1.0f);
    }
}

}  // namespace
}  // namespace pelagic
