// Rays through spray against numeric integrals in double along the same map, and their limits.
#include "core/lighting/spray.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <glm/geometric.hpp>
#include <random>

#include "core/base/constants.h"
#include "core/plan/spray.h"

namespace pelagic {
namespace {

constexpr int kColumns = 33, kRows = 96;
constexpr double kScale_m = 2.0, kFirst_m = 0.5, kLast_m = 2e4;

// Height of the surface [m] and extinction there [1/m], by distance.
using Sea = std::function<glm::dvec2(double distance_m)>;

double radius_m(int row) {
    return kFirst_m * std::exp(std::log(kLast_m / kFirst_m) / (kRows - 1) * row);
}

Spray spray_of(double eye_m, const Sea& sea) {
    Spray spray{.columns = kColumns,
                .rows = kRows,
                .columns_per_rad = static_cast<float>((kColumns - 1) / kTwoPi),
                .first_m = static_cast<float>(kFirst_m),
                .row_step = static_cast<float>(std::log(kLast_m / kFirst_m) / (kRows - 1)),
                .scale_m = static_cast<float>(kScale_m),
                .eye_m = static_cast<float>(eye_m)};
    spray.top_m = -1e30f;
    for (int row = 0; row < kRows; ++row)
        for (int column = 0; column < kColumns; ++column) {
            spray.texels.emplace_back(glm::vec2(sea(radius_m(row))), 0.0f, 0.0f);
            spray.top_m = std::max(spray.top_m, spray.texels.back().x);
        }
    return spray;
}

const Sea kFlat = [](double) { return glm::dvec2(0.0, 0.05); };
// Crests of 4 m, with spray over them alone.
const Sea kWaves = [](double distance_m) {
    const double phase = kTwoPi * std::log(distance_m) * 2.0, crest = 0.5 + 0.5 * std::cos(phase);
    return glm::dvec2(4.0 * std::cos(phase), 0.2 * crest * crest * crest);
};

glm::dvec3 spray_towards(double elevation, double azimuth = 0.3) {
    return {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
            std::sin(elevation)};
}

// What the map says along a ray, in small steps: between rows all is linear in distance.
double thickness(double eye_m, const Sea& sea, double elevation, double distance_m) {
    const double across = std::cos(elevation);
    std::vector<double> ends{0.0};
    for (int row = 0; row < kRows; ++row)
        if (radius_m(row) < distance_m * across) ends.push_back(radius_m(row) / across);
    ends.push_back(distance_m);
    const auto at = [&](double s_m) {
        const double r_m = s_m * across;
        if (r_m <= kFirst_m) return sea(kFirst_m);
        const int row =
            std::min(static_cast<int>(std::log(r_m / kFirst_m) / std::log(kLast_m / kFirst_m) * (kRows - 1)),
                     kRows - 2);
        const double part = (r_m - radius_m(row)) / (radius_m(row + 1) - radius_m(row));
        return glm::mix(sea(radius_m(row)), sea(radius_m(row + 1)), part);
    };
    double sum = 0.0;
    for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
        constexpr int kSteps = 2000;
        const double step_m = (ends[i + 1] - ends[i]) / kSteps;
        for (int j = 0; j < kSteps; ++j) {
            const double s_m = ends[i] + (j + 0.5) * step_m;
            const glm::dvec2 here = at(s_m);
            const double z = eye_m + s_m * std::sin(elevation) - here.x;
            sum += here.y * std::exp(-std::max(z, 0.0) / kScale_m) * step_m;
        }
    }
    return sum;
}

double seen_thickness(const Spray& spray, double elevation, double distance_m, bool on_sea = false) {
    return -std::log(static_cast<double>(
        spray_before(spray, glm::vec3(spray_towards(elevation)), static_cast<float>(distance_m), on_sea)
            .transmittance));
}

// Ribbons with a half and a quarter of what they have at the surface, and haze.
constexpr double kStep_m = 3.0, kHaze_per_m = 0.004, kHazeScale_m = 40.0;
Spray torn_spray(double eye_m, const Sea& sea) {
    Spray spray = spray_of(eye_m, sea);
    spray.is_torn = true;
    spray.scale_m = static_cast<float>(kHazeScale_m);
    spray.step_m = static_cast<float>(kStep_m);
    spray.haze_per_m = static_cast<float>(kHaze_per_m);
    for (glm::vec4& texel : spray.texels) texel = {texel.x, texel.y, 0.5f * texel.y, 0.25f * texel.y};
    return spray;
}

TEST(SprayBefore, RaysAreTheIntegralOverTheMap) {
    for (const Sea* sea : {&kFlat, &kWaves})
        for (const double eye_m : {1.0, 4.5, 12.0, 200.0})
            for (const double elevation : {-0.5, -0.05, -0.003, 0.0, 0.003, 0.1}) {
                const Spray spray = spray_of(eye_m, *sea);
                for (const double distance_m : {0.3, 7.0, 60.0, 900.0}) {
                    const double expected = thickness(eye_m, *sea, elevation, distance_m);
                    if (expected > 8.0) continue;  // too little is left to tell
                    // Single precision along some hundred rows, and what the first of a high eye's skip: e^−12.
                    EXPECT_NEAR(seen_thickness(spray, elevation, distance_m), expected,
                                1e-3 * expected + 3e-6)
                        << eye_m << " m, " << elevation << ", " << distance_m << " m";
                }
            }
}

// Straight through the whole layer it is as thick as the law says, wherever the ray begins and ends.
TEST(SprayBefore, ALayerHasItsOwnThickness) {
    for (const double eye_m : {20.0, 1e3, 1e5})
        for (const double elevation : {-0.5 * kPi, -1.0, -0.3}) {
            const double distance_m = eye_m / -std::sin(elevation);
            EXPECT_NEAR(seen_thickness(spray_of(eye_m, kFlat), elevation, distance_m, true),
                        0.05 * kScale_m / -std::sin(elevation), 1e-3)
                << eye_m << " m, " << elevation;
        }
    // From its bottom up, to the sky.
    for (const double elevation : {0.5 * kPi, 1.0, 0.2, 0.02}) {
        const auto up = spray_before(spray_of(0.0, kFlat), glm::vec3(spray_towards(elevation)), {}, false);
        EXPECT_NEAR(-std::log(up.transmittance) / (0.05 * kScale_m / std::sin(elevation)), 1.0, 2e-3)
            << elevation;
    }
}

// Where cells hide waves, a ray that ends on the surface still goes through the whole layer over it.
TEST(SprayBefore, ARayToTheSeaEndsOnIt) {
    const Spray spray = spray_of(1e3, kFlat);
    for (const double crest_m : {-5.0, 0.0, 5.0}) {
        const double elevation = -0.4, distance_m = (1e3 - crest_m) / std::sin(0.4);
        EXPECT_NEAR(seen_thickness(spray, elevation, distance_m, true), 0.05 * kScale_m / std::sin(0.4), 2e-3)
            << crest_m;
    }
    // It moves with the end, without a jump, over the rows, where the map lies 1 m too low.
    const Spray low = spray_of(12.0, kFlat);
    const auto to_crest = [&](double elevation) {
        return seen_thickness(low, elevation, 11.0 / std::sin(-elevation), true);
    };
    for (int i = 0; i < 1000; ++i) {
        const double elevation = -0.02 - 4e-5 * i;
        EXPECT_NEAR(to_crest(elevation - 4e-5), to_crest(elevation), 6e-3 * to_crest(elevation)) << elevation;
    }
}

// Under the same light from everywhere there is no spray to be seen: what is dimmed comes back.
void expect_white_furnace(Spray spray) {
    spray.above = spray.below = spray.low_ahead = spray.low_beside = spray.low_behind = glm::vec3(1.0f);
    spray.to_sun = glm::vec3(0.6f, 0.0f, 0.8f);
    double least = 1.0;
    for (const double elevation : {-0.3, -0.02, 0.0, 0.02, 0.7}) {
        for (const double distance_m : {1.0, 100.0, 1e4}) {
            const auto seen = spray_before(spray, glm::vec3(spray_towards(elevation)),
                                           static_cast<float>(distance_m), false);
            EXPECT_NEAR(seen.scattered.y + seen.transmittance, 1.0f, 2e-5f);
            least = std::min(least, static_cast<double>(seen.transmittance));
        }
        SeaRadiance sky{.sky = glm::vec3(1.0f)};
        see_through_spray(spray, glm::vec3(spray_towards(elevation)), {}, sky);
        EXPECT_NEAR(sky.sky.y + sky.air.y, 1.0f, 2e-5f);
    }
    EXPECT_LT(least, 1e-3);  // through thick spray as well
}
TEST(SprayBefore, AWhiteFurnaceStaysWhite) {
    expect_white_furnace(spray_of(3.0, kWaves));
    expect_white_furnace(torn_spray(3.0, kWaves));
}

// Ribbons and haze are the integral of what they are at each height.
TEST(SprayBefore, RaysThroughTornSprayAreTheIntegral) {
    const auto density = [](double z) {
        constexpr std::array kAt{0.0, 1.0, 2.5, 5.0}, kPart{1.0, 0.5, 0.25, 0.0};
        double torn = z < 0.0 ? 1.0 : 0.0;
        for (std::size_t i = 0; i < 3; ++i)
            if (const double step = z / kStep_m; step >= kAt[i] && step < kAt[i + 1])
                torn = std::lerp(kPart[i], kPart[i + 1], (step - kAt[i]) / (kAt[i + 1] - kAt[i]));
        return 0.05 * torn + kHaze_per_m * std::exp(-std::max(z, 0.0) / kHazeScale_m);
    };
    for (const double eye_m : {1.0, 4.5, 12.0, 200.0})
        for (const double elevation : {-0.5, -0.05, -0.003, 0.0, 0.003, 0.1})
            for (const double distance_m : {0.3, 7.0, 60.0, 390.0}) {
                double expected = 0.0;
                constexpr int kSteps = 20000;
                for (int i = 0; i < kSteps; ++i)
                    expected += density(eye_m + (i + 0.5) / kSteps * distance_m * std::sin(elevation)) *
                                distance_m / kSteps;
                if (expected > 8.0) continue;
                EXPECT_NEAR(seen_thickness(torn_spray(eye_m, kFlat), elevation, distance_m), expected,
                            2e-3 * expected + 3e-6)
                    << eye_m << " m, " << elevation << ", " << distance_m << " m";
            }
    // The whole of it, from its bottom up.
    for (const double elevation : {0.5 * kPi, 1.0, 0.2}) {
        const auto up = spray_before(torn_spray(0.0, kFlat), glm::vec3(spray_towards(elevation)), {}, false);
        const double whole = 0.05 * kStep_m * (0.75 + 0.5625 + 0.3125) + kHaze_per_m * kHazeScale_m;
        EXPECT_NEAR(-std::log(up.transmittance) / (whole / std::sin(elevation)), 1.0, 3e-3) << elevation;
    }
}

// Where the sea falls off ribbons stay up: nothing right above it, and as much in all.
TEST(SprayBefore, LiftedRibbonsAreAsThickAndHigher) {
    const glm::dvec3 law(0.05, 0.025, 0.0125);
    const SprayRibbons ribbons{.extinction_per_m = law, .step_m = kStep_m};
    for (const double lift : {0.0, 0.2, 1.0, 2.9}) {
        EXPECT_NEAR(ribbons.mean(law, 0.0, ribbons.top_m(), lift * kStep_m) * ribbons.top_m(),
                    ribbons.optical_thickness(), 1e-12);
        Spray spray = torn_spray(0.0, kFlat);
        for (glm::vec4& texel : spray.texels)
            for (int i = 1; i < 4; ++i) texel[i] *= static_cast<float>(SprayRibbons::thinned(law, lift));
        spray.texels.resize(2 * spray.texels.size(), glm::vec4(lift, 0.0f, 0.0f, 0.0f));
        for (const double elevation : {0.5 * kPi, 1.0, 0.2}) {
            const auto up = spray_before(spray, glm::vec3(spray_towards(elevation)), {}, false);
            const double whole = ribbons.optical_thickness() + kHaze_per_m * kHazeScale_m;
            EXPECT_NEAR(-std::log(up.transmittance) / (whole / std::sin(elevation)), 1.0, 3e-3) << elevation;
        }
        spray.eye_m = static_cast<float>(0.35 * kStep_m);
        const double level = seen_thickness(spray, 0.0, 10.0) - 10.0 * kHaze_per_m;
        EXPECT_NEAR(level,
                    10.0 * ribbons.mean(law, 0.35 * kStep_m - 1e-3, 0.35 * kStep_m + 1e-3, lift * kStep_m),
                    2e-3)
            << lift;
        if (lift > 0.5) {
            EXPECT_LT(level, 2e-3) << lift;
        }
    }
}

Spray threaded_spray() {
    Spray spray = torn_spray(2.0, kFlat);
    spray.threads = {.cell = {65535.0f, 3.0f, 0.3f, 0.8f},
                     .wind = {0.8f, 0.6f, 2.25f, 1e3f},
                     .born = {0.4f, 2.0f, 0.6f, 0.8f},
                     .names = {12345.0f, 6789.0f},
                     .per_m = 0.05f,
                     .pixel_rad = 1e-3f};
    return spray;
}

// Threads have the map's mean, however dense it is, and whatever pixels resolve of them.
TEST(SprayBefore, ThreadsHaveTheMeanOne) {
    const Spray spray = threaded_spray();
    for (const float extinction_per_m : {1e-3f, 0.05f, 1.0f})
        for (const float pixel_m : {0.02f, 0.2f, 0.6f}) {
            double sum = 0.0, square = 0.0;
            constexpr int kSide = 60;
            for (int i = 0; i < kSide; ++i)
                for (int j = 0; j < kSide; ++j)
                    for (int k = 0; k < 12; ++k) {
                        const auto factor = static_cast<double>(
                            spray_thread(spray, glm::vec2(glm::dvec2(41.3 * i - 1e3, 17.9 * j - 500.0)),
                                         static_cast<float>(-0.3 + 0.61 * k), extinction_per_m, pixel_m));
                        ASSERT_GE(factor, 0.0);
                        sum += factor;
                        square += factor * factor;
                    }
            constexpr double kCount = kSide * kSide * 12.0;
            EXPECT_NEAR(sum / kCount, 1.0, 0.02) << extinction_per_m << " " << pixel_m;
            if (pixel_m < 0.1f && extinction_per_m < 0.1f) {
                EXPECT_GT(square / kCount, 1.5) << "no threads";
            }
        }
    EXPECT_EQ(spray_thread(spray, {3.0f, 5.0f}, 1.0f, 0.05f, 2.0f), 1.0f) << "pixels see none";
}

// Some times as long along the wind as across it and up, although the wind shears them.
TEST(SprayBefore, ThreadsLieAlongTheWind) {
    const Spray spray = threaded_spray();
    const auto at = [&](glm::vec3 place_m) {
        return static_cast<double>(spray_thread(spray, glm::vec2(place_m), place_m.z, 0.05f, 0.02f));
    };
    const auto differs = [&](glm::vec3 by_m) {
        double sum = 0.0;
        for (int i = 0; i < 60; ++i)
            for (int j = 0; j < 60; ++j) {
                const glm::vec3 place_m(glm::dvec3(41.3 * i, 17.9 * j, 0.04 * j));
                sum += std::abs(at(place_m + by_m) - at(place_m));
            }
        return sum;
    };
    const double along = differs({0.8f, 0.6f, 0.0f});
    EXPECT_GT(differs({-0.6f, 0.8f, 0.0f}), 2.5 * along);
    EXPECT_GT(differs({0.0f, 0.0f, 1.0f}), 2.5 * along);
}

// What rays see on average is as thick as without threads.
TEST(SprayBefore, RaysThroughThreadsAreAsThickOnAverage) {
    Spray spray = threaded_spray();
    for (glm::vec4& texel : spray.texels) texel *= glm::vec4(1.0f, glm::vec3(0.02f));
    spray.haze_per_m = 1e-9f;
    spray.threads.per_m *= 0.02f;
    Spray smooth = spray;
    smooth.threads = {};
    double threads = 0.0, all = 0.0, least = 1e9, most = 0.0;
    for (int i = 0; i < 4000; ++i) {
        const double azimuth = kTwoPi * i / 4000.0 * 7.0;
        spray.threads.names.x = static_cast<float>(10000 + i / 100);
        spray.threads.names.y = static_cast<float>(20000 + i / 100);
        const auto thick = [&](const Spray& through) {
            return -std::log(static_cast<double>(
                spray_before(through, glm::vec3(spray_towards(-0.01, azimuth)), 60.0f, false).transmittance));
        };
        const double seen = thick(spray), plain = thick(smooth);
        threads += seen;
        all += plain;
        least = std::min(least, seen / plain);
        most = std::max(most, seen / plain);
    }
    std::printf("    rays through threads: %.4f of the thickness, %.2f ... %.2f\n", threads / all, least,
                most);
    EXPECT_NEAR(threads / all, 1.0, 0.03);
    EXPECT_LT(least, 0.9);
    EXPECT_GT(most, 1.1);
}

// Against a low sun torn spray is brighter than the sky that it hides.
TEST(SprayBefore, TornSprayShinesAgainstTheSun) {
    Spray spray = torn_spray(3.0, kFlat);
    spray.forward = {0.95f, 0.75f};
    spray.to_sun = glm::vec3(spray_towards(0.2, 0.0));
    // A clear sky's: its light is a fourth of the sun's, and twice as bright low below that.
    spray.sun = glm::vec3(4.0f);
    spray.above = glm::vec3(static_cast<float>(1.0 / kPi));
    spray.low_ahead = 2.0f * spray.above;
    spray.low_beside = spray.low_behind = spray.above;
    const auto seen = [&](double azimuth) {
        const auto path = spray_before(spray, glm::vec3(spray_towards(0.01, azimuth)), 30.0f, false);
        return path.scattered.y / (1.0f - path.transmittance);
    };
    EXPECT_GT(seen(0.15), 1.3f * spray.low_ahead.y);
    EXPECT_LT(seen(kPi), spray.low_behind.y);
}

TEST(SprayBefore, ThinSprayIsLinearAndThickSprayIsItsOwnLight) {
    const auto times = [](double factor) {
        Spray spray = spray_of(3.0, kWaves);
        for (glm::vec4& texel : spray.texels) texel.y *= static_cast<float>(factor);
        spray.to_sun = glm::vec3(0.0f, 0.6f, 0.8f);
        spray.sun = glm::vec3(100.0f);
        spray.above = glm::vec3(5.0f);
        spray.below = glm::vec3(1.0f);
        return spray_before(spray, glm::vec3(spray_towards(-0.02)), 100.0f, true);
    };
    const auto thin = times(1e-4), twice = times(2e-4);
    EXPECT_NEAR(twice.scattered.y / thin.scattered.y, 2.0, 1e-3);
    EXPECT_NEAR((1.0 - twice.transmittance) / (1.0 - thin.transmittance), 2.0, 5e-3);
    EXPECT_EQ(times(0.0).transmittance, 1.0f);
    EXPECT_EQ(times(0.0).scattered, glm::vec3(0.0f));
    const auto thick = times(1e6);
    EXPECT_EQ(thick.transmittance, 0.0f);
    // The sun's light comes from all sides there.
    EXPECT_NEAR(thick.scattered.y, 100.0 / (4.0 * kPi) + 3.0 - 0.85 * 0.02 * 2.0, 0.01);
}

// The sun's light goes on nearly straight: spray before the sun shines, spray behind the viewer doesn't.
TEST(SprayBefore, ScattersAhead) {
    Spray spray = spray_of(3.0, kFlat);
    spray.to_sun = glm::vec3(spray_towards(0.1, 0.0));
    spray.sun = glm::vec3(1.0f);
    for (glm::vec4& texel : spray.texels) texel.y = 1e-6f;
    const auto light = [&](double azimuth) {
        return spray_before(spray, glm::vec3(spray_towards(0.0, azimuth)), 100.0f, false).scattered.y;
    };
    EXPECT_GT(light(0.0), 20.0f * light(0.5 * kPi));
    EXPECT_GT(light(0.5 * kPi), 1.5f * light(kPi));
}

TEST(SprayBefore, IsFiniteEverywhere) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    for (const double eye_m : {-8.0, 0.0, 1e-3, 3.0, 60.0, 1e5, 1e8})
        for (const auto& [factor, torn] :
             {std::pair(0.0, false), {1e-6, true}, {1.0, false}, {1.0, true}, {1e6, false}, {1e6, true}}) {
            Spray spray = torn ? torn_spray(eye_m, kWaves) : spray_of(eye_m, kWaves);
            for (glm::vec4& texel : spray.texels)
                for (int i = 1; i < 4; ++i) texel[i] *= static_cast<float>(factor);
            spray.to_sun = glm::vec3(spray_towards(-0.01));
            spray.sun = spray.above = spray.below = glm::vec3(100.0f);
            const auto check = [&](glm::vec3 direction, std::optional<float> distance_m) {
                for (const bool on_sea : {false, true}) {
                    const SpraySeen seen = spray_before(spray, direction, distance_m, on_sea && distance_m);
                    ASSERT_TRUE(seen.transmittance >= 0.0f && seen.transmittance <= 1.0f) << eye_m;
                    ASSERT_TRUE(seen.scattered.x >= 0.0f && std::isfinite(seen.scattered.x)) << eye_m;
                }
            };
            for (const float distance_m : {0.0f, 1e-3f, 5.0f, 1e3f, 1e6f, 1e9f}) {
                check({0.0f, 0.0f, -1.0f}, distance_m);
                check({0.0f, 0.0f, 1.0f}, distance_m);
                check({1.0f, 0.0f, 0.0f}, distance_m);
                for (int i = 0; i < 50; ++i)
                    check(glm::vec3(spray_towards((unit(random) - 0.5) * kPi, kTwoPi * unit(random))),
                          distance_m);
            }
            for (int i = 0; i < 50; ++i)
                check(glm::vec3(spray_towards((unit(random) - 0.5) * 0.1, kTwoPi * unit(random))), {});
            check({0.0f, 0.0f, 1.0f}, {});
            check({0.0f, 0.0f, -1.0f}, {});
        }
}

