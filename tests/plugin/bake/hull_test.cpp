// Hulls in the sea: where a body keeps water out, against rays through its triangles and against pictures; and what bakes leave out there.
#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <iterator>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "core/base/constants.h"
#include "core/effects/spray_drops.h"
#include "core/evaluate/hulls.h"
#include "core/evaluate/object_place.h"
#include "core/plan/fingerprint.h"
#include "core/plan/hulls.h"
#include "core/plan/spray_drops.h"
#include "core/scene/hull.h"
#include "plugin/bake/bake.h"
#include "plugin/format/shot/object_file.h"
#include "plugin/format/usd/read_mesh.h"
#include "plugin/render/objects.h"
#include "tests/plugin/bake/read_exr.h"
#include "tests/plugin/bake/read_vdb.h"

namespace {

using namespace pelagic;
using namespace pelagic::test;
namespace fs = std::filesystem;

std::string bytes_of(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

std::shared_ptr<const ObjectMesh> trawler() {
    static const auto mesh = load_object(fs::path(PELAGIC_SOURCE_DIR) / "examples/data/trawler.obj");
    return mesh;
}

// A box without its top, or a sheet.
std::shared_ptr<const ObjectMesh> barge(glm::vec3 half) {
    ObjectMeshData mesh;
    mesh.materials = {{.name = "steel"}};
    for (int i = 0; i < 8; ++i)
        mesh.points_m.emplace_back(i & 1 ? half.x : -half.x, i & 2 ? half.y : -half.y,
                                   i & 4 ? half.z : -half.z);
    const std::array<std::array<std::uint32_t, 4>, 5> faces{
        {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}}};
    for (const auto& f : faces)
        for (const std::uint32_t corner : {f[0], f[1], f[2], f[0], f[2], f[3]})
            mesh.triangles.push_back(corner);
    mesh.normals.assign(mesh.triangles.size(), {0.0f, 0.0f, 1.0f});
    mesh.material.assign(mesh.triangles.size() / 3, 0);
    return std::make_shared<const ObjectMesh>(std::move(mesh));
}

std::shared_ptr<const ObjectMesh> sheet() {
    return std::make_shared<const ObjectMesh>(ObjectMeshData{.points_m = {{-5, -5, 1}, {5, -5, 1}, {0, 5, 1}},
                                                             .triangles = {0, 1, 2},
                                                             .normals = std::vector<glm::vec3>(3, {0, 0, 1}),
                                                             .material = {0},
                                                             .materials = {{.name = "sail"}}});
}

// Möller and Trumbore 1997.
bool meets(const ObjectMesh& mesh, const glm::dvec3& from, const glm::dvec3& way) {
    const ObjectMeshData& data = mesh.data();
    for (std::size_t i = 0; i < data.triangles.size(); i += 3) {
        const glm::dvec3 a(data.points_m[data.triangles[i]]), b(data.points_m[data.triangles[i + 1]]),
            c(data.points_m[data.triangles[i + 2]]);
        const glm::dvec3 p = glm::cross(way, c - a);
        const double det = glm::dot(p, b - a);
        if (det == 0.0) continue;
        const double u = glm::dot(from - a, p) / det;
        const glm::dvec3 q = glm::cross(from - a, b - a);
        const double v = glm::dot(way, q) / det;
        if (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && glm::dot(c - a, q) / det > 0.0) return true;
    }
    return false;
}

bool is_in_by_rays(const ObjectMesh& mesh, const glm::dvec3& place) {
    if (glm::any(glm::lessThan(place, mesh.least_m())) || glm::any(glm::greaterThan(place, mesh.most_m())))
        return false;
    if (!meets(mesh, place, {0.0, 0.0, -1.0})) return false;
    int met = 0;
    for (int side = 0; side < 8; ++side) {
        const double angle = kTwoPi * (side + 0.5) / 8.0;
        met += meets(mesh, place, {std::cos(angle), std::sin(angle), 0.0});
    }
    return met >= 6;
}

TEST(Hull, OfABargeIsItsBox) {
    const Hull hull(*barge({10.0f, 3.0f, 1.0f}));
    ASSERT_TRUE(hull.keeps_water_out());
    double worst_m = 0.0;
    std::mt19937 random(3);
    std::uniform_real_distribution<double> x(-11.0, 11.0), y(-4.0, 4.0), z(-0.97, 0.97);
    for (int i = 0; i < 20000; ++i) {
        const glm::dvec3 place(x(random), y(random), z(random));
        const glm::dvec2 beyond = glm::abs(glm::dvec2(place)) - glm::dvec2(10.0, 3.0);
        const double exact_m =
            glm::length(glm::max(beyond, 0.0)) + std::min(std::max(beyond.x, beyond.y), 0.0);
        worst_m = std::max(worst_m, std::abs(hull.distance_m(place) - exact_m));
    }
    // A corner is rounded, by less than half of its square's diagonal.
    EXPECT_LT(worst_m, 0.5 * hull.cell_m());
    EXPECT_EQ(hull.distance_m({0.0, 0.0, 1.01}), std::numeric_limits<double>::infinity());
    EXPECT_EQ(hull.distance_m({0.0, 0.0, -1.01}), std::numeric_limits<double>::infinity());
    EXPECT_NEAR(hull.above_bottom_m({1.0, 1.0, 0.5}), 1.5, 1e-5);
    const glm::dvec2 starboard = hull.outward({2.0, -3.2, 0.0});
    EXPECT_NEAR(starboard.y, -1.0, 1e-6);
    EXPECT_FALSE(Hull(*sheet()).keeps_water_out());
}

TEST(Hull, HoldsWhatRaysThroughItsTrianglesFind) {
    const ObjectMesh& mesh = *trawler();
    const Hull hull(mesh);
    std::mt19937 random(7);
    const glm::dvec3 least = mesh.least_m(), most = mesh.most_m();
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    int inside = 0, apart = 0, places = 0;
    double farthest_m = 0.0;
    for (; places < 4000; ++places) {
        glm::dvec3 place = least + (most - least) * glm::dvec3(unit(random), unit(random), unit(random));
        place.z = std::lerp(-2.5, 1.5, unit(random));  // where water may be
        const bool is_in = is_in_by_rays(mesh, place), by_hull = hull.distance_m(place) < 0.0;
        inside += is_in;
        if (is_in == by_hull) continue;
        ++apart;
        // At an edge over which water would come in the answer changes with height.
        const glm::dvec3 level(0.0, 0.0, hull.level_m());
        if (is_in_by_rays(mesh, place + level) != is_in || is_in_by_rays(mesh, place - level) != is_in)
            continue;
        farthest_m = std::max(farthest_m, std::abs(hull.distance_m(place)));
    }
    std::printf("hull: %d of %d places are inside, %d are others by rays, at most %.3f m from the outline\n",
                inside, places, apart, farthest_m);
    EXPECT_GT(inside, 1000);
    EXPECT_LT(apart, places / 200);
    EXPECT_LT(farthest_m, 0.5 * hull.cell_m());
}

// A trawler that lies turned in waves.
Scene at_sea() {
    Scene scene;
    scene.shot.last_frame = 3;
    scene.sea.wind_speed_mps = 11.0;
    scene.sea.wind_direction_deg = 30.0;
    scene.waves.cascades = {{.size_m = 240.0, .resolution = 128}, {.size_m = 60.0, .resolution = 128}};
    scene.surface.size_m = 48.0;
    scene.surface.resolution = 96;
    scene.quality.level = QualityLevel::Preview;
    scene.objects = {
        {.name = "boat", .file = "trawler.obj", .mesh = trawler(), .heading_deg = 40.0, .floats = true}};
    return scene;
}

// However many there are: a plan asks for them a dozen times.
TEST(Hull, IsKeptByItsMesh) {
    std::vector<std::shared_ptr<const ObjectMesh>> meshes;
    std::vector<std::weak_ptr<const Hull>> hulls;
    for (int i = 0; i < 9; ++i) {
        meshes.push_back(barge({4.0f + 0.1f * static_cast<float>(i), 2.0f, 1.0f}));
        hulls.emplace_back(hull_of(*meshes.back()));
    }
    for (int i = 0; i < 9; ++i) EXPECT_EQ(hull_of(*meshes[i]), hulls[i].lock()) << i;
    const auto equal = barge({4.0f, 2.0f, 1.0f});
    EXPECT_EQ(hull_of(*equal), hulls[0].lock());
    meshes.clear();
    EXPECT_TRUE(hulls[1].expired());
    EXPECT_FALSE(hulls[0].expired());
}

TEST(Hulls, AreWherePicturesHaveThem) {
    for (const bool floats : {false, true}) {
        Scene scene = at_sea();
        scene.objects[0].floats = floats;
        scene.objects[0].roll_deg = 12.0;
        const auto prepared = prepare(scene);
        const Plan plan = make_plan(prepared, {view_query(*prepared, {.products = products(Product::Position),
                                                                      .finest_cell_m = 0.5,
                                                                      .finest_pixel_m = 0.5}),
                                               *hulls_query(scene, false)});
        Frame<double> frame(std::make_shared<const Sea<double>>(plan));
        frame.set(scene.shot.time_s(2));
        LitObjects lit(plan.from->scene);
        lit.place(frame, 2.0, {});
        Hulls hulls(plan.from->scene);
        hulls.place(frame, hulls_query(plan), 2.0);
        std::mt19937 random(11);
        std::uniform_real_distribution<double> across(-20.0, 20.0), height(-2.0, 2.0);
        int dry = 0, apart = 0, far_apart = 0;
        for (int i = 0; i < 20000; ++i) {
            const glm::dvec3 place(across(random), across(random), height(random));
            const bool is_dry = lit.is_dry(glm::vec3(place));
            const double distance_m = hulls.distance_m(place);
            dry += is_dry;
            apart += is_dry != (distance_m < 0.0);
            far_apart += is_dry != (distance_m < 0.0) && std::abs(distance_m) > 0.1;
        }
        std::printf(
            "hulls: %d of 20000 places are dry, %d by one of the two, %d of these are 0.1 m and more from the outline\n",
            dry, apart, far_apart);
        EXPECT_GT(dry, 1000);
        EXPECT_LT(apart, dry / 50);
        EXPECT_LT(far_apart, dry / 200);  // at bulwarks
    }
}

class HullBakes : public ::testing::Test {
  protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / ("pelagic-hulls-" + std::to_string(getpid()));
        fs::remove_all(folder_);
    }
    void TearDown() override { fs::remove_all(folder_); }
    fs::path baked(const Scene& scene, std::vector<int> frames, const char* into) const {
        bake(scene, {.out = folder_ / into, .frames = std::move(frames), .progress = {}, .cancel = nullptr});
        return folder_ / into;
    }
    static usd::MeshLayer mesh(const fs::path& folder, int frame = 1) {
        return usd::read_mesh_layer(bytes_of(folder / usd::frame_file("sea", frame, "usdc")));
    }
    static std::vector<float> numbers(const usd::MeshLayer& layer, const char* name) {
        for (const usd::MeshArray& array : layer.arrays)
            if (array.name == name) return std::get<std::vector<float>>(array.values);
        return {};
    }
    fs::path folder_;
};

