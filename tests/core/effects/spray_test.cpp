// What breaks now on average, against what evaluate() says of a patch of the sea, whether foam lives or not.
#include "core/effects/spray.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "core/plan/spray.h"
#include "core/plan/weather.h"
#include "core/scene/keys.h"
#include "core/scene/number_keys.h"
#include "core/scene/validate.h"
#include "core/waves/sea_over_time.h"
#include "core/waves/whitecaps.h"
#include "tests/core/waves/samples.h"

namespace pelagic {
namespace {

using namespace test;

std::shared_ptr<const Sea<float>> spray_sea(const Scene& scene) {
    return std::make_shared<const Sea<float>>(
        make_plan(scene, {filtered(products(Product::Breaking, Product::JacobianMoments), 1.0)}));
}

Scene spray_scene(double wind_mps, double decay_s = 0.0) {
    Scene scene;
    scene.sea.wind_speed_mps = wind_mps;
    scene.effects.foam_decay_s = decay_s;
    scene.effects.spray = true;
    return scene;
}

double seen_over_area(const std::shared_ptr<const Sea<float>>& sea) {
    Frame<float> frame(sea);
    double foam = 0.0, area = 0.0;
    for (int time = 0; time < 4; ++time) {
        frame.set(1000.0 * time);
        std::vector<glm::vec2> rest_m;
        for (int i = 0; i < 400; ++i)
            for (int j = 0; j < 400; ++j) rest_m.emplace_back(5.3 * i, 5.3 * j);
        Values values;
        QueryRunner<float>().run(frame, 0, Points<float>{.count = rest_m.size(), .rest_m = {rest_m.data()}},
                                 values);
        for (std::size_t i = 0; i < rest_m.size(); ++i) {
            const glm::vec3 j = values.vectors(Product::JacobianMoments)[i];
            const double of = sea_area(pelagic::JacobianMoments<double>{j.x, j.y, j.z}, true);
            foam += of * static_cast<double>(values.numbers(Product::Breaking)[i]);
            area += of;
        }
    }
    return foam / area;
}

TEST(Spray, TheMeanOfWhatBreaksIsTheSeasOwn) {
    for (const double decay_s : {0.0, 4.0}) {
        const auto sea = spray_sea(spray_scene(15.0, decay_s));
        // Four patches of 2 km: they hold some 4 % more or less than the whole sea.
        EXPECT_NEAR(seen_over_area(sea) / mean_breaking(*sea), 1.0, 0.08) << decay_s;
    }
}

TEST(Spray, FoamThatStaysIsNoneThatBreaks) {
    const Scene scene = spray_scene(15.0);
    EXPECT_NEAR(mean_breaking(*spray_sea(scene)) / law_coverage(scene), 1.0, 1e-6);
    EXPECT_LT(mean_breaking(*spray_sea(spray_scene(15.0, 4.0))), 0.6 * law_coverage(scene));
}

TEST(Spray, ThereIsNoneWhereNoWaveBreaks) {
    const auto veil_of = [](const Scene& scene) {
        Frame<float> frame(spray_sea(scene));
        frame.set(1.0);
        return SprayVeil(frame);
    };
    Scene scene = spray_scene(0.0);
    EXPECT_EQ(mean_breaking(*spray_sea(scene)), 0.0);
    EXPECT_TRUE(veil_of(scene).empty());
    scene = spray_scene(15.0);
    EXPECT_FALSE(veil_of(scene).empty());
    scene.effects.spray = false;
    EXPECT_TRUE(veil_of(scene).empty());
}

// The noise is 1 on average over places, times and seeds; also in a loop, which it closes.
TEST(Spray, TheTearingHasTheMeanOne) {
    for (const double loop_s : {0.0, 10.0}) {
        std::array<double, 3> sum{}, square{};
        int count = 0;
        for (std::uint64_t seed = 0; seed < 10; ++seed) {
            Scene scene = spray_scene(20.0);
            scene.shot.seed = seed;
            scene.shot.loop_s = loop_s;
            Frame<float> frame(spray_sea(scene));
            frame.set(loop_s > 0.0 ? 3.0 : 1e4 * static_cast<double>(seed));
            const SprayVeil veil(frame);
            for (int i = 0; i < 100; ++i)
                for (int j = 0; j < 100; ++j, ++count)
                    for (int height = 0; height < 3; ++height) {
                        const double factor = veil.torn(height, {47.3 * i - 1e5, 7.7 * j}, 0.2).factor;
                        EXPECT_GE(factor, 0.0);
                        sum[static_cast<std::size_t>(height)] += factor;
                        square[static_cast<std::size_t>(height)] += factor * factor;
                    }
            frame.set(0.0);
            const SprayVeil begins(frame);
            frame.set(loop_s > 0.0 ? loop_s * (1.0 - 1e-9) : 0.0);
            const SprayVeil ends(frame);
            EXPECT_NEAR(begins.torn(1, {31.0, 5.0}, 0.2).factor, ends.torn(1, {31.0, 5.0}, 0.2).factor, 1e-3);
        }
        for (std::size_t height = 0; height < 3; ++height) {
            EXPECT_NEAR(sum[height] / count, 1.0, 0.03) << height;
            EXPECT_GT(square[height] / count, 2.0) << "it hardly tears";
        }
    }
}

// Of a wind that rises: as much as the moment's, torn by a noise that has come as far as the wind has blown.
TEST(Spray, OfAWindThatChangesIsThatOfTheMoment) {
    for (const auto interpolation : {CameraInterpolation::Linear, CameraInterpolation::Smooth}) {
        Scene scene = spray_scene(10.0);
        scene.shot.time_scale = 0.5;
        scene.shot.time_offset_s = 3.0;
        const NumberKeys keys{{{1, 6.0}, {49, 14.0}, {97, 24.0}, {145, 18.0}}, interpolation};
        ASSERT_FALSE(set_value(scene, key_of("sea.wind_speed_mps"), keys));
        ASSERT_TRUE(validate(scene).empty());
        const std::vector<Query> queries{filtered(products(Product::Breaking, Displacement), 1.0)};
        const auto veil_at = [&](double f) {
            Frame<float> frame(std::make_shared<const SeaOverTime<float>>(make_plan(scene, queries)));
            frame.set(scene.shot.time_s(f));
            return SprayVeil(frame);
        };
        EXPECT_TRUE(veil_at(1.0).empty());  // 6 m/s tear nothing off
        for (const double f : {49.0, 60.0, 97.0, 120.5, 300.0}) {
            const SprayVeil veil = veil_at(f);
            const Scene now = scene_at(scene, f);
            EXPECT_NEAR(veil.wind_speed_mps() / now.sea.wind_speed_mps, 1.0, 1e-9);
            const auto prepared = prepared_at(prepare(scene), scene.shot.time_s(f));
            EXPECT_NEAR(veil.law().optical_thickness() /
                            spray_law(now, prepared->extent.significant_height_m).optical_thickness(),
                        1.0, 1e-9);
        }
        const auto shot = prepare(scene);
        const auto way_m = [&](double f) {
            const double t = scene.shot.time_s(f);
            return wind_way_m(*prepared_at(shot, t), t);
        };
        // The seas at keys know it as well, and the sea's time 0 is where it begins.
        EXPECT_NEAR(wind_way_m(*prepared_at(shot, 0.0), 0.0), 0.0, 1e-12);
        double summed = 0.0;
        constexpr double kStep = 0.25;
        for (double f = -200.0; f < 200.0; f += kStep) {
            const double from_s = scene.shot.time_s(f), to_s = scene.shot.time_s(f + kStep);
            summed += scene_at(scene, f + 0.5 * kStep).sea.wind_speed_mps * (to_s - from_s);
            ASSERT_NEAR(way_m(f + kStep) - way_m(-200.0), summed, 1e-3) << f;
        }
        // The noise is where an even wind has it that has blown as far.
        const SprayVeil changing = veil_at(97.0);
        Scene even = spray_scene(way_m(97.0) / scene.shot.time_s(97.0));
        Frame<float> frame(std::make_shared<const Sea<float>>(make_plan(even, queries)));
        frame.set(scene.shot.time_s(97.0));
        const SprayVeil steady(frame);
        ASSERT_FALSE(steady.empty());
        for (int i = 0; i < 20; ++i) {
            const glm::dvec2 place_m(3.7 * i, -2.1 * i);
            EXPECT_NEAR(changing.torn(i % 3, place_m, 0.0).factor / steady.torn(i % 3, place_m, 0.0).factor,
                        1.0, 1e-6);
        }
    }
}

// Threads' generations take turns without a jump, and close a loop.
TEST(Spray, GenerationsTakeTurns) {
    for (const double loop_s : {0.0, 10.0}) {
        Scene scene = spray_scene(20.0);
        scene.shot.loop_s = loop_s;
        Frame<float> frame(spray_sea(scene));
        const auto at = [&](double time_s) {
            frame.set(time_s);
            return SprayVeil(frame).generations();
        };
        for (int i = 0; i < 200; ++i) {
            const double time_s = 0.05 * i;
            const auto now = at(time_s), then = at(time_s + 1e-6);
            EXPECT_NEAR(now[0].weight * now[0].weight + now[1].weight * now[1].weight, 1.0, 1e-12);
            for (const auto& each : now) {
                if (each.weight < 1e-4) continue;
                const auto same = std::find_if(then.begin(), then.end(),
                                               [&](const auto& other) { return other.name == each.name; });
                ASSERT_NE(same, then.end()) << time_s;
                EXPECT_NEAR(same->weight, each.weight, 1e-5);
                EXPECT_NEAR(same->age_s, each.age_s, 1e-5);
            }
        }
        if (!(loop_s > 0.0)) continue;
        const auto ends = at(loop_s - 1e-7), begins = at(0.0);
        EXPECT_EQ(begins[1].name, ends[0].name);
        EXPECT_NEAR(begins[1].age_s, ends[0].age_s, 1e-6);
        EXPECT_NEAR(begins[1].weight, ends[0].weight, 1e-6);
    }
}

// Where cells are coarse for the noise what ribbons have is what breaks, over the sea; it lies downwind of that.
TEST(Spray, RibbonsAreWhatBreaksUpwind) {
    Scene scene = spray_scene(20.0);
    const auto sea = std::make_shared<const Sea<float>>(
        make_plan(scene, {filtered(products(Product::Displacement, Product::Breaking), 2.0)}));
    Frame<float> frame(sea);
    frame.set(7.0);
    constexpr int kSide = 400;
    constexpr double kSpacing_m = 5.0;
    std::vector<glm::vec2> places_m;
    for (int j = 0; j < kSide; ++j)
        for (int i = 0; i < kSide; ++i) places_m.emplace_back(glm::dvec2(kSpacing_m * i, kSpacing_m * j));
    const Points<float> points{.count = places_m.size(), .rest_m = {places_m.data()}};
    const PreparedQuery<float> query(frame, 0, products(Product::Displacement, Product::Breaking));
    std::vector<float> breaking(points.count);
    Results<float> results;
    results.set(Product::Breaking, {breaking.data()});
    std::vector<glm::vec3> displacement_m(points.count);
    results.set(Product::Displacement, {displacement_m.data()});
    evaluate_at(query, points, {.tolerance_m = 0.05}, results);
    const SprayVeil veil(frame);
    std::vector<glm::dvec3> shares(points.count);
    std::vector<double> lifts_m(points.count);
    veil.shares<float>(query, points, breaking, displacement_m, std::vector<double>(points.count, 5.9),
                       shares, lifts_m);
    double most_lift_m = 0.0;
    for (const double lift_m : lifts_m) {
        ASSERT_TRUE(lift_m >= 0.0 && lift_m <= SprayRibbons::kMostLift * veil.law().ribbons.step_m);
        most_lift_m = std::max(most_lift_m, lift_m);
    }
    EXPECT_GT(most_lift_m, 2.0) << "they lie on the sea";
    glm::dvec3 sum(0.0);
    double broken = 0.0, downwind = 0.0, upwind = 0.0;
    for (int j = 0; j < kSide; ++j)
        for (int i = 0; i < kSide; ++i) {
            const auto at = static_cast<std::size_t>(j * kSide + i);
            sum += shares[at];
            broken += static_cast<double>(breaking[at]) / mean_breaking(*sea);
            if (i < 6 || i + 6 >= kSide) continue;
            // The wind blows along x.
            downwind += shares[at + 5].z * static_cast<double>(breaking[at]);
            upwind += shares[at - 5].z * static_cast<double>(breaking[at]);
        }
    for (int height = 0; height < 3; ++height) EXPECT_NEAR(sum[height] / broken, 1.0, 0.03) << height;
    EXPECT_GT(downwind, 2.0 * upwind);
}

}  // namespace
}  // namespace pelagic
