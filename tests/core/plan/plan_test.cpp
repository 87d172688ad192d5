// The closure: what is asked for is there, and nothing else.
#include "core/plan/plan.h"
#include "core/plan/fingerprint.h"

#include <gtest/gtest.h>
#include <algorithm>

#include "core/plan/products.h"
#include "core/plan/quality.h"
#include "core/scene/names.h"

namespace pelagic {
namespace {

FieldSet fields_of_plan(const Plan& plan) {
    FieldSet all;
    for (const CascadePlan& cascade : plan.cascades)
        for (const Grid& grid : cascade.grids) all |= grid.fields;
    return all;
}

Scene scene_with(std::vector<MeshAttribute> attributes) {
    Scene scene;
    scene.surface.resolution = 64;
    scene.output.attributes = std::move(attributes);
    return scene;
}

const FieldSet kPositions = fields(Field::Height, Field::Dx, Field::Dy);
const FieldSet kSlopes = fields(Field::SlopeX, Field::SlopeY);
const FieldSet kDisplacementGradients = fields(Field::Dxx, Field::Dyy, Field::Dxy);
const FieldSet kVelocities = fields(Field::VelocityX, Field::VelocityY, Field::VelocityZ);

TEST(Plan, HoldsTheFieldsOfWhatIsAskedForAndNoOthers) {
    using enum MeshAttribute;
    EXPECT_EQ(fields_of_plan(plan_bake(scene_with({}))), kPositions);
    EXPECT_EQ(fields_of_plan(plan_bake(scene_with({Normal}))), kPositions | kSlopes | kDisplacementGradients);
    EXPECT_EQ(fields_of_plan(plan_bake(scene_with({Velocity}))), kPositions | kVelocities);
    EXPECT_EQ(fields_of_plan(plan_bake(scene_with({Whitecaps}))), kPositions | kDisplacementGradients);
    EXPECT_EQ(fields_of_plan(plan_bake(scene_with({SlopeVariance}))),
              kPositions | kDisplacementGradients);  // an integral of the spectrum, and what carries it
}

TEST(Plan, HasNoJacobianWithoutWhitecapsNormalsAndSlopeVariance) {
    using enum MeshAttribute;
    Scene scene = scene_with({Velocity, Whitecaps});
    scene.effects.whitecaps = false;
    const Plan plan = plan_bake(scene);
    EXPECT_EQ(fields_of_plan(plan) & kDisplacementGradients, FieldSet());
    EXPECT_EQ(fields_of_plan(plan) & kSlopes, FieldSet());
    for (const PlannedQuery& planned : plan.queries) {
        EXPECT_FALSE(planned.query.products[index(Product::Coverage)]);
        EXPECT_FALSE(planned.query.products[index(Product::JacobianMoments)]);
    }
}

// But the gradient that waves would have, where somebody asks for foam. So little choppiness that nobody sees it is none.
TEST(Plan, HasNoHorizontalFieldsWithoutChoppiness) {
    const FieldSet level = fields(Field::Height, Field::VelocityZ) | kSlopes;
    for (const double choppiness : {0.0, 1e-12, 1e-6, 0.99 * Choppiness::kLeastShown}) {
        Scene scene = scene_with({MeshAttribute::Normal, MeshAttribute::Velocity});
        scene.waves.choppiness = choppiness;
        EXPECT_EQ(fields_of_plan(plan_bake(scene)), level);
        scene.output.attributes.push_back(MeshAttribute::Whitecaps);
        EXPECT_EQ(fields_of_plan(plan_bake(scene)), level | kDisplacementGradients);
        // And the page says so.
        const std::string page = explain(plan_bake(scene));
        EXPECT_NE(page.find("whitecap coverage  ← Dxx, Dyy, Dxy"), std::string::npos) << page;
        EXPECT_NE(page.find("as a choppiness of 0.01 would press them"), std::string::npos) << page;
    }
    Scene scene = scene_with({MeshAttribute::Normal, MeshAttribute::Velocity, MeshAttribute::Whitecaps});
    scene.waves.choppiness = Choppiness::kLeastShown;
    EXPECT_TRUE(fields_of_plan(plan_bake(scene))[index(Field::Dx)]);
    EXPECT_EQ(explain(plan_bake(scene)).find("would press them"), std::string::npos);
}

TEST(Plan, HasNothingToRunWithoutWindAndSwell) {
    Scene scene;
    scene.sea.wind_speed_mps = 0.0;
    const Plan plan = plan_bake(scene);
    EXPECT_EQ(plan.transforms_per_frame(), 0);
    EXPECT_EQ(plan.sea_bytes(), 0u);
    EXPECT_EQ(plan.frame_bytes(), 0u);
    for (const CascadePlan& cascade : plan.cascades) EXPECT_FALSE(cascade.why_empty.empty());
}

// Of all outputs, at the first frame.
std::string fingerprints(const Plan& plan) {
    std::string all;
    for (const PlannedOutput& output : plan.outputs)
        all += frame_fingerprint(plan, output, output_fingerprint(plan, output), 1) + " ";
    return all;
}

// The grid of the camera: its points are counted, its page says so, and its fingerprint knows the camera.
TEST(Plan, AProjectedGridIsPlannedForTheCamerasOwnShot) {
    Scene scene = scene_with({MeshAttribute::Normal});
    const auto with_camera_at = [&](double height_m) {
        scene.camera.position_m.z = height_m;
        return plan_bake(scene);
    };
    EXPECT_EQ(fingerprints(with_camera_at(4.0)), fingerprints(with_camera_at(5.0)));
    scene.surface.kind = SurfaceKind::ProjectedGrid;
    EXPECT_NE(fingerprints(with_camera_at(4.0)), fingerprints(with_camera_at(5.0)));
    const Plan plan = plan_bake(scene);
    const ProjectedGridNeeds needs =
        projected_grid_needs(view_at(scene.camera, 1), projected_grid_options(*prepare(scene)));
    EXPECT_EQ(plan.queries[0].query.points, points_of(needs.size));
    EXPECT_LE(plan.queries[0].query.pixel_m.front(), 1.4143 * needs.finest_cell_m);
    EXPECT_GE(1.4143 * plan.queries[0].query.pixel_m.front(), needs.finest_cell_m);
    EXPECT_FALSE(plan.queries[0].query.lattice);
    EXPECT_NE(explain(plan).find(std::to_string(needs.size.columns) + " × " +
                                 std::to_string(needs.size.rows) + " quads"),
              std::string::npos);
    // Higher up the finest cell is larger: fewer waves are computed.
    EXPECT_LT(with_camera_at(500.0).lines_per_frame(), plan.lines_per_frame());
    // Without a mesh the camera is the root's alone.
    scene.output.mesh = MeshFormat::None;
    scene.output.maps = {MapKind::Normal};
    EXPECT_EQ(fingerprints(with_camera_at(4.0)), fingerprints(with_camera_at(5.0)));
}

TEST(Plan, SharesAGridBetweenQueriesOfOneFootprint) {
    Scene scene = scene_with({MeshAttribute::Normal});
    const int mesh_alone = plan_bake(scene).transforms_per_frame();
    scene.output.maps = {MapKind::Normal, MapKind::Displacement};
    scene.output.map_resolution = 64;
    EXPECT_EQ(plan_bake(scene).transforms_per_frame(), mesh_alone);
    scene.output.map_resolution = 32;
    EXPECT_GT(plan_bake(scene).transforms_per_frame(), mesh_alone);
}

// Bands: from 0 to infinity, each beginning where the one before ends, and the same at every resolution.
TEST(Plan, CutsBandsThatAreDisjointCompleteAndOfTheSizesAlone) {
    for (double wind : {3.0, 10.0, 30.0}) {
        std::vector<double> edges;
        for (int resolution : {16, 64, 1024}) {
            Scene scene;
            scene.sea.wind_speed_mps = wind;
            scene.surface.resolution = resolution;
            const Plan plan = plan_bake(scene);
            ASSERT_EQ(plan.cascades.size(), 4u);
            EXPECT_EQ(plan.cascades.front().k_lower, 0.0);
            EXPECT_TRUE(std::isinf(plan.cascades.back().k_upper));
            for (std::size_t c = 1; c < 4; ++c) {
                EXPECT_EQ(plan.cascades[c].k_lower, plan.cascades[c - 1].k_upper);
                EXPECT_LT(plan.cascades[c].size_m, plan.cascades[c - 1].size_m);
            }
            std::vector<double> these;
            for (const CascadePlan& cascade : plan.cascades) these.push_back(cascade.k_lower);
            if (edges.empty()) edges = these;
            EXPECT_EQ(these, edges);
        }
    }
}

// A grid holds all modes it is filled with (no wrapping), and the waves of its band that its footprint shows.
TEST(Plan, GivesEachGridRoomForItsModes) {
    for (int resolution : {1, 2, 7, 64, 256}) {
        Scene scene;
        scene.surface.resolution = resolution;
        const Plan plan = plan_bake(scene);
        for (const CascadePlan& cascade : plan.cascades) {
            EXPECT_LE(2 * cascade.mode_radius, cascade.resolution);
            for (const Grid& grid : cascade.grids) {
                const double step = 2.0 * std::numbers::pi / cascade.size_m;
                const double last = std::min({plan.filter.cutoff(plan.levels[grid.level].footprint_m),
                                              cascade.k_upper, cascade.mode_radius * step});
                EXPECT_GT(grid.resolution * step, 2.0 * last) << resolution;
            }
        }
    }
}

TEST(Plan, RefusesMalformedFootprints) {
    const auto query = [](std::vector<double> cell, std::vector<double> pixel) {
        Query q;
        q.name = "points";
        q.products = products(Product::Position);
        q.cell_m = std::move(cell);
        q.pixel_m = std::move(pixel);
        return std::vector<Query>{q};
    };
    const double nan = std::numeric_limits<double>::quiet_NaN(),
                 infinity = std::numeric_limits<double>::infinity();
    EXPECT_NO_THROW(make_plan(Scene{}, query({0.0, 1.0}, {0.5})));
    EXPECT_THROW(make_plan(Scene{}, query({}, {0.5})), std::invalid_argument);
    EXPECT_THROW(make_plan(Scene{}, query({0.5}, {})), std::invalid_argument);
    EXPECT_THROW(make_plan(Scene{}, query({1.0, 0.5}, {0.5})), std::invalid_argument);
    EXPECT_THROW(make_plan(Scene{}, query({0.5, 0.5}, {0.5})), std::invalid_argument);
    EXPECT_THROW(make_plan(Scene{}, query({-0.5}, {0.5})), std::invalid_argument);
    EXPECT_THROW(make_plan(Scene{}, query({0.5}, {nan})), std::invalid_argument);
    EXPECT_THROW(make_plan(Scene{}, query({0.5}, {nan, 1.0})), std::invalid_argument);
    EXPECT_THROW(make_plan(Scene{}, query({0.5, nan, 1.0}, {0.5})), std::invalid_argument);
    EXPECT_THROW(make_plan(Scene{}, query({0.5}, {infinity})), std::invalid_argument);
}

TEST(Plan, FingerprintFollowsTheSeaAndNotTheRangeOfFrames) {
    Scene scene;
    const auto before = fingerprints(plan_bake(scene));
    scene.shot.last_frame = 480;
    EXPECT_EQ(fingerprints(plan_bake(scene)), before);
    for (auto change :
         {+[](Scene& s) { s.shot.seed = 2; }, +[](Scene& s) { s.sea.wind_speed_mps = 10.5; },
          +[](Scene& s) { s.waves.choppiness = 0.9; }, +[](Scene& s) { s.surface.resolution = 128; },
          +[](Scene& s) { s.effects.whitecaps = false; },
          +[](Scene& s) { s.quality.level = QualityLevel::Draft; }}) {
        Scene other = scene;
        change(other);
        EXPECT_NE(fingerprints(plan_bake(other)), before);
    }
    EXPECT_EQ(output_fingerprint(plan_bake(scene), plan_bake(scene).outputs.front()).size(), 16u);
}

// A bake that took hours isn't done again for another sun.
TEST(Plan, FingerprintKnowsNoLightAndOnlyAGridOfTheCameraKnowsTheCamera) {
    const std::vector<void (*)(Scene&)> light{[](Scene& s) { s.light.sun_elevation_deg = 5.0; },
                                              [](Scene& s) { s.light.sun_azimuth_deg = 5.0; },
                                              [](Scene& s) { s.light.sky = "noon.exr"; },
                                              [](Scene& s) { s.light.turbidity = 6.0; },
                                              [](Scene& s) { s.water.type = WaterType::Turbid; },
                                              [](Scene& s) { s.water.chlorophyll_mg_m3 = 2.0; }};
    const std::vector<void (*)(Scene&)> camera{
        [](Scene& s) { s.camera.position_m.x = 3.0; },
        [](Scene& s) { s.camera.look_at_m.x = 3.0; },
        [](Scene& s) { s.camera.fov_deg = 49.0; },
        [](Scene& s) {
            s.camera.resolution = {1280, 736};
        },
        [](Scene& s) {
            s.camera.keys = {{.frame = 9, .position_m = {1.0, 2.0, 3.0}}};
        },
        [](Scene& s) { s.surface.cell_px = 9.0; }};
    const auto changed = [](Scene scene, void (*change)(Scene&)) {
        const auto before = fingerprints(plan_bake(scene));
        change(scene);
        return fingerprints(plan_bake(scene)) != before;
    };
    Scene patch = scene_with({}), grid = patch, maps_alone = patch;
    grid.surface.kind = maps_alone.surface.kind = SurfaceKind::ProjectedGrid;
    maps_alone.output.mesh = MeshFormat::None;
    maps_alone.output.maps = {MapKind::Normal};
    for (std::size_t i = 0; i < light.size(); ++i)
        for (const Scene& scene : {patch, grid, maps_alone}) EXPECT_FALSE(changed(scene, light[i])) << i;
    for (std::size_t i = 0; i < camera.size(); ++i) {
        EXPECT_FALSE(changed(patch, camera[i])) << i;
        EXPECT_FALSE(changed(maps_alone, camera[i])) << i;
        EXPECT_TRUE(changed(grid, camera[i])) << i;
    }
}

TEST(Plan, AnswersAtOnceForTheLargestSea) {
    Scene scene;
    scene.waves.cascades = {{4000.0, 8192}, {150.0, 8192}};
    scene.surface.resolution = 8192;
    const Plan plan = plan_bake(scene);
    EXPECT_GT(plan.frame_bytes(), std::size_t{1} << 30);  // nothing of which was allocated
    const std::string page = explain(plan);
    EXPECT_NE(page.find("8192"), std::string::npos);
}

// What a camera sees never decides which levels there are, only how many of them are needed.
TEST(Plan, LevelsArePowersOfTwoWhoeverAsks) {
    const auto prepared = prepare(Scene{});
    for (const double finest_m : {0.003, 0.1, 0.7, 1.0, 33.0}) {
        const Query query =
            view_query(*prepared, {.finest_cell_m = 6.0 * finest_m, .finest_pixel_m = finest_m});
        for (const double level_m : query.pixel_m)
            EXPECT_EQ(std::exp2(std::round(std::log2(level_m))), level_m);
        EXPECT_LE(query.cell_m.front(), 1.4143 * 6.0 * finest_m);
    }
}

// A picture's light is read from fewer nodes than positions are, on levels of its own; a mesh's normals aren't light, and what is
// as fine needs none.
TEST(Plan, APicturesLightHasLevelsOfItsOwn) {
    Scene scene;
    const auto plan_of = [&](ProductSet wanted) {
        const auto prepared = prepare(scene);
        return make_plan(
            prepared,
            {view_query(*prepared,
                        {.products = wanted, .finest_cell_m = 0.1, .finest_pixel_m = 0.1, .points = 1000})});
    };
    const auto finest_nodes = [](const Plan& plan, const std::vector<int>& levels) {
        const CascadePlan& finest = plan.cascades.back();
        return finest.grids[finest.grid_of_level[levels.front()]].resolution;
    };
    const auto are_of_light = [](const Plan& plan, const std::vector<int>& levels) {
        return std::all_of(levels.begin(), levels.end(), [&](int i) { return plan.levels[i].is_of_light; });
    };
    for (const QualityRow& row : quality_table()) {
        scene.quality.level = row.level;
        const Plan picture = plan_of({});
        const PlannedQuery& seen = picture.queries.front();
        EXPECT_FALSE(are_of_light(picture, seen.cell_levels));
        if (row.light_oversampling < row.oversampling) {
            EXPECT_TRUE(are_of_light(picture, seen.pixel_levels)) << word_of(row.level);
            EXPECT_LT(finest_nodes(picture, seen.pixel_levels), finest_nodes(picture, seen.cell_levels))
                << word_of(row.level);
        } else {
            EXPECT_EQ(finest_nodes(picture, seen.pixel_levels), finest_nodes(picture, seen.cell_levels));
        }
        const Plan mesh = plan_of(products(Product::Position, Product::Normal));
        EXPECT_FALSE(are_of_light(mesh, mesh.queries.front().pixel_levels));
    }
}

}  // namespace
}  // namespace pelagic