// Hulls of what floats, as a bake has them.
Hulls hulls_of_bake(const Scene& scene, int at, const std::function<void(const Plan&)>& keep) {
    const auto plan = std::make_shared<const Plan>(plan_bake(prepare(scene), std::vector{at}));
    keep(*plan);
    Frame<float> frame(std::make_shared<const Sea<float>>(*plan));
    frame.set(scene.shot.time_s(at));
    Hulls hulls(plan->from->scene);
    hulls.place(frame, hulls_query(*plan), at);
    return hulls;
}

TEST_F(HullBakes, SayWhereAMeshIsWet) {
    const Scene scene = at_sea();
    Scene empty = scene;
    empty.objects.clear();
    const fs::path with = baked(scene, {2}, "with"), without = baked(empty, {2}, "without");
    const usd::MeshLayer layer = mesh(with, 2), plain = mesh(without, 2);
    const std::vector<float> wet = numbers(layer, "primvars:wet"), points = numbers(layer, "points");
    ASSERT_EQ(3 * wet.size(), points.size());
    // The sea itself is the same.
    for (const char* name : {"points", "normals", "velocities", "primvars:slopeVariance"})
        EXPECT_EQ(numbers(layer, name), numbers(plain, name)) << name;
    EXPECT_TRUE(numbers(plain, "primvars:wet").empty());
    std::shared_ptr<const PreparedScene> from;
    const Hulls hulls = hulls_of_bake(scene, 2, [&](const Plan& plan) { from = plan.from; });
    std::size_t dry = 0, between = 0;
    for (std::size_t i = 0; i < wet.size(); ++i) {
        const double distance_m = hulls.distance_m({points[3 * i], points[3 * i + 1], points[3 * i + 2]});
        ASSERT_NEAR(wet[i], std::clamp(0.5 + distance_m / 0.5, 0.0, 1.0), 1e-4);
        dry += wet[i] == 0.0f;
        between += wet[i] > 0.0f && wet[i] < 1.0f;
    }
    EXPECT_GT(dry, 200u);
    EXPECT_GT(between, 60u);
    const std::string stage = bytes_of(with / "sea.usda"), plain_stage = bytes_of(without / "sea.usda");
    for (const char* line : {"float inputs:opacityThreshold = 0.5", "string inputs:varname = \"wet\"",
                             "Water/WetReader.outputs:result>", "\"ND_ifgreatereq_color3\""}) {
        EXPECT_NE(stage.find(line), std::string::npos) << line;
        EXPECT_EQ(plain_stage.find(line), std::string::npos) << line;
    }
    // Whether others ask for more of a hull's water changes nothing.
    Scene mapped = scene;
    mapped.output.maps = {MapKind::Whitecaps};
    mapped.output.map_resolution = 32;
    EXPECT_EQ(bytes_of(baked(mapped, {2}, "mapped") / usd::frame_file("sea", 2, "usdc")),
              bytes_of(with / usd::frame_file("sea", 2, "usdc")));
    // What keeps no water out changes nothing, to the bit.
    Scene sail = scene;
    sail.objects[0].mesh = sheet();
    EXPECT_EQ(bytes_of(baked(sail, {2}, "sail") / usd::frame_file("sea", 2, "usdc")),
              bytes_of(without / usd::frame_file("sea", 2, "usdc")));
}

