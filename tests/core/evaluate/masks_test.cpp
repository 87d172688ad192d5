// Calm and rough places (waves.masks): slopes, velocities and J are those of the positions, what is shown and hidden adds up to what the
// masks say, a calm has no foam, and where no mask reaches the sea is the same, to the bit.
#include "core/plan/masks.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>

#include "core/effects/sea_at_time.h"
#include "core/scene/text.h"
#include "core/waves/folding.h"
#include "tests/core/waves/samples.h"
#include "tests/core/waves/worst.h"

namespace pelagic {
namespace {

using namespace test;

constexpr double kTime_s = 2.5;

// Of any shares: a value of 0 … 1 for each pixel.
std::shared_ptr<const MaskPicture> picture(int width, int height, const auto& share) {
    std::vector<float> shares;
    for (int row = 0; row < height; ++row)
        for (int x = 0; x < width; ++x) shares.push_back(static_cast<float>(share(x, row)));
    return std::make_shared<const MaskPicture>(width, height, std::move(shares));
}
double blotches(int x, int row) {
    return 0.5 + 0.5 * std::sin(2.1 * x + 1.3 * row) * std::cos(0.7 * x - 2.9 * row);
}

// Young wind waves, of which masks of a hundred metres hold many.
Scene young_sea(std::vector<WaveMask> masks = {}) {
    Scene scene;
    scene.sea.wind_speed_mps = 5.0;
    scene.sea.fetch_m = 3e3;
    scene.waves.cascades = {{64.0, 64}, {18.0, 64}};
    scene.quality.level = QualityLevel::Reference;
    scene.effects.breaking_from_m = 0.0;
    scene.waves.masks = std::move(masks);
    return scene;
}

// A lee and a rough place whose edges cross.
const std::vector<WaveMask> kTwo{
    {.east_m = 5.0,
     .north_m = -3.0,
     .length_m = 60.0,
     .width_m = 25.0,
     .direction_deg = 30.0,
     .edge_m = 12.0,
     .waves = 0.2},
    {.east_m = 30.0, .north_m = 8.0, .length_m = 20.0, .width_m = 20.0, .edge_m = 25.0, .waves = 1.7}};

// The same with a rough picture across them.
Scene with_blotches(Scene scene) {
    scene.waves.masks.push_back({.east_m = -20.0,
                                 .north_m = 10.0,
                                 .length_m = 90.0,
                                 .width_m = 60.0,
                                 .direction_deg = -25.0,
                                 .edge_m = 12.0,
                                 .waves = 1.4,
                                 .picture = "blotches"});
    scene.waves.mask_pictures["blotches"] = picture(31, 17, blotches);
    return scene;
}

TEST(Masks, HaveTheNormalsTheJacobianAndTheVelocityOfTheirPositions) {
    constexpr double kStep = 1e-4;
    const ProductSet wanted = products(Position, Normal, Velocity, Product::JacobianMoments);
    const auto rest = random_points<double>(160.0, 1500);
    for (const bool is_trains : {false, true})
        for (const Tiling tiling : {Tiling::Random, Tiling::Periodic})
            for (const double footprint_m : {0.0, 1.0}) {
                Scene scene = with_blotches(young_sea(kTwo));
                scene.waves.tiling = tiling;
                if (is_trains) {
                    scene.waves.model = WaveModel::Trochoid;
                    scene.waves.cascades.clear();
                    scene.waves.trains = 40;
                }
                SCOPED_TRACE(testing::Message()
                             << is_trains << ' ' << (tiling == Tiling::Random) << ' ' << footprint_m);
                const std::vector<Query> queries{filtered(wanted, footprint_m)};
                auto frame = frame_of<double>(scene, queries, kTime_s);
                const Where<double> at{.origin_m = {3.0, -2.0}, .cell_m = {}, .pixel_m = {}};
                const auto moved = [&](glm::dvec2 by) {
                    std::vector<glm::dvec2> there = rest;
                    for (glm::dvec2& x : there) x += by;
                    return sample(frame, 0, there, at).vectors(Position);
                };
                const auto east = moved({kStep, 0.0}), west = moved({-kStep, 0.0}),
                           north = moved({0.0, kStep}), south = moved({0.0, -kStep});
                const auto answers = sample(frame, 0, rest, at);
                frame.set(kTime_s + kStep);
                const auto after = moved({});
                frame.set(kTime_s - kStep);
                const auto before = moved({});
                for (std::size_t i = 0; i < rest.size(); ++i) {
                    const glm::dvec3 tx = (east[i] - west[i]) / (2.0 * kStep),
                                     ty = (north[i] - south[i]) / (2.0 * kStep);
                    const glm::dvec3 across = glm::cross(tx, ty);
                    ASSERT_NEAR(glm::length(answers.vectors(Normal)[i] - glm::normalize(across)), 0.0, 2e-5)
                        << i;
                    ASSERT_NEAR(answers.vectors(Product::JacobianMoments)[i].x, across.z, 2e-5) << i;
                    const glm::dvec3 velocity = (after[i] - before[i]) / (2.0 * kStep);
                    ASSERT_NEAR(glm::length(answers.vectors(Velocity)[i] - velocity), 0.0, 1e-5) << i;
                }
            }
}

// Whoever asks for what else: a query of levels, one footprint, with points of a slick and an edge beside them.
TEST(Masks, LeaveTheSeaBeyondThemAsItIsToTheBit) {
    std::vector<WaveMask> masks = kTwo;
    masks.push_back(
        {.east_m = -40.0, .length_m = 20.0, .width_m = 10.0, .edge_m = 4.0, .ripples = 0.0, .foam = 0.5});
    Query levels = unfiltered(products(Position, Normal, Velocity, SlopeVariance, Product::Breaking));
    levels.cell_m = {0.0, 0.0625, 0.125, 0.25, 0.5, 1.0, 2.0};
    levels.pixel_m = {0.0, 0.0625, 0.125, 0.25, 0.5, 1.0, 2.0};
    Query one = levels;
    one.cell_m = one.pixel_m = {0.0625};
    Scene plain = young_sea(), masked = young_sea(masks);
    plain.effects.breaking_from_m = masked.effects.breaking_from_m = 1.0;
    const auto a = frame_of<float>(plain, {levels, one}, kTime_s),
               b = frame_of<float>(masked, {levels, one}, kTime_s);
    const auto rest = random_points<float>(160.0, 3000);
    Where<float> where;
    for (std::size_t i = 0; i < rest.size(); ++i) where.cell_m.push_back(0.05f * static_cast<float>(i % 40));
    where.pixel_m = where.cell_m;
    const MasksPlan& plan = *b.sea().plan().masks;
    for (int query = 0; query < 2; ++query) {
        const auto was = sample(a, query, rest, where), is = sample(b, query, rest, where);
        int beyond = 0, changed = 0;
        for (std::size_t i = 0; i < rest.size(); ++i) {
            const MaskGains<double> gains = plan.at(glm::dvec2(rest[i]));
            const bool is_same = was.vectors(Position)[i] == is.vectors(Position)[i] &&
                                 was.vectors(Normal)[i] == is.vectors(Normal)[i] &&
                                 was.vectors(Velocity)[i] == is.vectors(Velocity)[i] &&
                                 was.vectors(SlopeVariance)[i] == is.vectors(SlopeVariance)[i] &&
                                 was.numbers(Product::Breaking)[i] == is.numbers(Product::Breaking)[i];
            if (gains.waves == 1.0 && gains.ripples == 1.0 && gains.foam == 1.0) {
                ++beyond;
                ASSERT_TRUE(is_same) << i;
            }
            changed += !is_same;
            const auto alone =
                sample(b, query, {rest[i]},
                       {.origin_m = {}, .cell_m = {where.cell_m[i]}, .pixel_m = {where.pixel_m[i]}});
            ASSERT_EQ(alone.vectors(Normal)[0], is.vectors(Normal)[i]) << i;
            ASSERT_EQ(alone.vectors(SlopeVariance)[0], is.vectors(SlopeVariance)[i]) << i;
        }
        EXPECT_GT(beyond, 1000);
        EXPECT_GT(changed, 500);
    }
}

TEST(Masks, ThatChangeNothingAreNone) {
    EXPECT_FALSE(plan_masks(young_sea()));
    EXPECT_FALSE(plan_masks(young_sea({{.east_m = 5.0}})));
    EXPECT_EQ(make_plan(young_sea({{.east_m = 5.0}}), {unfiltered(products(Normal))}).transforms_per_frame(),
              make_plan(young_sea(), {unfiltered(products(Normal))}).transforms_per_frame());
}

// What is shown and what is hidden of the squares of the slopes, of a sea whose points stay over theirs at rest.
double slopes(const ProductArrays<float>& values) {
    return mean_of(values.vectors(Normal),
                   [](const glm::vec3& n) { return (n.x * n.x + n.y * n.y) / (n.z * n.z); }) +
           mean_of(values.vectors(SlopeVarianceAtRest), [](const glm::vec3& v) { return v.x + v.y; });
}

// Along lines across an edge: the squares of the slopes that are shown and what is hidden of them, against m² Σ + (∇m ⊗ ∇m) m0.
void show_and_hide_across_an_edge(bool is_picture) {
    constexpr double kEdge_m = 8.0;
    Scene scene = young_sea(
        {{.length_m = 1e5, .width_m = 100.0, .direction_deg = 90.0, .edge_m = kEdge_m, .waves = 0.25}});
    if (is_picture) {  // whose edge is half within
        scene.waves.masks[0].width_m += kEdge_m;
        scene.waves.masks[0].picture = "ones";
        scene.waves.mask_pictures["ones"] = picture(16, 64, [](int, int) { return 1.0; });
    }
    scene.quality.level = QualityLevel::Final;
    std::vector<Query> queries;
    for (const double footprint_m : {0.3, 2.0, 8.0})
        queries.push_back(filtered(products(Position, Normal, SlopeVarianceAtRest), footprint_m));
    const Scene flat = [&] {  // slopes are those of heights
        Scene of = scene;
        of.waves.choppiness = 0.0;
        return of;
    }();
    Scene plain = flat;
    plain.waves.masks.clear();
    const auto frame = frame_of<float>(flat, queries, kTime_s),
               without = frame_of<float>(plain, queries, kTime_s);
    const SpectralMoments all = frame.sea().total();
    double worst = 0.0;
    for (int query = 0; query < 3; ++query)
        for (const double share : {-0.2, 0.25, 0.5, 0.75, 1.2}) {
            const double x = 50.0 + share * kEdge_m;
            auto rest = random_points<float>(16000.0, 60000);
            for (glm::vec2& at : rest) at.x = static_cast<float>(x);
            // A realisation has its own part of what the spectrum says.
            const double there = slopes(sample(without, query, rest)) / all.mss();
            EXPECT_NEAR(there, 1.0, 0.02);
            const double said = there * mean_of(rest, [&](const glm::vec2& at) {
                                    const MaskGains<double> m = frame.sea().plan().masks->at(glm::dvec2(at));
                                    return m.waves * m.waves * all.mss() + (m.x * m.x + m.y * m.y) * all.m0;
                                });
            const double found = slopes(sample(frame, query, rest)) / said;
            EXPECT_NEAR(found, 1.0, 0.01) << query << ' ' << share;
            worst = worse(worst, std::abs(found - 1.0));
        }
    testing::Test::RecordProperty("variance_off", number_text(worst));
}

TEST(Masks, ShowAndHideWhatTheySayAcrossAnEdge) {
    show_and_hide_across_an_edge(false);
}
TEST(Masks, ShowAndHideWhatTheySayAcrossThatOfAPicture) {
    show_and_hide_across_an_edge(true);
}

// The same in a slick, for footprints finer and coarser than it, and half a slick.
TEST(Masks, ShowAndHideWhatASlickLeaves) {
    for (const double ripples : {0.0, 0.5}) {
        Scene scene = young_sea({{.length_m = 1e5, .width_m = 1e5, .ripples = ripples}});
        scene.quality.level = QualityLevel::Final;
        scene.waves.choppiness = 0.0;
        scene.waves.cascades = {{64.0, 256}, {5.0, 256}};
        scene.effects.breaking_from_m = 1.0;
        std::vector<Query> queries;
        for (const double footprint_m : {0.06, 0.125, 0.5, 2.0})
            queries.push_back(filtered(products(Normal, SlopeVarianceAtRest), footprint_m));
        Query levels = queries[0];
        levels.cell_m = levels.pixel_m = {0.03125, 0.0625, 0.125, 0.25, 0.5, 1.0, 2.0};
        queries.push_back(levels);
        queries.push_back(filtered(queries[0].products,
                                   0.0));  // finer than all waves of the grids, whose shortest is a ripple
        Scene plain = scene;
        plain.waves.masks.clear();
        const auto frame = frame_of<float>(scene, queries, kTime_s),
                   without = frame_of<float>(plain, queries, kTime_s);
        const double all = frame.sea().total().mss(),
                     said = all - (1.0 - ripples * ripples) * frame.sea().slick().mss();
        const auto rest = random_points<float>(4000.0, 60000);
        const auto slopes_of = [&](const Frame<float>& of, int query, float footprint_m) {
            return slopes(sample(of, query, rest,
                                 {{},
                                  std::vector<float>(rest.size(), footprint_m),
                                  std::vector<float>(rest.size(), footprint_m)}));
        };
        const auto judge = [&](int query, float footprint_m) {
            // A realisation has its own part of what the spectrum says.
            const double own = slopes_of(without, query, footprint_m) - all,
                         calm =
                             slopes_of(without, 4, std::max(footprint_m, static_cast<float>(kSlick_m))) - all;
            const double there = ripples * ripples * own + (1.0 - ripples * ripples) * calm;
            EXPECT_LT(std::abs(there), 0.02 * said);
            EXPECT_NEAR((slopes_of(frame, query, footprint_m) - there) / said, 1.0, 0.01)
                << ripples << ' ' << query << ' ' << footprint_m;
        };
        judge(5, 0.0f);
        constexpr std::array kFootprints_m{0.06f, 0.125f, 0.5f, 2.0f};
        for (int query = 0; query < 4; ++query) judge(query, kFootprints_m[query]);
        for (const float footprint_m : {0.04f, 0.1f, 0.2f, 1.5f}) judge(4, footprint_m);
    }
}

// Waves of a metre that no grid holds are hidden, and stay so.
TEST(Masks, ASlickTakesNoLongerWavesThanItsOwn) {
    Scene scene = young_sea({{.length_m = 1e3, .width_m = 1e3, .ripples = 0.0}});
    scene.waves.cascades = {{64.0, 64}};
    scene.effects.breaking_from_m = 1.0;
    Scene plain = scene;
    plain.waves.masks.clear();
    const std::vector<Query> queries{unfiltered(products(SlopeVarianceAtRest))};
    const auto hidden = [&](const Frame<double>& frame) {
        const glm::dvec3 at = sample(frame, 0, {{3.0, 4.0}}).vectors(SlopeVarianceAtRest)[0];
        return at.x + at.y;
    };
    const auto frame = frame_of<double>(scene, queries);
    const double all = hidden(frame_of<double>(plain, queries)), slick = frame.sea().slick().mss();
    EXPECT_GT(all, 1.1 * slick);
    EXPECT_NEAR(hidden(frame), all - slick, 1e-6);
}

// Cox and Munk 1954: 0.008 + 1.56e-3 U ± 0.004 in slicks.
TEST(Masks, ASlickHasTheSlopesOfCoxAndMunks) {
    for (const double wind_mps : {5.0, 10.0, 14.0}) {
        Scene scene;
        scene.sea.wind_speed_mps = wind_mps;
        scene.waves.masks = {{.ripples = 0.0}};
        const auto prepared = prepare(scene);
        const DirectionalSpectrum& spectrum = prepared->spectrum;
        const double all = moments(spectrum, 0.0, 1e9).mss(), slick = all - slick_moments(spectrum, {}).mss();
        EXPECT_NEAR(slick, 0.008 + 1.56e-3 * wind_mps, 0.004) << wind_mps << " of " << all;
        RecordProperty("mss_at_" + std::to_string(static_cast<int>(wind_mps)), number_text(slick));
    }
}

// Living foam and what breaks now: of 60 s of a storm none in a calm, and less where foam has a gain.
TEST(Masks, ACalmHasNoFoamNorHadIt) {
    Scene scene;
    scene.sea.wind_speed_mps = 18.0;
    scene.sea.fetch_m = 20e3;
    scene.waves.cascades = {{300.0, 128}, {60.0, 128}};
    scene.effects.foam_drift = 0.0;
    const Scene plain = scene;
    scene.waves.masks = {
        {.east_m = -400.0, .length_m = 150.0, .width_m = 150.0, .edge_m = 100.0, .waves = 0.0},
        {.east_m = 400.0, .length_m = 150.0, .width_m = 150.0, .edge_m = 50.0, .foam = 0.25}};
    const auto foam_round = [&](const Scene& of, double east_m, double pixel_m = 1.0) {
        const Query query = filtered(foam_products(), pixel_m);
        SeaAtTime<float> sea(std::make_shared<const Sea<float>>(make_plan(of, {query})));
        sea.set(40.0);
        const auto rest = random_points<float>(90.0, 1500);
        ProductArrays<float> values;
        values.resize(query.products, rest.size());
        sea.evaluate(0, {.origin_m = {east_m, 0.0}, .count = rest.size(), .rest_m = {rest.data()}},
                     values.results());
        return std::pair(mean_of(values.numbers(Coverage), [](float v) { return v; }),
                         mean_of(values.numbers(Product::Breaking), [](float v) { return v; }));
    };
    const auto calm = foam_round(scene, -400.0), less = foam_round(scene, 400.0),
               full = foam_round(plain, 400.0);
    EXPECT_LT(calm.first, 1e-6);
    EXPECT_LT(calm.second, 1e-6);
    EXPECT_GT(full.second, 0.002);
    EXPECT_NEAR(less.second / full.second, 0.25, 1e-5);
    EXPECT_NEAR(less.first / full.first, 0.25, 0.02);
    EXPECT_EQ(foam_round(scene, 0.0), foam_round(plain, 0.0));
    // Beyond the tiles of foam, where it is the sea's mean.
    const auto far = foam_round(plain, 400.0, 512.0).first;
    EXPECT_GT(far, 0.002);
    EXPECT_LT(foam_round(scene, -400.0, 512.0).first, 1e-6);
    EXPECT_NEAR(foam_round(scene, 400.0, 512.0).first / far, 0.25, 1e-3);
}

TEST(Masks, BreakAsMuchOfTheSeaAsItsWavesAreHigher) {
    const auto share = [](double y) { return 0.5 * std::erfc(-y / std::sqrt(2.0)); };
    for (const double y : {-3.0, -2.5, -2.0})
        for (const double m : {0.5, 0.8, 1.0, 1.2, 1.5})
            EXPECT_NEAR(masked_breaking(m, y) / (share(y / m) / share(y)), 1.0, 0.15) << y << " " << m;
    EXPECT_EQ(masked_breaking(0.0, -2.0), 0.0);
}

TEST(Masks, AreAsHighTogetherAsThoseThatOverlap) {
    Scene scene;
    scene.waves.masks = {
        {.length_m = 100.0, .width_m = 100.0, .edge_m = 50.0, .waves = 2.0},
        {.east_m = 80.0, .length_m = 100.0, .width_m = 100.0, .edge_m = 50.0, .waves = 1.5},
        {.east_m = 5000.0, .length_m = 100.0, .width_m = 100.0, .edge_m = 50.0, .waves = 2.5}};
    EXPECT_EQ(plan_masks(scene)->largest(), 3.0);
}

// As high as it is asked for, and the highest round it, also where a lee begins.
TEST(Masks, AHeroStandsInALeeAsHighAsItIsAskedFor) {
    for (const double east_m : {0.0, 120.0}) {
        Scene scene;
        scene.sea.wind_speed_mps = 14.0;
        scene.waves.cascades = {{700.0, 256}, {90.0, 128}};
        scene.waves.second_order = 0.0;
        scene.waves.masks = {{.edge_m = 70.0, .waves = 0.4}};
        scene.waves.heroes = {{.frame = 30.0, .east_m = east_m, .height_m = 2.5}};
        const auto frame =
            frame_of<double>(scene, {filtered(products(Displacement), 1.0)}, scene.shot.time_s(30.0));
        std::vector<glm::dvec2> rest{{east_m, 0.0}};
        for (int i = 0; i < 400; ++i) rest.emplace_back(east_m + (i % 20 - 9.5), i / 20 - 9.5);
        const std::vector<glm::dvec3> moved = sample(frame, 0, rest).vectors(Displacement);
        EXPECT_NEAR(moved[0].z, 2.5, 0.05);
        EXPECT_LT(std::hypot(moved[0].x, moved[0].y), 0.1);
        for (const glm::dvec3& there : moved) EXPECT_LT(there.z, 2.6);
    }
}

// In a sea whose wind has keys, between two of them.
TEST(Masks, StandInASeaThatChanges) {
    Scene scene = young_sea();
    scene.quality.level = QualityLevel::Final;
    scene.waves.second_order = 0.0;
    scene.keyed = {{"sea.wind_speed_mps", {{{1, 4.0}, {100, 8.0}}, CameraInterpolation::Linear}}};
    const auto moved = [&](const Scene& of) {
        Frame<float> frame(
            std::make_shared<const SeaOverTime<float>>(make_plan(of, {unfiltered(products(Displacement))})));
        frame.set(2.0);
        return sample(frame, 0, {{3.0f, 4.0f}, {700.0f, 0.0f}}).vectors(Displacement);
    };
    const auto before = moved(scene);
    scene.waves.masks = {{.edge_m = 60.0, .waves = 0.5}};
    const auto after = moved(scene);
    EXPECT_EQ(after[0], 0.5f * before[0]);
    EXPECT_EQ(after[1], before[1]);
    EXPECT_NE(before[0], glm::vec3(0.0f));
}

TEST(Masks, AreWarnedOfWhereTheirEdgesCutWavesAndRefusedWhereTheyCannotBe) {
    Scene scene;
    scene.waves.masks = {{.edge_m = 5.0, .waves = 0.5}};
    const auto warned = [&] {
        std::string all;
        for (const std::string& warning : sea_warnings(*prepare(scene))) all += warning + '\n';
        return all;
    };
    EXPECT_NE(warned().find("waves.masks[0].edge_m = 5"), std::string::npos) << warned();
    scene.waves.masks[0].edge_m = 200.0;
    EXPECT_EQ(warned().find("waves.masks"), std::string::npos) << warned();
    scene.waves.masks[0].waves = 4.0;
    EXPECT_NE(warned().find("waves.masks[0].waves = 4: the surface folds"), std::string::npos) << warned();
    scene.waves.masks[0].waves = 0.5;
    scene.waves.heroes = {{.height_m = 1.0}};
    EXPECT_EQ(warned().find("waves.heroes"), std::string::npos) << warned();
    scene.waves.heroes[0].height_m = 5.0;
    EXPECT_NE(warned().find("waves.heroes[0].height_m = 5: no such sea"), std::string::npos) << warned();
    scene.waves.masks[0].waves = 0.05;
    EXPECT_NE(warned().find("waves.heroes[0].height_m = 5: stands where less than a tenth"),
              std::string::npos)
        << warned();
    scene.waves.masks[0].waves = 0.5;
    scene.waves.heroes.clear();
    scene.waves.masks[0].ripples = 0.0;
    EXPECT_TRUE(validate(scene).empty());
    scene.waves.model = WaveModel::Trochoid;
    ASSERT_EQ(validate(scene).size(), 1u);
    EXPECT_EQ(validate(scene).front().key, "waves.masks[0].ripples");
    scene.waves.model = WaveModel::Fft;
    scene.effects.breaking_from_m = 0.2;
    ASSERT_EQ(validate(scene).size(), 1u);
    EXPECT_EQ(validate(scene).front().accepted, "1, or effects.breaking_from_m of 0.25 or more");
}

// Where a picture of ones holds, it is the ellipse of the same gains, and half of it on its border.
TEST(MaskPictures, OfOnesAreWhatAnEllipseIsInItsMiddle) {
    const WaveMask ellipse{.east_m = 40.0,
                           .north_m = -10.0,
                           .length_m = 100.0,
                           .width_m = 60.0,
                           .direction_deg = 20.0,
                           .edge_m = 10.0,
                           .waves = 0.3,
                           .ripples = 0.5,
                           .foam = 0.25};
    Scene of_ellipse = young_sea({ellipse}), of_picture = of_ellipse;
    of_ellipse.effects.breaking_from_m = of_picture.effects.breaking_from_m = 1.0;
    of_picture.waves.masks[0].picture = "ones";
    of_picture.waves.mask_pictures["ones"] = picture(40, 24, [](int, int) { return 1.0; });
    const std::vector<Query> queries{
        filtered(products(Position, Normal, Velocity, SlopeVariance, Product::Breaking), 0.1)};
    const auto a = frame_of<float>(of_ellipse, queries, kTime_s),
               b = frame_of<float>(of_picture, queries, kTime_s);
    const Where<float> at{.origin_m = {40.0, -10.0}, .cell_m = {}, .pixel_m = {}};
    const auto rest = random_points<float>(24.0, 500);
    const auto was = sample(a, 0, rest, at), is = sample(b, 0, rest, at);
    for (std::size_t i = 0; i < rest.size(); ++i) {
        ASSERT_LT(glm::length(was.vectors(Position)[i] - is.vectors(Position)[i]), 1e-6f) << i;
        ASSERT_LT(glm::length(was.vectors(Normal)[i] - is.vectors(Normal)[i]), 1e-6f) << i;
        ASSERT_LT(glm::length(was.vectors(Velocity)[i] - is.vectors(Velocity)[i]), 1e-6f) << i;
        ASSERT_LT(glm::length(was.vectors(SlopeVariance)[i] - is.vectors(SlopeVariance)[i]), 1e-6f) << i;
        ASSERT_NEAR(was.numbers(Product::Breaking)[i], is.numbers(Product::Breaking)[i], 1e-6f) << i;
    }
    const MasksPlan plan = *plan_masks(of_picture);
    const auto gains_at = [&](double u, double v) {
        const double turn = 20.0 * kPi / 180.0, c = std::cos(turn), s = std::sin(turn);
        return plan.at({40.0 + u * c - v * s, -10.0 + u * s + v * c});
    };
    const MaskGains<double> whole = gains_at(-44.0, 24.0), border = gains_at(-50.0, 3.0),
                            beyond = gains_at(-55.1, 3.0);
    EXPECT_NEAR(whole.waves, 0.3, 1e-12);
    EXPECT_NEAR(whole.ripples, 0.5, 1e-12);
    EXPECT_NEAR(whole.foam, 0.25, 1e-12);
    EXPECT_NEAR(border.waves, 0.65, 1e-12);
    EXPECT_NEAR(border.foam, 0.625, 1e-12);
    EXPECT_EQ(beyond.waves, 1.0);
    EXPECT_EQ(beyond.foam, 1.0);
}

// Left is left, and the top is to the left of the length.
TEST(MaskPictures, LieAsTheirLengthDoes) {
    Scene scene = young_sea({{.east_m = 5.0,
                              .length_m = 40.0,
                              .width_m = 20.0,
                              .direction_deg = 90.0,
                              .edge_m = 1.0,
                              .waves = 0.0,
                              .picture = "corner"}});
    scene.waves.mask_pictures["corner"] = picture(4, 2, [](int x, int row) { return x == 3 && row == 0; });
    const MasksPlan plan = *plan_masks(scene);
    // Its length runs north, so its last column is the northernmost, and its top lies west.
    EXPECT_NEAR(plan.at({0.0, 15.0}).waves, 1.0 - 0.75 * 0.75, 1e-12);
    EXPECT_NEAR(plan.at({10.0, 15.0}).waves, 1.0 - 0.75 * 0.125, 1e-12);
    EXPECT_EQ(plan.at({0.0, -15.0}).waves, 1.0);
}

// Their bounds, and derivatives that are those of what is shown, wherever a picture is as rough as can be.
TEST(MaskPictures, AreAsSmoothAsTheirEdge) {
    for (const double edge_m : {1.0, 9.0, 40.0, 500.0}) {
        Scene scene = young_sea({{.east_m = 1e5,
                                  .length_m = 120.0,
                                  .width_m = 80.0,
                                  .direction_deg = 33.0,
                                  .edge_m = edge_m,
                                  .waves = 3.0,
                                  .picture = "chequers"}});
        scene.waves.mask_pictures["chequers"] =
            picture(48, 37, [](int x, int row) { return (x / 3 + row / 2) % 2; });
        SCOPED_TRACE(edge_m);
        const MasksPlan plan = *plan_masks(scene);
        const MasksPlan::Mask& mask = plan.masks[0];
        const glm::dvec2 cell_m = 1.0 / mask.cells_per_m;
        EXPECT_GE(std::min(cell_m.x, cell_m.y), 0.5 * edge_m);
        double most = 1.0, farthest_m = 0.0;
        const double reach_m = mask.reach_m;
        for (const glm::dvec2& from : random_points<double>(2.2 * reach_m, 20000)) {
            const glm::dvec2 at = mask.middle_m + from;
            const MaskGains<double> gains = plan.at(at);
            ASSERT_GE(gains.waves, 1.0);
            ASSERT_LE(gains.waves, mask.strongest + 1e-12);
            most = std::max(most, gains.waves);
            if (gains.waves > 1.0) farthest_m = std::max(farthest_m, glm::length(from));
            const glm::dvec2 rate(glm::dot(glm::dvec2(gains.x, gains.y), mask.along),
                                  gains.y * mask.along.x - gains.x * mask.along.y);
            ASSERT_LE(std::abs(rate.x), 2.0 / cell_m.x * (1.0 + 1e-12));
            ASSERT_LE(std::abs(rate.y), 2.0 / cell_m.y * (1.0 + 1e-12));
            constexpr double kStep_m = 1e-4;
            for (const glm::dvec2 way : {glm::dvec2(1.0, 0.0), glm::dvec2(0.0, 1.0)}) {
                const MaskGains<double> after = plan.at(at + kStep_m * way),
                                        before = plan.at(at - kStep_m * way);
                const double said = way.x * gains.x + way.y * gains.y, least_m = std::min(cell_m.x, cell_m.y);
                ASSERT_NEAR((after.waves - before.waves) / (2.0 * kStep_m), said,
                            8.0 * kStep_m / (least_m * least_m) + 1e-6);
                ASSERT_LE(
                    std::abs(way.x * (after.x - before.x) + way.y * (after.y - before.y)) / (2.0 * kStep_m),
                    8.0 / (least_m * least_m) + 1e-6);
            }
        }
        EXPECT_LE(farthest_m, reach_m);
        EXPECT_GT(most, 1.0 + 0.55 * (mask.strongest - 1.0));  // one cell alone has 9/16
        EXPECT_EQ(plan.gains_in(mask.middle_m, mask.middle_m).largest, mask.strongest);
        EXPECT_EQ(plan.largest(), mask.strongest);
        // The whole of it is kept, however wide the edge.
        double held_m2 = 0.0;
        for (const glm::dvec2& from : random_points<double>(2.2 * reach_m, 200000))
            held_m2 += 0.5 * (plan.at(mask.middle_m + from).waves - 1.0);
        held_m2 *= 2.2 * reach_m * 2.2 * reach_m / 200000.0;
        double share = 0.0;
        for (const float each : scene.waves.mask_pictures["chequers"]->shares())
            share += static_cast<double>(each) / (48.0 * 37.0);
        EXPECT_NEAR(held_m2 / (120.0 * 80.0 * share), 1.0, 0.03);
    }
}

// A frame by itself on one thread and after others on two.
TEST(MaskPictures, AreTheSameToTheBitInEveryFrameHoweverItIsMade) {
    const Scene scene = with_blotches(young_sea(kTwo));
    const std::vector<Query> queries{filtered(products(Position, Normal, SlopeVariance), 0.25)};
    const auto rest = random_points<float>(160.0, 2000);
    const auto values_on = [&](int threads, const std::vector<double>& times_s) {
        tbb::task_arena arena(threads);
        return arena.execute([&] {
            auto frame = frame_of<float>(scene, queries, times_s.front());
            for (const double t_s : times_s) frame.set(t_s);
            return sample(frame, 0, rest);
        });
    };
    const auto alone = values_on(1, {kTime_s}), after = values_on(2, {0.0, 1.25, kTime_s});
    EXPECT_EQ(alone.vectors(Position), after.vectors(Position));
    EXPECT_EQ(alone.vectors(Normal), after.vectors(Normal));
    EXPECT_EQ(alone.vectors(SlopeVariance), after.vectors(SlopeVariance));
}

TEST(MaskPictures, AreRefusedWhereTheyAreNone) {
    const auto refusal = [](int width, int height, std::vector<float> shares) -> std::string {
        try {
            const MaskPicture made(width, height, std::move(shares));
        } catch (const MaskPictureError& error) {
            return error.what();
        }
        return "";
    };
    constexpr const char* kAccepted = "; accepted: a picture of 2 … 4096 pixels a side, with values of 0 … 1";
    EXPECT_EQ(refusal(2, 2, {0.0f, 0.5f, 1.0f, -0.0f}), "");
    EXPECT_EQ(refusal(1, 1, {0.0f}), std::string("has 1 x 1 pixels") + kAccepted);
    EXPECT_EQ(refusal(65536, 2, {}), std::string("has 65536 x 2 pixels") + kAccepted);
    EXPECT_EQ(refusal(2, 2, {0.0f}), std::string("has 1 values for 2 x 2 pixels") + kAccepted);
    EXPECT_EQ(refusal(2, 2, {0.0f, 1.0f, 1.5f, 0.0f}),
              std::string("has a value of 1.5 in its row 2, column 1") + kAccepted);
    EXPECT_EQ(refusal(2, 2, {0.0f, std::nanf(""), 0.0f, 0.0f}),
              std::string("has a value of nan in its row 1, column 2") + kAccepted);
    Scene scene;
    scene.waves.masks = {{.waves = 0.5, .picture = "lee.exr"}};
    ASSERT_EQ(validate(scene).size(), 1u);
    EXPECT_EQ(validate(scene).front().key, "waves.masks[0].picture");
    EXPECT_EQ(validate(scene).front().problem, "was not read");
    EXPECT_THROW(plan_masks(scene), std::invalid_argument);
    scene.waves.mask_pictures["lee.exr"] = picture(2, 4096, [](int, int) { return 1.0; });
    EXPECT_TRUE(validate(scene).empty());
    scene.waves.masks.resize(5, scene.waves.masks[0]);
    ASSERT_EQ(validate(scene).size(), 1u);
    EXPECT_EQ(validate(scene).front().key, "waves.masks[4].picture");
    EXPECT_EQ(validate(scene).front().problem, "and those of the masks before it have 20480 rows");
}

// Two cells of a picture are an edge as well, and a picture that holds nowhere whole is as rough as it is there.
TEST(MaskPictures, AreWarnedOfByWhatTheyShow) {
    Scene scene;
    scene.waves.masks = {{.edge_m = 5.0, .waves = 0.5, .picture = "coarse"}};
    scene.waves.mask_pictures["coarse"] = picture(2, 2, [](int, int) { return 1.0; });
    const auto warned = [&] {
        std::string all;
        for (const std::string& warning : sea_warnings(*prepare(scene))) all += warning + '\n';
        return all;
    };
    EXPECT_EQ(warned().find("waves.masks"), std::string::npos) << warned();
    scene.waves.mask_pictures["coarse"] = picture(64, 64, [](int, int) { return 1.0; });
    EXPECT_NE(warned().find("waves.masks[0].edge_m = 5"), std::string::npos) << warned();
    scene.waves.masks[0].edge_m = 200.0;
    scene.waves.masks[0].waves = 4.0;
    EXPECT_NE(warned().find("waves.masks[0].waves = 4: the surface folds"), std::string::npos) << warned();
    scene.waves.mask_pictures["coarse"] = picture(2, 2, [](int, int) { return 0.1; });
    EXPECT_EQ(warned().find("waves.masks"), std::string::npos) << warned();
}

}  // namespace
}  // namespace pelagic
