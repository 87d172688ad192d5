// The light at places whose sun is another than the one below the eye (place.glsl).
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <vector>

#include "core/base/constants.h"
#include "core/lighting/air.h"
#include "core/lighting/lighting.h"
#include "core/lighting/sky.h"

namespace {

using namespace pelagic;

constexpr double kDegree = kPi / 180.0;
const WaterBody kWaterBody{glm::vec3(0.001f, 0.012f, 0.05f)};

Sky low_sky(double sun_elevation_deg) {
    return daylight_sky({.sun_elevation_deg = sun_elevation_deg, .sun_azimuth_deg = 90.0, .turbidity = 3.0},
                        64);
}

// Of a place that many degrees round the earth towards the sun, seen from straight above it; that is, in the eye's axes,
// along its vertical.
SeaPoint point_at(double towards_sun_deg) {
    const glm::vec3 up(
        glm::dvec3(0.0, std::sin(towards_sun_deg * kDegree), std::cos(towards_sun_deg * kDegree)));
    return {.to_eye = up, .slope_variance = {0.02f, 0.02f, 0.0f}, .coverage = 0.2f, .up = up};
}

SeaRadiance lit(const Sky& sky, const SeaPoint& point, const Air* air) {
    SeaRadiance radiance;
    shade_sea({}, sky, kWaterBody, {&point, 1}, {&radiance, 1}, air);
    return radiance;
}

void expect_near(const glm::vec3& a, const glm::vec3& b, float share, float least, const char* what) {
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], share * b[i] + least) << what << " " << i;
}

// From day into night: sun, water and foam are those of a sky whose sun is as high as the place's own. Of the night's light
// there is less than a thousandth of a low sun's.
TEST(LightByPlace, IsThatOfThePlacesOwnSun) {
    for (const double below_deg : {35.0, 3.0, -6.0}) {
        const Sky sky = low_sky(below_deg);
        const Air air = sky.air->seen_from(400e3);
        for (const double towards_deg : {-9.0, -3.5, 4.0, 19.0}) {
            SCOPED_TRACE(std::to_string(below_deg) + " below, " + std::to_string(towards_deg) + " towards");
            const SeaRadiance here = lit(sky, point_at(towards_deg), &air);
            const SeaRadiance own = lit(low_sky(below_deg + towards_deg), point_at(0.0), nullptr);
            expect_near(here.sun, own.sun, 0.04f, 1e-5f, "sun");
            expect_near(here.sea, own.sea, 0.04f, 1e-5f, "sea");
            expect_near(here.foam, own.foam, 0.04f, 2e-4f, "foam");
            // The sky's pattern is that below the eye; in the night that is none, and a uniform one has up to 3.5 times a low
            // sun's zenith, whose horizon is so much brighter.
            if (below_deg > 0.0) expect_near(here.sky, own.sky, 0.65f, 2e-4f, "sky");
            for (int i = 0; i < 3; ++i) {
                EXPECT_LT(here.sky[i], 3.6f * own.sky[i] + 2e-4f) << i;
                EXPECT_GT(here.sky[i], 0.25f * own.sky[i] - 2e-4f) << i;
            }
        }
    }
}

// Nothing changes for low eyes, on a flat earth and below the eye; and the change comes by and by as the eye rises.
TEST(LightByPlace, NearTheSeaIsThatBelowTheEye) {
    const Sky sky = low_sky(1.5);
    const Air low = sky.air->seen_from(2.0), high = sky.air->seen_from(400e3),
              some = sky.air->seen_from(520.0);
    EXPECT_EQ(low.by_place, 0.0f);
    EXPECT_EQ(high.by_place, 1.0f);
    const auto same = [](const SeaRadiance& a, const SeaRadiance& b) {
        return a.sun == b.sun && a.sky == b.sky && a.sea == b.sea && a.foam == b.foam;
    };
    for (const double towards_deg : {-1.0, 0.0, 0.05}) {
        const SeaPoint point = point_at(towards_deg);
        EXPECT_TRUE(same(lit(sky, point, &low), lit(sky, point, nullptr)));
        const SeaRadiance a = lit(sky, point, &some), b = lit(sky, point, nullptr);
        expect_near(a.foam, b.foam, 2e-3f, 0.0f, "foam of an eye that rises");
        expect_near(a.sun, b.sun, 2e-3f, 0.0f, "sun of an eye that rises");
    }
    EXPECT_TRUE(same(lit(sky, point_at(0.0), &high), lit(sky, point_at(0.0), nullptr)));
}

}  // namespace