TEST_F(HullBakes, AreTheSameAloneAndInARun) {
    Scene scene = at_sea();
    scene.objects[0].buoyancy = Buoyancy::Response;
    scene.output.maps = {MapKind::Whitecaps};
    scene.output.map_resolution = 64;
    scene.output.volumes = {VolumeKind::LevelSet};
    scene.output.voxel_m = 1.0;
    const fs::path run = baked(scene, {}, "run");
    const oneapi::tbb::global_control one(oneapi::tbb::global_control::max_allowed_parallelism, 1);
    const fs::path alone = baked(scene, {3}, "alone");
    for (const char* file :
         {"mesh/sea.0003.usdc", "maps/sea.whitecaps.0003.exr", "volumes/sea.level-set.0003.vdb"}) {
        const std::string bytes = bytes_of(alone / file);
        ASSERT_FALSE(bytes.empty()) << file;
        EXPECT_TRUE(bytes == bytes_of(run / file)) << file;
    }
    // How it floats is a part of what they are made of.
    const std::string late = bytes_of(run / "mesh/sea.0003.usdc");
    scene.objects[0].buoyancy = Buoyancy::Plane;
    EXPECT_TRUE(late != bytes_of(baked(scene, {3}, "run") / "mesh/sea.0003.usdc"));
}

