// What the USD layers hold: names, declarations, checks and the grid's faces.
#include "plugin/format/usd/layers.h"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <utility>

namespace pelagic::usd {
namespace {

std::string refusal(const auto& call) {
    try {
        call();
    } catch (const std::invalid_argument& error) {
        return error.what();
    }
    return "nothing was refused";
}

TEST(UsdNames, RootPrimIsAnIdentifier) {
    EXPECT_EQ(prim_name("sea"), "sea");
    EXPECT_EQ(prim_name("north-sea-storm"), "north_sea_storm");
    EXPECT_EQ(prim_name("3-days-out"), "_3_days_out");
    EXPECT_EQ(prim_name("_x"), "_x");
    EXPECT_EQ(prim_name("-"), "_");
    for (const char* bad : {"", "a/b", "a.b", "a b", "#", "mér"}) {
        EXPECT_THROW(prim_name(bad), std::invalid_argument) << bad;
    }
}

TEST(UsdNames, FrameNumbersAreWhatUsdMakesOfFourHashes) {
    EXPECT_EQ(frame_file("sea", 7, "usda"), "mesh/sea.0007.usda");
    EXPECT_EQ(frame_file("sea", 0, "usdc"), "mesh/sea.0000.usdc");
    EXPECT_EQ(frame_file("sea", 12345, "usda"), "mesh/sea.12345.usda");
    EXPECT_EQ(frame_file("sea", -5, "usda"), "mesh/sea.-005.usda");
    EXPECT_EQ(frame_file("sea", std::numeric_limits<int>::min(), "usda"), "mesh/sea.-2147483648.usda");
    EXPECT_EQ(frame_file_template("sea", "usdc"), "mesh/sea.####.usdc");
    EXPECT_EQ(root_file("a-b"), "a-b.usda");
    EXPECT_EQ(camera_file("a-b"), "a-b.camera.usdc");
    EXPECT_EQ(topology_file("a-b", "usdc"), "mesh/a-b.topology.usdc");
    EXPECT_EQ(manifest_file("a-b"), "mesh/a-b.manifest.usda");
}

TEST(UsdExtent, IsTheBoxRoundThePoints) {
    const std::vector<glm::vec3> points{{1, -2, 3}, {-4, 5, -6}, {0, 0, 7}};
    const Extent extent = extent_of(points);
    EXPECT_EQ(extent[0], glm::vec3(-4, -2, -6));
    EXPECT_EQ(extent[1], glm::vec3(1, 5, 7));
    // One point is its own box, also where zero is outside of it.
    EXPECT_EQ(extent_of(std::span(points).first(1))[0], points[0]);
    EXPECT_EQ(extent_of(std::span(points).first(1))[1], points[0]);
}

struct Frame {
    std::vector<glm::vec3> points{3, glm::vec3(1)}, normals{3, glm::vec3(2)}, velocities{3, glm::vec3(3)},
        slope_variance{3, glm::vec3(4)};
    std::vector<float> whitecap_coverage{0.5f, 0.5f, 0.5f};

