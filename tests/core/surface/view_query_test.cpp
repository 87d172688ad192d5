// The levels of footprints for points at all distances, and the query at the projected grid's points.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "core/evaluate/values.h"
#include "core/plan/plan.h"
#include "core/plan/products.h"
#include "core/scene/validate.h"
#include "core/surface/projected_grid.h"

namespace pelagic {
namespace {

Scene scene_of_two_tiles() {
    Scene scene;
    scene.waves.cascades = {{.size_m = 400.0, .resolution = 128}, {.size_m = 80.0, .resolution = 128}};
    scene.camera.resolution = {320, 180};
    EXPECT_TRUE(validate(scene).empty());
    return scene;
}

Values ask(const Frame<float>& frame, const Points<float>& points) {
    Values answers;
    const ProductSet held = frame.sea().plan().queries.front().query.products;
    QueryRunner<float>().run(frame, 0, points, held & ~lasting_products(), answers);
    return answers;
}

Frame<float> frame_of(const Scene& scene, const Query& query) {
    Frame<float> frame(std::make_shared<const Sea<float>>(make_plan(scene, {query})));
    frame.set(7.25);
    return frame;
}

Points<float> points_of_grid(const ProjectedGrid& grid) {
    return {.origin_m = grid.origin_m,
            .count = grid.rest_m.size(),
            .rest_m = {grid.rest_m.data()},
            .cell_m = {grid.cell_m.data()},
            .pixel_m = {grid.pixel_m.data()},
            .cell_axis_m = {grid.cell_axis_m.data()},
            .pixel_axis_m = {grid.pixel_axis_m.data()}};
}

TEST(ViewQuery, DoublesFromTheFinestUpToWhereNothingPasses) {
    const Scene scene = scene_of_two_tiles();
    for (const double finest_m : {0.0, 0.01, 0.7, 90.0}) {
        const Query query =
            view_query(*prepare(scene), {.finest_cell_m = 5.0 * finest_m, .finest_pixel_m = finest_m});
        // The first level is the power of two nearest to the finest footprint, or the one below 80/64/4 m, whatever
        // is coarser: finer than that nothing changes.
        const double first_m =
            std::max(finest_m > 0.0 ? std::exp2(std::round(std::log2(finest_m))) : 0.0, 0.25);
        const std::size_t first = finest_m > 0.0 ? 0 : 1;  // after the level that filters nothing
        EXPECT_EQ(query.pixel_m.front(), finest_m > 0.0 ? first_m : 0.0);
        EXPECT_EQ(query.pixel_m[first], first_m);
        for (std::size_t i = first + 1; i < query.pixel_m.size(); ++i)
            EXPECT_EQ(query.pixel_m[i], 2.0 * query.pixel_m[i - 1]);
        // Footprints that cells ask for lie between their first level and the next, or below the first of all.
        EXPECT_LE(query.cell_m.front(), std::max(1.5 * 5.0 * finest_m, 0.25));
        EXPECT_TRUE(std::equal(query.cell_m.rbegin(), query.cell_m.rend(), query.pixel_m.rbegin()));
        const Plan plan = make_plan(scene, {query});
        const std::vector<int>& levels = plan.queries[0].pixel_levels;
        for (const CascadePlan& cascade : plan.cascades) EXPECT_EQ(cascade.grid_of_level[levels.back()], -1);
        // One level earlier some waves still pass.
        EXPECT_GE(plan.cascades[0].grid_of_level[levels[levels.size() - 2]], 0);
    }
}

// Footprints that pass every mode of a cascade share a grid: one for the cells, and one of fewer nodes for the light.
TEST(ViewQuery, RunsNoTransformTwice) {
    const Scene scene = scene_of_two_tiles();
    const Plan plan = make_plan(scene, {view_query(*prepare(scene))});
    for (const CascadePlan& cascade : plan.cascades) {
        // By hand: the shortest wave is 1/64 of the tile, or at the band's end. Footprints up to a quarter of
        // it pass every mode.
        const double shortest_m =
            cascade.size_m / std::min(64.0, cascade.k_upper * cascade.size_m / 6.283185307);
        std::size_t unfiltered = 0;
        std::array<int, 2> shared{-1, -1};  // of cells, of light
        for (std::size_t l = 0; l < plan.levels.size(); ++l) {
            if (plan.levels[l].footprint_m > 0.95 * shortest_m / 4.0) continue;
            ++unfiltered;
            int& grid = shared[plan.levels[l].is_of_light ? 1 : 0];
            if (grid < 0) grid = cascade.grid_of_level[l];
            EXPECT_EQ(cascade.grid_of_level[l], grid);
        }
        EXPECT_GE(unfiltered, 2u);
        EXPECT_LT(cascade.grids.size(), plan.levels.size() - unfiltered + 2);
        ASSERT_TRUE(shared[0] >= 0 && shared[1] >= 0);
        const Grid &cells = cascade.grids[shared[0]], &light = cascade.grids[shared[1]];
        EXPECT_LT(light.resolution, cells.resolution);
        EXPECT_EQ(cells.fields | light.fields, fields_of(plan.queries[0].query.products));
    }
    // The first tile's band ends at 20 modes: several levels are below its waves.
    EXPECT_EQ(plan.cascades[0].grid_of_level[0], plan.cascades[0].grid_of_level[3]);
}

// On one of the levels a query equals a plan of that footprint alone, up to rounding.
TEST(ViewQuery, OnALevelAnswersAsAPlanOfThatFootprintAlone) {
    const Scene scene = scene_of_two_tiles();
    const Query levels = view_query(*prepare(scene));
    const Frame<float> frame = frame_of(scene, levels);
    std::vector<glm::vec2> rest;
    for (int i = 0; i < 200; ++i)
        rest.emplace_back(1.37f * static_cast<float>(i), 0.61f * static_cast<float>(i % 37));
    for (const std::size_t level :
         {std::size_t(0), std::size_t(1), std::size_t(4), levels.pixel_m.size() - 2}) {
        const auto footprint_m = static_cast<float>(levels.pixel_m[level]);
        const std::vector<float> footprints(rest.size(), footprint_m);
        Query alone = levels;
        alone.cell_m = alone.pixel_m = {static_cast<double>(footprint_m)};
        const Points<float> points{.count = rest.size(), .rest_m = {rest.data()}};
        Points<float> varied = points;
        varied.cell_m = varied.pixel_m = {footprints.data()};
        const Values a = ask(frame, varied), b = ask(frame_of(scene, alone), points);
        for (std::size_t i = 0; i < rest.size(); ++i) {
            // Single precision: heights of 3 m, sums of thousands of modes.
            EXPECT_LE(glm::length(a.vectors(Product::Position)[i] - b.vectors(Product::Position)[i]), 2e-5f)
                << "level " << level;
            EXPECT_LE(glm::length(a.vectors(Product::Normal)[i] - b.vectors(Product::Normal)[i]), 2e-5f)
                << "level " << level;
            EXPECT_LE(
                glm::length(a.vectors(Product::SlopeVariance)[i] - b.vectors(Product::SlopeVariance)[i]),
                1e-6f)
                << "level " << level;
        }
    }
}

// A camera shifted by whole periods of every tile sees the same sea, up to rounding, even 1e6 m away.
TEST(ViewQuery, FarFromTheOriginTheSeaIsAsGood) {
    Scene scene = scene_of_two_tiles();
    scene.waves.tiling = Tiling::Periodic;
    const auto seen = [&](glm::dvec3 shift_m) {
        Scene moved = scene;
        moved.camera.position_m += shift_m;
        moved.camera.look_at_m += shift_m;
        ProjectedGridOptions options = projected_grid_options(*prepare(scene));
        return projected_grid(view_at(moved.camera, 1.0), options);
    };
    const Frame<float> frame = frame_of(scene, view_query(*prepare(scene)));
    const ProjectedGrid here = seen(glm::dvec3(0.0)), there = seen({1e6, -2e6, 0.0});
    ASSERT_EQ(here.rest_m.size(), there.rest_m.size());
    const Values a = ask(frame, points_of_grid(here)), b = ask(frame, points_of_grid(there));
    double waves_m2 = 0.0;
    for (std::size_t i = 0; i < here.rest_m.size(); ++i) {
        const glm::vec2 rest = here.rest_m[i];
        // The grids differ by the rounding of 2e6 m in double, 2e-10 m, and by a unit in the last place of
        // single precision. Such a unit in the position changes the height along slopes of up to 1.
        const float digit = 4e-7f * (1.0f + glm::length(rest));
        EXPECT_LE(glm::length(rest - there.rest_m[i]), digit);
        if (glm::length(rest) > 1000.0f) continue;  // beyond, rounding exceeds the resolved waves
        EXPECT_LE(glm::length(a.vectors(Product::Position)[i] - b.vectors(Product::Position)[i]),
                  3.0f * digit + 3e-5f);
        EXPECT_LE(glm::length(a.vectors(Product::Normal)[i] - b.vectors(Product::Normal)[i]),
                  5.0f * digit + 3e-5f);
        waves_m2 += std::pow(static_cast<double>(a.vectors(Product::Position)[i].z), 2);
    }
    EXPECT_GT(waves_m2, 1.0);
    for (const Values* answers : {&a, &b})
        for (std::size_t i = 0; i < here.rest_m.size(); ++i) {
            const glm::vec3 p = answers->vectors(Product::Position)[i],
                            n = answers->vectors(Product::Normal)[i],
                            s = answers->vectors(Product::SlopeVariance)[i];
            ASSERT_TRUE(std::isfinite(p.x + p.y + p.z + n.x + n.y + n.z + s.x + s.y + s.z +
                                      answers->numbers(Product::Breaking)[i]));
        }
}

// At the horizon all waves are unresolved: a flat sea with the slope variance of the whole spectrum.
TEST(ViewQuery, AtTheHorizonAllIsVariance) {
    Scene scene = scene_of_two_tiles();
    scene.surface.earth_curvature =
        false;  // the last row of a round one has the crests that rise over the horizon
    const Frame<float> frame = frame_of(scene, view_query(*prepare(scene)));
    const ProjectedGrid grid =
        projected_grid(view_at(scene.camera, 1.0), projected_grid_options(*prepare(scene)));
    const Values answers = ask(frame, points_of_grid(grid));
    const SpectralMoments& whole = frame.sea().total();
    for (std::size_t i = answers.vectors(Product::Position).size() - grid.columns - 1;
         i < answers.vectors(Product::Position).size(); ++i) {
        EXPECT_EQ(answers.vectors(Product::Position)[i].z, 0.0f);
        // A pixel there is an ellipse of finite length. What of the slopes across it is left, of 0.2 in all, no eye sees.
        EXPECT_LT(glm::length(glm::vec2(answers.vectors(Product::Normal)[i])), 4e-3);
        // What ellipses hide is an integral over the spectrum, and the whole a sum of modes. It rides on what is left of
        // the gradient across.
        EXPECT_NEAR(answers.vectors(Product::SlopeVariance)[i].x, whole.xx, 1e-2 * whole.xx);
        EXPECT_NEAR(answers.vectors(Product::SlopeVariance)[i].y, whole.yy, 1e-2 * whole.yy);
    }
}

// Ten thousand points of a realisation stay within the bounds, and come within a factor of three: the bounds
// are five deviations, and ten thousand correlated points reach about 3.7.
TEST(Extent, HoldsTheSeaAndNotMuchMore) {
    Scene scene = scene_of_two_tiles();
    scene.sea.depth_m = 12.0;  // horizontal reach exceeds the vertical one there
    const Extent extent = prepare(scene)->extent;
    Query query;
    query.name = "points";
    query.products = products(Product::Displacement);
    const Frame<float> frame = frame_of(scene, query);
    std::vector<glm::vec2> rest;
    for (int i = 0; i < 10000; ++i)
        rest.emplace_back(4.0f * static_cast<float>(i % 100), 4.0f * static_cast<float>(i / 100));
    std::vector<glm::vec3> moved(rest.size());
    Results<float> results;
    results.set(Product::Displacement, {moved.data()});
    evaluate(frame, 0, Points<float>{.count = rest.size(), .rest_m = {rest.data()}}, results);
    double height_m = 0.0, reach_m = 0.0;
    for (const glm::vec3& d : moved) {
        height_m = std::max(height_m, static_cast<double>(std::abs(d.z)));
        reach_m = std::max(reach_m, static_cast<double>(std::hypot(d.x, d.y)));
    }
    EXPECT_LT(height_m, extent.height_m);
    EXPECT_GT(height_m, extent.height_m / 3.0);
    EXPECT_LT(reach_m, extent.reach_m);
    EXPECT_GT(reach_m, extent.reach_m / 3.0);
    EXPECT_GT(extent.reach_m, extent.height_m);
    // Crests are higher than those of the waves alone.
    EXPECT_GT(extent.height_m, extent.significant_height_m * kExtentDeviations / 4.0);
    scene.waves.second_order = 0.0;
    const Extent first = prepare(scene)->extent;
    EXPECT_DOUBLE_EQ(first.significant_height_m, first.height_m * 4.0 / kExtentDeviations);
    EXPECT_EQ(first.significant_height_m, extent.significant_height_m);
    EXPECT_EQ(frame.sea().extent().reach_m, extent.reach_m);
    scene.sea.wind_speed_mps = 0.0;
    EXPECT_EQ(prepare(scene)->extent.height_m, 0.0);
    EXPECT_EQ(prepare(scene)->extent.reach_m, 0.0);
}

// From calm to hurricane, in a puddle and over an abyss, up to looping crests: the bounds stay usable.
TEST(Extent, HardCasesStayFinite) {
    for (const double wind_mps : {0.0, 0.1, 80.0})
        for (const double depth_m : {0.01, 10.0, 1e9})
            for (const double choppiness : {0.0, 1.0, 10.0}) {
                Scene scene;
                scene.sea.wind_speed_mps = wind_mps;
                scene.sea.depth_m = depth_m;
                scene.waves.choppiness = choppiness;
                const Extent extent = prepare(scene)->extent;
                EXPECT_TRUE(std::isfinite(extent.height_m) && std::isfinite(extent.reach_m));
                EXPECT_EQ(extent.height_m > 0.0, wind_mps > 0.0);
                EXPECT_EQ(extent.reach_m > 0.0, wind_mps > 0.0 && choppiness > 0.0);
                const ProjectedGridNeeds needs =
                    projected_grid_needs(view_at(scene.camera, 1.0), projected_grid_options(*prepare(scene)));
                EXPECT_TRUE(std::isfinite(needs.finest_cell_m) && needs.finest_cell_m > 0.0);
                EXPECT_TRUE(std::isfinite(needs.finest_pixel_m) && needs.finest_pixel_m > 0.0);
            }
}

// The trains don't depend on how near a camera is: they are those of the bake.
TEST(ViewQuery, DoesNotDecideWhichTrainsThereAre) {
    Scene scene;
    scene.waves.model = WaveModel::Trochoid;
    const Plan baked = plan_bake(scene);
    for (const double finest_pixel_m : {0.0, 1e-4, 0.1, 10.0}) {
        const Plan seen = make_plan(scene, {view_query(*prepare(scene), {.finest_pixel_m = finest_pixel_m})});
        EXPECT_EQ(seen.trains->shortest_m, baked.trains->shortest_m) << finest_pixel_m;
        EXPECT_EQ(seen.trains->longest_m, baked.trains->longest_m) << finest_pixel_m;
    }
}

}  // namespace
}  // namespace pelagic