TEST_F(HullBakes, LeaveWaterAndFoamOutOfThem) {
    Scene scene = at_sea();
    scene.sea.wind_speed_mps = 20.0;
    scene.objects[0] = {.name = "barge", .file = "b.obj", .mesh = barge({12.0f, 6.0f, 6.0f}), .foam = 0.0};
    scene.effects.spray = true;
    scene.output.mesh = MeshFormat::None;
    scene.output.maps = {MapKind::Whitecaps, MapKind::Displacement};
    scene.output.map_resolution = 96;
    scene.output.volumes = {VolumeKind::LevelSet, VolumeKind::Spray};
    scene.output.voxel_m = 1.0;
    const fs::path folder = baked(scene, {1}, "out");
    const auto surface = read_vdb(folder / "volumes/sea.level-set.0001.vdb");
    ASSERT_EQ(surface.size(), 1u);
    // Voxels' middles are at half metres; the box is 12 m deep about 0.
    int water = 0;
    for (int i = 0; i < 48; ++i)
        for (int j = 0; j < 48; ++j)
            for (int k = -9; k < 6; ++k) {
                const glm::dvec3 at = surface[0].place_m({i, j, k});
                const glm::dvec3 beyond = glm::abs(at) - glm::dvec3(12.0, 6.0, 6.0);
                const float value = surface[0].value({i, j, k}).x;
                const double inside_m = -std::max({beyond.x, beyond.y, beyond.z});
                if (inside_m > 0.2) {
                    ASSERT_GT(value, 0.0f) << at.x << ' ' << at.y << ' ' << at.z;
                } else if (inside_m < -0.2 && at.z < -4.5) {
                    ASSERT_LT(value, 0.0f) << at.x << ' ' << at.y << ' ' << at.z;
                    ++water;
                    // Flat sides: the way to them is the distance, unless it is past an edge.
                    if (beyond.x < 0.0 && beyond.y < 0.0 && beyond.z < 2.5) {
                        ASSERT_NEAR(value, -beyond.z, 0.1);
                    }
                    if (beyond.x < -1.0 && beyond.y > 0.0 && beyond.y < 2.5 && beyond.z < -2.0) {
                        ASSERT_NEAR(value, -beyond.y, 0.1);
                    }
                }
            }
    EXPECT_GT(water, 2000);
    Scene empty = scene;
    empty.objects.clear();
    const fs::path plain = baked(empty, {1}, "plain");
    const Plane foam = read_level(folder / "maps/sea.whitecaps.0001.exr", "R", 0),
                before = read_level(plain / "maps/sea.whitecaps.0001.exr", "R", 0),
                x = read_scanlines(folder / "maps/sea.displacement.0001.exr", "R"),
                y = read_scanlines(folder / "maps/sea.displacement.0001.exr", "G");
    double lost = 0.0;
    for (int j = 0; j < foam.n; ++j)
        for (int i = 0; i < foam.n; ++i) {
            const glm::dvec2 at =
                48.0 * (glm::dvec2(i, j) / double(foam.n) - 0.5) + glm::dvec2(x.at(i, j), y.at(i, j));
            const glm::dvec2 beyond = glm::abs(at) - glm::dvec2(12.0, 6.0);
            const double outside_m = std::max(beyond.x, beyond.y);
            if (outside_m < -0.8) {
                ASSERT_EQ(foam.at(i, j), 0.0f);
                lost += static_cast<double>(before.at(i, j));
            }
            if (outside_m > 0.8) {
                ASSERT_EQ(foam.at(i, j), before.at(i, j));
            }
        }
    EXPECT_GT(lost, 1.0);  // there was some
    EXPECT_EQ(bytes_of(folder / "maps/sea.displacement.0001.exr"),
              bytes_of(plain / "maps/sea.displacement.0001.exr"));
    double left = 0.0, gone = 0.0;
    for (const fs::path& of : {folder, plain})
        read_vdb(of / "volumes/sea.spray.0001.vdb").at(0).for_each([&](glm::ivec3 at, glm::vec3 value) {
            if (std::abs(at.x - 23.5) < 11.0 && std::abs(at.y - 23.5) < 5.0)
                (of == folder ? left : gone) += static_cast<double>(value.x);
        });
    EXPECT_EQ(left, 0.0);
    EXPECT_GT(gone, 0.0);
}

