// What must come of a hard case's picture, wherever it was made.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "plugin/render/render.h"
#include "tests/hard_cases/hard_cases.h"

namespace pelagic::test {

// message: of what refused it, or empty; nothing is then said of the picture but that it is finite.
inline void expect_as_told(const HardCase& hard, const std::string& message, const Picture& picture) {
    if (hard.picture == "fine") {
        EXPECT_EQ(message, "");
    } else if (hard.picture != "any") {
        EXPECT_NE(message.find(hard.picture), std::string::npos) << message;
    }
    if (message.empty()) {
        EXPECT_FALSE(picture.layers.empty());
    }
    for (const SeaRadiance& light : picture.layers)
        for (const glm::vec3& layer : {light.sun, light.sky, light.sea, light.foam, light.air})
            for (int c = 0; c < 3; ++c) ASSERT_TRUE(std::isfinite(layer[c]) && layer[c] >= 0.0f) << layer[c];
}

}  // namespace pelagic::test
