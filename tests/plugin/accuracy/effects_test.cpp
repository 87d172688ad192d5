// An effect that is off costs nothing: over the table of effects, a shot in which it was turned off is, in transforms and
// bytes, one that never had it.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <functional>
#include <string>
#include <vector>

#include "core/plan/effects.h"
#include "plugin/bake/measure.h"
#include "plugin/bake/sequence.h"
#include "plugin/render/render.h"

namespace pelagic {
namespace {

// Without any effect, but with the numbers that they would have.
Scene without_effects() {
    Scene scene;
    scene.shot.last_frame = 3;
    scene.sea.wind_speed_mps = 16.0;
    scene.surface.resolution = 32;
    scene.surface.size_m = 80.0;
    scene.waves.cascades = {{400.0, 128}, {60.0, 64}};
    scene.waves.choppiness = 0.0;
    scene.camera.resolution = {24, 14};
    scene.output.maps = {MapKind::Displacement, MapKind::Normal};
    scene.output.map_resolution = 16;
    scene.waves.second_order = 0.0;
    scene.effects.whitecaps = false;
    scene.effects.foam_decay_s = 0.0;
    scene.effects.foam_structure = 0.0;
    scene.sea.depth_file = "bay.exr";  // the floor that a coast feels is no part of it
    return scene;
}

struct Switch {
    const char* name;
    void (*turn_on)(Scene&);
};
// A new effect needs its line here.
constexpr auto kSwitches = std::to_array<Switch>({
    {"horizontal displacement", [](Scene& scene) { scene.waves.choppiness = 1.1; }},
    {"second order", [](Scene& scene) { scene.waves.second_order = 1.0; }},
    {"whitecaps",
     [](Scene& scene) {
         scene.effects.whitecaps = true;
         scene.output.maps.push_back(MapKind::Whitecaps);
     }},
    {"living foam", [](Scene& scene) { scene.effects.foam_decay_s = 3.0; }},
    {"foam structure", [](Scene& scene) { scene.effects.foam_structure = 0.8; }},
    {"spray",
     [](Scene& scene) {
         scene.effects.spray = true;
         scene.effects.spray_gain = 10.0;
     }},
    {"gusts", [](Scene& scene) { scene.sea.gust_strength = 0.4; }},
    {"wakes", [](Scene& scene) { scene.waves.vessels = {{}}; }},
    {"calm and rough places",
     [](Scene& scene) { scene.waves.masks = {{.waves = 0.5, .ripples = 0.0, .foam = 0.5}}; }},
    {"tiles on a coast",
     [](Scene& scene) {
         scene.waves.coast = true;
         scene.waves.coast_depths = std::make_shared<const DepthMap>(
             glm::ivec2(2, 1), std::vector{3.0f, 4.0f}, glm::dvec2(), glm::dvec2(40.0, 20.0));
     }},
});

Scene with_all_but(const std::string& name) {
    Scene scene = without_effects();
    for (const Switch& effect : kSwitches)
        if (name != effect.name) effect.turn_on(scene);
    return scene;
}

// Everything that a bake and a picture of the shot plan, and what a frame of the bake then executes.
std::vector<std::int64_t> costs_of(const Scene& scene) {
    const Plan bake = plan_bake(scene);
    const std::array frames{1, 2};
    const RenderOptions options = render_options(scene);
    const Plan picture = picture_plan(scene, frames, options);
    std::vector<std::int64_t> costs;
    for (const Plan* plan : {&bake, &picture}) {
        const PlanCost cost = cost_of(*plan);
        costs.insert(costs.end(), {cost.transforms, cost.lines, cost.sea_bytes, cost.frame_bytes,
                                   cost.output_bytes, static_cast<std::int64_t>(plan->foam_history_bytes())});
    }
    costs.push_back(static_cast<std::int64_t>(render_memory(scene, options, frames, {}, 1).bytes()));
    FrameSlot slot;
    const auto sequence = make_sequence(bake);
    sequence->compute(1, slot);
    costs.push_back(sequence->executed_transforms());
    EXPECT_EQ(sequence->executed_transforms(), bake.transforms_per_frame());
    return costs;
}

// Nothing that the table says to be gone is computed, but for the gradients that break, which foam has of its own.
void expect_gone(const Plan& plan, const EffectRow& row) {
    const FieldSet gone =
        row.fields & ~(plan.from->scene.effects.whitecaps ? displacement_gradient_fields() : FieldSet());
    for (const CascadePlan& cascade : plan.cascades)
        for (const Grid& grid : cascade.grids) EXPECT_TRUE((grid.fields & gone).none());
    for (const PlannedQuery& planned : plan.queries)
        EXPECT_TRUE((planned.query.products & row.products).none()) << planned.query.name;
}

TEST(AccuracyEffects, WhatIsOffCostsNothing) {
    ASSERT_EQ(kSwitches.size(), effect_table().size());
    const Scene whole = with_all_but("");
    const std::vector<std::int64_t> all = costs_of(whole);
    for (const EffectRow& row : effect_table()) {
        SCOPED_TRACE(row.name);
        EXPECT_TRUE(row.is_on(whole));
        Scene off = whole;
        row.turn_off(off);
        EXPECT_FALSE(row.is_on(off));
        EXPECT_FALSE(row.is_on(with_all_but(row.name)));
        expect_gone(plan_bake(off), row);
        expect_gone(picture_plan(off, std::array{1}, render_options(off)), row);
        const std::vector<std::int64_t> costs = costs_of(off);
        EXPECT_EQ(costs, costs_of(with_all_but(row.name)));
        for (std::size_t i = 0; i < costs.size(); ++i) EXPECT_LE(costs[i], all[i]) << i;
    }
    Scene bare = whole;
    for (const EffectRow& row : effect_table()) row.turn_off(bare);
    EXPECT_EQ(costs_of(bare), costs_of(without_effects()));
}

// What an effect that is off would have had for its numbers is no matter.
TEST(AccuracyEffects, NumbersOfWhatIsOffCostNothing) {
    const std::vector<std::int64_t> bare = costs_of(without_effects());
    Scene calm = without_effects();
    calm.effects.foam_decay_s = 9.0;
    calm.effects.foam_structure = 1.0;
    calm.effects.foam_streaks = 1.0;
    calm.effects.spray = true;
    calm.effects.spray_gain = 100.0;
    EXPECT_EQ(costs_of(calm), bare) << "no whitecaps";
}

// Which costs an effect has: they fall when it goes, so that the tests above can tell.
TEST(AccuracyEffects, WhatIsOnCostsSomething) {
    constexpr std::size_t kBakeTransforms = 0, kBakeOutput = 4, kBakeHistory = 5, kPictureTransforms = 6,
                          kPictureHistory = 11, kPictureMemory = 12;
    struct Case {
        const char* name;
        std::vector<std::size_t> falls;
    };
    const std::vector<std::int64_t> all = costs_of(with_all_but(""));
    for (const Case& each : {Case{"horizontal displacement", {kBakeTransforms, kPictureTransforms}},
                             Case{"whitecaps", {kBakeOutput, kBakeHistory, kPictureHistory}},
                             Case{"living foam", {kBakeHistory, kPictureHistory}},
                             Case{"spray", {kPictureMemory}}, Case{"tiles on a coast", {kPictureMemory}}}) {
        const std::vector<std::int64_t> without = costs_of(with_all_but(each.name));
        for (const std::size_t i : each.falls) EXPECT_LT(without[i], all[i]) << each.name << ", " << i;
    }
}

}  // namespace
}  // namespace pelagic
