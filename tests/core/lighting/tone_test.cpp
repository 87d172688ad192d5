// Tone mapping, dither, the exposure for a brightness, and the background.
#include "core/lighting/tone.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "core/base/constants.h"
#include "core/lighting/background.h"
#include "core/lighting/colour.h"
#include "core/lighting/lighting.h"
#include "core/lighting/sky.h"
#include "core/lighting/sky_bake.h"
#include "core/lighting/sky_map.h"

namespace pelagic {
namespace {

// The inverse of IEC 61966-2-1: from a display value to light.
double light_of(float shown) {
    const auto v = static_cast<double>(shown);
    return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
}

TEST(Tone, MiddleGreyStaysWhereItIs) {
    for (const float exposure : {1.0f, 1e-3f, 50.0f}) {
        const glm::vec3 shown = display_colour(glm::vec3(0.18f / exposure), exposure);
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(light_of(shown[c]), 0.18, 1e-3);  // half a step of 8 bits
    }
}

// The darks of a sea by day, up to two stops below middle grey, go down steeply. What is brighter is as without a toe, and the tones of
// a night are nearly as far apart.
TEST(Tone, HasBlacksByDayAndKeepsTheNight) {
    const auto shown = [](float light) { return light_of(display_colour(glm::vec3(light), 1.0f).y); };
    const auto contrast = [&](float bright, float dark) {
        return std::log(shown(bright) / shown(dark)) / std::log(static_cast<double>(bright / dark));
    };
    const auto without = [](double light) { return 1.0 / (1.0 + std::pow(0.4644 / light, 1.6)); };
    EXPECT_NEAR(contrast(0.18f, 0.09f), 1.8, 0.1);
    EXPECT_NEAR(contrast(0.09f, 0.045f), 1.6, 0.1);
    EXPECT_NEAR(shown(0.06f) / without(0.06), std::pow(0.8, 1.6), 0.01);
    EXPECT_GT(contrast(0.02f, 0.002f), 1.45);
    for (const double light : {0.18, 0.3, 1.0, 5.0})
        EXPECT_NEAR(shown(static_cast<float>(light)) / without(light), 1.0, 1e-3);
}

// More light never makes any component darker, and all stay in 0 … 1, over sixty orders of magnitude. 2e-6:
// some units in the last place at 1.
TEST(Tone, RisesWithTheLightAndStaysInRange) {
    std::mt19937_64 random(5);
    std::uniform_real_distribution<float> part(0.0f, 1.0f);
    for (int colour = 0; colour < 200; ++colour) {
        const glm::vec3 hue =
            colour == 0 ? glm::vec3(1.0f, 0.0f, 0.0f) : glm::vec3(part(random), part(random), part(random));
        glm::vec3 before(0.0f);
        for (float power = -30.0f; power <= 30.0f; power += 0.05f) {
            const glm::vec3 shown = display_colour(hue * std::pow(10.0f, power), 1.0f);
            for (int c = 0; c < 3; ++c) {
                ASSERT_TRUE(shown[c] >= 0.0f && shown[c] <= 1.0f) << power;
                ASSERT_GE(shown[c], before[c] - 2e-6f) << power;
            }
            before = shown;
        }
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(before[c], 1.0f, 1e-5f);  // very bright colours are white
    }
    EXPECT_EQ(display_colour(glm::vec3(0.0f), 1.0f), glm::vec3(0.0f));
    EXPECT_EQ(display_colour(glm::vec3(-1.0f, -2.0f, 0.0f), 1.0f), glm::vec3(0.0f));
    const float most = std::numeric_limits<float>::max();
    for (int c = 0; c < 3; ++c) EXPECT_TRUE(std::isfinite(display_colour(glm::vec3(most), 1e3f)[c]));
}

glm::dvec3 rgb_of_xy(double x, double y) {  // Y = 1; the published inverse of IEC 61966-2-1's primaries
    const glm::dvec3 xyz(x / y, 1.0, (1.0 - x - y) / y);
    return {glm::dot(glm::dvec3(3.2404542, -1.5371385, -0.4985314), xyz),
            glm::dot(glm::dvec3(-0.9692660, 1.8760108, 0.0415560), xyz),
            glm::dot(glm::dvec3(0.0556434, -0.2040259, 1.0572252), xyz)};
}

// Light of a temperature gets the colour that light of 6500 K has without, at its own luminance. Illuminant A is a radiator of
// 2856 K (CIE 015: x = 0.44757, y = 0.40745); at 6500 K Planck's locus is at x = 0.3135, y = 0.3237 (Wyszecki and Stiles 1982).
TEST(Tone, WhiteBalanceMakesALightsColourNeutral) {
    EXPECT_EQ(white_balance(6500.0), glm::mat3(1.0f));
    const glm::dvec3 shown = glm::dmat3(white_balance(2856.0)) * rgb_of_xy(0.44757, 0.40745),
                     wanted = rgb_of_xy(0.3135, 0.3237);
    // The fit's 1e-4 in (u, v) is some 3e-3 of A's little blue, which becomes two to three times as bright.
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(shown[c], wanted[c], 8e-3) << c;
    glm::vec3 before = white_balance(1500.0) * glm::vec3(1.0f);
    for (const double kelvin : {3000.0, 5000.0, 6500.0, 9000.0, 15000.0}) {
        const glm::vec3 white = white_balance(kelvin) * glm::vec3(1.0f);
        EXPECT_TRUE(white.x > before.x && white.z < before.z) << kelvin;
        before = white;
    }
}

// Hue as it is seen, the angle of Oklab's two opponent colours [degrees], and saturation as a colour picker has it.
double hue_deg(glm::dvec3 linear) {
    const glm::dvec3 felt(
        std::cbrt(0.4122214708 * linear.x + 0.5363325363 * linear.y + 0.0514459929 * linear.z),
        std::cbrt(0.2119034982 * linear.x + 0.6806995451 * linear.y + 0.1073969566 * linear.z),
        std::cbrt(0.0883024619 * linear.x + 0.2817188376 * linear.y + 0.6299787005 * linear.z));
    return std::atan2(0.0259040371 * felt.x + 0.7827717662 * felt.y - 0.8086757660 * felt.z,
                      1.9779984951 * felt.x - 2.4285922050 * felt.y + 0.4505937099 * felt.z) *
           180.0 / kPi;
}
double saturation(glm::dvec3 colour) {
    const double most = std::max({colour.x, colour.y, colour.z});
    return (most - std::min({colour.x, colour.y, colour.z})) / most;
}

// From dark to nearly white the colours of low suns, sky and water keep their hue, and half of their saturation up to two stops above
// middle grey's white. A curve per component would make the orange yellow; white mixed into linear light makes it pink.
TEST(Tone, KeepsHueAndSaturation) {
    for (const glm::dvec3 colour :
         {glm::dvec3(66.6, 34.1, 8.2), glm::dvec3(1.0, 0.45, 0.1), glm::dvec3(1.0, 0.7, 0.4),
          glm::dvec3(0.3, 0.6, 1.0), glm::dvec3(0.2, 0.8, 1.0)}) {
        const glm::dvec3 unit = colour / std::max({colour.x, colour.y, colour.z});
        for (double strength = 1e-2; strength < 40.0; strength *= 1.3) {
            const glm::vec3 shown = display_colour(glm::vec3(unit * strength), 1.0f);
            const glm::dvec3 light(light_of(shown.x), light_of(shown.y), light_of(shown.z));
            EXPECT_NEAR(hue_deg(light), hue_deg(unit), 5.0) << strength << ' ' << colour.x;
            if (strength < 4.0) {
                EXPECT_GT(saturation(glm::dvec3(shown)) / saturation(unit), 0.45)
                    << strength << ' ' << colour.x;
            }
        }
    }
    // A low sun's path, at the exposure with which it was a pale pink before: (238, 218, 201), 0.18 of its saturation.
    const glm::vec3 path = display_colour(glm::vec3(66.6f, 34.1f, 8.2f), 2.5f / 66.6f);
    EXPECT_GT(saturation(glm::dvec3(path)) / saturation(glm::dvec3(66.6, 34.1, 8.2)), 0.6);
}

// Light that has come through metres of water has no red, and isn't shown as neon; what has a quarter of each component stays.
TEST(Tone, HasSomeOfEachComponent) {
    for (const glm::vec3 light : {glm::vec3(0.0f, 0.8f, 1.0f), glm::vec3(0.0f, 0.3f, 0.6f)}) {
        const glm::vec3 shown = display_colour(light, 1.0f);
        const double red = light_of(shown.x) / light_of(shown.z);
        EXPECT_GT(red, 0.05);
        EXPECT_LT(red, 0.15);
        EXPECT_NEAR(hue_deg({light_of(shown.x), light_of(shown.y), light_of(shown.z)}),
                    hue_deg(glm::dvec3(light)), 5.0);
    }
    const glm::vec3 stays = display_colour(glm::vec3(0.3f, 0.8f, 1.0f), 0.5f);
    EXPECT_NEAR(light_of(stays.x) / light_of(stays.z), 0.3, 1e-4);
}

// The glitter of suns at 2 … 10° and the sky within 40° of them, from dark to four and a half stops above middle grey: half of the saturation
// to three and a half of them, and a little less above, where colours go to white.
TEST(Tone, KeepsTheColoursOfLowSuns) {
    double least_kept = 1.0, least_kept_brightest = 1.0, most_turned_deg = 0.0;
    int judged = 0;
    const auto judge = [&](glm::dvec3 colour) {
        const glm::dvec3 unit = colour / std::max({colour.x, colour.y, colour.z});
        if (saturation(unit) < 0.5) return;  // the display's encoding alone takes half of a pale colour's
        ++judged;
        for (double strength = 1e-2; strength < 22.7 * 0.18; strength *= 1.2) {
            const glm::vec3 shown = display_colour(glm::vec3(unit * strength), 1.0f);
            const glm::dvec3 light(light_of(shown.x), light_of(shown.y), light_of(shown.z));
            double& least = strength < 11.3 * 0.18 ? least_kept : least_kept_brightest;
            least = std::min(least, saturation(glm::dvec3(shown)) / saturation(unit));
            most_turned_deg = std::max(most_turned_deg, std::abs(hue_deg(light) - hue_deg(unit)));
        }
    };
    for (const double sun_deg : {2.0, 4.0, 6.0, 8.0, 10.0}) {
        const Sky sky =
            daylight_sky({.sun_elevation_deg = sun_deg, .sun_azimuth_deg = 0.0, .turbidity = 2.0}, 64);
        judge(glm::dvec3(sky.sun_radiance));
        for (const double elevation_deg : {1.0, 5.0, 15.0})
            for (const double azimuth_deg : {0.0, 10.0, 40.0}) {
                const double e = elevation_deg * kPi / 180.0, a = azimuth_deg * kPi / 180.0;
                const glm::vec3 towards(std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e));
                judge(glm::dvec3(sky.map.radiance(sky_map_place(towards), 0.0f)));
            }
    }
    RecordProperty("least_saturation_kept", std::to_string(least_kept));
    RecordProperty("least_saturation_kept_brightest", std::to_string(least_kept_brightest));
    RecordProperty("most_turned_deg", std::to_string(most_turned_deg));
    EXPECT_GE(judged, 10);
    EXPECT_GE(least_kept, 0.5);
    EXPECT_GE(least_kept_brightest, 0.4);
    EXPECT_LE(most_turned_deg, 5.0);
}

// By day a brighter light looks slightly brighter; in twilight a tenth of it looks half as bright.
TEST(Exposure, FollowsTheLightALittle) {
    double exposure_before = std::numeric_limits<double>::infinity(), shown_before = 0.0;
    for (double mean = 1e-5; mean < 1e3; mean *= 1.5) {
        const double exposure = exposure_for(mean);
        EXPECT_LT(exposure, exposure_before);
        EXPECT_GT(exposure * mean, shown_before);
        exposure_before = exposure;
        shown_before = exposure * mean;
    }
    const auto shown = [](double mean) { return mean * exposure_for(mean); };
    EXPECT_NEAR(std::log2(shown(8.0) / shown(4.0)), 0.13, 0.01);
    EXPECT_NEAR(shown(1e-3) / shown(1e-2), 0.5, 0.01);
}

// A photographer's table: 15 for a landscape in the sun, whose middle grey has 4.1 kcd/m².
TEST(Exposure, IsThatOfAPhotographersMeter) {
    EXPECT_NEAR(exposure_of_ev100(15.0) * 4.096, 0.18, 1e-6);
    EXPECT_NEAR(exposure_of_ev100(14.0) / exposure_of_ev100(15.0), 2.0, 1e-12);
}

// 8-bit values have the mean of the light, where rounding would show a step; the ends stay clean. The same pixel
// always rounds the same way, and neighbours don't.
TEST(Dither, KeepsTheMeanAndTheEnds) {
    constexpr int kSide = 128;
    for (const float light : {0.002f, 0.0107f, 0.18f, 0.5f}) {
        const glm::vec3 shown = display_colour(glm::vec3(light), 1.0f);
        double sum = 0.0;
        int least = 255, most = 0;
        for (int y = 0; y < kSide; ++y)
            for (int x = 0; x < kSide; ++x) {
                const int value = display_bytes(glm::vec3(light), 1.0f, {x, y})[1];
                sum += value;
                least = std::min(least, value);
                most = std::max(most, value);
            }
        // 4 deviations of the mean of so many.
        EXPECT_NEAR(sum / (kSide * kSide), 255.0 * static_cast<double>(shown.y), 4.0 * 0.5 / kSide) << light;
        EXPECT_EQ(most - least, 1);
    }
    for (int x = 0; x < 1000; ++x) {
        EXPECT_EQ(display_bytes(glm::vec3(0.0f), 1.0f, {x, 3})[0], 0);
        EXPECT_EQ(display_bytes(glm::vec3(1e30f), 1.0f, {x, 3})[0], 255);
        EXPECT_EQ(dither({x, 7}), dither({x, 7}));
        EXPECT_NE(dither({x, 7}), dither({x + 1, 7}));
    }
}

// Summed over a picture's pixels the disc has its solid angle π ρ², for pixels much smaller or larger than
// it. The midpoint rule, on a grid finer than a pixel's soft edge, is accurate to 1e-3.
TEST(Background, DiscHasItsSolidAngleWhateverThePixels) {
    Sky sky;
    sky.map = SkyMap(4, std::vector<glm::vec3>(16, glm::vec3(0.0f)));
    sky.sun_direction = glm::normalize(glm::vec3(0.3f, 0.5f, 0.4f));
    sky.sun_radiance = glm::vec3(2.0f);
    const glm::vec3 across = glm::normalize(glm::cross(sky.sun_direction, glm::vec3(0.0f, 0.0f, 1.0f)));
    const glm::vec3 upwards = glm::cross(across, sky.sun_direction);
    for (const float pixel : {1e-4f, 1e-3f, 0.0092f, 0.0094f, 0.03f}) {
        const float reach = 1.1f * (sky.sun_angular_radius + 0.5f * pixel);
        constexpr int kSteps = 400;
        const float step = 2.0f * reach / kSteps;
        double sum = 0.0;
        for (int j = 0; j < kSteps; ++j)
            for (int i = 0; i < kSteps; ++i) {
                const float x = (static_cast<float>(i) + 0.5f) * step - reach;
                const float y = (static_cast<float>(j) + 0.5f) * step - reach;
                const glm::vec3 direction = glm::normalize(sky.sun_direction + x * across + y * upwards);
                sum += static_cast<double>(background(sky, direction, pixel).sun.x) *
                       static_cast<double>(step * step);
            }
        const auto radius = static_cast<double>(sky.sun_angular_radius);
        EXPECT_NEAR(sum / (2.0 * kPi * radius * radius), 1.0, 2e-3) << pixel;
    }
}

TEST(Background, ShowsTheMapAndTheDiscOnlyWhereTheyAre) {
    Sky sky;
    sky.map = SkyMap(4, std::vector<glm::vec3>(16, glm::vec3(3.0f)));
    sky.sun_direction = {0.0f, 0.6f, 0.8f};
    sky.sun_radiance = {1e6f, 9e5f, 7e5f};
    const float pixel = 1e-4f;
    const Background middle = background(sky, sky.sun_direction, pixel);
    EXPECT_NEAR(middle.sun.x, 1e6f, 1e3f);
    EXPECT_EQ(middle.sky, glm::vec3(3.0f));
    EXPECT_EQ(background(sky, glm::vec3(0.0f, 0.61f, 0.7924f), pixel).sun, glm::vec3(0.0f));
    EXPECT_EQ(background(sky, -sky.sun_direction, pixel).sun, glm::vec3(0.0f));
}

// The background is the sky down to the horizon in every direction, and the horizon's below it, where the map for
// reflections has what is under the horizon.
TEST(Background, IsTheSkyDownToTheHorizon) {
    SkyDome dome;
    dome.radiance = [](glm::vec3) { return glm::vec3(4.0f); };
    dome.samples = [](glm::vec3, float) { return 1; };
    Sky sky;
    sky.map = bake_sky_map(64, dome).map;
    for (int azimuth = 0; azimuth < 360; ++azimuth) {
        const auto a = static_cast<float>(azimuth * kPi / 180.0);
        for (const float z : {-0.6f, -0.03f, 0.0f, 0.003f, 0.02f, 0.1f, 0.9f}) {
            const float across = std::sqrt(1.0f - z * z);
            const glm::vec3 direction(across * std::cos(a), across * std::sin(a), z);
            EXPECT_NEAR(background(sky, direction, 1e-3f).sky.x, 4.0f, 1e-5f) << azimuth << ", " << z;
            if (z < -0.05f) {
                EXPECT_LT(sky.map.radiance(sky_map_place(direction), 0.0f).x, 1.0f);
            }
        }
    }
}

// The disc near the horizon: its lower limb is darker and redder, it is round about its true middle, and what is
// visible of it has the light that the sea gets.
TEST(Background, TheLowSunsDiscIsExtinguishedByElevation) {
    for (const double elevation : {0.0, 0.1, 0.3, 1.0}) {
        const Sky sky =
            daylight_sky({.sun_elevation_deg = elevation, .sun_azimuth_deg = 0.0, .turbidity = 3.0}, 16);
        const double radius = static_cast<double>(sky.sun_angular_radius), e = elevation * kPi / 180.0;
        constexpr int kSteps = 200;
        const double step = 2.4 * radius / kSteps;
        glm::dvec3 sum(0.0);
        for (int j = 0; j < kSteps; ++j)
            for (int i = 0; i < kSteps; ++i) {
                const double a = (i + 0.5) * step - 1.2 * radius, up = e + (j + 0.5) * step - 1.2 * radius;
                const glm::vec3 direction(
                    glm::dvec3(std::cos(up) * std::cos(a), std::cos(up) * std::sin(a), std::sin(up)));
                const glm::dvec3 seen(background(sky, direction, 1e-5f).sun);
                if (std::hypot(a, up - e) > 1.01 * radius) {
                    EXPECT_EQ(seen.x, 0.0);
                }
                if (up > 0.0) sum += seen * (step * step);
            }
        const double mean = luminance(glm::dvec3(sky.sun_radiance));
        EXPECT_NEAR(luminance(sum) / (kPi * radius * radius * mean), 1.0, 0.03) << elevation;
        const auto limb = [&](double up) {
            return background(sky, glm::vec3(glm::dvec3(std::cos(e + up), 0.0, std::sin(e + up))), 1e-5f).sun;
        };
        EXPECT_GT(limb(0.9 * radius).x, limb(-0.9 * radius).x);
        EXPECT_GE(limb(0.9 * radius).y / limb(0.9 * radius).x, limb(-0.9 * radius).y / limb(-0.9 * radius).x);
    }
}

// A pixel's solid angle is t² cos³θ: those of a picture 90° wide add up to a sixth of a sphere, as a cube's
// face.
TEST(Background, PixelsAnglesFillThePicture) {
    constexpr int kPixels = 200;
    constexpr float kTangent = 2.0f / kPixels;
    double sum = 0.0;
    for (int j = 0; j < kPixels; ++j)
        for (int i = 0; i < kPixels; ++i) {
            const float x = (static_cast<float>(i) + 0.5f) * kTangent - 1.0f;
            const float y = (static_cast<float>(j) + 0.5f) * kTangent - 1.0f;
            const auto angle =
                static_cast<double>(pixel_angle(kTangent, 1.0f / std::sqrt(1.0f + x * x + y * y)));
            sum += angle * angle;
        }
    EXPECT_NEAR(sum, 4.0 * kPi / 6.0, 1e-4);  // the midpoint rule's error: kTangent²
}

}  // namespace
}  // namespace pelagic