// What is lifted by the waves is still looked for in maps, whose texels know where they rest alone.
TEST_F(HullBakes, FindsAHullThatHeavesInMaps) {
    Scene scene = at_sea();
    scene.objects[0] = {.name = "buoy", .file = "b.obj", .mesh = barge({1.0f, 1.0f, 1.0f}), .floats = true};
    scene.waves.choppiness = 0.05;
    scene.shot.fps = 2.0;
    scene.shot.last_frame = 12;
    scene.sea.wind_speed_mps = 22.0;
    scene.output.mesh = MeshFormat::None;
    scene.output.maps = {MapKind::Whitecaps};
    scene.output.map_resolution = 96;
    const fs::path folder = baked(scene, {}, "out");
    Scene empty = scene;
    empty.objects.clear();
    const fs::path plain = baked(empty, {}, "plain");
    for (int frame = scene.shot.first_frame; frame <= scene.shot.last_frame; ++frame) {
        const std::string file = "maps/sea.whitecaps." + std::string(4 - std::to_string(frame).size(), '0') +
                                 std::to_string(frame) + ".exr";
        const Plane with = read_level(folder / file, "R", 0), without = read_level(plain / file, "R", 0);
        int changed = 0;
        for (int j = 0; j < with.n; ++j)
            for (int i = 0; i < with.n; ++i) changed += with.at(i, j) != without.at(i, j);
        EXPECT_GT(changed, 4) << frame;
    }
}

