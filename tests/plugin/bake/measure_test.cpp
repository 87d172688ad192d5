// The bytes of points and results that a plan promises are those that a bake's frame holds.
#include "plugin/bake/measure.h"
#include "core/plan/fingerprint.h"

#include <gtest/gtest.h>

#include "plugin/bake/sequence.h"

namespace pelagic {
namespace {

std::size_t size_of_values(const Values& values) {
    std::size_t bytes = 0;
    for (const ProductRow& row : kProductTable)
        bytes += values.size(row.product) * row.components * sizeof(float);
    return bytes;
}

Scene small() {
    Scene scene;
    scene.waves.cascades = {{40.0, 32}};
    scene.effects.foam_decay_s = 0.0;  // an item of its own
    scene.surface.size_m = 40.0;
    scene.surface.resolution = 32;
    scene.output.maps = {MapKind::Displacement, MapKind::Whitecaps};
    scene.output.map_resolution = 16;
    return scene;
}

// 33² vertices and 16² texels, two numbers each, once; the mesh's 13 numbers a vertex, the maps' 3 and 4 a
// texel.
TEST(Measure, PromisesTheBytesThatAFrameHolds) {
    const Scene scene = small();
    const Plan plan = plan_bake(scene);
    FrameSlot slot;
    make_sequence(plan)->compute(1, slot);
    std::size_t results = 0;
    for (const auto& output : slot.outputs) results += size_of_values(output->values);
    const std::size_t vertices = 33 * 33, texels = 16 * 16;
    EXPECT_EQ(results, 4 * (vertices * 13 + texels * (3 + 4)));
    EXPECT_EQ(plan.output_bytes(), results + 4 * 2 * (vertices + texels));
}

// Of all outputs.
std::string fingerprints(const Plan& plan) {
    std::string all;
    for (const PlannedOutput& output : plan.outputs) all += output_fingerprint(plan, output) + " ";
    return all;
}

// What changes an output's numbers is work, also where transforms and products stay.
TEST(Measure, KnowsWhatABakeDoesWithout) {
    Scene scene = small();
    scene.effects.foam_decay_s = 4.0;
    scene.sea.gust_strength = 0.3;
    const Plan whole = plan_bake(scene);
    std::vector<std::string> same;
    for (const MeasureItem& item : measure_items(scene))
        if (same_work(whole, plan_bake(item.without))) same.push_back(item.name);
    EXPECT_EQ(same, std::vector<std::string>{"foam structure"});
    Scene dry = scene;
    dry.effects.foam_decay_s = 0.0;
    EXPECT_GT(cost_of(whole).frame_bytes, cost_of(plan_bake(dry)).frame_bytes) << "the foam's history";
}

TEST(Measure, TakesAwayOneThingAtATime) {
    Scene scene = small();
    scene.output.cascade_tiles = true;
    const std::int64_t whole = cost_of(plan_bake(scene)).transforms;
    for (const MeasureItem& item : measure_items(scene)) {
        const Plan without = plan_bake(item.without);
        EXPECT_LE(without.transforms_per_frame(), whole) << item.name;
        EXPECT_EQ(fingerprints(without) == fingerprints(plan_bake(scene)), item.name == "foam structure")
            << item.name << ", of which a bake has nothing";
    }
    scene.output.maps = {MapKind::Whitecaps};
    for (const MeasureItem& item : measure_items(scene))
        if (item.name == "whitecaps") {
            EXPECT_TRUE(item.without.output.maps.empty());
            EXPECT_FALSE(item.without.output.cascade_tiles);
        }
}

// Each item is measured, within its pairs; what changes nothing isn't.
TEST(Measure, MeasuresEachItemOnce) {
    Scene scene = small();
    scene.output.attributes = {MeshAttribute::Normal};
    scene.output.maps = {};
    std::vector<Measured> rows;
    int last = -1;
    MeasureOptions options{
        .seconds_an_item = 0.0, .least_pairs = 2, .most_pairs = 4, .progress = {}, .measured = {}};
    options.progress = [&](const MeasureProgress& now) {
        EXPECT_GE(now.item, last);
        EXPECT_EQ(now.items, 6);
        EXPECT_GE(now.seconds_left, 0.0);
        last = now.item;
    };
    options.measured = [&](const Measured& row) { rows.push_back(row); };
    const Measured whole = measure(scene, options);
    ASSERT_EQ(rows.size(), 6u);
    EXPECT_EQ(rows[0].name, "mesh");
    EXPECT_EQ(rows[1].name, "mesh normal");
    EXPECT_EQ(rows[2].name, "horizontal displacement");
    EXPECT_EQ(rows[3].name, "second order");
    EXPECT_EQ(rows[4].name, "whitecaps");
    for (int i = 0; i < 4; ++i) EXPECT_EQ(rows[i].pairs, 2) << rows[i].name;
    EXPECT_EQ(rows[4].pairs, 0) << "on, but nothing asks for them";
    EXPECT_EQ(whole.pairs, 8);
    EXPECT_GT(whole.compute.median, 0.0);
}

}  // namespace
}  // namespace pelagic