    MeshSample sample() const {
        return {.points = points,
                .normals = normals,
                .velocities = velocities,
                .slope_variance = slope_variance,
                .whitecap_coverage = whitecap_coverage};
    }
};

TEST(UsdValues, AreViewsOfTheCallersArrays) {
    const Frame frame;
    const MeshSample sample = frame.sample();
    const Extent extent = extent_of(sample.points);
    const auto values = varying_values(sample, extent);
    ASSERT_EQ(values.size(), 6u);
    const auto floats = [&](std::size_t i) { return std::get<std::span<const float>>(values[i].values); };
    EXPECT_EQ(floats(0).data(), &frame.points[0].x);
    EXPECT_EQ(floats(0).size(), 9u);
    EXPECT_EQ(values[0].count(), 3u);
    EXPECT_EQ(floats(1).data(), &extent[0].x);
    EXPECT_EQ(floats(1).size(), 6u);
    EXPECT_EQ(floats(5).data(), frame.whitecap_coverage.data());
    EXPECT_EQ(floats(5).size(), 3u);
    // The declarations name the same attributes in the same order.
    const auto declared = varying_attributes(sample.attributes());
    ASSERT_EQ(declared.size(), values.size());
    for (std::size_t i = 0; i < values.size(); ++i) EXPECT_EQ(declared[i].name, values[i].attribute.name);
}

TEST(UsdValues, OnlyWhatIsGivenIsThere) {
    const Frame frame;
    const auto none = varying_values({.points = frame.points}, {});
    ASSERT_EQ(none.size(), 2u);
    EXPECT_EQ(none[0].attribute.name, "points");
    EXPECT_EQ(none[1].attribute.name, "extent");
    const auto one =
        varying_values({.points = frame.points, .whitecap_coverage = frame.whitecap_coverage}, {});
    ASSERT_EQ(one.size(), 3u);
    EXPECT_EQ(one[2].attribute.name, "primvars:whitecapCoverage");
}

TEST(UsdValues, NotFiniteIsRefusedByName) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float infinity = std::numeric_limits<float>::infinity();
    const auto refused = [](const Frame& frame) {
        return refusal([&] { varying_values(frame.sample(), extent_of(frame.points)); });
    };
    Frame frame;
    frame.points[1].z = nan;
    EXPECT_NE(refused(frame).find("points[1]"), std::string::npos) << refused(frame);
    frame = Frame{};
    frame.normals[2].x = infinity;
    EXPECT_NE(refused(frame).find("normals[2]"), std::string::npos) << refused(frame);
    frame = Frame{};
    frame.velocities[0].y = -infinity;
    EXPECT_NE(refused(frame).find("velocities[0]"), std::string::npos) << refused(frame);
    frame = Frame{};
    frame.slope_variance[0].x = nan;
    EXPECT_NE(refused(frame).find("slopeVariance[0]"), std::string::npos) << refused(frame);
    frame = Frame{};
    frame.whitecap_coverage[2] = nan;
    EXPECT_NE(refused(frame).find("whitecapCoverage[2]"), std::string::npos) << refused(frame);
}

TEST(UsdValues, ArraysAreAsLongAsPoints) {
    Frame frame;
    frame.velocities.pop_back();
    const std::string said = refusal([&] { varying_values(frame.sample(), {}); });
    EXPECT_NE(said.find("velocities has 2 values for 3 points"), std::string::npos) << said;
}

TEST(UsdTopology, FacesThatDontFitAreRefused) {
    const std::vector<std::int32_t> counts{3}, two{2}, indices{0, 1, 2}, negative{0, 1, -1}, beyond{0, 1, 3},
        few{0, 1};
    const std::vector<glm::vec2> st(3, glm::vec2(0));
    EXPECT_NO_THROW(check({.face_vertex_counts = counts, .face_vertex_indices = indices, .st = st}));
    const auto refused = [](const Topology& topology) { return refusal([&] { check(topology); }); };
    EXPECT_NE(refused({.face_vertex_counts = two, .face_vertex_indices = few}).find("at least three"),
              std::string::npos);
    EXPECT_NE(refused({.face_vertex_counts = counts, .face_vertex_indices = few}).find("asks for 3"),
              std::string::npos);
    EXPECT_NE(refused({.face_vertex_counts = counts, .face_vertex_indices = negative}).find("-1"),
              std::string::npos);
    EXPECT_NE(
        refused({.face_vertex_counts = counts, .face_vertex_indices = beyond, .st = st}).find("3 is not"),
        std::string::npos);
    const std::vector<glm::vec2> torn{{0, 0}, {0, std::numeric_limits<float>::quiet_NaN()}, {1, 1}};
    EXPECT_NE(
        refused({.face_vertex_counts = counts, .face_vertex_indices = indices, .st = torn}).find("st[1]"),
        std::string::npos);
}

TEST(UsdValues, FacesThatVaryAreTheFramesOwn) {
    const Frame frame;
    const std::vector<std::int32_t> counts{3}, indices{0, 1, 2}, beyond{0, 1, 3};
    const std::vector<glm::vec2> st(3, glm::vec2(0)), few(2, glm::vec2(0));
    MeshSample sample = frame.sample();
    sample.faces = Faces{counts, indices, st};
    const auto values = varying_values(sample, {});
    ASSERT_EQ(values.size(), 9u);
    EXPECT_EQ(values[2].attribute.name, "faceVertexCounts");
    EXPECT_EQ(std::get<std::span<const std::int32_t>>(values[2].values).data(), counts.data());
    EXPECT_EQ(values[3].attribute.name, "faceVertexIndices");
    EXPECT_EQ(std::get<std::span<const std::int32_t>>(values[3].values).data(), indices.data());
    EXPECT_EQ(values[4].attribute.name, "primvars:st");
    EXPECT_EQ(values[4].count(), 3u);

    const auto refused = [&](const Faces& faces) {
        sample.faces = faces;
        return refusal([&] { varying_values(sample, {}); });
    };
    EXPECT_NE(refused({counts, beyond, st}).find("3 is not the index of a point"), std::string::npos);
    EXPECT_NE(refused({counts, {}, st}).find("asks for 3"), std::string::npos);
    EXPECT_NE(refused({counts, indices, few}).find("primvars:st has 2 values for 3 points"),
              std::string::npos);
    // No point is in sight: no faces, and that is a frame too.
    EXPECT_EQ(varying_values({.faces = Faces{}}, {}).size(), 5u);
}

TEST(UsdTopology, HasNoFacesWhereTheyVary) {
    const std::vector<std::int32_t> counts{3}, indices{0, 1, 2};
    EXPECT_NO_THROW(check({.attributes = {.faces = true}}));
    EXPECT_THROW(
        check({.face_vertex_counts = counts, .face_vertex_indices = indices, .attributes = {.faces = true}}),
        std::invalid_argument);
}

}  // namespace
}  // namespace pelagic::usd
