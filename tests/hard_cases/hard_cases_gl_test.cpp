// The hard cases on the GPU: finite light, or refused as on the CPU.
#include "tests/hard_cases/hard_pictures.h"

#include <gtest/gtest.h>

#include <string>

#include "plugin/format/shot/shot.h"
#include "plugin/host/preview/offscreen.h"
#include "plugin/light/light.h"

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
    test::expect_as_told(GetParam(), message, picture);
}

INSTANTIATE_TEST_SUITE_P(Shot, HardCasesOnTheGpu, testing::ValuesIn(test::hard_cases()),
                         [](const auto& of) { return test::name_of(of.param); });

}  // namespace
}  // namespace pelagic