// A cage lies as high as it is drawn, and so does what floats in it.
TEST_F(HullBakes, FloatOnACageThatIsRaised) {
    const auto cage_at = [](double height_m) {
        CageMesh mesh;
        constexpr int kFaces = 8;
        for (int y = 0; y <= kFaces; ++y)
            for (int x = 0; x <= kFaces; ++x)
                mesh.points_m.emplace_back(6.0 * (x - 0.5 * kFaces), 6.0 * (y - 0.5 * kFaces), height_m);
        for (int y = 0; y < kFaces; ++y)
            for (int x = 0; x < kFaces; ++x) {
                const int corner = y * (kFaces + 1) + x;
                mesh.face_counts.push_back(4);
                mesh.indices.insert(mesh.indices.end(),
                                    {corner, corner + 1, corner + kFaces + 2, corner + kFaces + 1});
            }
        return std::make_shared<const Cage>(std::move(mesh));
    };
    const auto dry_at = [&](double height_m, const char* into) {
        Scene scene = at_sea();
        scene.surface.kind = SurfaceKind::Cage;
        scene.surface.cage = cage_at(height_m);
        const std::vector<float> wet = numbers(mesh(baked(scene, {1}, into)), "primvars:wet");
        return std::ranges::count(wet, 0.0f);
    };
    const auto at_rest = dry_at(0.0, "low");
    EXPECT_GT(at_rest, 20);
    // Single precision is coarser 20 m up: a vertex on the outline may fall to its other side.
    EXPECT_NEAR(static_cast<double>(dry_at(20.0, "high")), static_cast<double>(at_rest), 2.0);
}

// Contact foam is new: the foam's age, a mean, gets less where it is, and what was old there is no more than before.
TEST_F(HullBakes, ContactFoamMakesFoamYounger) {
    Scene scene = at_sea();
    scene.sea.wind_speed_mps = 20.0;
    scene.effects.foam_decay_s = 4.0;
    scene.output.mesh = MeshFormat::None;
    scene.output.maps = {MapKind::Whitecaps};
    scene.output.map_resolution = 96;
    Scene without = scene;
    without.objects[0].foam = 0.0;
    const fs::path folder = baked(scene, {2}, "out"), plain = baked(without, {2}, "plain");
    const auto level = [](const fs::path& of, const char* name) {
        return read_level(of / "maps/sea.whitecaps.0002.exr", name, 0);
    };
    const Plane foam = level(folder, "R"), before = level(plain, "R"), age = level(folder, "foamAge"),
                age_before = level(plain, "foamAge");
    int younger = 0;
    for (int j = 0; j < foam.n; ++j)
        for (int i = 0; i < foam.n; ++i) {
            const double old = static_cast<double>(foam.at(i, j)) * static_cast<double>(age.at(i, j)),
                         old_before =
                             static_cast<double>(before.at(i, j)) * static_cast<double>(age_before.at(i, j));
            ASSERT_LE(old, old_before * 1.01 + 1e-3)
                << i << ' ' << j << ' ' << foam.at(i, j) << ' ' << before.at(i, j) << ' ' << age.at(i, j)
                << ' ' << age_before.at(i, j);
            younger += foam.at(i, j) > 2.0f * before.at(i, j) && age_before.at(i, j) > 0.1f &&
                       age.at(i, j) < 0.6f * age_before.at(i, j);
        }
    EXPECT_GT(younger, 5);
}

