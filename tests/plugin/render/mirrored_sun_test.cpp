// The pattern of the sun's light that waves mirror onto a body, beside the sum over all facets that mirror it there.
#include "plugin/render/mirrored_sun.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <cmath>
#include <cstddef>
#include <glm/glm.hpp>
#include <memory>
#include <vector>

#include "core/base/constants.h"
#include "core/evaluate/evaluate.h"
#include "core/plan/plan.h"
#include "core/waves/sea.h"
#include "plugin/light/light.h"

namespace pelagic {
namespace {

constexpr double kFinest_m = 0.004;

struct OpenSea {
    glm::vec3 waves{0.0f};
    std::shared_ptr<Frame<float>> frame;
};
OpenSea open_sea(double wind_mps, int seed = 1, double choppiness = 0.0) {
    Scene scene;
    scene.sea.wind_speed_mps = wind_mps;
    scene.sea.fetch_m = 2e3;
    scene.shot.seed = static_cast<std::uint64_t>(seed);
    scene.waves.choppiness = choppiness;  // 0: places at rest are as dense as on the sea
    scene.waves.cascades = {{.size_m = 30.0, .resolution = 256}, {.size_m = 3.0, .resolution = 256}};
    const auto prepared = prepare(scene);
    const Query query = view_query(
        *prepared, {.products = {}, .finest_cell_m = kFinest_m, .finest_pixel_m = kFinest_m, .points = 1000});
    const auto sea =
        std::make_shared<const Sea<float>>(make_plan(prepared, {query}, {.double_precision = false}));
    OpenSea made{.waves = make_water(scene).waves, .frame = std::make_shared<Frame<float>>(sea)};
    made.frame->set(3.0);
    return made;
}

glm::vec3 sun_at(double elevation_deg, double azimuth_deg = 40.0) {
    const double e = elevation_deg * kPi / 180.0, a = azimuth_deg * kPi / 180.0;
    return glm::vec3(glm::dvec3(std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e)));
}

MirroredSunWanted box_over(const OpenSea& sea, double elevation_deg, glm::dvec3 middle_m, glm::dvec3 half_m) {
    return {.sun = {.to_sun = sun_at(elevation_deg), .angular_radius = 0.00465f, .waves = sea.waves},
            .middle_m = middle_m,
            .half_edges_m = {{half_m.x, 0.0, 0.0}, {0.0, half_m.y, 0.0}, {0.0, 0.0, half_m.z}},
            .level_m = 0.0,
            .finest_m = kFinest_m,
            .finest_cell_m = kFinest_m};
}

MirroredSun pattern_of(const OpenSea& sea, const MirroredSunWanted& wanted) {
    MirroredSun made;
    made.find(*sea.frame, wanted, nullptr);
    return made;
}

double mirrored_part(double cosine) {
    constexpr double n = 1.34;
    const double t = std::sqrt(1.0 - (1.0 - cosine * cosine) / (n * n));
    const double s = (cosine - n * t) / (cosine + n * t), p = (n * cosine - t) / (n * cosine + t);
    return 0.5 * (s * s + p * p);
}

// What a square metre at rest sends to a place, of a beam of 1, on a wall that looks to the sun: facets whose slopes have a normal distribution
// round a mean.
double sent_to(const glm::dvec3& from, const glm::dvec3& to, const glm::dvec3& to_sun, const glm::dvec2& mean,
               const glm::dvec3& variance) {
    const glm::dvec3 way = to - from, towards = glm::normalize(way);
    if (!(towards.z > 0.0)) return 0.0;
    const glm::dvec3 facet = glm::normalize(towards + to_sun);
    const glm::dvec2 d = -glm::dvec2(facet) / facet.z - mean;
    const double det = variance.x * variance.y - variance.z * variance.z;
    const double power =
        (variance.y * d.x * d.x - 2.0 * variance.z * d.x * d.y + variance.x * d.y * d.y) / det;
    if (power > 80.0) return 0.0;
    const double density = std::exp(-0.5 * power) / (2.0 * kPi * std::sqrt(det));
    const glm::dvec2 wall = glm::normalize(glm::dvec2(to_sun));
    return std::max(-glm::dot(glm::dvec2(towards), wall), 0.0) * mirrored_part(glm::dot(facet, to_sun)) *
           density / (4.0 * std::pow(facet.z, 4.0) * glm::dot(way, way));
}

// On places of a wall, what square facets of the sea send there: of its waves, or without, in the mean over them.
std::vector<double> by_facets(const OpenSea& sea, bool has_waves, const glm::dvec3& to_sun,
                              const std::vector<glm::dvec3>& places, double facet_m, double far_m) {
    const auto side = static_cast<std::size_t>(far_m / facet_m);
    const glm::dvec2 corner = glm::dvec2(places[places.size() / 2]) +
                              0.4 * far_m * glm::normalize(glm::dvec2(to_sun)) - 0.5 * far_m;
    std::vector<double> sums(places.size());
    std::vector<glm::vec2> rest(side);
    std::vector<glm::vec3> position(side), normal(side), hidden(side);
    const std::vector<float> width(side, static_cast<float>(facet_m));
    for (std::size_t row = 0; row < side; ++row) {
        for (std::size_t i = 0; i < side; ++i) {
            rest[i] = glm::vec2(static_cast<double>(i) * facet_m, static_cast<double>(row) * facet_m);
            position[i] = glm::vec3(rest[i], 0.0f);
            normal[i] = {0.0f, 0.0f, 1.0f};
            hidden[i] = sea.waves;
        }
        Results<float> results;
        results.set(Product::Position, {position.data()});
        results.set(Product::Normal, {normal.data()});
        results.set(Product::SlopeVariance, {hidden.data()});
        if (has_waves)
            evaluate(*sea.frame, 0,
                     Points<float>{.origin_m = corner,
                                   .count = side,
                                   .rest_m = {rest.data()},
                                   .cell_m = {width.data()},
                                   .pixel_m = {width.data()}},
                     results);
        for (std::size_t i = 0; i < side; ++i) {
            const glm::dvec3 at = glm::dvec3(corner, 0.0) + glm::dvec3(position[i]);
            const glm::dvec2 slope = -glm::dvec2(normal[i]) / static_cast<double>(normal[i].z);
            for (std::size_t k = 0; k < places.size(); ++k)
                sums[k] +=
                    facet_m * facet_m * sent_to(at, places[k], to_sun, slope, glm::dvec3(hidden[i]) + 1e-6);
        }
    }
    return sums;
}

// Half a million facets, a few centimetres wide: the only test beside the law itself, of where lines are and how bright.
TEST(MirroredSun, IsThatOfAllFacets) {
    const OpenSea sea = open_sea(4.0);
    for (const double elevation : {20.0, 40.0}) {
        const MirroredSunWanted wanted = box_over(sea, elevation, {3.0, -2.0, 0.8}, {1.0, 1.0, 0.4});
        const MirroredSun pattern = pattern_of(sea, wanted);
        std::vector<glm::dvec3> places;
        const glm::dvec2 across(-wanted.sun.to_sun.y, wanted.sun.to_sun.x);
        for (const double height : {0.4, 0.7, 1.2})
            for (int i = -4; i <= 4; ++i)
                places.emplace_back(glm::dvec2(3.0, -2.0) + 0.22 * i * across, height);
        const glm::dvec3 to_sun(wanted.sun.to_sun);
        const double far_m = elevation < 30.0 ? 20.0 : 11.0;
        const std::vector<double> facets = by_facets(sea, true, to_sun, places, far_m / 700.0, far_m),
                                  means = by_facets(sea, false, to_sun, places, 0.08, far_m);
        double squares = 0.0, errors = 0.0, mean = 0.0;
        for (std::size_t k = 0; k < places.size(); ++k)
            mean += facets[k] / means[k] / static_cast<double>(places.size());
        for (std::size_t k = 0; k < places.size(); ++k) {
            const double light = facets[k] / means[k],
                         error = static_cast<double>(pattern.at(places[k])) - light;
            EXPECT_LT(std::abs(error), 0.25 * std::max(light, 1.0)) << elevation << ' ' << k;
            errors += error * error / static_cast<double>(places.size());
            squares += (light - mean) * (light - mean) / static_cast<double>(places.size());
        }
        EXPECT_LT(std::sqrt(errors), elevation < 30.0 ? 0.06 : 0.13) << elevation;
        EXPECT_GT(std::sqrt(squares), elevation < 30.0 ? 0.1 : 0.25) << elevation;
    }
}

TEST(MirroredSun, KeepsItsMean) {
    // Of seas and places enough that their longest waves count little.
    std::vector<OpenSea> seas;
    for (const int seed : {1, 2, 3}) seas.push_back(open_sea(4.0, seed));
    for (const double elevation : {8.0, 20.0, 60.0}) {
        double sum = 0.0, squares = 0.0;
        int count = 0;
        for (const OpenSea& sea : seas) {
            MirroredSunWanted wanted = box_over(sea, elevation, {0.0, 0.0, 1.7}, {20.0, 20.0, 1.3});
            wanted.finest_m = 0.7;
            const MirroredSun pattern = pattern_of(sea, wanted);
            for (const double height : {0.3, 0.8, 1.5, 2.8})
                for (int y = 0; y < 60; ++y)
                    for (int x = 0; x < 60; ++x) {
                        const auto value =
                            static_cast<double>(pattern.at({(x - 29.5) / 1.5, (y - 29.5) / 1.5, height}));
                        ASSERT_TRUE(std::isfinite(value) && value >= 0.0);
                        sum += value;
                        squares += value * value;
                        ++count;
                    }
        }
        const double mean = sum / count;
        EXPECT_NEAR(mean, 1.0, 0.02) << elevation;
    }
}

TEST(MirroredSun, IsEvenOnACalmSeaFarUpAndWithoutASun) {
    const OpenSea calm = open_sea(0.0), sea = open_sea(4.0);
    const auto coarsely = [](const OpenSea& of, MirroredSunWanted wanted, double finest_m) {
        wanted.finest_m = finest_m;
        return pattern_of(of, wanted);
    };
    const MirroredSun still = coarsely(calm, box_over(calm, 25.0, {0.0, 0.0, 1.0}, {3.0, 1.0, 1.0}), 0.1);
    for (const double height : {0.0, 0.2, 1.1, 1.9})
        EXPECT_NEAR(static_cast<double>(still.at({1.0, 0.5, height})), 1.0, 1e-4) << height;
    const auto contrast = [](const MirroredSun& pattern, double size, double height) {
        double most = 0.0;
        for (int i = -10; i <= 10; ++i) {
            const auto value = static_cast<double>(pattern.at({0.05 * i * size, 0.03 * i * size, height}));
            EXPECT_TRUE(std::isfinite(value) && value >= 0.0) << value;
            most = std::max(most, std::abs(value - 1.0));
        }
        return most;
    };
    const auto of = [&](double elevation, double size, double bottom, double top, double finest_m) {
        return contrast(coarsely(sea,
                                 box_over(sea, elevation, {0.0, 0.0, 0.5 * (bottom + top)},
                                          {size, size, 0.5 * (top - bottom)}),
                                 finest_m),
                        size, 0.5 * (std::max(bottom, 0.0) + top));
    };
    EXPECT_GT(of(25.0, 2.0, -1.0, 2.0, 0.05), 0.1);
    EXPECT_EQ(of(-1.0, 2.0, -1.0, 2.0, 0.05), 0.0);
    EXPECT_EQ(of(0.0, 2.0, -1.0, 2.0, 0.05), 0.0);
    EXPECT_EQ(of(25.0, 2.0, -3.0, -1.0, 0.05), 0.0);
    EXPECT_LT(of(25.0, 2.0, 2e3, 2e3 + 4.0, kFinest_m), 0.02);
    EXPECT_LT(of(25.0, 1e4, -5.0, 1e3, 200.0), 0.2);
    for (const double elevation : {1.5, 4.0, 89.0, 90.0})
        of(elevation, 3.0, -1.0, 30.0, elevation < 10.0 ? 4.0 : 0.3);
    for (const double size : {1e-6, 1e-3, 1e7}) of(30.0, size, -size, size, 0.05 * size);
    EXPECT_EQ(MirroredSun().at({1.0, 2.0, 3.0}), 1.0f);
}

// A mast in a low sun: down to the water its light comes from far beside it.
TEST(MirroredSun, ReachesTheWaterOnWhatIsThin) {
    const OpenSea sea = open_sea(4.0);
    MirroredSunWanted wanted = box_over(sea, 8.0, {0.0, 0.0, 6.0}, {0.25, 0.25, 6.5});
    wanted.finest_m = 0.1;
    const MirroredSun pattern = pattern_of(sea, wanted);
    for (const double height : {0.0, 0.05, 0.1, 0.15, 0.3, 0.6}) {
        double most = 0.0;
        for (int i = -20; i <= 20; ++i) {
            const float value = pattern.at({0.012 * i, -0.01 * i, height});
            EXPECT_NE(value, 1.0f) << height << ' ' << i;
            most = std::max(most, static_cast<double>(std::abs(value - 1.0f)));
        }
        EXPECT_GT(most, 0.05) << height;
    }
}

// A strong wind whose waves are choppy, and far beyond.
TEST(MirroredSun, IsLightWhereWavesFold) {
    for (const double choppiness : {1.5, 8.0}) {
        const double elevation = 25.0;
        const OpenSea sea = open_sea(20.0, 1, choppiness);
        MirroredSunWanted wanted = box_over(sea, elevation, {0.0, 0.0, 1.5}, {7.5, 7.5, 1.5});
        wanted.finest_m = choppiness < 2.0 ? 0.3 : 0.12;
        const MirroredSun pattern = pattern_of(sea, wanted);
        double sum = 0.0, least = 1.0, most = 0.0;
        int count = 0;
        for (const double height : {0.05, 0.3, 0.8, 1.5, 2.8})
            for (int y = 0; y < 60; ++y)
                for (int x = 0; x < 60; ++x) {
                    const auto value =
                        static_cast<double>(pattern.at({0.25 * x - 7.375, 0.25 * y - 7.375, height}));
                    ASSERT_TRUE(std::isfinite(value));
                    least = std::min(least, value);
                    most = std::max(most, value);
                    sum += value;
                    ++count;
                }
        EXPECT_GE(least, 0.0) << choppiness;
        // One sea's places, by chance. Far beyond what folds, slopes are no longer those of the spectrum, nor is their mean.
        if (choppiness < 2.0) {
            EXPECT_NEAR(sum / count, 1.0, 0.1);
        }
        EXPECT_GT(most, 1.2) << choppiness;
    }
}

// A body that heaves keeps its planes.
TEST(MirroredSun, DoesNotJumpWhereABodyHeaves) {
    const OpenSea sea = open_sea(4.0);
    const auto heaved = [&](double up_m) {
        MirroredSunWanted wanted = box_over(sea, 25.0, {2.0, 1.0, 1.0 + up_m}, {1.0, 0.5, 2.0});
        wanted.finest_m = 0.06;
        return pattern_of(sea, wanted);
    };
    const MirroredSun still = heaved(0.0);
    for (const double up_m : {0.1, 0.4, 0.9}) {
        const MirroredSun other = heaved(up_m);
        for (int i = -20; i <= 20; ++i)
            for (const double height : {0.0, 0.3, 1.3, 2.2}) {
                const glm::dvec3 place(2.0 + 0.04 * i, 1.0 - 0.02 * i, height);
                EXPECT_NEAR(other.at(place), still.at(place), 1e-5f) << up_m << ' ' << i << ' ' << height;
            }
    }
}

TEST(MirroredSun, IsTheSameOnAnyNumberOfThreadsAndWhateverWasFoundBefore) {
    const OpenSea sea = open_sea(6.0);
    MirroredSunWanted wanted = box_over(sea, 15.0, {1e4, -3e3, 1.0}, {4.0, 2.0, 1.0}),
                      other = box_over(sea, 30.0, {0.0, 0.0, 1.0}, {4.0, 2.0, 1.0});
    wanted.finest_m = other.finest_m = 0.15;
    const MirroredSun many = pattern_of(sea, wanted);
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    MirroredSun alone = pattern_of(sea, other);
    alone.find(*sea.frame, wanted, nullptr);
    for (int i = -20; i <= 20; ++i) {
        const glm::dvec3 place(1e4 + 0.19 * i, -3e3 + 0.07 * i, 1.0 + 0.04 * i);
        EXPECT_EQ(many.at(place), alone.at(place));
    }
}

}  // namespace
}  // namespace pelagic
