// Veiling glare against a sum pixel by pixel, and what scattering keeps.
#include "plugin/render/glare.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "core/base/constants.h"

namespace pelagic {
namespace {

constexpr glm::ivec2 kSize{37, 22};
constexpr double kTangent = 2e-3;

std::vector<glm::vec3> noise() {
    std::mt19937 random(3);
    std::exponential_distribution<float> light(1.0f);
    std::vector<glm::vec3> picture(static_cast<std::size_t>(kSize.x * kSize.y));
    for (glm::vec3& pixel : picture) pixel = {light(random), light(random), light(random)};
    picture[500] = glm::vec3(3e4f, 2e4f, 1e4f);  // the sun
    return picture;
}

TEST(Glare, KeepsTheLight) {
    const std::vector<glm::vec3> picture = noise();
    const ScatteredLight scattered = scattered_light(picture, kSize, kTangent);
    glm::dvec3 before(0.0), after(0.0);
    for (const glm::vec3& pixel : picture) before += glm::dvec3(pixel);
    for (const glm::vec3& pixel : scattered.light) after += glm::dvec3(pixel);
    // Single precision's rounding.
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(after[c] / before[c], 1.0, 1e-5);
}

// From one point: round, right where the density is as good as even over a pixel, and as much to every side.
TEST(Glare, IsTheSpreadOfEachPoint) {
    std::vector<glm::vec3> picture(static_cast<std::size_t>(kSize.x * kSize.y), glm::vec3(0.0f));
    const auto at = [](int x, int y) { return static_cast<std::size_t>(y * kSize.x + x); };
    picture[at(20, 9)] = glm::vec3(1.0f, 10.0f, 100.0f);
    add_glare(picture, kSize, {.share = 0.5, .pixel_tangent = kTangent});
    EXPECT_GT(picture[at(20, 9)].x, 0.5f);
    const auto density = [](double pixels) {
        return glare_density(std::atan(pixels * kTangent) * 180.0 / kPi);
    };
    for (const auto& [x, y] : {std::pair(12, 0), {0, 11}, {-12, 0}, {-12, -9}, {14, 11}}) {
        const glm::vec3 &here = picture[at(20 + x, 9 + y)], &near = picture[at(20, 9 + 10)];
        EXPECT_NEAR(here.x / near.x, density(std::hypot(x, y)) / density(10.0), 1e-3) << x << ' ' << y;
        // Single precision's rounding, of the pixel itself, beside which this is a thousandth.
        EXPECT_NEAR(here.y / here.x, 10.0f, 3e-3f);
        EXPECT_NEAR(here.z / here.x, 100.0f, 3e-2f);
    }
}

TEST(Glare, IsLinearAndNoneAtZero) {
    const std::vector<glm::vec3> picture = noise();
    std::vector<glm::vec3> none = picture, once = picture, brighter = picture;
    add_glare(none, kSize, {.share = 0.0, .pixel_tangent = kTangent});
    EXPECT_EQ(none, picture);
    for (glm::vec3& pixel : brighter) pixel *= 8.0f;  // exact
    add_glare(once, kSize, {.share = 0.3, .pixel_tangent = kTangent});
    add_glare(brighter, kSize, {.share = 0.3, .pixel_tangent = kTangent});
    for (std::size_t i = 0; i < picture.size(); ++i) {
        EXPECT_EQ(brighter[i], 8.0f * once[i]);
        EXPECT_GE(once[i].x, 0.7f * picture[i].x);
    }
}

TEST(Glare, IsFiniteOfTheBrightestAndDarkest) {
    for (const float light : {0.0f, 1e-38f, std::numeric_limits<float>::max()})
        for (const glm::ivec2 size : {glm::ivec2(1), {1, 5}, {16, 9}}) {
            std::vector<glm::vec3> picture(static_cast<std::size_t>(size.x * size.y), glm::vec3(light));
            add_glare(picture, size, {.share = 1.0, .pixel_tangent = 2.0});
            for (const glm::vec3& pixel : picture)
                for (int c = 0; c < 3; ++c) EXPECT_TRUE(std::isfinite(pixel[c]) && pixel[c] >= 0.0f);
        }
}

}  // namespace
}  // namespace pelagic
