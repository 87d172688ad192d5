// Gusts: a varying wind roughens the sea and breaks its waves in patches, and changes neither on the whole.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "core/scene/canonical.h"
#include "core/waves/whitecaps.h"
#include "tests/core/waves/samples.h"

namespace pelagic {
namespace {

using namespace test;

const ProductSet kGusty = products(Product::SlopeVariance, Product::Breaking);

Scene gusty_scene(double strength, double wind_mps = 14.0) {
    Scene scene;
    scene.effects.foam_decay_s = 0.0;  // all foam breaks now
    scene.sea.wind_speed_mps = wind_mps;
    scene.sea.gust_strength = strength;
    return scene;
}

double mean_variance(const ProductArrays<float>& values) {
    double sum = 0.0;
    for (const glm::vec3& v : values.vectors(SlopeVariance)) sum += static_cast<double>(v.x + v.y);
    return sum;
}
double mean_foam(const ProductArrays<float>& values) {
    double sum = 0.0;
    for (const float w : values.numbers(Product::Breaking)) sum += static_cast<double>(w);
    return sum;
}

// Over area as much as without, whatever a footprint shows of the pattern: of the slopes by symmetry, of the foam by
// calibration. The farthest footprints show no patches.
TEST(Gusts, ChangeNoMean) {
    const auto points = random_points<float>(60000.0, 100000);
    const double footprints_m[] = {20.0, 40.0, 70.0, 120.0, 200.0, 400.0, 3000.0};
    std::vector<Query> queries;
    for (const double footprint_m : footprints_m) queries.push_back(filtered(kGusty, footprint_m));
    for (const double wind_mps : {5.0, 14.0, 30.0})
        for (const WhitecapLaw law : {WhitecapLaw::Monahan1980, WhitecapLaw::Callaghan2008}) {
            Scene calm = gusty_scene(0.0, wind_mps);
            calm.effects.whitecap_law = law;
            const auto even = frame_of<float>(calm, queries, 3.0);
            for (const double strength : {0.6, 1.0}) {
                Scene scene = calm;
                scene.sea.gust_strength = strength;
                const auto gusty = frame_of<float>(scene, queries, 3.0);
                for (int q = 0; q < static_cast<int>(queries.size()); ++q) {
                    SCOPED_TRACE(testing::Message() << wind_mps << " m/s, strength " << strength
                                                    << ", footprint " << footprints_m[q] << " m");
                    const auto with = sample(gusty, q, points), without = sample(even, q, points);
                    EXPECT_NEAR(mean_variance(with) / mean_variance(without), 1.0, 0.01);
                    // In a hurricane gusts reach the most foam that there can be: a kink, which the polynomial rounds.
                    EXPECT_NEAR(mean_foam(with) / mean_foam(without), 1.0, wind_mps < 30.0 ? 0.02 : 0.03);
                    const auto [least, most] =
                        std::ranges::minmax(with.vectors(SlopeVariance), {}, &glm::vec3::x);
                    const auto [even_least, even_most] =
                        std::ranges::minmax(without.vectors(SlopeVariance), {}, &glm::vec3::x);
                    EXPECT_GE(least.x, 0.0f);
                    if (footprints_m[q] > 1000.0) {
                        EXPECT_EQ(most.x, even_most.x);
                        EXPECT_EQ(least.x, even_least.x);
                    } else if (footprints_m[q] < 50.0) {
                        EXPECT_GT(static_cast<double>(most.x),
                                  (1.0 + 0.7 * strength) * static_cast<double>(even_least.x));
                        EXPECT_LT(static_cast<double>(least.x),
                                  (1.0 - 0.7 * strength) * static_cast<double>(even_most.x));
                    }
                }
            }
        }
}

// Where waves are resolved, fewer of them break in a lull: the mean is the same, but for what a finite number of points
// sees of it.
TEST(Gusts, BreakMoreWavesAndNoLessFoamOnEach) {
    const auto points = random_points<float>(20000.0, 200000);
    for (const double footprint_m : {0.5, 4.0}) {
        const auto even =
            sample(frame_of<float>(gusty_scene(0.0), {filtered(kGusty, footprint_m)}, 3.0), 0, points);
        const auto gusty =
            sample(frame_of<float>(gusty_scene(0.8), {filtered(kGusty, footprint_m)}, 3.0), 0, points);
        EXPECT_NEAR(mean_foam(gusty) / mean_foam(even), 1.0, 0.05) << footprint_m;
        EXPECT_NEAR(std::ranges::max(gusty.numbers(Product::Breaking)),
                    std::ranges::max(even.numbers(Product::Breaking)), 0.1f);
    }
}

// Along the wind, at the speed that the wind has a little above the water.
// A gust of f times the wind has f^p times the coverage, by the law's exponent: counted over the sea, in classes of f, which the
// unresolved slopes tell.
TEST(Gusts, WhitecapsFollowTheShotsLaw) {
    constexpr double kWind_mps = 14.0,
                     kFootprint_m = 40.0;  // hides the waves that break, and shows the gusts
    const auto points = random_points<float>(200000.0, 200000);
    for (const WhitecapLaw law :
         {WhitecapLaw::Monahan1980, WhitecapLaw::Monahan1986, WhitecapLaw::Callaghan2008}) {
        Scene scene = gusty_scene(0.6, kWind_mps);
        scene.effects.whitecap_law = law;
        // 3 · 14 / 15.98 of the third.
        const double exponent = law == WhitecapLaw::Monahan1980   ? 3.52
                                : law == WhitecapLaw::Monahan1986 ? 2.55
                                                                  : 2.628;
        Scene calm = scene;
        calm.sea.gust_strength = 0.0;
        const auto sampled = sample(frame_of<float>(scene, {filtered(kGusty, kFootprint_m)}, 3.0), 0, points);
        const auto even = sample(frame_of<float>(calm, {filtered(kGusty, kFootprint_m)}, 3.0), 0, points);
        struct Class {
            double foam = 0.0, even = 0.0, law = 0.0;
        };
        std::array<Class, 8> classes{};  // f from 0.4 to 1.6
        Class whole;
        for (std::size_t i = 0; i < points.size(); ++i) {
            const double f =
                static_cast<double>(sampled.vectors(SlopeVariance)[i].x / even.vectors(SlopeVariance)[i].x);
            auto& in = classes[static_cast<std::size_t>(std::clamp((f - 0.4) / 0.15, 0.0, 7.0))];
            for (Class* to : {&in, &whole}) {
                to->foam += static_cast<double>(sampled.numbers(Product::Breaking)[i]);
                to->even += static_cast<double>(even.numbers(Product::Breaking)[i]);
                to->law += std::pow(f, exponent);
            }
        }
        for (const Class& in : classes) {
            const double expected = in.law / whole.law, found = in.foam / whole.foam;
            EXPECT_NEAR(found / expected, 1.0, 0.1) << static_cast<int>(law) << " of " << expected;
        }
    }
}

TEST(Gusts, DriftWithTheWind) {
    Scene scene = gusty_scene(1.0, 10.0);
    scene.sea.wind_direction_deg = 60.0;
    const Query query = filtered(products(Product::SlopeVariance), 40.0);
    auto frame = frame_of<double>(scene, {query}, 100.0);
    const auto points = random_points<double>(1000.0, 2000);
    const auto before = sample(frame, 0, points);
    const glm::dvec2 way_m = 20.0 * 8.5 * glm::dvec2(0.5, std::sqrt(0.75));
    std::vector<glm::dvec2> moved;
    for (const glm::dvec2& at : points) moved.push_back(at + way_m);
    frame.set(120.0);
    const auto after = sample(frame, 0, moved), stayed = sample(frame, 0, points);
    double differs = 0.0, stays = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double was = before.vectors(SlopeVariance)[i].x;
        differs = std::max(differs, std::abs(after.vectors(SlopeVariance)[i].x / was - 1.0));
        stays = std::max(stays, std::abs(stayed.vectors(SlopeVariance)[i].x / was - 1.0));
    }
    EXPECT_LT(differs, 0.05);  // long waves, which are shown, carry the unresolved slopes
    EXPECT_GT(stays, 0.5);
}

TEST(Gusts, LoopWithTheShotToTheBit) {
    Scene scene = gusty_scene(1.0, 20.0);
    scene.shot.loop_s = 48.0;
    scene.sea.gust_size_m = 60.0;
    auto frame = frame_of<float>(scene, {filtered(kGusty, 1.0)}, 5.0);
    const auto points = random_points<float>(2000.0, 500);
    const auto first = sample(frame, 0, points);
    frame.set(5.0 + 48.0);
    const auto again = sample(frame, 0, points);
    frame.set(30.0);
    const auto between = sample(frame, 0, points);
    EXPECT_EQ(first.vectors(SlopeVariance), again.vectors(SlopeVariance));
    EXPECT_EQ(first.numbers(Product::Breaking), again.numbers(Product::Breaking));
    EXPECT_NE(first.vectors(SlopeVariance), between.vectors(SlopeVariance));
}

// Far out and late the pattern is as smooth as here.
TEST(Gusts, AreSmoothAnywhereAndAtAnyTime) {
    for (const auto& [far_m, t_s] : {std::pair(0.0, 0.0), std::pair(1e8, 1e9), std::pair(-3e8, -1e9)}) {
        auto frame =
            frame_of<float>(gusty_scene(1.0), {filtered(kGusty, 200.0), filtered(kGusty, 20.0)}, t_s);
        std::vector<glm::vec2> line;
        for (int i = 0; i < 3000; ++i)
            line.emplace_back(static_cast<float>(i), 0.25f * static_cast<float>(i));
        const auto along =
            sample<float>(frame, 1, line, {.origin_m = {far_m, 0.5 * far_m}, .cell_m = {}, .pixel_m = {}});
        float least = 1e9f, most = 0.0f, step = 0.0f;
        for (std::size_t i = 0; i < line.size(); ++i) {
            const float at = along.vectors(SlopeVariance)[i].x;
            ASSERT_TRUE(std::isfinite(at));
            ASSERT_TRUE(std::isfinite(along.numbers(Product::Breaking)[i]));
            least = std::min(least, at);
            most = std::max(most, at);
            if (i > 0) step = std::max(step, std::abs(at - along.vectors(SlopeVariance)[i - 1].x));
        }
        EXPECT_GT(most, 3.0f * least);
        EXPECT_LT(step, 0.15f * most);
    }
}

// A point has them whoever is beside it and from whichever origin it is asked; ellipses see less of them along their axis.
TEST(Gusts, DependOnNothingButThePoint) {
    Query query = filtered(kGusty | products(Position, Normal), 0.0);
    query.pixel_m = {0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0};
    const auto frame = frame_of<float>(gusty_scene(1.0), {query}, 4.0);
    const auto points = random_points<float>(400.0, 300);
    Where<float> where;
    for (std::size_t i = 0; i < points.size(); ++i)
        where.pixel_m.push_back(0.4f * std::exp2(static_cast<float>(i % 7)));
    const auto together = sample(frame, 0, points, where);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const auto alone = sample<float>(frame, 0, {points[i]},
                                         {.origin_m = {}, .cell_m = {}, .pixel_m = {where.pixel_m[i]}});
        ASSERT_EQ(alone.vectors(SlopeVariance)[0], together.vectors(SlopeVariance)[i]) << i;
        ASSERT_EQ(alone.numbers(Product::Breaking)[0], together.numbers(Product::Breaking)[i]) << i;
    }
    const auto range_of = [&](glm::vec2 axis_m) {
        const std::vector<float> widths(points.size(), 8.0f);
        const std::vector<glm::vec2> axes(points.size(), axis_m);
        ProductArrays<float> values;
        values.resize(kGusty, points.size());
        Points<float> asked{.count = points.size(), .rest_m = {points.data()}};
        asked.pixel_m = {widths.data()};
        asked.pixel_axis_m = {axes.data()};
        evaluate(frame, 0, asked, values.results());
        const auto [least, most] = std::ranges::minmax(values.vectors(SlopeVariance), {}, &glm::vec3::x);
        return most.x / least.x;
    };
    EXPECT_GT(range_of({9.0f, 0.0f}), 4.0f);
    EXPECT_GT(range_of({0.0f, 900.0f}), 1.2f);  // what varies along x alone
    EXPECT_LT(range_of({0.0f, 900.0f}), 0.7f * range_of({9.0f, 0.0f}));
}

