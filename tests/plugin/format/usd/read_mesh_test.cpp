// Layers of the mesh, written and read back; and bytes that are no such layers.
#include "plugin/format/usd/read_mesh.h"

#include <gtest/gtest.h>

#include <functional>
#include <glm/vec2.hpp>

#include "plugin/format/usd/crate.h"
#include "plugin/format/usd/text.h"

namespace pelagic::usd {
namespace {

const std::vector<glm::vec3> kPoints{{0, 0, 0.1f}, {1, 0, -2e-7f}, {1, 1, 1e9f},
                                     {0, 1, 4},    {2, 0, 0},      {2, 1, 0}};
const std::vector<glm::vec3> kNormals(6, {0, 0, 1}), kVelocities(6, {1, 2, 3}),
    kVariances(6, {0.1f, 0.2f, 0});
const std::vector<float> kCoverage{0, 0.25f, 0.5f, 0.75f, 1, 0};
const std::vector<std::int32_t> kCounts{4, 4}, kCorners{0, 1, 2, 3, 1, 4, 5, 2};
const std::vector<glm::vec2> kSt{{0, 0}, {0.5f, 0}, {0.5f, 1}, {0, 1}, {1, 0}, {1, 1}};
// Of a mesh with faces of its own; no float holds it.
constexpr glm::dvec3 kOrigin_m{1e7 + 0.1, -1e9 - 1e-6, 0.0};
constexpr Faces faces() {
    return {.counts = kCounts, .indices = kCorners, .st = kSt};
}

MeshSample frame(std::optional<Faces> its_faces = {}) {
    return {.frame = -5,
            .fps = 24.0,
            .faces = its_faces,
            .origin_m = its_faces ? std::optional(kOrigin_m) : std::nullopt,
            .fingerprint = "0123abcd",
            .points = kPoints,
            .normals = kNormals,
            .velocities = kVelocities,
            .slope_variance = kVariances,
            .whitecap_coverage = kCoverage};
}
Topology topology() {
    return {.face_vertex_counts = kCounts,
            .face_vertex_indices = kCorners,
            .st = kSt,
            .attributes = frame().attributes()};
}

template <class Vector>
std::vector<float> flat(const std::vector<Vector>& vectors) {
    std::vector<float> values;
    for (const Vector& vector : vectors)
        for (int i = 0; i < Vector::length(); ++i) values.push_back(vector[i]);
    return values;
}

void expect(const MeshLayer& layer, const std::string& name, const std::vector<float>& values,
            int components) {
    for (const MeshArray& array : layer.arrays) {
        if (array.name != name) continue;
        EXPECT_EQ(std::get<std::vector<float>>(array.values), values) << name;
        EXPECT_EQ(array.components, components) << name;
        return;
    }
    ADD_FAILURE() << name << " is not there";
}
void expect_faces(const MeshLayer& layer) {
    std::size_t found = 0;
    for (const MeshArray& array : layer.arrays) {
        if (array.name == "faceVertexCounts")
            found += std::get<std::vector<std::int32_t>>(array.values) == kCounts ? 1 : 0;
        if (array.name == "faceVertexIndices")
            found += std::get<std::vector<std::int32_t>>(array.values) == kCorners ? 1 : 0;
    }
    EXPECT_EQ(found, 2u);
    expect(layer, "primvars:st", flat(kSt), 2);
}
void expect_frame(const MeshLayer& layer) {
    EXPECT_EQ(layer.frame, -5.0);
    expect(layer, "points", flat(kPoints), 3);
    expect(layer, "normals", flat(kNormals), 3);
    expect(layer, "velocities", flat(kVelocities), 3);
    expect(layer, "primvars:slopeVariance", flat(kVariances), 3);
    expect(layer, "primvars:whitecapCoverage", kCoverage, 1);
}

std::string message(const std::string& bytes) {
    try {
        read_mesh_layer(bytes);
    } catch (const ReadError& error) {
        return error.what();
    }
    return "";
}

TEST(UsdReadMesh, FramesComeBackBitForBit) {
    for (const std::string& bytes : {frame_crate(frame()), frame_text(frame())}) {
        const MeshLayer layer = read_mesh_layer(bytes);
        expect_frame(layer);
        EXPECT_EQ(layer.arrays.size(), 5u);
        EXPECT_EQ(layer.origin_m, std::nullopt);
    }
    for (const std::string& bytes : {frame_crate(frame(faces())), frame_text(frame(faces()))}) {
        const MeshLayer layer = read_mesh_layer(bytes);
        expect_frame(layer);
        expect_faces(layer);
        EXPECT_EQ(layer.origin_m, kOrigin_m);
    }
}

TEST(UsdReadMesh, TopologiesComeBack) {
    for (const std::string& bytes : {topology_crate(topology()), topology_text(topology())}) {
        const MeshLayer layer = read_mesh_layer(bytes);
        EXPECT_EQ(layer.frame, std::nullopt);
        EXPECT_EQ(layer.arrays.size(), 3u);
        expect_faces(layer);
    }
    const Topology moves{.attributes = {.faces = true, .origin = true}};
    for (const std::string& bytes : {topology_crate(moves), topology_text(moves)}) {
        EXPECT_TRUE(read_mesh_layer(bytes).arrays.empty());
        EXPECT_EQ(read_mesh_layer(bytes).origin_m, std::nullopt);
    }
}

// With seams there is a texture coordinate for each corner of each face: more than points.
TEST(UsdReadMesh, TextureCoordinatesOfCornersComeBack) {
    const std::vector<glm::vec2> st{{0, 0},    {0.5f, 0}, {0.5f, 1}, {0, 1},
                                    {0.1f, 0}, {1, 0},    {1, 1},    {0.1f, 1}};
    const Faces seamed{.counts = kCounts, .indices = kCorners, .st = st, .is_st_of_corners = true};
    for (const std::string& bytes : {frame_crate(frame(seamed)), frame_text(frame(seamed))}) {
        const MeshLayer layer = read_mesh_layer(bytes);
        expect_frame(layer);
        expect(layer, "primvars:st", flat(st), 2);
    }
    Topology whole = topology();
    whole.st = st;
    whole.attributes.st_of_corners = true;
    for (const std::string& bytes : {topology_crate(whole), topology_text(whole)})
        expect(read_mesh_layer(bytes), "primvars:st", flat(st), 2);
    // One for each corner is as many as that, and no other number.
    const std::vector<glm::vec2> few(st.begin(), st.end() - 1);
    EXPECT_THROW(frame_crate(frame(Faces{kCounts, kCorners, few, true})), std::invalid_argument);
}

TEST(UsdReadMesh, APointsOnlyFrameAndAnEmptyOneAreFrames) {
    EXPECT_EQ(read_mesh_layer(frame_crate({.points = kPoints})).arrays.size(), 1u);
    EXPECT_EQ(read_mesh_layer(frame_text({.points = kPoints})).arrays.size(), 1u);
    EXPECT_EQ(read_mesh_layer(frame_crate({})).frame, 1.0);
}

TEST(UsdReadMesh, WhatIsCutShortIsRefusedAtEveryLength) {
    for (const std::string& bytes : {frame_crate(frame(faces())), frame_text(frame(faces())),
                                     topology_crate(topology()), topology_text(topology())})
        for (std::size_t length = 0; length < bytes.size(); ++length)
            EXPECT_FALSE(message(bytes.substr(0, length)).empty()) << length << " of " << bytes.size();
}

// A changed number may still be a number: what counts is that nothing else happens, which a sanitizer sees.
TEST(UsdReadMesh, NoChangedByteLeadsOutOfTheFile) {
    for (const std::string& bytes : {frame_crate(frame(faces())), frame_text(frame(faces())),
                                     topology_crate(topology()), topology_text(topology())}) {
        int refused = 0;
        for (std::size_t at = 0; at < bytes.size(); ++at)
            for (const int change : {0x01, 0x80, 0xff}) {
                std::string changed = bytes;
                changed[at] = static_cast<char>(changed[at] ^ change);
                refused += message(changed).empty() ? 0 : 1;
            }
        EXPECT_GT(refused, 100);
    }
}

TEST(UsdReadMesh, SaysWhatIsWrong) {
    EXPECT_EQ(message(""), "is not a layer of USD");
    EXPECT_EQ(message("PNG and so on"), "is not a layer of USD");
    EXPECT_EQ(message("PXR-USDC"), "is cut short or damaged");
    EXPECT_EQ(message("#usda 1.0\n\ndef Xform \"Root\"\n{\n}\n"), "is not the layer of a sea's mesh");
    const auto replaced = [](std::string bytes, const std::string& from, const std::string& to) {
        bytes.replace(bytes.find(from), from.size(), to);
        return bytes;
    };
    const std::string text = frame_text(frame(faces()));
    EXPECT_EQ(message(replaced(text, "0, 1, 2, 3", "0, 1, 2, 6")),
              "is damaged: USD: faceVertexIndices: 6 is not the index of a point");
    EXPECT_EQ(message(replaced(text, "(0, 0, 0.1), ", "")),
              "is damaged: USD: primvars:st has 6 values for 5 points; it must have as many");
    EXPECT_EQ(message(replaced(text, "(0, 0, 0.1)", "(0, 0, nan)")),
              "is damaged: USD: points[0] is nan, and only finite values can be written");
    EXPECT_EQ(message(replaced(text, "normal3f[] normals", "point3f[] points")),
              "is damaged: points is there twice");
    EXPECT_EQ(message(replaced(text, "(10000000.1, ", "(inf, ")),
              "is damaged: USD: the points' origin must be finite");
    EXPECT_EQ(message(replaced(text, "(10000000.1, ", "(")), "is not a mesh that Pelagic wrote");
    EXPECT_EQ(message(replaced(text, "double3 xformOp:translate.timeSamples = {\n        -5",
                               "double3 xformOp:translate.timeSamples = {\n        -4")),
              "has samples of several frames");
    EXPECT_EQ(message(replaced(frame_crate(frame()), "Sea", "Cow")), "is not the layer of a sea's mesh");
}

}  // namespace
}  // namespace pelagic::usd
