// The same scene gives the same bits, for any number of threads and any order of frames. The transforms
// executed are those that the plan promises.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <stdexcept>
#include <vector>

#include "tests/core/waves/samples.h"

namespace pelagic {
namespace {

using namespace test;

template <class V>
bool same_bytes(const std::vector<V>& a, const std::vector<V>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(V)) == 0;
}
void expect_same_bits(const ProductArrays<float>& a, const ProductArrays<float>& b, const char* what) {
    for (const ProductRow& row : kProductTable) {
        if (lasting_products()[index(row.product)]) continue;
        ASSERT_GT(a.size(row.product), 0u) << row.name;
        if (row.components == 1) {
            const auto product = NumberProduct::checked(row.product);
            EXPECT_TRUE(same_bytes(a.numbers(product), b.numbers(product))) << what << ": " << row.name;
        } else {
            const auto product = VectorProduct::checked(row.product);
            EXPECT_TRUE(same_bytes(a.vectors(product), b.vectors(product))) << what << ": " << row.name;
        }
    }
}

Scene windy_sea() {
    Scene scene;
    scene.sea.wind_speed_mps = 14.0;
    scene.sea.swell = {{.height_m = 1.0, .period_s = 11.0, .direction_deg = 80.0}};
    return scene;
}
Query everything() {
    return filtered(~lasting_products(), 0.8);
}

// Who gives a field's samples back has read them for the last time.
TEST(Frame, ThatGaveSamplesBackTakesNoTime) {
    const auto sea = std::make_shared<const Sea<float>>(make_plan(windy_sea(), {everything()}));
    Frame<float> frame(sea);
    frame.set(1.0);
    ASSERT_NE(frame.samples(0, 0, Field::Height), nullptr);
    frame.release(0, 0, Field::Height);
    EXPECT_EQ(frame.samples(0, 0, Field::Height), nullptr);
    EXPECT_NE(frame.samples(0, 0, Field::SlopeX), nullptr);
    EXPECT_THROW(frame.set(2.0), std::logic_error);
    // Planes lie side by side: what one gives back takes nothing of the others.
    Frame<float> whole(sea);
    whole.set(1.0);
    const std::vector<CascadePlan>& cascades = sea->plan().cascades;
    std::vector<std::size_t> pages;
    for (std::size_t c = 0; c < cascades.size(); ++c)
        for (std::size_t g = 0; g < cascades[c].grids.size(); ++g)
            for (std::size_t f = 0; f < kFieldCount; f += 2)
                if (cascades[c].grids[g].fields[f]) {
                    pages.push_back(grid_bytes(cascades[c].grids[g].resolution, false) / 4096);
                    frame.release(static_cast<int>(c), static_cast<int>(g), static_cast<Field>(f));
                }
    EXPECT_GT(*std::ranges::max_element(pages), 2u);
    for (std::size_t c = 0; c < cascades.size(); ++c)
        for (std::size_t g = 0; g < cascades[c].grids.size(); ++g)
            for (std::size_t f = 1; f < kFieldCount; f += 2) {
                const auto field = static_cast<Field>(f);
                const float* const kept = frame.samples(static_cast<int>(c), static_cast<int>(g), field);
                if (!kept) continue;
                const int n = cascades[c].grids[g].resolution;
                EXPECT_EQ(std::memcmp(kept, whole.samples(static_cast<int>(c), static_cast<int>(g), field),
                                      static_cast<std::size_t>(n) * line_stride<float>(n) * sizeof(float)),
                          0)
                    << c << ' ' << g << ' ' << f;
            }
}

TEST(Threads, ChangeNoBit) {
    const auto points = random_points<float>(300.0, 5000);
    const auto run = [&](std::size_t threads) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        return sample(frame_of<float>(windy_sea(), {everything()}, 0.25), 0,
                      points);  // Sea, Frame and query on the same threads
    };
    const auto alone = run(1);
    for (std::size_t threads : {2, 7}) expect_same_bits(alone, run(threads), "threads");
}

TEST(Frames, HaveNoTimeOnceCancelled) {
    const auto sea = std::make_shared<const Sea<float>>(make_plan(windy_sea(), {everything()}));
    const auto points = random_points<float>(300.0, 2000);
    Frame<float> alone(sea), stopped(sea);
    std::atomic<bool> cancel = true;
    stopped.set(0.5);
    EXPECT_THROW(stopped.set(0.25, &cancel), BuildCancelled);
    EXPECT_FALSE(stopped.is_set());
    cancel = false;
    stopped.set(0.25, &cancel);
    alone.set(0.25);
    expect_same_bits(sample(stopped, 0, points), sample(alone, 0, points), "after one that was cancelled");
}

TEST(Frames, DependOnTheirTimeAlone) {
    const auto sea = std::make_shared<const Sea<float>>(make_plan(windy_sea(), {everything()}));
    const auto points = random_points<float>(300.0, 2000);
    Frame<float> alone(sea), run(sea), backwards(sea);
    alone.set(6 / 24.0);
    const auto seventh = sample(alone, 0, points);
    for (int f = 1; f <= 7; ++f) {
        run.set((f - 1) / 24.0);
        backwards.set((13 - f) / 24.0);  // frames 13 … 7, in a second Frame beside the first
    }
    expect_same_bits(seventh, sample(run, 0, points), "after frames 1 to 6");
    expect_same_bits(seventh, sample(backwards, 0, points), "after frames 13 to 8");
    alone.set(100.0);
    expect_same_bits(seventh, sample(run, 0, points), "while another frame moved on");
}