// ---- Fronts

constexpr double kUnseen_m =
    1.0;  // the size of a pattern that no footprint of these tests shows: edges are smooth

Scene with_front(GustFront front, double wind_mps = 14.0) {
    Scene scene = gusty_scene(0.0, wind_mps);
    scene.sea.gust_size_m = kUnseen_m;
    scene.sea.gust_fronts = {front};
    return scene;
}
Scene without_fronts(Scene scene) {
    scene.sea.gust_fronts.clear();
    return scene;
}
// Of a front that is long across its way, so far from its middle along it, in a footprint.
double share_along(const GustFront& front, double from_m, double footprint_m) {
    const auto rise = [](double x) { return x * x * (3.0 - 2.0 * x); };
    const double t = std::clamp(
        (std::abs(from_m) - 0.5 * (front.length_m - footprint_m)) / (front.edge_m + footprint_m), 0.0, 1.0);
    return rise(1.0 - rise(t));
}

// Along its way, across both edges, shown and hidden slopes add up to what its wind makes of those that are hidden; also far out and late,
// where it has gone ten thousand kilometres.
template <class T>
void expect_slopes_along_its_way(const GustFront& front, double t_s, glm::dvec2 at_m, double tolerance) {
    const Scene scene = with_front(front);
    const Query query = filtered(products(Product::Normal, Product::SlopeVariance), 4.0);
    const double turn = front.direction_deg * kPi / 180.0;
    const glm::dvec2 way(std::cos(turn), std::sin(turn));
    std::vector<glm::vec<2, T>> path;
    for (int i = -300; i <= 300; ++i) path.emplace_back(1.1 * i * way);
    const Where<T> where{.origin_m = at_m, .cell_m = {}, .pixel_m = {}};
    const auto with = sample<T>(frame_of<T>(scene, {query}, t_s), 0, path, where),
               plain = sample<T>(frame_of<T>(without_fronts(scene), {query}, t_s), 0, path, where);
    EXPECT_EQ(with.vectors(Normal), plain.vectors(Normal));
    double sum = 0.0, expected = 0.0, hidden = 0.0, shown = 0.0;
    for (std::size_t i = 0; i < path.size(); ++i) {
        const double from_m = 1.1 * (static_cast<double>(i) - 300.0),
                     factor = 1.0 + (front.wind - 1.0) * share_along(front, from_m, 4.0);
        const auto variance = [&](const auto& of) {
            return static_cast<double>(of.vectors(SlopeVariance)[i].x + of.vectors(SlopeVariance)[i].y);
        };
        const glm::vec<3, T> n = with.vectors(Normal)[i];
        const double slope2 = static_cast<double>((n.x * n.x + n.y * n.y) / (n.z * n.z));
        ASSERT_NEAR(variance(with) / variance(plain), factor, tolerance) << from_m;
        sum += slope2 + variance(with);
        expected += slope2 + factor * variance(plain);
        hidden += variance(plain);
        shown += slope2;
    }
    EXPECT_NEAR(sum / expected, 1.0, 0.01);
    EXPECT_GT(sum, 1.05 * (hidden + shown));
}

