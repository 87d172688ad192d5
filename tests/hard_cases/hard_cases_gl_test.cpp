// The hard cases on the GPU: finite light, or refused as on the CPU.
#include "tests/hard_cases/hard_cases.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "plugin/light/light.h"
#include "plugin/preview/offscreen.h"
#include "plugin/shot/shot.h"

namespace pelagic {
namespace {

class HardCasesOnTheGpu : public testing::TestWithParam<test::HardCase> {};

TEST_P(HardCasesOnTheGpu, ArePicturesOfFiniteLight) {
    if (!GetParam().loads()) return;
    static const OffscreenContext context;
    const Scene shot = load_shot(GetParam().file, check_scene);
    std::string message;
    Picture picture;
    try {
        picture = render_offscreen(plan_offscreen(shot, 1), make_sky(shot)).picture;
    } catch (const std::invalid_argument& error) {
        message = error.what();
    }
    if (GetParam().picture != "fine" && GetParam().picture != "any") {
        EXPECT_NE(message.find(GetParam().picture), std::string::npos) << message;
    }
    if (GetParam().picture == "fine") {
        EXPECT_EQ(message, "");
    }
    for (const SeaRadiance& light : picture.layers)
        for (const glm::vec3& layer : {light.sun, light.sky, light.sea, light.foam, light.air})
            for (int c = 0; c < 3; ++c) ASSERT_TRUE(std::isfinite(layer[c]) && layer[c] >= 0.0f) << layer[c];
}

INSTANTIATE_TEST_SUITE_P(Shot, HardCasesOnTheGpu, testing::ValuesIn(test::hard_cases()),
                         [](const auto& of) { return test::name_of(of.param); });

}  // namespace
}  // namespace pelagic
