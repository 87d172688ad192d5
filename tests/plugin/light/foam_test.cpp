// How dense foam is while it breaks and afterwards: all of it together as Koepke found it.
#include <gtest/gtest.h>

#include "plugin/light/light.h"

namespace pelagic {
namespace {

TEST(FoamOfAllAges, HasKoepkesMean) {
    for (const double active : {0.0, 0.01, 0.1, 0.3, 0.7, 0.99, 1.0}) {
        const FoamLook look = make_foam(Scene{}, active);
        EXPECT_NEAR(active * static_cast<double>(look.dense_active) +
                        (1.0 - active) * static_cast<double>(look.dense_left),
                    0.4, 1e-6)
            << active;
        EXPECT_GE(look.dense_active, look.dense_left) << active;
        EXPECT_LE(look.dense_active, 1.0f) << active;
        EXPECT_GE(look.dense_left, 0.0f) << active;
    }
    // Fresh foam is white where most of the foam is old.
    EXPECT_GT(make_foam(Scene{}, 0.1).dense_active, 0.8f);
}

}  // namespace
}  // namespace pelagic