TEST(GustFronts, RaiseWhatIsHiddenWhereTheyAre) {
    GustFront front{.frame = 25.0,
                    .east_m = 40.0,
                    .north_m = -30.0,
                    .direction_deg = 30.0,
                    .speed_mps = 7.0,
                    .length_m = 200.0,
                    .width_m = 1000.0,
                    .edge_m = 80.0,
                    .wind = 2.5};
    const glm::dvec2 way(std::sqrt(0.75), 0.5);
    expect_slopes_along_its_way<double>(front, 41.0, glm::dvec2(40.0, -30.0) + 280.0 * way, 1e-9);
    expect_slopes_along_its_way<float>(front, 1.0, glm::dvec2(40.0, -30.0), 1e-5);
    // Far out and late.
    front = {.frame = 1.0, .north_m = 3e5, .speed_mps = 10.0, .width_m = 1000.0, .wind = 1.8};
    expect_slopes_along_its_way<float>(front, 1e6, {1e7, 3e5}, 1e-5);
    expect_slopes_along_its_way<double>(front, -1e6, {-1e7, 3e5}, 1e-8);
}

// A still one that is placed there is the same, with the pattern on its edges and its foam.
TEST(GustFronts, AreToTheBitWhereAStillOneWouldBe) {
    GustFront front{.frame = 25.0,
                    .east_m = -50.0,
                    .north_m = 10.0,
                    .speed_mps = 6.0,
                    .length_m = 60.0,
                    .width_m = 150.0,
                    .edge_m = 70.0,
                    .wind = 2.0};
    Scene moving = with_front(front);
    moving.sea.gust_strength = 0.5;
    moving.sea.gust_size_m = 60.0;
    Scene still = moving, unmoved = moving;
    still.sea.gust_fronts[0].speed_mps = unmoved.sea.gust_fronts[0].speed_mps = 0.0;
    still.sea.gust_fronts[0].east_m += 6.0 * 20.0;
    const auto points = random_points<float>(400.0, 2000);
    const auto at = [&](const Scene& scene) {
        return sample(frame_of<float>(scene, {filtered(kGusty, 2.0)}, 21.0), 0, points);
    };
    const auto moved = at(moving), placed = at(still), before = at(unmoved);
    EXPECT_EQ(moved.vectors(SlopeVariance), placed.vectors(SlopeVariance));
    EXPECT_EQ(moved.numbers(Product::Breaking), placed.numbers(Product::Breaking));
    EXPECT_NE(moved.vectors(SlopeVariance), before.vectors(SlopeVariance));
    EXPECT_NE(moved.numbers(Product::Breaking), before.numbers(Product::Breaking));
}

