// Each of these has broken somebody's ocean. Every answer is finite, every variance ≥ 0, every normal a unit
// vector, every coverage a share.
#include <gtest/gtest.h>

#include "core/scene/validate.h"
#include "tests/core/waves/samples.h"

namespace pelagic {
namespace {

using namespace test;

template <class T>
void expect_sound(const ProductArrays<T>& samples, const std::string& what) {
    const auto finite = [](auto v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); };
    const auto all = [&](const auto& values, auto&& is, const char* name) {
        ASSERT_FALSE(values.empty());
        std::size_t bad = 0;
        for (const auto& value : values) bad += is(value) ? 0 : 1;
        EXPECT_EQ(bad, 0u) << name << " of " << what;
    };
    all(samples.vectors(Position), finite, "position");
    all(samples.vectors(Displacement), finite, "displacement");
    all(samples.vectors(Velocity), finite, "velocity");
    // Rounding of a unit vector's three components.
    all(
        samples.vectors(Normal),
        [&](auto n) { return finite(n) && std::abs(std::hypot(n.x, n.y, n.z) - T(1)) < T(1e-6); }, "normal");
    all(
        samples.vectors(SlopeVariance),
        [&](auto v) {
            // A covariance: positive semi-definite, to rounding.
            return finite(v) && v.x >= T(0) && v.y >= T(0) && v.z * v.z <= v.x * v.y * (T(1) + T(1e-5));
        },
        "slope variance");
    all(
        samples.vectors(Product::JacobianMoments), [&](auto j) { return finite(j) && j.y >= T(0); },
        "Jacobian");
    all(
        samples.numbers(Product::Breaking), [](T w) { return w >= T(0) && w <= T(1); }, "coverage");
}

struct HardCase {
    const char* name;
    void (*change)(Scene&);
};

class HardCases : public testing::TestWithParam<HardCase> {};

// As a bake does it: the mesh of the scene, then points anywhere without and with a footprint.
TEST_P(HardCases, GiveSoundAnswers) {
    Scene scene;
    scene.surface.resolution = 32;
    GetParam().change(scene);
    for (const Problem& problem : validate(scene)) ADD_FAILURE() << text_of(problem);
    const ProductSet all = ~lasting_products();
    std::vector<Query> queries;
    for (const PlannedQuery& planned : plan_bake(scene).queries) queries.push_back(planned.query);
    for (Query& query : queries) query.products = all;
    queries.push_back(filtered(all, 3.0));
    const Plan plan = make_plan(scene, queries);
    for (double t : {0.0, 1e7, -33.3}) {
        const auto frame = frame_of<float>(scene, plan, t);
        const int n = scene.surface.resolution;
        expect_sound(sample(frame, 0,
                            rest_points<float>({.per_side = n + 1,
                                                .spacing_m = scene.surface.size_m / n,
                                                .first_m = -0.5 * scene.surface.size_m})),
                     "mesh");
        expect_sound(sample(frame, 1, random_points<float>(1e4, 300)), "points");
        expect_sound(sample(frame, 1, random_points<float>(10.0, 50),
                            {.origin_m = {1e6, -1e6}, .cell_m = {}, .pixel_m = {}}),
                     "far points");
    }
}

INSTANTIATE_TEST_SUITE_P(
    Each, HardCases,
    testing::Values(HardCase{"NoWind", [](Scene& s) { s.sea.wind_speed_mps = 0.0; }},
                    HardCase{"FaintWind", [](Scene& s) { s.sea.wind_speed_mps = 0.1; }},
                    HardCase{"FaintestWind", [](Scene& s) { s.sea.wind_speed_mps = 1.001e-3; }},
                    HardCase{"Denormal", [](Scene& s) { s.sea.wind_speed_mps = 5e-324; }},
                    HardCase{"Hurricane", [](Scene& s) { s.sea.wind_speed_mps = 80.0; }},
                    HardCase{"FetchOfAMetre", [](Scene& s) { s.sea.fetch_m = 1.0; }},
                    HardCase{"EndlessFetch", [](Scene& s) { s.sea.fetch_m = 1e7; }},
                    HardCase{"Puddle", [](Scene& s) { s.sea.depth_m = 0.01; }},
                    HardCase{"PuddleOfTma",
                             [](Scene& s) {
                                 s.sea.depth_m = 0.01;
                                 s.sea.spectrum = SpectrumKind::Tma;
                             }},
                    HardCase{"HurricaneOverAPuddle",
                             [](Scene& s) {
                                 s.sea.depth_m = 0.01;
                                 s.sea.wind_speed_mps = 80.0;
                                 s.waves.choppiness = 10.0;
                             }},
                    HardCase{"Folded", [](Scene& s) { s.waves.choppiness = 10.0; }},
                    HardCase{"NoChoppiness", [](Scene& s) { s.waves.choppiness = 0.0; }},
                    HardCase{"OneQuad", [](Scene& s) { s.surface.resolution = 1; }},
                    HardCase{"TwoQuads", [](Scene& s) { s.surface.resolution = 2; }},
                    HardCase{"OddQuads", [](Scene& s) { s.surface.resolution = 77; }},
                    HardCase{"TinyPatch", [](Scene& s) { s.surface.size_m = 0.01; }},
                    HardCase{"HugePatch", [](Scene& s) { s.surface.size_m = 1e6; }},
                    HardCase{"SmallestTile",
                             [](Scene& s) {
                                 s.waves.cascades = {{0.01, 16}};
                             }},
                    HardCase{"LargestTile",
                             [](Scene& s) {
                                 s.waves.cascades = {{1e6, 16}};
                             }},
                    HardCase{"ParallelWaves",
                             [](Scene& s) {
                                 // One mode's row: a swell as long as its tile; a wind sea of nothing.
                                 s.sea.wind_speed_mps = 0.0;
                                 s.sea.swell = {{.height_m = 50.0, .period_s = 10.0, .direction_deg = 0.0}};
                                 s.waves.cascades = {{156.0, 16}};
                                 s.waves.choppiness = 10.0;
                             }},
                    HardCase{"LoopShorterThanAPeriod", [](Scene& s) { s.shot.loop_s = 1.0 / 24.0; }},
                    HardCase{"CoarseDraft", [](Scene& s) { s.quality.level = QualityLevel::Draft; }},
                    HardCase{"LongestSwell",
                             [](Scene& s) {
                                 s.sea.swell = {{.height_m = 50.0, .period_s = 100.0, .direction_deg = 0.0}};
                             }},
                    HardCase{"ShortestSwell",
                             [](Scene& s) {
                                 s.sea.wind_speed_mps = 0.0;
                                 s.sea.swell = {{.height_m = 1e-3, .period_s = 0.1, .direction_deg = 0.0}};
                             }}),
    [](const auto& instance) { return std::string(instance.param.name); });

// Without wind and swell the right limit is known: flat, still, up, no foam, nothing unresolved.
TEST(Calm, IsExactlyFlat) {
    Scene scene;
    scene.sea.wind_speed_mps = 0.0;
    const ProductSet all = ~lasting_products();
    const auto samples =
        sample(frame_of<float>(scene, {filtered(all, 1.0)}, 5.0), 0, random_points<float>(100.0, 50));
    for (std::size_t i = 0; i < samples.vectors(Normal).size(); ++i) {
        EXPECT_EQ(samples.vectors(Displacement)[i], glm::vec3(0.0f));
        EXPECT_EQ(samples.vectors(Velocity)[i], glm::vec3(0.0f));
        EXPECT_EQ(samples.vectors(Normal)[i], glm::vec3(0.0f, 0.0f, 1.0f));
        EXPECT_EQ(samples.vectors(SlopeVariance)[i], glm::vec3(0.0f));
        EXPECT_EQ(samples.vectors(Product::JacobianMoments)[i], glm::vec3(1.0f, 0.0f, 0.0f));
        EXPECT_EQ(samples.numbers(Product::Breaking)[i], 0.0f);
    }
}

// Its foam is where the slightest choppiness would press the surface together.
TEST(NoChoppiness, HasFoamButNoHorizontalMotion) {
    Scene scene;
    scene.waves.choppiness = 0.0;
    const ProductSet all = ~lasting_products();
    const auto samples =
        sample(frame_of<float>(scene, {filtered(all, 1.0)}, 5.0), 0, random_points<float>(100.0, 50));
    for (std::size_t i = 0; i < samples.vectors(Normal).size(); ++i) {
        EXPECT_EQ(samples.vectors(Displacement)[i].x, 0.0f);
        EXPECT_EQ(samples.vectors(Displacement)[i].y, 0.0f);
        EXPECT_NE(samples.vectors(Displacement)[i].z, 0.0f);
        EXPECT_EQ(samples.vectors(Velocity)[i].x, 0.0f);
        EXPECT_NEAR(samples.vectors(Product::JacobianMoments)[i].x, 1.0f, 0.02f);
        EXPECT_NE(samples.vectors(Product::JacobianMoments)[i].x, 1.0f);
    }
}

}  // namespace
}  // namespace pelagic
