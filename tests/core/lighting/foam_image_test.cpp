// An artist's picture as the pattern of foam: its mean is the coverage, whatever the picture's brightnesses are.
#include "core/lighting/foam_image.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/lighting/foam_structure.h"
#include "tests/core/lighting/optics.h"

namespace pelagic {
namespace {

using optics::Optics;

// Bright ridges on black, a distribution far from a normal one; it tiles.
std::vector<float> ridges(int side) {
    std::vector<float> out;
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
            const double u = 2.0 * optics::oracle::kPi * x / side, v = 2.0 * optics::oracle::kPi * y / side;
            const double bent =
                std::sin(2.0 * u + 1.3 * std::sin(3.0 * v)) + std::sin(3.0 * v + std::sin(2.0 * u + 2.0));
            out.push_back(static_cast<float>(std::max(0.0, std::exp(-9.0 * bent * bent) - 0.01)));
        }
    return out;
}

// Over independent places, from texels to many tiles, whatever the opacity. 6 % of the variance and 2 % of the coverage beside chance:
// between texels both depend a little on the place, and a blend of two levels is only nearly normal.
TEST(FoamImage, HasTheCoverageAsItsMean) {
    constexpr int kPlaces = 20000;
    constexpr std::array kShares{0.02f, 0.1f, 0.4f, 0.8f};
    const auto picture = std::make_shared<const FoamImage>(make_foam_image(128, ridges(128)));
    Optics of_picture;
    of_picture.foam_image = picture.get();
    const auto pattern = optics::glsl(
        foam_pattern({.image = picture, .image_m = 6.4, .structure = 1.0, .wind_direction_deg = 20.0}, {}));
    std::mt19937 random(5);
    std::uniform_real_distribution<float> place(-2000.0f, 2000.0f);
    for (const float footprint_m :
         {1e-3f, 0.05f, 0.07f, 0.1f, 0.17f, 0.45f, 1.3f, 3.3f, 6.4f, 9.0f, 100.0f}) {
        std::array<double, kShares.size()> sum{};
        double squares = 0.0, variance = 0.0;
        for (int i = 0; i < kPlaces; ++i) {
            const auto noise =
                of_picture.foam_noise(pattern, {place(random), place(random)}, footprint_m, 2.0f);
            squares += static_cast<double>(noise.shown * noise.shown) / kPlaces;
            variance = static_cast<double>(noise.variance);
            for (std::size_t c = 0; c < kShares.size(); ++c)
                sum[c] +=
                    static_cast<double>(of_picture.foam_opacity_in(noise, 0.4f * kShares[c], 0.3f)) / kPlaces;
        }
        EXPECT_NEAR(squares, variance, 0.06 * variance + 1e-3) << footprint_m;
        for (std::size_t c = 0; c < kShares.size(); ++c) {
            const double expected = 0.4 * static_cast<double>(kShares[c]);
            EXPECT_NEAR(sum[c], expected,
                        4.5 * std::sqrt(expected * (1.0 - expected) / kPlaces) + 0.02 * expected)
                << footprint_m << " m, coverage " << kShares[c];
        }
    }
}

// Its right points downwind, and its top to the left of that; it stays with the water for any origin.
TEST(FoamImage, LiesAlongTheWind) {
    Optics over;
    const auto at = [&](const std::shared_ptr<const FoamImage>& picture, glm::dvec2 origin_m,
                        glm::dvec2 place_m) {
        const FoamLook look{.image = picture, .image_m = 64.0, .structure = 1.0, .wind_direction_deg = 90.0};
        over.foam_image = picture.get();
        return over
            .foam_noise(optics::glsl(foam_pattern(look, origin_m)), glm::vec2(place_m - origin_m), 0.01f,
                        0.0f)
            .shown;
    };
    std::vector<float> along, across;
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x) {
            along.push_back(static_cast<float>(x));
            across.push_back(static_cast<float>(y));
        }
    const auto rising_along = std::make_shared<const FoamImage>(make_foam_image(64, along)),
               rising_across = std::make_shared<const FoamImage>(make_foam_image(64, across));
    EXPECT_GT(at(rising_along, {}, {-32.0, 44.0}), at(rising_along, {}, {-32.0, 20.0}) + 0.5f);
    EXPECT_GT(at(rising_across, {}, {-44.0, 32.0}), at(rising_across, {}, {-20.0, 32.0}) + 0.5f);
    for (const glm::dvec2 origin_m : {glm::dvec2(17.0, -5.0), glm::dvec2(6.4e4, 640.0)})
        EXPECT_NEAR(at(rising_along, origin_m, {-22.0, 32.0}), at(rising_along, {}, {-22.0, 32.0}), 1e-3f);
}

TEST(FoamImage, RefusesWhatIsNoPattern) {
    const auto problem = [](int side, std::vector<float> brightness) {
        try {
            make_foam_image(side, brightness);
        } catch (const std::invalid_argument& error) {
            return std::string(error.what());
        }
        return std::string("accepted");
    };
    EXPECT_EQ(problem(8, std::vector<float>(64, 0.0f)), "has a side of 8 pixels");
    EXPECT_EQ(problem(48, std::vector<float>(48 * 48)), "has a side of 48 pixels");
    EXPECT_EQ(problem(8192, {}), "has a side of 8192 pixels");
    EXPECT_EQ(problem(16, std::vector<float>(256, 0.3f)), "is of one brightness all over");
    std::vector<float> broken(256, 0.3f);
    for (const float value :
         {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        broken[7] = value;
        EXPECT_EQ(problem(16, broken), "has pixels that aren't finite");
    }
    // One bright pixel, halves at their largest, and 8 bits' steps are patterns.
    broken[7] = 65504.0f;
    EXPECT_EQ(problem(16, broken), "accepted");
    for (const float texel : make_foam_image(16, broken).texels) EXPECT_TRUE(std::isfinite(texel));
}

}  // namespace
}  // namespace pelagic