// The pattern tears their edges, and neither what lies within nor what lies beyond; from far away they are smooth again.
TEST(GustFronts, HaveRaggedEdges) {
    Scene scene = with_front({.speed_mps = 0.0, .length_m = 200.0, .width_m = 200.0, .edge_m = 100.0});
    scene.sea.gust_size_m = 30.0;
    std::vector<glm::vec2> ring;
    for (int i = 0; i < 400; ++i)
        ring.emplace_back(std::cos(kTwoPi * i / 400.0), std::sin(kTwoPi * i / 400.0));
    const auto factors = [&](double radius_m, double footprint_m) {
        std::vector<glm::vec2> points = ring;
        for (glm::vec2& point : points) point *= static_cast<float>(radius_m);
        const Query query = filtered(products(Product::SlopeVariance), footprint_m);
        const auto with = sample(frame_of<float>(scene, {query}, 3.0), 0, points),
                   plain = sample(frame_of<float>(without_fronts(scene), {query}, 3.0), 0, points);
        std::pair<double, double> range{1e9, 0.0};
        for (std::size_t i = 0; i < points.size(); ++i) {
            const auto factor =
                static_cast<double>(with.vectors(SlopeVariance)[i].x / plain.vectors(SlopeVariance)[i].x);
            range = {std::min(range.first, factor), std::max(range.second, factor)};
        }
        return range;
    };
    const auto edge = factors(150.0, 1.0), within = factors(95.0, 1.0), beyond = factors(205.0, 1.0),
               far = factors(150.0, 80.0);
    EXPECT_LT(edge.first, 1.1);
    EXPECT_GT(edge.second, 1.9);
    EXPECT_NEAR(within.first, 2.0, 1e-5);
    EXPECT_NEAR(within.second, 2.0, 1e-5);
    EXPECT_EQ(beyond, std::pair(1.0, 1.0));
    EXPECT_NEAR(far.first, 1.5, 1e-3);
    EXPECT_NEAR(far.second, 1.5, 1e-3);
}