// A wake's foam that is next to none beside what breaks: its age is a quotient of roundings, and was 141,034 s, which no half holds.
TEST_F(HullBakes, AWakesFoamHasAnAgeInMaps) {
    Scene scene = at_sea();
    scene.objects.clear();
    scene.sea.wind_speed_mps = 16.0;
    scene.shot.first_frame = 1;
    scene.surface.size_m = 100.0;
    scene.waves.vessels = {{.path = "1 -20 0, 200 30 0"}};
    scene.waves.vessels[0].length_m = 26.0;
    scene.waves.vessels[0].beam_m = 7.0;
    scene.waves.vessels[0].draught_m = 3.0;
    scene.effects.foam_decay_s = Scene{}.effects.foam_decay_s;
    scene.output.mesh = MeshFormat::None;
    scene.output.maps = {MapKind::Whitecaps};
    scene.output.map_resolution = 256;
    const fs::path folder = baked(scene, {1}, "wake");
    for (int level = 0; level < 5; ++level) {
        const Plane age = read_level(folder / "maps/sea.whitecaps.0001.exr", "foamAge", level);
        for (int j = 0; j < age.n; ++j)
            for (int i = 0; i < age.n; ++i)
                ASSERT_LE(age.at(i, j), 901.0f) << level;  // ten lives of a wake's foam, by halves
    }
}

TEST(HullDrops, StartInNone) {
    Scene scene = at_sea();
    scene.sea.wind_speed_mps = 22.0;
    scene.effects.spray = scene.effects.spray_drops = true;
    scene.output.mesh = MeshFormat::None;
    scene.output.drops = true;
    scene.objects[0] = {.name = "barge", .file = "b.obj", .mesh = barge({60.0f, 60.0f, 8.0f})};
    for (const bool has_hull : {true, false}) {
        if (!has_hull) scene.objects.clear();
        const Plan plan = plan_bake(prepare(scene), std::vector{1});
        SprayDrops<float> drops(Sea<float>(plan), scene.surface.size_m);
        std::vector<SprayDrop> flying;
        drops.at(scene.shot.time_s(1), glm::dvec2(0.0), flying);
        // Drops fly in from where there is water, at most with 1.3 times the wind for 2.5 s.
        EXPECT_EQ(flying.size() < 100u, has_hull) << flying.size();
        EXPECT_EQ(flying.size() > 1000u, !has_hull) << flying.size();
    }
}