// Between two columns it is their mean; the circle has no seam.
TEST(SprayBefore, GoesRoundTheCircleWithoutASeam) {
    Spray spray = spray_of(3.0, kFlat);
    for (int row = 0; row < kRows; ++row)
        for (int column = 0; column < kColumns; ++column)
            spray.texels[static_cast<std::size_t>(row * kColumns + column)].y =
                0.05f * (1.0f + 0.5f * std::sin(static_cast<float>(kTwoPi * column / (kColumns - 1))));
    const auto left = [&](double azimuth) {
        return spray_before(spray, glm::vec3(spray_towards(-0.02, azimuth)), 100.0f, false).transmittance;
    };
    for (int i = 0; i < 1000; ++i)
        EXPECT_NEAR(left(kTwoPi * i / 1000.0), left(kTwoPi * (i + 1) / 1000.0), 0.02f) << i;
    EXPECT_NEAR(left(-1e-6), left(1e-6), 1e-4f);
}

TEST(SprayBefore, WithoutSprayNothingChanges) {
    const glm::vec3 to_eye(0.0f, 0.0f, 1.0f);
    const float distance_m = 5.0f;
    SeaRadiance light{.sun = glm::vec3(1.0f), .air = glm::vec3(2.0f)};
    see_through_spray({}, {&to_eye, 1}, {&distance_m, 1}, {&light, 1});
    EXPECT_EQ(see_through_spray({}, -to_eye, {}, light), 1.0f);
    EXPECT_EQ(light.sun, glm::vec3(1.0f));
    EXPECT_EQ(light.air, glm::vec3(2.0f));
    EXPECT_THROW(see_through_spray({}, {&to_eye, 1}, {}, {&light, 1}), std::invalid_argument);
}

}  // namespace
}  // namespace pelagic