// It is a wind, and no mask of waves: positions and velocities are those of the sea without it, and fit each other.
TEST(GustFronts, LeaveTheSurfaceAsItIs) {
    const Scene scene = with_front({.speed_mps = 20.0, .edge_m = 20.0, .wind = 3.0});
    const Query query = filtered(products(Product::Position, Product::Velocity, Product::Normal), 0.5);
    auto frame = frame_of<double>(scene, {query}, 2.0);
    const auto points = random_points<double>(300.0, 300);
    const auto here = sample(frame, 0, points),
               plain = sample(frame_of<double>(without_fronts(scene), {query}, 2.0), 0, points);
    EXPECT_EQ(here.vectors(Position), plain.vectors(Position));
    EXPECT_EQ(here.vectors(Velocity), plain.vectors(Velocity));
    constexpr double kStep_s = 1e-3;
    frame.set(2.0 - kStep_s);
    const auto before = sample(frame, 0, points);
    frame.set(2.0 + kStep_s);
    const auto after = sample(frame, 0, points);
    for (std::size_t i = 0; i < points.size(); ++i)
        for (int axis = 0; axis < 3; ++axis)
            ASSERT_NEAR(
                (after.vectors(Position)[i][axis] - before.vectors(Position)[i][axis]) / (2.0 * kStep_s),
                here.vectors(Velocity)[i][axis], 1e-3);
}

