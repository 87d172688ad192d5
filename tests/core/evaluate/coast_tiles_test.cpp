// Tiles on a coast (core/plan/coast.h): heights over depth against the law, what is shown and hidden across a beach, and its ends: the deep,
// the land, a calm, a map of one texel.
#include "core/plan/coast.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "core/evaluate/bounds.h"
#include "core/plan/effects.h"
#include "core/spectrum/gauss.h"
#include "core/waves/coast.h"
#include "core/waves/folding.h"
#include "tests/core/waves/samples.h"

namespace pelagic {
namespace {

using namespace test;

constexpr double kTilesTime_s = 2.5, kTilesSide_m = 400.0;

std::shared_ptr<const DepthMap> bed_of(const auto& depth_m, int texels = 100) {
    std::vector<float> depths;
    for (int y = 0; y < texels; ++y)
        for (int x = 0; x < texels; ++x) {
            const glm::dvec2 at = (glm::dvec2(x, y) + 0.5) * (kTilesSide_m / texels) - 0.5 * kTilesSide_m;
            depths.push_back(static_cast<float>(depth_m(at)));
        }
    return std::make_shared<const DepthMap>(glm::ivec2(texels), std::move(depths),
                                            glm::dvec2(-0.5 * kTilesSide_m), glm::dvec2(kTilesSide_m));
}
// To the east, 1:30; dry from x = 150 m on.
constexpr double kBeachSlope = 1.0 / 30.0, kShore_m = 150.0;
double plane_beach(glm::dvec2 at) {
    return (kShore_m - at.x) * kBeachSlope;
}

Scene tiles(std::shared_ptr<const DepthMap> depths, double depth_m = 12.0) {
    Scene scene;
    scene.sea.wind_speed_mps = 7.0;
    scene.sea.fetch_m = 20e3;
    scene.sea.depth_m = depth_m;
    scene.sea.depth_file = "bay.exr";
    scene.waves.cascades = {{200.0, 192}, {24.0, 64}};
    scene.waves.second_order = 0.0;
    scene.waves.lean_deg = 0.0;
    scene.waves.coast = true;
    scene.waves.coast_depths = std::move(depths);
    scene.quality.level = QualityLevel::Final;
    return scene;
}
Scene tiles_alone(Scene scene) {
    scene.waves.coast = false;
    scene.waves.coast_depths.reset();
    return scene;
}
Scene swell(std::shared_ptr<const DepthMap> depths, double height_m, double depth_m) {
    Scene scene = tiles(std::move(depths), depth_m);
    scene.sea.wind_speed_mps = 0.0;
    scene.sea.swell = {{.height_m = height_m, .period_s = 10.0, .direction_deg = 0.0}};
    scene.waves.cascades = {{1200.0, 128}};
    return scene;
}

const ProductSet kAllOfTiles =
    products(Position, Normal, Velocity, SlopeVariance, Product::JacobianMoments, Product::Breaking);

// ∫ S φ(ω, d) dω over that at depth_m, of a wind sea, by the formula itself.
double kitaigorodskiis_share(const DirectionalSpectrum& spectrum, double depth_m) {
    const auto phi = [](double omega, double d) {
        const double h = omega * std::sqrt(d / 9.81);
        return h <= 1.0 ? 0.5 * h * h : h < 2.0 ? 1.0 - 0.5 * (2.0 - h) * (2.0 - h) : 1.0;
    };
    const double from_m = spectrum.dispersion().depth_m;
    double share = 0.0, all = 0.0;
    for (double k = 0.02; k < 60.0; k *= 1.002) {
        const double energy = k * spectrum.omnidirectional(k), omega = spectrum.dispersion().omega(k);
        share += energy * phi(omega, depth_m) / phi(omega, from_m);
        all += energy;
    }
    return share / all;
}

// Over 4 m, between higher waves in the west and lower ones in the east.
TEST(CoastTiles, AHeroStandsAsHighAsItIsAskedFor) {
    constexpr double kEast_m = 30.0;
    Scene scene = tiles(bed_of(plane_beach));
    scene.waves.heroes = {{.frame = 30.0, .east_m = kEast_m, .height_m = 0.6}};
    const auto frame =
        frame_of<double>(scene, {filtered(products(Displacement), 0.5)}, scene.shot.time_s(30.0));
    std::vector<glm::dvec2> rest{{kEast_m, 0.0}};
    for (int i = 0; i < 100; ++i) rest.emplace_back(kEast_m + (i % 10 - 4.5), i / 10 - 4.5);
    const std::vector<glm::dvec3> moved = sample(frame, 0, rest).vectors(Displacement);
    EXPECT_NEAR(moved[0].z, 0.6, 0.02);
    EXPECT_LT(std::hypot(moved[0].x, moved[0].y), 0.1);
    for (const glm::dvec3& there : moved) EXPECT_LT(there.z, 0.65);
    const auto warned = [&] {
        std::string all;
        for (const std::string& warning : sea_warnings(*prepare(scene))) all += warning + '\n';
        return all;
    };
    EXPECT_EQ(warned().find("waves.heroes"), std::string::npos) << warned();
    scene.waves.choppiness = 0.0;  // or the crest would fold first
    scene.waves.heroes[0].height_m = 4.0;
    EXPECT_NE(warned().find("no such sea has one as high"), std::string::npos) << warned();
    scene.waves.heroes[0].east_m = 170.0;
    EXPECT_NE(warned().find("stands where less than a tenth"), std::string::npos) << warned();
}

// Along the beach, of a sea too low to break: what is left of its energy, and of slopes what is shown and hidden.
TEST(CoastTiles, HaveTheEnergyOfTheirDepthAcrossABeach) {
    Scene scene = tiles(bed_of(plane_beach));
    scene.sea.fetch_m = 5e3;
    scene.waves.choppiness = 0.0;  // slopes are those of heights
    std::vector<Query> queries;
    for (const double footprint_m : {0.3, 6.0})
        queries.push_back(filtered(products(Position, Normal, SlopeVarianceAtRest), footprint_m));
    const auto frame = frame_of<float>(scene, queries, kTilesTime_s),
               deep = frame_of<float>(tiles_alone(scene), queries, kTilesTime_s);
    const SpectralMoments all = frame.sea().total();
    const DirectionalSpectrum& spectrum = frame.sea().plan().from->spectrum;
    const auto slopes = [](const ProductArrays<float>& values) {
        double sum = 0.0;
        for (const glm::vec3& n : values.vectors(Normal)) sum += (n.x * n.x + n.y * n.y) / (n.z * n.z);
        for (const glm::vec3& v : values.vectors(SlopeVarianceAtRest)) sum += v.x + v.y;
        return sum;
    };
    const auto heights = [](const ProductArrays<float>& values) {
        double sum = 0.0;
        for (const glm::vec3& at : values.vectors(Position)) sum += at.z * at.z;
        return sum;
    };
    double before = 2.0;
    for (const double depth_m : {10.5, 6.0, 3.0, 1.5, 1.0}) {
        std::vector<glm::vec2> rest;
        for (int i = 0; i < 20000; ++i)
            rest.emplace_back(kShore_m - depth_m / kBeachSlope, -180.0 + 0.018 * static_cast<float>(i));
        const double share = kitaigorodskiis_share(spectrum, depth_m);
        EXPECT_LT(share, before);
        before = share;
        for (int query = 0; query < 2; ++query) {
            const auto here = sample(frame, query, rest), there = sample(deep, query, rest);
            EXPECT_NEAR(heights(here) / heights(there) / share, 1.0, 0.01) << depth_m << ' ' << query;
            const MaskGains<double> m = frame.sea().plan().masks->at(glm::dvec2(rest.front()));
            const double edge = (m.x * m.x + m.y * m.y) * all.m0 / all.mss();
            EXPECT_NEAR(slopes(here) / slopes(there) / (share + edge), 1.0, 0.01) << depth_m << ' ' << query;
        }
    }
    EXPECT_LT(before, 0.7);  // the test is of something
}

// North is no east: on a map twice as wide as it is long, over a bed that falls along neither.
TEST(CoastTiles, AreAsHighAsTheDepthAtThePlaceOnAnObliqueBed) {
    const glm::dvec2 size_m(kTilesSide_m, 0.5 * kTilesSide_m);
    const auto depth_at = [](glm::dvec2 at) { return 4.0 - 0.007 * at.x + 0.02 * at.y; };
    const glm::ivec2 texels(200, 100);
    std::vector<float> depths;
    for (int y = 0; y < texels.y; ++y)
        for (int x = 0; x < texels.x; ++x)
            depths.push_back(static_cast<float>(
                depth_at((glm::dvec2(x, y) + 0.5) / glm::dvec2(texels) * size_m - 0.5 * size_m)));
    Scene scene = tiles(std::make_shared<const DepthMap>(texels, std::move(depths), -0.5 * size_m, size_m));
    scene.waves.choppiness = 0.0;
    const std::vector<Query> queries{unfiltered(products(Position))};
    const auto frame = frame_of<double>(scene, queries, kTilesTime_s),
               plain = frame_of<double>(tiles_alone(scene), queries, kTilesTime_s);
    const TilesOverDepth over(frame.sea().plan().from->spectrum, 12.0);
    std::vector<glm::dvec2> rest = random_points<double>(0.95, 1000);
    for (glm::dvec2& at : rest) at *= size_m;
    const auto here = sample(frame, 0, rest).vectors(Position),
               deep = sample(plain, 0, rest).vectors(Position);
    int seen = 0;
    double least = 1.0, most = 0.0;
    for (std::size_t i = 0; i < rest.size(); ++i) {
        const double amplitude = over.amplitude(depth_at(rest[i]));
        ASSERT_NEAR(here[i].z, amplitude * deep[i].z, 0.005 * std::abs(deep[i].z) + 1e-6) << i;
        if (std::abs(deep[i].z) < 0.05) continue;
        ++seen;
        least = std::min(least, amplitude);
        most = std::max(most, amplitude);
    }
    EXPECT_GT(seen, 500);
    EXPECT_GT(most - least, 0.15);  // the test is of something
}

// The sheet's figures, as wave trains have them: 1.5 m (rms) and 10 s on 1:50 from the deep.
TEST(CoastTiles, ASwellBreaksAsTrainsDo) {
    const auto depths = bed_of([](glm::dvec2 at) { return (180.0 - at.x) / 50.0; });
    const Scene scene = swell(depths, 1.5 * std::sqrt(2.0), std::numeric_limits<double>::infinity());
    const DirectionalSpectrum spectrum(scene.sea);
    const TilesOverDepth over(spectrum, 40.0);
    for (const auto& [depth_m, expected] : {std::pair(5.0, 0.32), std::pair(3.0, 0.38), std::pair(1.0, 0.44)})
        EXPECT_NEAR(over.rms_height_m(depth_m) / depth_m / expected, 1.0, 0.1) << depth_m;
    // Those of its own law.
    for (const auto& [depth_m, own] : {std::pair(5.0, 0.316), std::pair(3.0, 0.409), std::pair(1.0, 0.420)})
        EXPECT_NEAR(over.rms_height_m(depth_m) / depth_m / own, 1.0, 0.01) << depth_m;
    for (double depth_m = 0.06; depth_m < 30.0; depth_m *= 1.1)
        EXPECT_LT(over.rms_height_m(depth_m), kSurfGamma * depth_m);
    EXPECT_GT(over.energy(2.0), 1.2);  // it rises before
    // Of the surface itself.
    Scene flat = scene;
    flat.waves.choppiness = 0.0;
    auto frame = frame_of<float>(flat, {unfiltered(products(Position))});
    std::vector<glm::vec2> rest;
    for (int i = 0; i < 400; ++i) rest.emplace_back(30.0f, -200.0f + static_cast<float>(i));
    double sum = 0.0;
    int times = 0;
    for (double t_s = 0.0; t_s < 4000.0; t_s += 13.7, ++times) {
        frame.set(t_s);
        for (const glm::vec3& at : sample(frame, 0, rest).vectors(Position)) sum += at.z * at.z;
    }
    EXPECT_NEAR(std::sqrt(8.0 * sum / (400.0 * times)) / 3.0 / 0.38, 1.0, 0.12);
}

// By the law of wind seas a peak at 12 s would keep 0.07 of its energy in 5 m.
TEST(CoastTiles, ABuoysSwellRisesAsASwellDoes) {
    Scene scene = swell(nullptr, 0.4, std::numeric_limits<double>::infinity());
    scene.sea.swell = {{.height_m = 0.4, .period_s = 12.0, .direction_deg = 0.0}};
    const TilesOverDepth swells(DirectionalSpectrum(scene.sea), 40.0);
    MeasuredSpectrum hour;
    for (double hz = 0.04; hz < 0.2; hz += 0.005) {
        const double from_peak = (hz - 1.0 / 12.0) / 0.008;
        hour.bins.push_back({hz, 25.0 * std::exp(-0.5 * from_peak * from_peak), 0.9, 0.0, 0.7, 0.0, true});
    }
    scene.sea.swell.clear();
    scene.sea.spectrum = SpectrumKind::File;
    scene.sea.measured = hour;
    for (const double wind_mps : {0.0, 6.0}) {  // with the wind's short waves as well
        scene.sea.wind_speed_mps = wind_mps;
        const TilesOverDepth buoys(DirectionalSpectrum(scene.sea), 40.0);
        EXPECT_NEAR(buoys.energy(5.0) / swells.energy(5.0), 1.0, 0.08) << wind_mps;
    }
    EXPECT_GT(swells.energy(5.0), 1.2);
}

TEST(CoastTiles, ChangeNothingWhereItIsDeep) {
    const Scene scene = tiles(bed_of([](glm::dvec2) { return 500.0; }), 500.0);
    const auto rest = random_points<double>(500.0, 300);
    for (const double footprint_m : {0.0, 3.0}) {
        const std::vector<Query> queries{filtered(kAllOfTiles, footprint_m)};
        const auto with = sample(frame_of<double>(scene, queries, kTilesTime_s), 0, rest),
                   plain = sample(frame_of<double>(tiles_alone(scene), queries, kTilesTime_s), 0, rest);
        for (std::size_t i = 0; i < rest.size(); ++i) {
            for (const Product product :
                 {Position, Normal, Velocity, SlopeVariance, Product::JacobianMoments}) {
                const VectorProduct of = VectorProduct::checked(product);
                ASSERT_NEAR(glm::length(with.vectors(of)[i] - plain.vectors(of)[i]), 0.0, 1e-6) << i;
            }
            ASSERT_NEAR(with.numbers(Product::Breaking)[i], plain.numbers(Product::Breaking)[i], 1e-6);
        }
    }
}

// Dry land, the map of one texel that is 0 deep, and a calm; far beyond waves are those of the deep.
TEST(CoastTiles, EndAshoreAndAreFiniteEverywhere) {
    Scene one = tiles(bed_of([](glm::dvec2) { return 0.0; }, 1));
    Scene calm = tiles(bed_of(plane_beach));
    calm.sea.wind_speed_mps = 0.0;
    std::vector<glm::vec2> ashore;
    for (int i = -15; i <= 15; ++i) ashore.emplace_back(178.0f, 10.0f * static_cast<float>(i));
    for (const Scene& scene : {tiles(bed_of(plane_beach)), one, calm}) {
        const auto frame =
            frame_of<float>(scene, {unfiltered(kAllOfTiles), filtered(kAllOfTiles, 5.0)}, kTilesTime_s);
        for (int query = 0; query < 2; ++query) {
            const auto at = sample(frame, query, ashore);
            for (std::size_t i = 0; i < ashore.size(); ++i) {
                // To the rounding of shares that add up to 1.
                EXPECT_LT(glm::length(at.vectors(Position)[i] - glm::vec3(ashore[i], 0.0f)), 1e-6f);
                EXPECT_LT(glm::length(at.vectors(Velocity)[i]), 1e-6f);
                EXPECT_LT(glm::length(at.vectors(Normal)[i] - glm::vec3(0.0f, 0.0f, 1.0f)), 1e-6f);
                EXPECT_LT(glm::length(at.vectors(SlopeVariance)[i]), 1e-9f);
                EXPECT_EQ(at.numbers(Product::Breaking)[i], 0.0f);
            }
            const auto rest = random_points<float>(900.0, 2000);
            const auto all = sample(frame, query, rest);
            for (std::size_t i = 0; i < rest.size(); ++i) {
                for (const Product product :
                     {Position, Normal, Velocity, SlopeVariance, Product::JacobianMoments}) {
                    const glm::vec3 value = all.vectors(VectorProduct::checked(product))[i];
                    ASSERT_TRUE(std::isfinite(value.x + value.y + value.z)) << i;
                }
                const float share = all.numbers(Product::Breaking)[i];
                ASSERT_TRUE(share >= 0.0f && share <= 1.0f) << i;
            }
        }
    }
    EXPECT_FALSE(make_plan(calm, {unfiltered(kAllOfTiles)}).masks);
    const std::vector<Query> queries{unfiltered(kAllOfTiles)};
    const auto with = frame_of<double>(tiles(bed_of(plane_beach)), queries, kTilesTime_s),
               plain = frame_of<double>(tiles_alone(tiles(nullptr)), queries, kTilesTime_s);
    // Halfway out of the map, half of it; its side over eight is the whole way.
    const auto gain = [&](double y) { return with.sea().plan().masks->at({60.0, y}).waves; };
    EXPECT_LT(gain(190.0), 0.9);
    EXPECT_NEAR(gain(225.0), 0.5 * (1.0 + gain(190.0)), 2e-3);
    const std::vector<glm::dvec2> far{{2e4, 30.0}, {-3e3, 7.0}, {0.0, 253.0}};
    for (std::size_t i = 0; i < far.size(); ++i)
        EXPECT_EQ(sample(with, 0, far).vectors(Position)[i], sample(plain, 0, far).vectors(Position)[i]);
}

TEST(CoastTiles, HaveTheNormalsAndTheVelocityOfTheirPositions) {
    constexpr double kStep = 1e-4;
    const auto rest = random_points<double>(560.0, 800);  // also where the map's part fades
    auto frame = frame_of<double>(tiles(bed_of(plane_beach)),
                                  {unfiltered(products(Position, Normal, Velocity))}, kTilesTime_s);
    const auto moved = [&](glm::dvec2 by) {
        std::vector<glm::dvec2> there = rest;
        for (glm::dvec2& x : there) x += by;
        return sample(frame, 0, there).vectors(Position);
    };
    const auto east = moved({kStep, 0.0}), west = moved({-kStep, 0.0}), north = moved({0.0, kStep}),
               south = moved({0.0, -kStep});
    const auto answers = sample(frame, 0, rest);
    frame.set(kTilesTime_s + kStep);
    const auto after = moved({});
    frame.set(kTilesTime_s - kStep);
    const auto before = moved({});
    for (std::size_t i = 0; i < rest.size(); ++i) {
        const glm::dvec3 tx = (east[i] - west[i]) / (2.0 * kStep), ty = (north[i] - south[i]) / (2.0 * kStep);
        ASSERT_LT(glm::length(answers.vectors(Normal)[i] - glm::normalize(glm::cross(tx, ty))), 2e-3) << i;
        ASSERT_NEAR(glm::length(answers.vectors(Velocity)[i] - (after[i] - before[i]) / (2.0 * kStep)), 0.0,
                    1e-5)
            << i;
    }
}

// On the crests, and as much in the mean as for trains.
TEST(CoastTiles, FoamWhereTheyBreak) {
    Scene scene = swell(bed_of(plane_beach), 1.3, 12.0);
    scene.effects.whitecap_amount = 0.0;
    scene.waves.choppiness = 0.5;
    auto frame = frame_of<float>(scene, {unfiltered(products(Position, Product::Breaking)),
                                         filtered(products(Position, Product::Breaking), 400.0)});
    auto alone = frame_of<float>(scene, {unfiltered(products(Product::Breaking))}, kTilesTime_s);
    const CoastSurf<double>& surf = *frame.sea().plan().masks->surf;
    std::vector<glm::vec2> rest;
    for (const float x : {-150.0f, 90.0f, 125.0f})
        for (int y = 0; y < 40; ++y) rest.emplace_back(x, -150.0f + 7.0f * static_cast<float>(y));
    double foam[3] = {}, heights[3] = {}, coarse[3] = {}, all_heights[3] = {};
    int times = 0;
    for (double t_s = 0.0; t_s < 2000.0; t_s += 7.3, ++times) {
        frame.set(t_s);
        const auto fine = sample(frame, 0, rest), far = sample(frame, 1, rest);
        for (std::size_t i = 0; i < rest.size(); ++i) {
            const double share = fine.numbers(Product::Breaking)[i], z = fine.vectors(Position)[i].z;
            foam[i / 40] += share;
            heights[i / 40] += share * z;
            all_heights[i / 40] += z;
            coarse[i / 40] += far.numbers(Product::Breaking)[i];
        }
    }
    for (int place = 0; place < 3; ++place) {
        const double count = 40.0 * times;
        const auto x =
            static_cast<int>((rest[static_cast<std::size_t>(40 * place)].x + 200.0) / surf.cell_m.x);
        const double expected = kRoller * surf.broken[surf.cell(x, surf.count.y / 2)];
        EXPECT_NEAR(foam[place] / count, expected, 0.25 * expected + 0.002) << place;
        EXPECT_NEAR(coarse[place] / count, expected, 0.05 * expected + 0.001) << place;
        if (place > 0) {
            EXPECT_GT(expected, 0.02);
            EXPECT_GT(heights[place] / foam[place], all_heights[place] / count + 0.05);
        }
    }
    EXPECT_LT(foam[0] / (40.0 * times), 0.01);
    frame.set(kTilesTime_s);
    for (std::size_t i = 0; i < rest.size(); ++i)  // whoever asks for nothing else
        EXPECT_EQ(sample(alone, 0, rest).numbers(Product::Breaking)[i],
                  sample(frame, 0, rest).numbers(Product::Breaking)[i]);
}

// What is no number has no foam and harms no other; a footprint that is none is the query's.
TEST(CoastTiles, FoamIsSafeFromWhatIsNoNumber) {
    constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
    const Scene scene = swell(bed_of(plane_beach), 1.3, 12.0);
    const auto frame = frame_of<float>(scene, {filtered(products(Position, Product::Breaking), 2.0)});
    const CoastSurf<double>& surf = *frame.sea().plan().masks->surf;
    const double none = std::numeric_limits<double>::quiet_NaN();
    for (const glm::dvec2 at : {glm::dvec2(none, 0.0), glm::dvec2(120.0, none), glm::dvec2(none)})
        EXPECT_EQ(coast_foam(surf, at, 0.1, 1.0, FootprintFilter{}), 0.0);
    std::vector<glm::vec2> rest{{kNone, 0.0f}, {120.0f, kNone}};
    for (int y = 0; y < 60; ++y) rest.emplace_back(125.0f, -150.0f + 5.0f * static_cast<float>(y));
    const auto with = sample(frame, 0, rest),
               of_none = sample(frame, 0, rest,
                                {.origin_m = {}, .cell_m = std::vector(rest.size(), kNone), .pixel_m = {}});
    double most = 0.0;
    for (std::size_t i = 2; i < rest.size(); ++i) {
        const float share = with.numbers(Product::Breaking)[i];
        EXPECT_TRUE(share >= 0.0f && share <= 1.0f) << i;
        EXPECT_EQ(share, of_none.numbers(Product::Breaking)[i]);
        most = std::max(most, static_cast<double>(share));
    }
    EXPECT_GT(most, 0.1);
}

TEST(CoastTiles, AreTheSameOnOneThreadAndTwoAndAloneAsInARun) {
    const Scene scene = tiles(bed_of(plane_beach));
    const auto rest = random_points<float>(700.0, 1500);
    const std::vector<Query> queries{unfiltered(kAllOfTiles), filtered(kAllOfTiles, 2.0)};
    const auto answers = [&](int threads, const std::vector<double>& times_s) {
        std::vector<ProductArrays<float>> of;
        tbb::task_arena(threads).execute([&] {
            auto frame = frame_of<float>(scene, queries, times_s.front());
            for (const double t_s : times_s) frame.set(t_s);
            for (int query = 0; query < 2; ++query) of.push_back(sample(frame, query, rest));
        });
        return of;
    };
    const auto alone = answers(1, {kTilesTime_s}), run = answers(2, {0.0, 1.25, kTilesTime_s});
    for (std::size_t query = 0; query < 2; ++query)
        for (std::size_t i = 0; i < rest.size(); ++i) {
            for (const Product product :
                 {Position, Normal, Velocity, SlopeVariance, Product::JacobianMoments}) {
                const VectorProduct of = VectorProduct::checked(product);
                ASSERT_EQ(alone[query].vectors(of)[i], run[query].vectors(of)[i]) << i;
            }
            ASSERT_EQ(alone[query].numbers(Product::Breaking)[i], run[query].numbers(Product::Breaking)[i]);
        }
}

// A swell that rises to more than it is at sea, too.
TEST(CoastTiles, BoundsAndExtentsHoldWhatTheyReach) {
    const Scene rising = swell(bed_of([](glm::dvec2 at) { return 3.0 + 0.004 * at.x; }), 0.2, 500.0);
    for (const Scene& scene : {tiles(bed_of(plane_beach)), rising}) {
        const auto frame = frame_of<float>(scene, {filtered(products(Displacement), 0.5)}, 4.5);
        const FrameBounds<float> bounds(frame, 0);
        const DisplacementBounds all = bounds.everywhere();
        const auto moved = sample(frame, 0, random_points<float>(560.0, 3000)).vectors(Displacement);
        for (const glm::vec3& by : moved) ASSERT_TRUE(by.z >= all.z.lo && by.z <= all.z.hi);
        for (int region = 0; region < 40; ++region) {
            const glm::dvec2 corner_m(-280.0 + 13.0 * region, -200.0 + 9.0 * region);
            std::vector<glm::vec2> rest = random_points<float>(14.0, 200, static_cast<unsigned>(region));
            const auto there = sample(frame, 0, rest, {.origin_m = corner_m, .cell_m = {}, .pixel_m = {}})
                                   .vectors(Displacement);
            const DisplacementBounds bound = bounds.region({corner_m - 7.0, corner_m + 7.0});
            for (const glm::vec3& by : there) {
                ASSERT_TRUE(by.z >= bound.z.lo && by.z <= bound.z.hi) << region;
                ASSERT_TRUE(by.x >= bound.dx.lo && by.x <= bound.dx.hi) << region;
            }
        }
    }
    const auto prepared = prepare(rising), plain = prepare(tiles_alone(rising));
    const double most = plan_masks(prepared->scene, prepared->spectrum)->largest();
    EXPECT_GT(most, 1.1);
    EXPECT_NEAR(prepared->extent.height_m / plain->extent.height_m, most, 1e-9);
}

// By a prepared scene, for all plans of it, those of foam's levels among them.
TEST(CoastTiles, AreWorkedOutOnce) {
    const auto prepared = prepare(tiles(bed_of(plane_beach)));
    ASSERT_TRUE(prepared->masks && prepared->masks->surf);
    const Plan plan = make_plan(prepared, {filtered(products(Position), 1.0)});
    EXPECT_EQ(plan.masks->surf, prepared->masks->surf);
    EXPECT_EQ(plan_of_foam_level(plan, 2.0).masks->surf, prepared->masks->surf);
}

// Nor for what an effect costs that leaves them as they are: with a surf that nobody would work out, it costs nothing.
TEST(CoastTiles, ArentWorkedOutAgainToExplain) {
    Scene scene = tiles(bed_of(plane_beach));
    scene.sea.gust_strength = 0.5;
    PreparedScene prepared = *prepare(scene);
    CoastSurf<double> surf = *prepared.masks->surf;
    surf.broken.resize(2 * surf.broken.size());
    prepared.masks->surf = std::make_shared<const CoastSurf<double>>(std::move(surf));
    const Plan plan = make_plan(std::make_shared<const PreparedScene>(std::move(prepared)),
                                {filtered(products(Position, Product::Breaking), 1.0)});
    const std::string page = explain(plan);
    EXPECT_NE(page.find("  gusts: no transform and no memory"), std::string::npos) << page;
}

TEST(CoastTiles, SayTheirBytesAndLeaveOthersAlone) {
    const Scene scene = tiles(bed_of(plane_beach));
    const Plan plan = make_plan(scene, {unfiltered(products(Position))}),
               plain = make_plan(tiles_alone(scene), {unfiltered(products(Position))});
    EXPECT_NE(explain(plan).find("tiles on a coast: "), std::string::npos) << explain(plan);
    EXPECT_NE(explain(plain).find("no tiles on a coast: "), std::string::npos);
    EXPECT_FALSE(plain.masks);
    const CoastSurf<double>& surf = *plan.masks->surf;
    EXPECT_EQ(plan.masks->coast_bytes(),
              16 * surf.broken.size() + 4 * plan.masks->masks.back().cells->shares.size());
    EXPECT_EQ(row_of(Effect::Coast).state.bytes(plan), plan.masks->coast_bytes() + 4 * 100 * 100);
    EXPECT_EQ(plan.masks->picture_texels(), 0u);
    Scene unread = scene;
    unread.waves.coast_depths.reset();
    EXPECT_THROW(make_plan(unread, {unfiltered(products(Position))}), std::invalid_argument);
    // A calm place in surf is both.
    Scene both = scene;
    both.waves.masks = {{.east_m = 90.0, .length_m = 40.0, .width_m = 40.0, .edge_m = 10.0, .waves = 0.5}};
    const MasksPlan two = *make_plan(both, {unfiltered(products(Position))}).masks;
    EXPECT_NEAR(two.at({90.0, 0.0}).waves, 0.5 * plan.masks->at({90.0, 0.0}).waves, 1e-6);
    EXPECT_NE(explain(make_plan(both, {unfiltered(products(Position))})).find("1 mask"), std::string::npos);
}

}  // namespace
}  // namespace pelagic
