// A sea that feels its floor (waves.coast): what it shows is one surface, with what it hides it is the energy that came in, and where the
// floor is level nothing changes.
#include "core/waves/coast.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>

#include "core/evaluate/bounds.h"
#include "core/scene/text.h"
#include "tests/core/waves/samples.h"
#include "tests/core/waves/worst.h"

namespace pelagic {
namespace {

using namespace test;

constexpr double kTime_s = 2.5, kSide_m = 400.0;

// Over a square round the origin.
std::shared_ptr<const DepthMap> floor_of(const auto& depth_m, double side_m = kSide_m) {
    constexpr int kTexels = 100;
    std::vector<float> depths;
    for (int y = 0; y < kTexels; ++y)
        for (int x = 0; x < kTexels; ++x) {
            const glm::dvec2 at = (glm::dvec2(x, y) + 0.5) * (side_m / kTexels) - 0.5 * side_m;
            depths.push_back(static_cast<float>(depth_m(at)));
        }
    return std::make_shared<const DepthMap>(glm::ivec2(kTexels), std::move(depths), glm::dvec2(-0.5 * side_m),
                                            glm::dvec2(side_m));
}
// A beach to the east, 1:30 on the whole, that isn't quite straight; dry from about x = 150 m on.
double beach(glm::dvec2 at) {
    return (150.0 - at.x) / 30.0 + 0.5 * std::sin(at.y / 30.0);
}

Scene coast(std::shared_ptr<const DepthMap> depths, double depth_m = 12.0) {
    Scene scene;
    scene.sea.wind_speed_mps = 7.0;
    scene.sea.fetch_m = 60e3;
    scene.sea.depth_m = depth_m;
    scene.sea.depth_file = "bay.exr";
    scene.sea.swell = {{.height_m = 0.6, .period_s = 9.0, .direction_deg = 10.0}};
    scene.waves.model = WaveModel::Trochoid;
    scene.waves.trains = 60;
    scene.waves.coast = true;
    scene.waves.coast_depths = std::move(depths);
    scene.quality.level = QualityLevel::Reference;
    return scene;
}
Scene without_coast(Scene scene) {
    scene.waves.coast = false;
    scene.waves.coast_depths.reset();
    return scene;
}

const ProductSet kAll =
    products(Position, Normal, Velocity, SlopeVariance, Product::JacobianMoments, Product::Breaking);

TEST(Coast, ChangesNothingOverALevelFloor) {
    const Scene scene = coast(floor_of([](glm::dvec2) { return 12.0; }));
    const auto rest = random_points<double>(500.0, 400);
    for (const double footprint_m : {0.0, 3.0}) {
        const std::vector<Query> queries{filtered(kAll, footprint_m)};
        const auto with = sample(frame_of<double>(scene, queries, kTime_s), 0, rest),
                   plain = sample(frame_of<double>(without_coast(scene), queries, kTime_s), 0, rest);
        for (std::size_t i = 0; i < rest.size(); ++i) {
            ASSERT_NEAR(glm::length(with.vectors(Position)[i] - plain.vectors(Position)[i]), 0.0, 2e-3);
            ASSERT_NEAR(glm::length(with.vectors(Normal)[i] - plain.vectors(Normal)[i]), 0.0, 2e-3);
            ASSERT_NEAR(glm::length(with.vectors(Velocity)[i] - plain.vectors(Velocity)[i]), 0.0, 2e-3);
            ASSERT_NEAR(glm::length(with.vectors(SlopeVariance)[i] / plain.vectors(SlopeVariance)[i].x -
                                    plain.vectors(SlopeVariance)[i] / plain.vectors(SlopeVariance)[i].x),
                        0.0, 0.01);
            ASSERT_NEAR(with.vectors(Product::JacobianMoments)[i].x,
                        plain.vectors(Product::JacobianMoments)[i].x, 2e-3);
            ASSERT_NEAR(with.vectors(Product::JacobianMoments)[i].y,
                        plain.vectors(Product::JacobianMoments)[i].y, 2e-4);
        }
    }
}

// Heights alone have exact slopes; of the displacement's gradient the turn of ∇S is left out.
TEST(Coast, HasTheNormalsAndTheVelocityOfItsPositions) {
    constexpr double kStep = 1e-4;
    const auto rest = random_points<double>(560.0, 1600);  // also where the map's waves fade
    for (const double choppiness : {0.0, 1.0}) {
        Scene scene = coast(floor_of(beach));
        scene.waves.choppiness = choppiness;
        auto frame = frame_of<double>(scene, {unfiltered(products(Position, Normal, Velocity))}, kTime_s);
        const auto moved = [&](glm::dvec2 by) {
            std::vector<glm::dvec2> there = rest;
            for (glm::dvec2& x : there) x += by;
            return sample(frame, 0, there).vectors(Position);
        };
        const auto east = moved({kStep, 0.0}), west = moved({-kStep, 0.0}), north = moved({0.0, kStep}),
                   south = moved({0.0, -kStep});
        const auto answers = sample(frame, 0, rest);
        frame.set(kTime_s + kStep);
        const auto after = moved({});
        frame.set(kTime_s - kStep);
        const auto before = moved({});
        double squares = 0.0, tilts = 0.0;
        for (std::size_t i = 0; i < rest.size(); ++i) {
            const glm::dvec3 tx = (east[i] - west[i]) / (2.0 * kStep),
                             ty = (north[i] - south[i]) / (2.0 * kStep);
            const glm::dvec3 normal = glm::normalize(glm::cross(tx, ty));
            const double error = glm::length(answers.vectors(Normal)[i] - normal);
            if (choppiness == 0.0) {
                ASSERT_LT(error, 2e-5) << i;
            }
            squares += error * error;
            tilts += normal.x * normal.x + normal.y * normal.y;
            const glm::dvec3 velocity = (after[i] - before[i]) / (2.0 * kStep);
            ASSERT_NEAR(glm::length(answers.vectors(Velocity)[i] - velocity), 0.0, 1e-5) << i;
        }
        EXPECT_LT(std::sqrt(squares / tilts), 0.05);
    }
}

TEST(Coast, IsDryAshoreAndLowOverShallowWater) {
    const Scene scene = coast(floor_of(beach));
    const auto frame = frame_of<float>(scene, {unfiltered(products(Position, Velocity))}, kTime_s);
    std::vector<glm::vec2> dry, low;
    for (int i = -15; i <= 15; ++i) {
        dry.emplace_back(178.0f, 10.0f * static_cast<float>(i));
        low.emplace_back(130.0f, 10.0f * static_cast<float>(i));
    }
    const auto ashore = sample(frame, 0, dry);
    for (std::size_t i = 0; i < dry.size(); ++i) {
        EXPECT_EQ(ashore.vectors(Position)[i], glm::vec3(dry[i], 0.0f));
        EXPECT_EQ(ashore.vectors(Velocity)[i], glm::vec3(0.0f));
    }
    const auto shallow = sample(frame, 0, low).vectors(Position);
    for (std::size_t i = 0; i < low.size(); ++i)
        EXPECT_GT(static_cast<double>(shallow[i].z), -beach(glm::dvec2(low[i]))) << low[i].y;
}

// What a coarse pixel hides is what a fine one shows.
TEST(Coast, ShownAndHiddenSlopesAddUp) {
    Scene scene = coast(floor_of(beach));
    scene.waves.choppiness = 0.0;
    std::vector<glm::dvec2> rest;
    for (int x = 0; x < 4; ++x)
        for (int y = 0; y < 75; ++y) rest.emplace_back(-40.0 + 40.0 * x, -150.0 + 4.0 * y);
    const double footprints_m[] = {0.0, 0.7, 4.0, 20.0, 1000.0};
    std::vector<double> total;
    for (const double footprint_m : footprints_m) {
        auto frame =
            frame_of<double>(scene, {filtered(products(Normal, Product::SlopeVarianceAtRest), footprint_m)});
        double sum = 0.0;
        int times = 0;
        for (double t_s = 0.0; t_s < 400.0; t_s += 3.7, ++times) {
            frame.set(t_s);
            const auto at = sample(frame, 0, rest);
            for (std::size_t i = 0; i < rest.size(); ++i) {
                const glm::dvec3 n = at.vectors(Normal)[i],
                                 hidden = at.vectors(Product::SlopeVarianceAtRest)[i];
                sum += (n.x * n.x + n.y * n.y) / (n.z * n.z) + hidden.x + hidden.y;
                ASSERT_GE(hidden.x, 0.0);
                ASSERT_LE(hidden.z * hidden.z, hidden.x * hidden.y * 1.0001);
            }
        }
        total.push_back(sum / (times * static_cast<double>(rest.size())));
    }
    for (const double sum : total) EXPECT_NEAR(sum / total.back(), 1.0, 0.03);
}

// Its own limit: 0.78 of the depth.
TEST(Coast, OneTrainBreaksAtItsLimit) {
    Scene scene = coast(floor_of([](glm::dvec2 at) { return (190.0 - at.x) / 50.0; }), 7.8);
    scene.sea.wind_speed_mps = 0.0;
    scene.sea.swell = {{.height_m = 1.0, .period_s = 10.0, .direction_deg = 0.0}};
    scene.waves.trains = 1;
    scene.waves.choppiness = 0.0;
    auto frame = frame_of<double>(scene, {unfiltered(products(Position))}, 0.0);
    const double height0_m = 2.0 * frame.sea().trains().height_m[0];
    std::vector<glm::dvec2> rest;
    for (int x = -190; x <= 180; ++x) rest.emplace_back(x, 0.0);
    std::vector<double> low(rest.size(), 0.0), high(rest.size(), 0.0);
    for (double t_s = 0.0; t_s < 12.0; t_s += 0.1) {
        frame.set(t_s);
        const auto at = sample(frame, 0, rest).vectors(Position);
        for (std::size_t i = 0; i < rest.size(); ++i) {
            ASSERT_TRUE(std::isfinite(at[i].z)) << rest[i].x;
            low[i] = std::min(low[i], at[i].z);
            high[i] = std::max(high[i], at[i].z);
        }
    }
    const auto depth_m = [&](std::size_t i) { return (190.0 - rest[i].x) / 50.0; };
    // Green's law brings it to the limit; from there on it has it.
    std::size_t breaks = 0;
    while (breaks < rest.size() && (high[breaks] - low[breaks]) / depth_m(breaks) < 0.70) ++breaks;
    ASSERT_LT(breaks + 20, rest.size());
    EXPECT_GT(high[breaks] - low[breaks], 1.1 * height0_m);
    double worst = 0.0;
    for (std::size_t i = breaks + 10; i < rest.size() && depth_m(i) > 0.3; ++i) {
        EXPECT_NEAR((high[i] - low[i]) / depth_m(i), 0.78, 0.05) << depth_m(i);
        worst = worse(worst, std::abs((high[i] - low[i]) / depth_m(i) - 0.78));
    }
    RecordProperty("limit_off", number_text(worst));
}

// On the crests, and as much in the mean as the law of breaking says.
TEST(Coast, FoamsWhereItBreaks) {
    Scene scene = coast(floor_of([](glm::dvec2 at) { return (150.0 - at.x) / 30.0; }));
    scene.effects.whitecap_amount = 0.0;
    const std::vector<Query> queries{unfiltered(products(Position, Product::Breaking)),
                                     filtered(products(Position, Product::Breaking), 200.0)};
    auto frame = frame_of<float>(scene, queries);
    const Coast<float>& held = *frame.sea().coast();
    std::vector<glm::vec2> rest;
    for (const float x : {-150.0f, 90.0f, 125.0f})
        for (int y = 0; y < 60; ++y) rest.emplace_back(x, -150.0f + 5.0f * static_cast<float>(y));
    double foam[3] = {}, heights[3] = {}, coarse[3] = {}, all_heights[3] = {};
    int times = 0;
    for (double t_s = 0.0; t_s < 300.0; t_s += 2.3, ++times) {
        frame.set(t_s);
        const auto fine = sample(frame, 0, rest), far = sample(frame, 1, rest);
        for (std::size_t i = 0; i < rest.size(); ++i) {
            const double share = fine.numbers(Product::Breaking)[i], z = fine.vectors(Position)[i].z;
            foam[i / 60] += share;
            heights[i / 60] += share * z;
            all_heights[i / 60] += z;
            coarse[i / 60] += far.numbers(Product::Breaking)[i];
        }
    }
    for (int place = 0; place < 3; ++place) {
        const double count = 60.0 * times;
        const glm::ivec2 cell((rest[static_cast<std::size_t>(60 * place)].x + 200.0) / held.cell_m.x, 128);
        const double expected = kRoller * static_cast<double>(held.broken[held.cell(cell.x, cell.y)]);
        EXPECT_NEAR(foam[place] / count, expected, 0.25 * expected + 0.002) << place;
        EXPECT_NEAR(coarse[place] / count, expected, 0.05 * expected + 0.001) << place;
        if (place > 0) {
            EXPECT_GT(expected, 0.02);
            EXPECT_GT(heights[place] / foam[place], all_heights[place] / count + 0.05);
        }
    }
    EXPECT_LT(foam[0] / (60.0 * times), 0.01);
}

TEST(Coast, APlaceThatIsNoNumberHasNoFoam) {
    const auto frame = frame_of<float>(coast(floor_of(beach)), {unfiltered(kAll)});
    const double none = std::numeric_limits<double>::quiet_NaN();
    for (const glm::dvec2 at : {glm::dvec2(none, 0.0), glm::dvec2(120.0, none), glm::dvec2(none)})
        EXPECT_EQ(frame.sea().surf_foam(at, 0.1, 1.0), 0.0);
    const std::vector<glm::vec2> rest{{std::numeric_limits<float>::quiet_NaN(), 0.0f}, {120.0f, 0.0f}};
    const float share = sample(frame, 0, rest).numbers(Product::Breaking)[1];
    EXPECT_EQ(share, sample(frame, 0, {rest[1], rest[1]}).numbers(Product::Breaking)[1]);
}

// At an island waves bend round, and everything is finite.
TEST(Coast, IsTheSameOnOneThreadAndTwoAndFinite) {
    const auto island =
        floor_of([](glm::dvec2 at) { return std::min(12.0, 0.2 * (glm::length(at) - 50.0)); });
    const Scene scene = coast(island);
    const auto rest = random_points<float>(900.0, 2000);
    const std::vector<Query> queries{unfiltered(kAll), filtered(kAll, 2.0)};
    const auto answers = [&](int threads) {
        std::vector<ProductArrays<float>> of;
        tbb::task_arena(threads).execute([&] {
            const auto frame = frame_of<float>(scene, queries, kTime_s);
            for (int query = 0; query < 2; ++query) of.push_back(sample(frame, query, rest));
        });
        return of;
    };
    const auto one = answers(1), two = answers(2);
    for (std::size_t query = 0; query < 2; ++query)
        for (std::size_t i = 0; i < rest.size(); ++i) {
            for (const Product product :
                 {Position, Normal, Velocity, SlopeVariance, Product::JacobianMoments}) {
                const glm::vec3 value = one[query].vectors(VectorProduct::checked(product))[i];
                ASSERT_TRUE(std::isfinite(value.x + value.y + value.z)) << i;
                ASSERT_EQ(value, two[query].vectors(VectorProduct::checked(product))[i]) << i;
            }
            ASSERT_EQ(one[query].numbers(Product::Breaking)[i], two[query].numbers(Product::Breaking)[i]);
        }
}

// A phase that is torn behind an island folds the surface along two lines to the horizon, which foam.
TEST(Coast, FoldsNowhereInALee) {
    constexpr double kRadius_m = 50.0;
    const auto island = [](glm::dvec2 at) { return std::min(12.0, 0.2 * (glm::length(at) - kRadius_m)); };
    const auto cliffs = [](glm::dvec2 at) { return glm::length(at) > kRadius_m ? 12.0 : -5.0; };
    for (const auto& depths : {floor_of(island), floor_of(cliffs)}) {
        Scene scene = coast(depths);
        scene.sea.wind_speed_mps = 5.0;
        scene.sea.fetch_m = 4e3;
        scene.sea.swell = {{.height_m = 1.0, .period_s = 9.0, .direction_deg = 0.0}};
        auto frame = frame_of<double>(scene, {unfiltered(products(Product::JacobianMoments))}, kTime_s);
        std::vector<glm::dvec2> rest;
        for (int x = 0; x < 70; ++x)
            for (int y = -48; y <= 48; ++y) rest.emplace_back(70.0 + 5.0 * x, 1.7 * y);
        for (const double t_s : {1.0, 4.0, 8.5}) {
            frame.set(t_s);
            const auto at = sample(frame, 0, rest).vectors(Product::JacobianMoments);
            for (std::size_t i = 0; i < rest.size(); ++i)
                EXPECT_GT(at[i].x, 0.0) << rest[i].x << ' ' << rest[i].y;
        }
    }
}

// The floor that is seen out there is that of sea.depth_m.
TEST(Coast, BeyondTheMapWavesAreThoseOfTheDeep) {
    const Scene scene = coast(floor_of(beach));
    const std::vector<Query> queries{
        unfiltered(products(Position, Normal, Velocity, Product::JacobianMoments, Product::Breaking))};
    const auto with = frame_of<double>(scene, queries, kTime_s),
               plain = frame_of<double>(without_coast(scene), queries, kTime_s);
    std::vector<glm::dvec2> rest;
    for (int i = 0; i < 40; ++i) rest.emplace_back(2e4 + 7.0 * i, -60.0 * i);
    const auto far = sample(with, 0, rest), there = sample(plain, 0, rest);
    for (std::size_t i = 0; i < rest.size(); ++i)
        for (const Product product : {Position, Normal, Velocity, Product::JacobianMoments}) {
            const VectorProduct of = VectorProduct::checked(product);
            EXPECT_NEAR(glm::length(far.vectors(of)[i] - there.vectors(of)[i]), 0.0, 1e-6) << i;
        }
    // Where it begins and ends to fade neither heights nor normals jump, ashore as in the lee.
    const double fade_m = with.sea().coast()->fade_m;
    ASSERT_NEAR(fade_m, kSide_m / 8.0, 1e-9);
    for (const glm::dvec2 edge : {glm::dvec2(200.0, 31.0), glm::dvec2(-20.0, 200.0)})
        for (const double beyond_m : {0.0, fade_m}) {
            const glm::dvec2 out = edge.x > 100.0 ? glm::dvec2(1.0, 0.0) : glm::dvec2(0.0, 1.0);
            constexpr double kStep_m = 1e-4;
            std::vector<glm::dvec2> line;
            for (int i = -500; i <= 500; ++i) line.push_back(edge + (beyond_m + kStep_m * i) * out);
            const auto at = sample(with, 0, line);
            const auto places = at.vectors(Position), normals = at.vectors(Normal);
            for (std::size_t i = 1; i + 1 < line.size(); ++i) {
                EXPECT_LT(std::abs(places[i].z - places[i - 1].z), kStep_m) << line[i].x << ' ' << line[i].y;
                EXPECT_LT(glm::length(normals[i + 1] - 2.0 * normals[i] + normals[i - 1]), 3e-4)
                    << line[i].x << ' ' << line[i].y;
            }
        }
}

TEST(Coast, BoundsHoldWhatItReaches) {
    const Scene scene = coast(floor_of(beach));
    const auto frame = frame_of<float>(scene, {filtered(products(Displacement), 0.5)}, 4.5);
    const FrameBounds<float> bounds(frame, 0);
    const DisplacementBounds all = bounds.everywhere();
    std::mt19937 random(3);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    for (int region = 0; region < 60; ++region) {
        const double side_m = std::exp(std::log(0.2) + unit(random) * std::log(500.0));
        const glm::dvec2 corner_m(-280.0 + 520.0 * unit(random), -280.0 + 520.0 * unit(random));
        const RestRegion where{corner_m, corner_m + side_m};
        std::vector<glm::vec2> rest;
        for (int i = 0; i < 200; ++i) rest.emplace_back(side_m * glm::dvec2(unit(random), unit(random)));
        const auto moved =
            sample(frame, 0, rest, {.origin_m = corner_m, .cell_m = {}, .pixel_m = {}}).vectors(Displacement);
        for (const DisplacementBounds& bound : {bounds.region(where), bounds.region(where, 1), all})
            for (const glm::vec3& by : moved) {
                ASSERT_TRUE(by.z >= bound.z.lo && by.z <= bound.z.hi) << side_m;
                ASSERT_TRUE(by.x >= bound.dx.lo && by.x <= bound.dx.hi) << side_m;
                ASSERT_TRUE(by.y >= bound.dy.lo && by.y <= bound.dy.hi) << side_m;
            }
    }
    // Of use: a metre of this sea isn't bounded by all of it.
    const DisplacementBounds metre = bounds.region({{0.0, 0.0}, {1.0, 1.0}});
    EXPECT_LT(metre.z.hi - metre.z.lo, 0.3 * (all.z.hi - all.z.lo));
}

TEST(Coast, IsRefusedWithoutDepthsAndSaysItsBytes) {
    Scene scene = coast(nullptr);
    try {
        make_plan(scene, {unfiltered(products(Position))});
        FAIL();
    } catch (const std::invalid_argument& error) {
        EXPECT_NE(std::string(error.what()).find("waves.coast"), std::string::npos) << error.what();
    }
    const Scene good = coast(floor_of(beach));
    const Plan plan = make_plan(good, {unfiltered(products(Position))}),
               plain = make_plan(without_coast(good), {unfiltered(products(Position))});
    EXPECT_NE(explain(plan).find("feel the floor"), std::string::npos);
    EXPECT_EQ(explain(plain).find("feel the floor"), std::string::npos);
    const Sea<float> sea(plan);
    const Coast<float>& held = *sea.coast();
    EXPECT_EQ(plan.trains->coast_bytes(false), (held.phase.size() + held.gain.size() + held.others.size() +
                                                held.broken.size() + held.deviation_m.size()) *
                                                   sizeof(float));
    EXPECT_GT(plan.sea_bytes(), plain.sea_bytes() + plan.trains->coast_bytes(false) - 1);
    EXPECT_EQ(Sea<float>(plain).coast(), nullptr);
    // Foam's own seas don't hold it again.
    EXPECT_EQ(Sea<float>(plan_of_foam_level(plan, 1.5), {}, nullptr, sea.coast()).coast(), sea.coast());
}

}  // namespace
}  // namespace pelagic