// Within a front, of w times the wind, there is the law's foam of w times the wind, also of a sea that has gusts; where fronts overlap the wind
// is no stronger and no weaker than theirs.
TEST(GustFronts, HaveTheFoamOfTheirWind) {
    const auto points = random_points<float>(60000.0, 40000);
    struct Case {
        double wind_mps, strength, tolerance;
        std::vector<double> winds;
        double together;
    };
    // Beyond 23 m/s the law stays. Below 3.7 m/s it has no foam, and lines between winds leave less than a thousandth of the sea's.
    for (const Case& of : {Case{14.0, 0.0, 0.02, {0.5}, 0.5},
                           {14.0, 0.5, 0.03, {0.5}, 0.5},
                           {14.0, 0.0, 0.02, {1.6}, 1.6},
                           {14.0, 0.5, 0.03, {1.6}, 1.6},
                           {14.0, 0.5, 0.03, {2.0, 1.9}, 2.0},
                           {14.0, 0.5, 0.03, {0.5, 2.0}, 1.0},
                           {10.0, 0.0, 0.02, {2.0}, 2.0},
                           {10.0, 0.5, 0.03, {4.0}, 4.0},
                           {10.0, 1.0, 0.06, {4.0}, 4.0},
                           {10.0, 0.0, 0.02, {0.3}, 0.3},
                           {5.0, 0.0, 0.02, {2.0}, 2.0},
                           {25.0, 0.0, 0.02, {0.3}, 0.3}}) {
        const Scene plain = gusty_scene(of.strength, of.wind_mps);
        Scene scene = plain;
        for (const double wind : of.winds)
            scene.sea.gust_fronts.push_back(
                {.speed_mps = 0.0, .length_m = 1e5, .width_m = 1e5, .wind = wind});
        const auto at = [&](const Scene& asked) {
            return sample(frame_of<float>(asked, {filtered(kGusty, 40.0)}, 3.0), 0, points);
        };
        const auto with = at(scene), without = at(plain);
        EXPECT_NEAR(mean_variance(with) / mean_variance(without), of.together, 1e-3)
            << of.wind_mps << " m/s, strength " << of.strength;
        const double law = law_coverage(plain, of.together) / law_coverage(plain);
        EXPECT_NEAR(mean_foam(with) / mean_foam(without), law, of.tolerance * law + 1e-3)
            << of.wind_mps << " m/s, strength " << of.strength << ", " << of.together << " times the wind";
    }
}

// A point beyond all fronts has the bits of the sea without them, with gusts and without, foam and slopes.
TEST(GustFronts, LeaveWhatLiesBeyondThemAsItIs) {
    const auto points = random_points<float>(3000.0, 4000);
    for (const double strength : {0.0, 0.5, 1.0}) {
        const Scene plain = gusty_scene(strength, 10.0);
        Scene scene = plain;
        scene.sea.gust_fronts = {{.east_m = 5000.0, .speed_mps = 0.0, .edge_m = 300.0, .wind = 4.0},
                                 {.east_m = -5000.0, .speed_mps = 0.0, .edge_m = 300.0, .wind = 0.2}};
        const auto at = [&](const Scene& asked) {
            return sample(frame_of<float>(asked, {filtered(kGusty, 40.0)}, 3.0), 0, points);
        };
        const auto with = at(scene), without = at(plain);
        EXPECT_EQ(with.vectors(SlopeVariance), without.vectors(SlopeVariance)) << strength;
        EXPECT_EQ(with.numbers(Product::Breaking), without.numbers(Product::Breaking)) << strength;
    }
}

