// A sky as a picture: its convention, and that it holds the light of the map.
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "core/base/constants.h"
#include "core/lighting/sky.h"

namespace pelagic {
namespace {

// The brightest pixel of the picture is where the sun's glow is: the middle column is +x, azimuth grows to the
// left, rows come from the top.
TEST(LatLongPicture, TheGlowIsWhereTheSunIs) {
    const Sky sky = daylight_sky({.sun_elevation_deg = 30.0, .sun_azimuth_deg = 70.0, .turbidity = 4.0});
    const LatLong picture = lat_long(sky, 360);
    ASSERT_EQ(picture.height, 180);
    std::size_t brightest = 0;
    for (std::size_t i = 0; i < picture.radiance.size(); ++i)
        if (picture.radiance[i].y > picture.radiance[brightest].y) brightest = i;
    EXPECT_NEAR(static_cast<double>(brightest % 360), 180.0 - 70.0, 2.0);
    EXPECT_NEAR(static_cast<double>(brightest / 360), 90.0 - 30.0, 2.0);
}

// Its irradiance is the sky's own. The horizon's band takes the sky just above (background.glsl), which counts
// for 1 % of a plane's irradiance at most.
TEST(LatLongPicture, ItsIrradianceIsTheSkys) {
    const Sky sky = daylight_sky({.sun_elevation_deg = 12.0, .sun_azimuth_deg = 200.0, .turbidity = 3.0});
    for (const int width : {64, 1000}) {
        const LatLong picture = lat_long(sky, width);
        const double pixel = kTwoPi / width;
        glm::dvec3 sum(0.0);
        for (int row = 0; row < picture.height / 2; ++row) {
            const double high = 0.5 * kPi - pixel * row, low = high - pixel;
            const double cosine = 0.5 * (std::sin(high) * std::sin(high) - std::sin(low) * std::sin(low));
            for (int i = 0; i < width; ++i)
                sum +=
                    glm::dvec3(picture.radiance[static_cast<std::size_t>(row) * width + i]) * pixel * cosine;
        }
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(sum[c] / static_cast<double>(sky.sky_irradiance[c]), 1.0, 0.02);
    }
}

// Read as a picture of a sky it gives the same sky again, but for its own sun: it has none.
TEST(LatLongPicture, ReadAsAPictureItIsTheSameSky) {
    const Sky sky = daylight_sky({.sun_elevation_deg = 40.0, .sun_azimuth_deg = -60.0, .turbidity = 3.0});
    const Sky again = picture_sky(lat_long(sky, 1024), 256);
    EXPECT_EQ(again.sun_radiance, glm::vec3(0.0f));
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(again.sky_irradiance[c] / sky.sky_irradiance[c], 1.0f, 0.01f);
    for (const glm::vec2 u : {glm::vec2(0.0f), glm::vec2(0.5f, -0.2f), glm::vec2(-0.6f, 0.6f)})
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(again.map.radiance(u, 1.0f)[c] / sky.map.radiance(u, 1.0f)[c], 1.0f, 0.03f);
}

TEST(LatLongPicture, SizesOutOfRangeAreRefused) {
    const Sky sky = daylight_sky({}, 16);
    for (const int width : {0, 7, 9, 16386}) EXPECT_THROW(lat_long(sky, width), std::invalid_argument);
    EXPECT_THROW(lat_long(Sky(), 16), std::invalid_argument);
}

}  // namespace
}  // namespace pelagic