TEST_F(HullBakes, HaveFoamWhereAHullMeetsTheWater) {
    Scene scene = at_sea();
    scene.sea.wind_speed_mps = 3.0;
    scene.shot.fps = 24.0;
    // 2 m/s along +x.
    scene.objects[0] = {.name = "barge",
                        .file = "b.obj",
                        .mesh = barge({10.0f, 4.0f, 1.5f}),
                        .path = "1 0 0, 25 2 0",
                        .interpolation = CameraInterpolation::Linear};
    scene.surface.resolution = 192;
    const fs::path with = baked(scene, {1}, "with");
    scene.objects[0].foam = 0.0;
    const fs::path without = baked(scene, {1}, "without");
    const auto foam = numbers(mesh(with), "primvars:whitecapCoverage"),
               before = numbers(mesh(without), "primvars:whitecapCoverage"),
               points = numbers(mesh(with), "points");
    ASSERT_EQ(3 * foam.size(), points.size());
    const double width_m = contact_foam_m(scene.objects[0], *hull_of(*scene.objects[0].mesh));
    EXPECT_NEAR(width_m, 0.96, 1e-9);
    double bow = 0.0, side = 0.0;
    int at_bow = 0, at_side = 0;
    for (std::size_t i = 0; i < foam.size(); ++i) {
        const glm::dvec2 at(points[3 * i], points[3 * i + 1]);
        ASSERT_GE(foam[i], before[i]);
        const double ahead_m = at.x - 10.0, beside_m = at.y - 4.0;
        const double added =
            1.0 - (1.0 - static_cast<double>(foam[i])) / (1.0 - static_cast<double>(before[i]));
        if (std::abs(at.y) < 3.0 && ahead_m > 0.0) {
            const double s = std::min(ahead_m / width_m, 1.0);
            // Of water that moves a little, past a bow at 2 m/s: as much as there can be.
            ASSERT_NEAR(added, 0.9 * (1.0 - s * s * (3.0 - 2.0 * s)), 0.02) << at.x << ' ' << at.y;
            if (s < 0.5) bow += added, ++at_bow;
        }
        if (std::abs(at.x) < 8.0 && beside_m > 0.0 && beside_m < 0.5 * width_m) side += added, ++at_side;
    }
    ASSERT_GT(at_bow, 20);
    ASSERT_GT(at_side, 40);
    EXPECT_GT(bow / at_bow, 0.5);
    EXPECT_LT(side / at_side, 0.35 * bow / at_bow);  // water goes along it
}

std::vector<std::pair<std::string, std::string>> fingerprints(const Scene& scene) {
    const Plan plan = plan_bake(prepare(scene), std::vector{1});
    std::vector<std::pair<std::string, std::string>> all;
    for (const PlannedOutput& output : plan.outputs)
        all.emplace_back(plan.queries[static_cast<std::size_t>(output.query)].query.name,
                         output_fingerprint(plan, output));
    return all;
}

TEST(HullFingerprints, HaveThemWhereTheyChangeSomething) {
    Scene scene = at_sea();
    scene.effects.spray = true;
    scene.output.maps = {MapKind::Whitecaps, MapKind::Displacement, MapKind::Normal};
    scene.output.map_resolution = 32;
    scene.output.volumes = {VolumeKind::LevelSet, VolumeKind::Spray};
    const auto with = fingerprints(scene);
    const auto expect_other = [&](const char* what, const std::function<void(SceneObject&)>& change,
                                  bool is_other, bool is_of_foam = false) {
        Scene changed = scene;
        change(changed.objects[0]);
        const auto now = fingerprints(changed);
        ASSERT_EQ(now.size(), with.size());
        for (std::size_t i = 0; i < with.size(); ++i) {
            const bool is_of_all = with[i].first == "map displacement" || with[i].first == "map normal" ||
                                   (is_of_foam && with[i].first.starts_with("volume"));
            EXPECT_EQ(now[i].second != with[i].second, is_other && !is_of_all)
                << what << ", " << with[i].first;
        }
    };
    expect_other(
        "place", [](SceneObject& o) { o.east_m = 1.0; }, true);
    expect_other(
        "foam", [](SceneObject& o) { o.foam = 0.5; }, true, true);
    expect_other(
        "floats", [](SceneObject& o) { o.floats = false; }, true);
    expect_other(
        "path", [](SceneObject& o) { o.path = "1 0 0, 20 3 0"; }, true);
    expect_other(
        "mesh",
        [](SceneObject& o) {
            o.mesh = barge({10.0f, 3.0f, 2.0f});
        },
        true);
    expect_other(
        "none", [](SceneObject& o) { o.mesh = sheet(); }, true);
    expect_other(
        "colour", [](SceneObject& o) { o.colour.y = 0.5; }, false);
    expect_other(
        "glow", [](SceneObject& o) { o.glow_cd_m2 = 5.0; }, false);
    expect_other(
        "caustics", [](SceneObject& o) { o.caustics = 1.0; }, false);
    Scene empty = scene;
    empty.objects.clear();
    scene.objects[0].mesh = sheet();
    EXPECT_EQ(fingerprints(scene), fingerprints(empty));
}

}  // namespace