// On the rim of a large one with a narrow edge, where roundings tell, a point has what it has whatever points are computed beside it.
TEST(GustFronts, EndForEachPointByItself) {
    constexpr double kSize_m = 1e5, kEdge_m = 1.0;
    Scene scene = with_front(
        {.speed_mps = 0.0, .length_m = kSize_m, .width_m = kSize_m, .edge_m = kEdge_m, .wind = 4.0});
    scene.sea.gust_size_m = 60.0;
    constexpr std::size_t kLongest = 16;  // values of a vector
    const auto beside = [&](glm::vec2 companion) {
        std::vector<glm::vec2> points;
        for (int i = 0; i < 4000; ++i) {
            const double turn = kTwoPi * i / 4000.0;
            points.emplace_back((0.5 * kSize_m + kEdge_m) * glm::dvec2(std::cos(turn), std::sin(turn)));
            points.insert(points.end(), kLongest - 1, companion);
        }
        const auto values = sample(
            frame_of<float>(scene, {unfiltered(products(Product::Normal, Product::SlopeVariance))}, 3.0), 0,
            points);
        std::vector<float> rim;
        for (std::size_t i = 0; i < points.size(); i += kLongest)
            rim.push_back(values.vectors(SlopeVariance)[i].x);
        return rim;
    };
    EXPECT_EQ(beside({0.0f, 0.0f}), beside({1e6f, 0.0f}));
}

// Of a front that is smaller than its footprint a point sees a part, by its area, so that none appears and goes between pixels; and of an ellipse
// along its long axis alone.
TEST(GustFronts, FadeWhereAPixelIsLarger) {
    const Scene scene =
        with_front({.speed_mps = 0.0, .length_m = 60.0, .width_m = 60.0, .edge_m = 20.0, .wind = 3.0});
    constexpr int kSide = 121;
    constexpr float kStep_m = 10.0f;
    std::vector<glm::vec2> points;
    for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x)
            points.push_back(kStep_m * (glm::vec2(x, y) - 0.5f * static_cast<float>(kSide - 1)));
    const auto more = [&](double footprint_m) {
        const Query query = filtered(products(Product::SlopeVariance), footprint_m);
        const auto with = sample(frame_of<float>(scene, {query}, 3.0), 0, points),
                   plain = sample(frame_of<float>(without_fronts(scene), {query}, 3.0), 0, points);
        std::vector<double> by;
        for (std::size_t i = 0; i < points.size(); ++i)
            by.push_back(
                static_cast<double>(with.vectors(SlopeVariance)[i].x / plain.vectors(SlopeVariance)[i].x) -
                1.0);
        return by;
    };
    const std::vector<double> fine = more(4.0), coarse = more(300.0);
    const auto sum = [](const std::vector<double>& of) { return std::accumulate(of.begin(), of.end(), 0.0); };
    EXPECT_NEAR(std::ranges::max(fine), 2.0, 1e-3);
    EXPECT_LT(std::ranges::max(coarse), 0.35);
    EXPECT_NEAR(sum(coarse) / sum(fine), 1.0,
                0.25);  // edges are no ramps: their area isn't that of their middle
    double step = 0.0;
    for (std::size_t i = 1; i < coarse.size(); ++i)
        if (i % kSide != 0) step = std::max(step, std::abs(coarse[i] - coarse[i - 1]));
    EXPECT_LT(step, 0.04);
    Query query = filtered(products(Product::SlopeVariance), 0.0);
    query.pixel_m = {4.0, 8.0, 16.0, 32.0, 64.0, 128.0, 256.0, 512.0};
    const std::vector<glm::vec2> two{{100.0f, 0.0f}, {0.0f, 100.0f}};
    const std::vector<float> widths(two.size(), 4.0f);
    const std::vector<glm::vec2> axes(two.size(), {300.0f, 0.0f});
    const auto seen = [&](const Scene& of) {
        ProductArrays<float> values;
        values.resize(products(Product::SlopeVariance), two.size());
        Points<float> asked{.count = two.size(), .rest_m = {two.data()}};
        asked.pixel_m = {widths.data()};
        asked.pixel_axis_m = {axes.data()};
        evaluate(frame_of<float>(of, {query}, 3.0), 0, asked, values.results());
        return values;
    };
    const auto with = seen(scene), plain = seen(without_fronts(scene));
    EXPECT_GT(with.vectors(SlopeVariance)[0].x, 1.1f * plain.vectors(SlopeVariance)[0].x);
    EXPECT_EQ(with.vectors(SlopeVariance)[1].x, plain.vectors(SlopeVariance)[1].x);
}