TEST(Seeds, GiveOtherSeas) {
    Scene scene = windy_sea();
    const auto points = random_points<float>(300.0, 200);
    const auto one = sample(frame_of<float>(scene, {everything()}), 0, points);
    scene.shot.seed = 2;
    const auto two = sample(frame_of<float>(scene, {everything()}), 0, points);
    EXPECT_FALSE(same_bytes(one.vectors(Position), two.vectors(Position)));
    EXPECT_TRUE(same_bytes(one.vectors(SlopeVarianceAtRest),
                           two.vectors(SlopeVarianceAtRest)));  // an expectation, not of one seed
}

// The transforms of a shot, counted by hand for one cascade. The mesh alone has one grid, and two real fields
// share a transform.
//   position: η, Dx, Dy;  normal: both slopes and Dxx, Dyy, Dxy;  velocity: three;  coverage and slope variance: Dxx, Dyy,
//   Dxy (without choppiness coverage alone, for what would fold). A map of slope variances has them on each of its levels.
struct Count {
    const char* name;
    std::vector<MeshAttribute> attributes;
    bool whitecaps;
    double choppiness;
    std::vector<MapKind> maps;  // with the mesh's spacing, so that they share its grid
    int fields;
};

class TransformCount : public testing::TestWithParam<Count> {};

TEST_P(TransformCount, IsTheMinimumAndIsWhatRuns) {
    const Count& c = GetParam();
    Scene scene = first_order();
    scene.waves.choppiness = c.choppiness;
    scene.waves.cascades = {{200.0, 64}};
    scene.waves.tiling = Tiling::Periodic;  // copies' gradient needs more (RandomTiling)
    scene.effects.whitecaps = c.whitecaps;
    scene.surface.resolution = 64;
    scene.output.attributes = c.attributes;
    scene.output.maps = c.maps;
    scene.output.map_resolution = 64;
    const Plan plan = plan_bake(scene);
    EXPECT_EQ(plan.transforms_per_frame(), c.fields);
    // One transform for each mx below the radius, then two rows at a time.
    const Grid& grid = plan.cascades[0].grids[0];
    if (plan.cascades[0].grids.size() == 1) {
        EXPECT_EQ(plan.lines_per_frame(), c.fields * (grid.radius + grid.resolution / 2));
    }
    Frame<float> frame(std::make_shared<const Sea<float>>(plan));
    EXPECT_EQ(frame.executed_transforms(), 0);
    for (int i = 1; i <= 3; ++i) {
        frame.set(0.5 * i);
        EXPECT_EQ(frame.executed_transforms(), i * plan.transforms_per_frame());
        EXPECT_EQ(frame.executed_lines(), i * plan.lines_per_frame());
    }
}

constexpr auto kNormal = MeshAttribute::Normal;
constexpr auto kVelocity = MeshAttribute::Velocity;
constexpr auto kVariance = MeshAttribute::SlopeVariance;
constexpr auto kWhitecaps = MeshAttribute::Whitecaps;

INSTANTIATE_TEST_SUITE_P(
    Scenes, TransformCount,
    testing::Values(Count{"Everything", {kNormal, kVelocity, kVariance, kWhitecaps}, true, 1.0, {}, 11},
                    Count{"WhitecapsOff", {kNormal, kVelocity, kVariance, kWhitecaps}, false, 1.0, {}, 11},
                    Count{"PositionsAlone", {}, true, 1.0, {}, 3},
                    Count{"WhitecapsAlone", {kWhitecaps}, true, 1.0, {}, 6},
                    Count{"WhitecapsAloneOff", {kWhitecaps}, false, 1.0, {}, 3},
                    Count{"VelocityAlone", {kVelocity}, true, 1.0, {}, 6},
                    Count{"VarianceAlone", {kVariance}, true, 1.0, {}, 6},
                    Count{"NormalAlone", {kNormal}, true, 1.0, {}, 8},
                    Count{"CalmPositions", {}, true, 0.0, {}, 1},
                    Count{"CalmNormals", {kNormal}, true, 0.0, {}, 3},
                    Count{"CalmVelocity", {kVelocity}, true, 0.0, {}, 2},
                    Count{"CalmWhitecaps", {kWhitecaps}, true, 0.0, {}, 4},
                    Count{"CalmEverything", {kNormal, kVelocity, kVariance, kWhitecaps}, true, 0.0, {}, 7},
                    Count{"NormalMap", {}, true, 1.0, {MapKind::Normal}, 8},
                    Count{"DisplacementMap", {}, true, 1.0, {MapKind::Displacement}, 3},
                    Count{"WhitecapsMap", {}, true, 1.0, {MapKind::Whitecaps}, 6},
                    Count{"SlopeVarianceMap", {}, true, 1.0, {MapKind::SlopeVariance}, 3 + 3 * 5}),
    [](const auto& instance) { return std::string(instance.param.name); });

// Larger shots, whose minimum isn't counted by hand: executed transforms equal planned ones.
TEST(ExecutedTransforms, AreThePlansOwnForWholeShots) {
    for (bool tiles : {false, true})
        for (bool whitecaps : {false, true})
            for (int map_resolution : {32, 96}) {
                Scene scene;
                scene.effects.whitecaps = whitecaps;
                scene.surface.resolution = 48;
                scene.output.cascade_tiles = tiles;
                scene.output.map_resolution = map_resolution;
                scene.output.maps = {MapKind::Displacement, MapKind::Normal};
                const Plan plan = plan_bake(scene);
                EXPECT_GT(plan.transforms_per_frame(), 0);
                Frame<float> frame(std::make_shared<const Sea<float>>(plan));
                for (double t : {0.0, 1.0, 1.0}) frame.set(t);
                EXPECT_EQ(frame.executed_transforms(), 3l * plan.transforms_per_frame());
            }
}

}  // namespace
}  // namespace pelagic
