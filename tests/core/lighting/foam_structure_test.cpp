// The pattern of foam: its mean is the coverage wherever, however old and however far away it is; it stays with the water.
#include "core/lighting/foam_structure.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "core/lighting/lighting.h"
#include "tests/core/lighting/optics.h"

namespace pelagic {
namespace {

using optics::glsl;
using optics::Optics;

Optics shading;

Optics::FoamPattern pattern_of(double structure, double streaks, double wind_deg = 20.0,
                               glm::dvec2 origin_m = {}) {
    return glsl(
        foam_pattern({.structure = structure, .streaks = streaks, .wind_direction_deg = wind_deg}, origin_m));
}

const glm::vec3 kSun(0.36f, 0.48f, 0.8f);
constexpr std::array kCoverages{0.01f, 0.03f, 0.1f, 0.3f, 0.5f, 0.7f, 0.9f};
constexpr float kWhite = 0.55f;
constexpr std::array kOpacities{0.2f, 0.7f};
constexpr std::array kFootprints_m{1e-3f, 0.02f, 0.06f, 0.15f, 0.4f, 1.0f, 2.5f, 8.0f, 1e3f};
constexpr std::array kAges_s{0.0f, 0.7f, 2.0f, 5.0f, 20.0f};

// Over independent places, for any opacity: of what it hides, and of the light that it reflects.
TEST(FoamStructure, HasTheCoverageAsItsMean) {
    double all = 0.0, all_expected = 0.0;
    constexpr int kPlaces = 4000;
    std::mt19937 random(5);
    // Over many of the wide rows: 4 km have so few that their own mean is 0.98.
    std::uniform_real_distribution<float> place(-30000.0f, 30000.0f);
    for (const float streaks : {0.0f, 0.5f, 1.0f})
        for (const float age_s : kAges_s) {
            const auto pattern = pattern_of(1.0, static_cast<double>(streaks));
            for (const float footprint_m : kFootprints_m) {
                std::array<std::array<double, kOpacities.size()>, kCoverages.size()> sums{}, light{};
                for (int i = 0; i < kPlaces; ++i) {
                    const auto noise =
                        shading.foam_noise(pattern, {place(random), place(random)}, footprint_m, age_s);
                    for (std::size_t c = 0; c < kCoverages.size(); ++c)
                        for (std::size_t d = 0; d < kOpacities.size(); ++d) {
                            const auto seen = shading.foam_in(noise, kCoverages[c] * kOpacities[d], kWhite,
                                                              shading.foam_thin(age_s));
                            ASSERT_GE(seen.opacity, 0.0f);
                            ASSERT_LE(seen.opacity, 1.0f);
                            ASSERT_GT(seen.white, 0.0f);
                            ASSERT_LE(seen.white, 0.96f);
                            sums[c][d] += static_cast<double>(seen.opacity);
                            light[c][d] += static_cast<double>(seen.opacity * seen.white);
                        }
                }
                for (std::size_t c = 0; c < kCoverages.size(); ++c)
                    for (std::size_t d = 0; d < kOpacities.size(); ++d) {
                        // No wider spread about the mean than that of foam that is opaque or isn't there.
                        const auto covered = static_cast<double>(kCoverages[c]);
                        const double expected = covered * static_cast<double>(kOpacities[d]);
                        const double noise = std::sqrt(expected * (1.0 - expected) / kPlaces);
                        all += sums[c][d] / kPlaces;
                        all_expected += expected;
                        EXPECT_NEAR(sums[c][d] / kPlaces, expected, 4.5 * noise + 0.01 * expected)
                            << "footprint " << footprint_m << " m, " << age_s << " s, streaks " << streaks
                            << ", opacity " << kOpacities[d];
                        EXPECT_NEAR(light[c][d] / kPlaces / static_cast<double>(kWhite), expected,
                                    1.35 * 4.5 * noise + 0.01 * expected)
                            << "light, footprint " << footprint_m << " m, " << age_s << " s, streaks "
                            << streaks << ", opacity " << kOpacities[d];
                    }
            }
        }
    RecordProperty("with_over_without_structure", std::to_string(all / all_expected));
}

// Where nothing of it can be seen any more, it is the coverage itself.
TEST(FoamStructure, FadesToTheCoverage) {
    const auto pattern = pattern_of(1.0, 0.5);
    for (const float coverage : {0.0f, 1e-5f, 0.01f, 0.4f, 0.97f, 1.0f}) {
        const auto seen = shading.seen_foam(pattern, {3.0f, 4.0f}, glm::vec3(50.0f, 0.0f, 0.0f), coverage,
                                            1.0f, 0.0f, kSun);
        EXPECT_EQ(seen.opacity, coverage * 0.4f);
        EXPECT_EQ(seen.white, 0.55f);
    }
}

// Without structure: the bits of smooth coverage.
TEST(FoamStructure, OffIsSmoothCoverage) {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    const auto pattern = pattern_of(0.0, 0.5);
    for (int i = 0; i < 1000; ++i) {
        const float coverage = unit(random);
        const auto seen = shading.seen_foam(pattern, {unit(random), unit(random)},
                                            glm::vec3(1e-3f, 0.0f, 0.0f), coverage, 1.0f, 3.0f, kSun);
        EXPECT_EQ(seen.opacity, coverage * 0.4f);
        EXPECT_EQ(seen.white, 0.55f);
    }
}

// Fresh foam and old foam are mixed as they hide the water, so that one place's light is the mean of its parts'.
TEST(FoamStructure, MixesFreshAndOldByWhatTheyHide) {
    const auto pattern = glsl(foam_pattern(
        {.fresh_opacity = 0.9f, .old_opacity = 0.2f, .fresh_albedo = 0.8f, .old_albedo = 0.3f}, {}));
    for (const float fresh : {0.0f, 0.02f, 0.15f, 0.3f}) {
        const auto seen =
            shading.seen_foam(pattern, {3.0f, 4.0f}, glm::vec3(1.0f, 0.0f, 0.0f), 0.3f, fresh, 2.0f, kSun);
        EXPECT_NEAR(seen.opacity, 0.9f * fresh + 0.2f * (0.3f - fresh), 1e-6f);
        EXPECT_NEAR(seen.opacity * seen.white, 0.9f * fresh * 0.8f + 0.2f * (0.3f - fresh) * 0.3f, 1e-6f);
    }
    const auto none = glsl(foam_pattern({.structure = 1.0, .fresh_opacity = 0.0f, .old_opacity = 0.0f}, {}));
    EXPECT_EQ(shading.seen_foam(none, {}, glm::vec3(0.01f, 0.0f, 0.0f), 0.3f, 0.1f, 2.0f, kSun).opacity,
              0.0f);
}

// What is fresh isn't cut off: beside thick foam there is lace, seldom bare water right away.
TEST(FoamStructure, PatchesEndInLace) {
    const auto pattern = pattern_of(1.0, 1.0, 0.0);
    std::mt19937 random(11);
    std::uniform_real_distribution<float> place(-500.0f, 500.0f), turn(0.0f, 6.2831853f);
    const auto at = [&](glm::vec2 rest_m) {
        const auto noise = shading.foam_noise(pattern, rest_m, 0.02f, 0.0f);
        return shading.foam_opacity_in(noise, 0.3f, shading.foam_thin(0.0f));
    };
    constexpr int kPlaces = 60000;
    int thick = 0, cut = 0;
    for (int i = 0; i < kPlaces; ++i) {
        const glm::vec2 m(place(random), place(random));
        const float angle = turn(random);
        const glm::vec2 ahead(std::cos(angle), std::sin(angle)), aside(-ahead.y, ahead.x);
        // Two strips of 60 × 24 cm, 12 cm apart.
        const auto mean = [&](float from_m) {
            float sum = 0.0f;
            for (int j = 0; j < 3; ++j)
                for (int k = -2; k <= 2; ++k)
                    sum += at(m + (from_m + 0.12f * static_cast<float>(j)) * ahead +
                              0.15f * static_cast<float>(k) * aside);
            return sum / 15.0f;
        };
        if (mean(-0.3f) < 0.75f) continue;
        ++thick;
        cut += mean(0.06f) < 0.15f;
    }
    std::printf("    of %d places %d are thick, and of these %d end in a cut\n", kPlaces, thick, cut);
    EXPECT_GT(thick, 2000);
    EXPECT_LT(cut, 4e-4 * kPlaces);
}

// The opacity and the white of foam at places of a fine footprint.
std::vector<Optics::SeenFoam> seen_near(float coverage, float breaking, float age_s) {
    std::mt19937 random(8);
    std::uniform_real_distribution<float> place(-500.0f, 500.0f);
    const auto pattern = glsl(foam_pattern(
        {.structure = 1.0, .streaks = 0.5, .wind_direction_deg = 20.0, .fresh_opacity = 0.9f}, {}));
    std::vector<Optics::SeenFoam> all;
    for (int i = 0; i < 4000; ++i)
        all.push_back(shading.seen_foam(pattern, {place(random), place(random)}, glm::vec3(0.01f, 0.0f, 0.0f),
                                        coverage, breaking, age_s, kSun));
    return all;
}

// Near, the pattern is there, and has no cut edge: opacities are spread from none to all, with much of the sea's between.
TEST(FoamStructure, IsThereAndSoft) {
    for (const float age_s : {0.0f, 5.0f}) {
        int open = 0, thin = 0, thick = 0;
        for (const auto& seen : seen_near(0.4f, age_s > 0.0f ? 0.0f : 0.4f, age_s)) {
            open += seen.opacity < 0.05f;
            thin += seen.opacity > 0.1f && seen.opacity < 0.6f;
            thick += seen.opacity > 0.8f;
        }
        EXPECT_GT(open, 1000) << age_s;
        EXPECT_GT(thin, 800) << age_s;
        EXPECT_GT(thick, age_s > 0.0f ? 40 : 400) << age_s;
    }
}

// Where foam covers nearly all old foam is threads with a film between them, and little open water: of 0.4 opacity a third is
// translucent. Fresh foam is dense.
TEST(FoamStructure, HasAThinFilmBetweenThreads) {
    for (const float age_s : {0.0f, 4.0f, 8.0f}) {
        int open = 0, film = 0, thick = 0;
        for (const auto& seen : seen_near(0.9f, age_s > 0.0f ? 0.0f : 0.9f, age_s)) {
            open += seen.opacity < 0.05f;
            film += seen.opacity > 0.15f && seen.opacity < 0.6f;
            thick += seen.opacity > 0.8f;
        }
        EXPECT_LT(open, 800) << age_s;
        EXPECT_TRUE(age_s > 0.0f ? film > 1200 && thick > 400 : film < 800 && thick > 2400)
            << age_s << ": " << film << ", " << thick;
    }
}

// Near it is torn down to a few centimetres: over 3 cm old foam changes by a good part of its opacity.
TEST(FoamStructure, IsTornNear) {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> place(-400.0f, 400.0f);
    const auto pattern = pattern_of(1.0, 0.0);
    double change = 0.0, foam = 0.0;
    for (int i = 0; i < 4000; ++i) {
        const glm::vec2 at(place(random), place(random));
        const auto opacity_at = [&](glm::vec2 rest_m) {
            return shading.seen_foam(pattern, rest_m, glm::vec3(0.005f, 0.0f, 0.0f), 0.5f, 0.0f, 3.0f, kSun)
                .opacity;
        };
        change += std::abs(opacity_at(at + glm::vec2(0.03f, 0.0f)) - opacity_at(at));
        foam += opacity_at(at);
    }
    std::printf("    over 3 cm %.3f of its opacity\n", change / foam);
    EXPECT_GT(change, 0.48 * foam);
}

// A roller that hides all of the water has heaps and hollows: its tone is not one.
TEST(FoamStructure, HasHeapsAndHollows) {
    std::vector<float> white;
    for (const auto& seen : seen_near(1.0f, 1.0f, 0.0f)) white.push_back(seen.white);
    std::sort(white.begin(), white.end());
    const float low = white[white.size() / 20], high = white[white.size() - white.size() / 20];
    EXPECT_LT(low, 0.8f * kWhite);
    EXPECT_GT(high, 1.1f * kWhite);
}

// What breaks has a relief of its own, as thick as it is: slopes to the sun and from it, as much light as without, near alone, and old foam has none.
TEST(FoamStructure, HasARelief) {
    constexpr int kPlaces = 20000;
    const auto pattern = pattern_of(1.0, 0.5);
    for (const float footprint_m : {0.01f, 0.1f, 2.0f}) {
        std::mt19937 random(6);
        std::uniform_real_distribution<float> place(-2000.0f, 2000.0f);
        double slope = 0.0, square = 0.0, light = 0.0, old = 0.0;
        for (int i = 0; i < kPlaces; ++i) {
            const glm::vec2 rest_m(place(random), place(random));
            const auto seen = [&](float breaking, float age_s) {
                return shading.seen_foam(pattern, rest_m, glm::vec3(footprint_m, 0.0f, 0.0f), 1.0f, breaking,
                                         age_s, kSun);
            };
            const auto fresh = seen(1.0f, 0.0f);
            slope += static_cast<double>(fresh.slope) / kPlaces;
            square += static_cast<double>(fresh.slope * fresh.slope) / kPlaces;
            light += static_cast<double>(fresh.opacity * fresh.white) / kPlaces;
            old = std::max(old, static_cast<double>(std::abs(seen(0.0f, 9.0f).slope)));
        }
        EXPECT_NEAR(slope, 0.0, 0.01) << footprint_m;
        EXPECT_NEAR(light, 0.4 * 0.55, 0.01 * 0.4 * 0.55) << footprint_m;
        if (footprint_m < 1.0f)
            EXPECT_TRUE(square > 0.1 * 0.1 && square < 0.35 * 0.35)
                << footprint_m << ": " << std::sqrt(square);
        else
            EXPECT_EQ(square, 0.0);
        EXPECT_LT(old, 0.002) << footprint_m;
    }
}

// What breaks is white water with torn edges, what it leaves is lace: where as much is covered it changes less over a hand's breadth,
// though it has no film.
TEST(FoamStructure, IsThickWhereItBreaks) {
    const auto change = [&](float breaking) {
        std::mt19937 random(5);
        std::uniform_real_distribution<float> place(-400.0f, 400.0f);
        const auto pattern =
            glsl(foam_pattern({.structure = 1.0, .fresh_opacity = 0.8f, .old_opacity = 0.8f}, {}));
        double sum = 0.0;
        for (int i = 0; i < 4000; ++i) {
            const glm::vec2 at(place(random), place(random));
            const auto opacity_at = [&](glm::vec2 rest_m) {
                return shading
                    .seen_foam(pattern, rest_m, glm::vec3(0.02f, 0.0f, 0.0f), 0.6f, breaking, 3.0f, kSun)
                    .opacity;
            };
            sum += static_cast<double>(std::abs(opacity_at(at + glm::vec2(0.1f, 0.0f)) - opacity_at(at)));
        }
        return sum;
    };
    const double fresh = change(0.6f), old = change(0.0f);
    std::printf("    over 10 cm fresh foam changes by %.2f of what old does\n", fresh / old);
    EXPECT_LT(fresh, old);
}

// Old foam lies in streaks along the wind: along it the pattern of a footprint of metres changes less than across it.
// Where a pixel is too large for heaps foam has patches of several tones, as much light as without, and no step from one octave to the next.
TEST(FoamStructure, HasTonesFarOff) {
    constexpr int kPlaces = 20000;
    const auto pattern = pattern_of(1.0, 0.5);
    for (const float footprint_m : {0.05f, 0.3f, 1.0f, 3.0f, 6.0f, 50.0f}) {
        std::mt19937 random(5);
        std::uniform_real_distribution<float> place(-2000.0f, 2000.0f);
        double mean = 0.0, square = 0.0, step = 0.0;
        for (int i = 0; i < kPlaces; ++i) {
            const glm::vec2 rest_m(place(random), place(random));
            const auto tone = static_cast<double>(shading.foam_tone(pattern, rest_m, footprint_m));
            ASSERT_LE(std::abs(tone), 1.0);
            mean += tone / kPlaces;
            square += tone * tone / kPlaces;
            step = std::max(step, std::abs(tone - static_cast<double>(shading.foam_tone(
                                                      pattern, rest_m, 1.001f * footprint_m))));
        }
        const bool is_seen = footprint_m > 0.5f && footprint_m < 7.0f;
        EXPECT_NEAR(mean, 0.0, 0.02) << footprint_m;
        EXPECT_NEAR(std::sqrt(square), is_seen ? std::sqrt(1.0 / 3.0) : 0.25, is_seen ? 0.03 : 0.26)
            << footprint_m;
        EXPECT_LT(step, 0.02) << footprint_m;
    }
    EXPECT_EQ(shading.foam_tone(pattern, {3.0f, 4.0f}, 0.05f), 0.0f);
    EXPECT_EQ(shading.foam_tone(pattern, {3.0f, 4.0f}, 50.0f), 0.0f);
    // An octave's end: 32 m / (5 · 1.6 m) = 4.
    EXPECT_NEAR(shading.foam_tone(pattern, {3.0f, 4.0f}, 1.5999f),
                shading.foam_tone(pattern, {3.0f, 4.0f}, 1.6001f), 0.01f);
    // In a picture's foam it is the light alone that has them.
    double light = 0.0;
    for (int i = 0; i < kPlaces; ++i)
        light += static_cast<double>(shading
                                         .seen_foam(pattern, {1.7f * float(i), 0.3f * float(i)},
                                                    glm::vec3(3.0f, 0.0f, 0.0f), 0.5f, 0.5f, 0.0f, kSun)
                                         .white);
    EXPECT_NEAR(light / kPlaces / 0.55, 1.0, 0.01);
}

TEST(FoamStructure, LiesInStreaksWhereOld) {
    std::mt19937 random(12);
    std::uniform_real_distribution<float> place(-3000.0f, 3000.0f);
    const auto pattern = pattern_of(1.0, 0.8, 0.0);
    const auto change = [&](glm::vec2 step_m, float age_s) {
        double squares = 0.0;
        for (int i = 0; i < 4000; ++i) {
            const glm::vec2 at(place(random), place(random));
            const double d = static_cast<double>(shading.foam_noise(pattern, at, 0.5f, age_s).shown -
                                                 shading.foam_noise(pattern, at + step_m, 0.5f, age_s).shown);
            squares += d * d / 4000.0;
        }
        return squares;
    };
    const glm::vec2 along(8.0f, 0.0f), across(0.0f, 8.0f);
    EXPECT_LT(change(along, 8.0f), 0.4 * change(across, 8.0f));
    EXPECT_GT(change(along, 0.0f), 0.6 * change(across, 0.0f));
}

// From a plane too: pixels of 10 m still tell wide rows from what is between, and rows bend: far along one the wind's own direction has left it.
TEST(FoamStructure, HasWideRowsThatBend) {
    std::mt19937 random(12);
    std::uniform_real_distribution<float> place(-3000.0f, 3000.0f);
    const auto likeness = [&](glm::vec2 step_m, float footprint_m) {
        const auto pattern = pattern_of(1.0, 1.0, 0.0);
        double both = 0.0, square = 0.0;
        for (int i = 0; i < 8000; ++i) {
            const glm::vec2 at(place(random), place(random));
            const auto here = static_cast<double>(shading.foam_noise(pattern, at, footprint_m, 8.0f).shown);
            both +=
                here * static_cast<double>(shading.foam_noise(pattern, at + step_m, footprint_m, 8.0f).shown);
            square += here * here;
        }
        EXPECT_GT(square / 8000.0, 0.05);
        return both / square;
    };
    EXPECT_LT(likeness({0.0f, 40.0f}, 10.0f), 0.2);
    EXPECT_GT(likeness({40.0f, 0.0f}, 10.0f), 0.7);
    // Rows of 8 m have cells of 136 m: straight ones are alike by 0.89.
    EXPECT_LT(likeness({40.0f, 0.0f}, 1.5f), 0.8);
}

// The same place of the sea, seen from any origin near it, also a million metres away from the world's; also beyond where
// integers of single precision end.
TEST(FoamStructure, StaysWithTheWater) {
    std::mt19937 random(9);
    std::uniform_real_distribution<double> near_m(-30.0, 30.0);
    const FoamLook look{.structure = 1.0, .streaks = 0.5, .wind_direction_deg = 20.0, .seed = 3};
    for (const glm::dvec2 centre : {glm::dvec2(0.0), glm::dvec2(1e6, -1e6), glm::dvec2(-2e7, 3e7)}) {
        std::vector<float> seen;
        for (int i = 0; i < 500; ++i) {
            const glm::dvec2 at = centre + glm::dvec2(near_m(random), near_m(random));
            std::array<float, 2> shown{};
            for (float& value : shown) {
                const glm::dvec2 origin = centre + glm::dvec2(near_m(random), near_m(random));
                value =
                    shading.foam_noise(glsl(foam_pattern(look, origin)), glm::vec2(at - origin), 0.01f, 2.0f)
                        .shown;
            }
            EXPECT_NEAR(shown[0], shown[1], 0.01f) << centre.x;
            seen.push_back(shown[0]);
        }
        // It isn't the same everywhere.
        double sum = 0.0, squares = 0.0;
        for (const float value : seen) {
            sum += static_cast<double>(value);
            squares += static_cast<double>(value * value);
        }
        const auto count = static_cast<double>(seen.size());
        const double mean = sum / count;
        EXPECT_NEAR(squares / count - mean * mean, 0.9, 0.35);
    }
}

// Seas of other seeds have other foam where cameras stand, and as much of it: no shot's is that of one bare patch.
TEST(FoamStructure, IsElsewhereInEachSea) {
    std::vector<double> first;
    double likeness = 0.0, mean = 0.0;
    constexpr int kSeeds = 40, kPlaces = 200;
    for (int seed = 1; seed <= kSeeds; ++seed) {
        std::mt19937 random(4);
        std::uniform_real_distribution<float> near_m(-10.0f, 10.0f);
        const auto pattern =
            glsl(foam_pattern({.structure = 1.0, .seed = static_cast<std::uint64_t>(seed)}, {}));
        for (int i = 0; i < kPlaces; ++i) {
            const glm::vec2 at(near_m(random), near_m(random));
            const double shown = static_cast<double>(shading.foam_noise(pattern, at, 0.1f, 2.0f).shown);
            if (seed == 1)
                first.push_back(shown);
            else
                likeness += first[static_cast<std::size_t>(i)] * shown;
            mean += shown;
        }
    }
    EXPECT_NEAR(mean / (kSeeds * kPlaces), 0.0, 0.1);
    EXPECT_NEAR(likeness / ((kSeeds - 1) * kPlaces), 0.0, 0.1);
}

// The largest cells have numbers that begin again after 65536 of them, also where the origin of the sea's places is: no seam is
// seen there, along the wind or across it.
TEST(FoamStructure, HasNoSeamWhereCellsAreNumberedAnew) {
    std::mt19937 random(11);
    std::uniform_real_distribution<float> place(-500.0f, 500.0f);
    const auto pattern = pattern_of(1.0, 0.5, 0.0);
    for (const bool across : {false, true})
        for (const float age_s : kAges_s)
            for (int i = 0; i < 500; ++i) {
                const float along_m = place(random);
                const auto shown = [&](float aside_m) {
                    const glm::vec2 at = across ? glm::vec2(along_m, aside_m) : glm::vec2(aside_m, along_m);
                    return shading.foam_noise(pattern, at, 0.01f, age_s).shown;
                };
                ASSERT_NEAR(shown(-1e-6f), shown(1e-6f), 2e-3f) << across << ", " << age_s << ", " << along_m;
            }
}

// Along any of place, footprint and age the pattern has no jump: steps of a 64th change it by less than a third, an eighth at the
// edges of a net, where it rises as a root.
TEST(FoamStructure, NeverJumps) {
    std::mt19937 random(10);
    std::uniform_real_distribution<double> place(-1000.0, 1000.0);
    const auto pattern = pattern_of(1.0, 0.5);
    struct At {
        glm::vec2 rest_m;
        float footprint_m, age_s;
    };
    const auto noise = [&](const At& at) {
        const auto n = shading.foam_noise(pattern, at.rest_m, at.footprint_m, at.age_s);
        return n.shown + n.variance;
    };
    const auto ways = std::to_array<std::array<At, 2>>({
        {At{{0.0f, 0.0f}, 0.01f, 2.0f}, At{{10.0f, 3.0f}, 0.01f, 2.0f}},
        {At{{0.3f, 0.2f}, 0.005f, 2.0f}, At{{0.3f, 0.2f}, 6.0f, 2.0f}},
        {At{{0.3f, 0.2f}, 0.01f, 0.0f}, At{{0.3f, 0.2f}, 0.01f, 30.0f}},
    });
    constexpr int kSteps[2] = {4000, 256000};
    for (const auto& [from, to] : ways)
        for (int line = 0; line < 3; ++line) {
            const glm::vec2 start(place(random), place(random));
            std::array<float, 2> most{};
            for (int fine = 0; fine < 2; ++fine) {
                float before = 0.0f;
                for (int i = 0; i <= kSteps[fine]; ++i) {
                    const float t = static_cast<float>(i) / static_cast<float>(kSteps[fine]);
                    const float value = noise({start + glm::mix(from.rest_m, to.rest_m, t),
                                               glm::mix(from.footprint_m, to.footprint_m, t),
                                               glm::mix(from.age_s, to.age_s, t)});
                    if (i > 0) most[fine] = std::max(most[fine], std::abs(value - before));
                    before = value;
                }
            }
            EXPECT_LT(most[1], 0.3f * most[0]) << "from " << start.x << ", " << start.y;
        }
}

// The pattern's settings, through the batch interface: off is the light of plain coverage to the bit.
TEST(FoamStructure, OffLightsAsBefore) {
    Sky sky;
    sky.sun_direction = glm::vec3(0.0f, 0.6f, 0.8f);
    sky.sun_radiance = glm::vec3(1e6f);
    sky.sun_angular_radius = 0.00465f;
    sky.sky_irradiance = glm::vec3(10.0f);
    const WaterBody water{.reflectance = glm::vec3(0.02f)};
    std::vector<SeaPoint> points(100);
    for (std::size_t i = 0; i < points.size(); ++i)
        points[i] = {.slope_variance = glm::vec3(0.02f, 0.02f, 0.0f),
                     .coverage = 0.01f * static_cast<float>(i),
                     .rest_m = glm::vec2(0.37f * static_cast<float>(i), 1.0f),
                     .pixel_m = glm::vec3(0.01f, 0.0f, 0.0f)};
    std::vector<SeaRadiance> plain(points.size()), off = plain, on = plain;
    const LightingChoice choice{.sky = false};
    shade_sea(choice, sky, water, points, plain);
    shade_sea(choice, sky, water, points, off, nullptr, foam_pattern({.streaks = 0.7}, {1e5, 3.0}));
    shade_sea(choice, sky, water, points, on, nullptr,
              foam_pattern({.structure = 1.0, .streaks = 0.5}, {1e5, 3.0}));
    int others = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        EXPECT_EQ(plain[i].foam, off[i].foam);
        EXPECT_EQ(plain[i].sea, off[i].sea);
        others += plain[i].foam != on[i].foam;
    }
    EXPECT_GT(others, 50);
}

}  // namespace
}  // namespace pelagic