TEST(GustFronts, ThatMoveAreRefusedInALoop) {
    Scene scene = with_front({});
    scene.sea.gust_size_m = 60.0;
    scene.shot.loop_s = 48.0;
    const std::vector<Problem> problems = validate(scene);
    ASSERT_EQ(problems.size(), 1u);
    EXPECT_EQ(
        text_of(problems[0]),
        "sea.gust_fronts[0].speed_mps = 6: takes it away, and in a loop it would have to be back; accepted: 0, or "
        "shot.loop_s = 0");
    scene.shot.time_scale = 0.0;  // stands still
    EXPECT_TRUE(validate(scene).empty());
    scene.shot.time_scale = 1.0;
    scene.sea.gust_fronts[0].speed_mps = 0.0;
    auto frame = frame_of<float>(scene, {filtered(kGusty, 1.0)}, 5.0);
    const auto points = random_points<float>(400.0, 500);
    const auto first = sample(frame, 0, points);
    frame.set(5.0 + 48.0);
    EXPECT_EQ(sample(frame, 0, points).vectors(SlopeVariance), first.vectors(SlopeVariance));
}

// In a sea that stands still all frames are one moment: a front is at its middle in each, whatever its frame and speed.
TEST(GustFronts, StandStillWithTheSea) {
    Scene moving =
        with_front({.frame = 40.0, .east_m = 30.0, .speed_mps = 100.0, .edge_m = 20.0, .wind = 4.0}, 80.0);
    moving.shot.time_scale = 0.0;
    moving.shot.time_offset_s = 1e6;
    Scene still = moving;
    still.sea.gust_fronts[0].speed_mps = 0.0;
    const auto points = random_points<float>(200.0, 500);
    const auto at = [&](const Scene& scene, int frame) {
        return sample(frame_of<float>(scene, {filtered(kGusty, 2.0)}, scene.shot.time_s(frame)), 0, points);
    };
    const auto first = at(moving, 1), later = at(moving, 48), placed = at(still, 40),
               plain = at(without_fronts(moving), 1);
    for (const auto* other : {&later, &placed}) {
        EXPECT_EQ(first.vectors(SlopeVariance), other->vectors(SlopeVariance));
        EXPECT_EQ(first.numbers(Product::Breaking), other->numbers(Product::Breaking));
    }
    EXPECT_NE(first.vectors(SlopeVariance), plain.vectors(SlopeVariance));
    for (std::size_t i = 0; i < points.size(); ++i) {
        EXPECT_TRUE(std::isfinite(first.vectors(SlopeVariance)[i].x)) << i;
        const float foam = first.numbers(Product::Breaking)[i];
        EXPECT_TRUE(foam >= plain.numbers(Product::Breaking)[i] && foam <= 1.0f) << i;
    }
}

// Shots without them keep their fingerprints.
TEST(GustFronts, ArentSaidWhereThereAreNone) {
    const Scene scene = with_front({});
    EXPECT_NE(canonical(scene).find("gust_fronts"), std::string::npos);
    EXPECT_EQ(canonical(without_fronts(scene)).find("gust_fronts"), std::string::npos);
    EXPECT_FALSE(frame_of<float>(with_front({.wind = 1.0}), {filtered(kGusty, 1.0)}, 0.0).sea().gusts());
}

// Without strength, without wind, and in a cascade's own tile there are none.
TEST(Gusts, AreNotWhereNobodyAsksForThem) {
    Scene scene = gusty_scene(0.0);
    scene.sea.gust_size_m = 17.0;
    EXPECT_FALSE(frame_of<float>(scene, {filtered(kGusty, 1.0)}, 0.0).sea().gusts());
    EXPECT_FALSE(frame_of<float>(gusty_scene(1.0, 0.0), {filtered(kGusty, 1.0)}, 0.0).sea().gusts());
    Query tile = filtered(kGusty, 1.0);
    tile.only_cascade = 1;
    const auto points = random_points<float>(400.0, 300);
    const auto gusty = sample(frame_of<float>(gusty_scene(1.0), {tile}, 2.0), 0, points),
               even = sample(frame_of<float>(gusty_scene(0.0), {tile}, 2.0), 0, points);
    EXPECT_EQ(gusty.vectors(SlopeVariance), even.vectors(SlopeVariance));
    EXPECT_EQ(gusty.numbers(Product::Breaking), even.numbers(Product::Breaking));
}

}  // namespace
}  // namespace pelagic
