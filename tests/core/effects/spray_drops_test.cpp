// The spray's large drops: that all of them together are the law's, and that they are known from the scene and the time alone.
#include "core/effects/spray_drops.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/task_arena.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <map>
#include <vector>

#include "core/effects/spray.h"
#include "core/plan/spray.h"
#include "core/scene/validate.h"
#include "core/waves/whitecaps.h"
#include "tests/core/waves/samples.h"

namespace pelagic {
namespace {

Scene drops_scene() {
    Scene scene;
    scene.sea.wind_speed_mps = 15.0;
    scene.sea.wind_direction_deg = 30.0;
    scene.waves.cascades = {{150.0, 128}, {31.0, 64}};
    scene.effects.foam_decay_s = 0.0;
    scene.effects.spray = scene.effects.spray_drops = true;
    scene.surface.size_m = 48.0;
    return scene;
}

std::shared_ptr<const Sea<float>> drops_sea(const Scene& scene) {
    for (const Problem& problem : validate(scene)) throw std::invalid_argument(text_of(problem));
    return std::make_shared<const Sea<float>>(
        make_plan(scene, {test::filtered(products(Product::Displacement, Product::Breaking), 1.0)}));
}

SprayDrops<float> drops_over(const Scene& scene) {
    return {*drops_sea(scene), scene.surface.size_m};
}

std::vector<SprayDrop> drops_at(SprayDrops<float>& of, double time_s, glm::dvec2 middle_m = glm::dvec2(0.0)) {
    std::vector<SprayDrop> drops;
    of.at(time_s, middle_m, drops);
    return drops;
}
std::vector<SprayDrop> drops_at(const Scene& scene, double time_s) {
    SprayDrops<float> of = drops_over(scene);
    return drops_at(of, time_s);
}

bool are_same(const std::vector<SprayDrop>& a, const std::vector<SprayDrop>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(SprayDrop)) == 0;
}

double section_m2(const std::vector<SprayDrop>& drops) {
    double sum = 0.0;
    for (const SprayDrop& drop : drops) sum += drop.section_m2;
    return sum;
}

// Over a whole loop and a whole copy of the sea, so that what breaks there beside the sea's mean is all that they may depend on.
TEST(SprayDrops, TheirSectionsAreTheLawsShare) {
    Scene scene = drops_scene();
    scene.waves.cascades = {{120.0, 96}, {31.0, 64}};
    scene.waves.tiling = Tiling::Periodic;
    scene.surface.size_m = 120.0;
    scene.effects.spray_gain = 40.0;
    constexpr double kLoop_s = 3.0;
    scene.shot.loop_s = kLoop_s;
    const auto sea = drops_sea(scene);
    SprayDrops<float> of(*sea, scene.surface.size_m);
    double found_m2 = 0.0;
    constexpr int kTimes = 24;
    for (int time = 0; time < kTimes; ++time)
        found_m2 += section_m2(drops_at(of, kLoop_s * time / kTimes)) / kTimes;

    Frame<float> frame(std::make_shared<const Sea<float>>(plan_of_spray_drops(sea->plan(), of.plan())));
    std::vector<glm::vec2> rest_m;
    for (int y = 0; y < 120; ++y)
        for (int x = 0; x < 120; ++x)
            rest_m.emplace_back(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
    double broken = 0.0;
    const auto intervals = static_cast<int>(of.plan().intervals_a_loop);
    ASSERT_EQ(intervals, 12);
    for (int interval = 0; interval < intervals; ++interval) {
        frame.set(interval * of.plan().interval_s);
        Values values;
        QueryRunner<float>().run(frame, 0, Points<float>{.count = rest_m.size(), .rest_m = {rest_m.data()}},
                                 values);
        for (std::size_t i = 0; i < rest_m.size(); ++i) {
            const glm::vec3 j = values.vectors(Product::JacobianMoments)[i];
            broken += sea_area(pelagic::JacobianMoments<double>{j.x, j.y, j.z}, true) *
                      static_cast<double>(values.numbers(Product::Breaking)[i]) / mean_breaking(*sea);
        }
    }
    broken /= static_cast<double>(rest_m.size()) * intervals;
    const auto prepared = prepare(scene);
    const double law =
        spray_law(prepared->scene, prepared->extent.significant_height_m).drops.optical_thickness;
    const double found = found_m2 / (scene.surface.size_m * scene.surface.size_m);
    std::printf("    sections %.5f of the area, the law's %.5f; broke %.3f of the mean\n", found, law,
                broken);
    EXPECT_NEAR(found / (law * broken), 1.0, 0.03);
    EXPECT_GT(broken, 0.3);
}

TEST(SprayDrops, AFrameAloneIsThatOfARun) {
    const Scene scene = drops_scene();
    SprayDrops<float> run = drops_over(scene);
    for (int frame = 0; frame <= 4; ++frame) drops_at(run, 0.2 * frame, {frame == 0 ? 40.0 : 0.0, 0.0});
    const std::vector<SprayDrop> alone = drops_at(scene, 0.75);
    EXPECT_GT(alone.size(), 300u);
    EXPECT_TRUE(are_same(alone, drops_at(run, 0.75)));
    tbb::task_arena one(1);
    EXPECT_TRUE(are_same(alone, one.execute([&] { return drops_at(scene, 0.75); })));
    Scene other = scene;
    other.shot.seed = 2;
    EXPECT_FALSE(are_same(alone, drops_at(other, 0.75)));
}

TEST(SprayDrops, DependOnNothingElseThatIsAskedOfTheSea) {
    Scene scene = drops_scene();
    scene.effects.foam_decay_s = 3.0;
    const auto asked_for = [&](ProductSet what) {
        SprayDrops<float> of(Sea<float>(make_plan(scene, {test::filtered(what, 1.0)})), scene.surface.size_m);
        return drops_at(of, 1.0);
    };
    const std::vector<SprayDrop> alone = asked_for(products(Product::Displacement));
    EXPECT_GT(alone.size(), 100u);
    EXPECT_TRUE(are_same(alone, asked_for(products(Product::Displacement, Product::Coverage))));
}

// What a square shows of the sea beside another is what that one shows there.
TEST(SprayDrops, SquaresThatMeetShareThem) {
    SprayDrops<float> of = drops_over(drops_scene());
    std::map<std::int64_t, SprayDrop> here;
    for (const SprayDrop& drop : drops_at(of, 3.0)) here[drop.id] = drop;
    std::size_t shared = 0;
    for (const SprayDrop& drop : drops_at(of, 3.0, {30.0, -10.0})) {
        if (drop.position_m.x >= 24.0 || drop.position_m.y < -24.0) continue;
        ++shared;
        ASSERT_TRUE(here.contains(drop.id));
        // Floats of another origin.
        EXPECT_LT(glm::length(here[drop.id].position_m - drop.position_m), 1e-3);
    }
    EXPECT_GT(shared, 50u);
}

TEST(SprayDrops, LoopsClose) {
    Scene scene = drops_scene();
    for (const double loop_s : {6.0, 1.0}) {
        scene.shot.loop_s = loop_s;
        SprayDrops<float> of = drops_over(scene);
        const std::vector<SprayDrop> first = drops_at(of, 0.0);
        EXPECT_GT(first.size(), 300u);
        EXPECT_TRUE(are_same(first, drops_at(of, loop_s)));
        // And what was in the air before is there behind.
        std::map<std::int64_t, SprayDrop> before;
        if (loop_s > SprayDropsPlan::kLongestLife_s) {
            for (const SprayDrop& drop : drops_at(of, loop_s - 0.01)) before[drop.id] = drop;
            std::size_t same = 0;
            for (const SprayDrop& drop : first) {
                const auto at = before.find(drop.id);
                if (at == before.end()) continue;
                ++same;
                EXPECT_LT(glm::length(at->second.position_m + 0.01 * drop.velocity_mps - drop.position_m),
                          0.01);
            }
            EXPECT_GT(same, first.size() * 9 / 10);
        }
    }
}

TEST(SprayDrops, VelocitiesAreTheirWaysAndNothingPops) {
    SprayDrops<float> of = drops_over(drops_scene());
    constexpr double kStep_s = 1e-3;
    std::map<std::int64_t, SprayDrop> before, behind;
    double largest = 0.0;
    for (const SprayDrop& drop : drops_at(of, 7.0 - kStep_s)) before[drop.id] = drop;
    for (const SprayDrop& drop : drops_at(of, 7.0 + kStep_s)) behind[drop.id] = drop;
    const std::vector<SprayDrop> drops = drops_at(of, 7.0);
    for (const SprayDrop& drop : drops) largest = std::max(largest, drop.section_m2);
    std::size_t seen = 0;
    for (const SprayDrop& drop : drops) {
        EXPECT_GT(drop.width_m, 0.0);
        if (std::max(std::abs(drop.position_m.x), std::abs(drop.position_m.y)) > 23.9)
            continue;  // the square's border
        if (!before.contains(drop.id) || !behind.contains(drop.id)) {
            EXPECT_LT(drop.section_m2, 0.02 * largest);
            continue;
        }
        ++seen;
        const glm::dvec3 moved = (behind[drop.id].position_m - before[drop.id].position_m) / (2.0 * kStep_s);
        EXPECT_LT(glm::length(moved - drop.velocity_mps), 1e-3);
        EXPECT_LT(std::abs(behind[drop.id].section_m2 - drop.section_m2), 0.05 * largest);
    }
    EXPECT_GT(seen, drops.size() * 9 / 10);
}

TEST(SprayDrops, AreFiniteOrNone) {
    struct Case {
        const char* what;
        bool is_empty;
        void (*change)(Scene&);
    };
    for (const Case& each : {
             Case{"no wind", true, [](Scene& s) { s.sea.wind_speed_mps = 0.0; }},
             Case{"little wind", true, [](Scene& s) { s.sea.wind_speed_mps = 7.0; }},
             Case{"no whitecaps", true, [](Scene& s) { s.effects.whitecaps = false; }},
             Case{"none of them", true, [](Scene& s) { s.effects.whitecap_amount = 0.0; }},
             Case{"no spray", true, [](Scene& s) { s.effects.spray = false; }},
             Case{"no drops", true, [](Scene& s) { s.effects.spray_drops = false; }},
             Case{"bubbles' alone", true, [](Scene& s) { s.effects.spray_law = SpraySource::Monahan1986; }},
             Case{"no gain", true, [](Scene& s) { s.effects.spray_gain = 0.0; }},
             Case{"most gain", false, [](Scene& s) { s.effects.spray_gain = 1e6; }},
             Case{"foam everywhere", false, [](Scene& s) { s.effects.whitecap_amount = 100.0; }},
             Case{"a storm", false, [](Scene& s) { s.sea.wind_speed_mps = 80.0; }},
             Case{"no choppiness", false, [](Scene& s) { s.waves.choppiness = 0.0; }},
             Case{"shallow", false, [](Scene& s) { s.sea.depth_m = 0.01; }},
             Case{"a tiny patch", false, [](Scene& s) { s.surface.size_m = 0.01; }},
             Case{"a huge patch", false, [](Scene& s) { s.surface.size_m = 1e4; }},
             Case{"a short loop", false, [](Scene& s) { s.shot.loop_s = 1.0 / 24.0; }},
             Case{"no loop", false, [](Scene& s) { s.shot.loop_s = 0.0; }},
         }) {
        SCOPED_TRACE(each.what);
        Scene scene = drops_scene();
        scene.shot.loop_s = 0.5;  // whose two seas are soon computed
        each.change(scene);
        SprayDrops<float> of = drops_over(scene);
        EXPECT_EQ(of.empty(), each.is_empty);
        for (const double time_s : {scene.shot.loop_s > 0.0 ? 0.0 : -1e6, 1e12}) {
            const std::vector<SprayDrop> drops = drops_at(of, time_s);
            EXPECT_TRUE(!each.is_empty || drops.empty());
            EXPECT_LT(drops.size(), 4000000u);
            for (const SprayDrop& drop : drops) {
                ASSERT_TRUE(std::isfinite(glm::dot(drop.position_m, drop.position_m)));
                ASSERT_TRUE(std::isfinite(glm::dot(drop.velocity_mps, drop.velocity_mps)));
                ASSERT_GT(drop.width_m, 0.0);
                ASSERT_GT(drop.section_m2, 0.0);
                ASSERT_TRUE(std::isfinite(drop.section_m2));
            }
        }
    }
}

}  // namespace
}  // namespace pelagic
