// Bodies from USD crates: the same meshes as from Wavefront OBJ, what is passed over, and damaged files.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "packed_crate.h"
#include "plugin/format/obj/obj.h"
#include "plugin/format/shot/object_file.h"
#include "temporary_folder.h"

namespace pelagic {
namespace {

using Crate = PackedCrate;

// A box of quads with a corner at 0; its corners are enough to be packed.
const std::vector<float> kBox{0, 0, 0, 4, 0, 0, 4, 2, 0, 0, 2, 0, 0, 0, 1, 4, 0, 1, 4, 2, 1, 0, 2, 1};
const std::vector<std::int32_t> kBoxCorners{0, 3, 2, 1, 4, 5, 6, 7, 0, 1, 5, 4,
                                            1, 2, 6, 5, 2, 3, 7, 6, 3, 0, 4, 7};

void add_box(Crate& crate, int prim, const char* scheme = "none") {
    crate.property(prim, "points", crate.array(Crate::kVec3f, kBox, 3));
    crate.property(prim, "faceVertexCounts", crate.integers({4, 4, 4, 4, 4, 4}));
    crate.property(prim, "faceVertexIndices", crate.integers(kBoxCorners));
    if (scheme) crate.property(prim, "subdivisionScheme", crate.token(scheme));
}
Crate layer_of_metres() {
    Crate crate({{"metersPerUnit", Crate::real(1.0f)}, {"upAxis", Crate::inlined(Crate::kToken, 1)}});
    crate.token("Z");  // the first after the empty one
    return crate;
}

std::string obj_box(const std::function<glm::vec3(glm::vec3)>& placed, bool is_mirrored = false) {
    std::string text = "mtllib b.mtl\nusemtl colour 1\n";
    for (std::size_t i = 0; i < kBox.size(); i += 3) {
        const glm::vec3 at = placed({kBox[i], kBox[i + 1], kBox[i + 2]});
        text += "v " + std::to_string(at.x) + ' ' + std::to_string(at.y) + ' ' + std::to_string(at.z) + '\n';
    }
    for (std::size_t face = 0; face < kBoxCorners.size(); face += 4) {
        text += "f";
        for (std::size_t i = 0; i < 4; ++i)
            text += ' ' + std::to_string(kBoxCorners[face + (is_mirrored ? 3 - i : i)] + 1);
        text += '\n';
    }
    return text;
}

class UsdBody : public ::testing::Test {
  protected:
    std::shared_ptr<const ObjectMesh> read(const std::string& bytes, const char* name = "b.usdc") {
        folder_.write(name, bytes);
        return load_object(folder_.path() / name);
    }
    std::string refusal(const std::string& bytes, const char* name = "b.usdc") {
        try {
            read(bytes, name);
        } catch (const ObjError& error) {
            return error.what();
        }
        return "";
    }
    std::string content_of_obj(const std::string& text, const std::string& colour = "0.8 0.8 0.8") {
        folder_.write("b.mtl", "newmtl colour 1\nKd " + colour + "\n");
        return read(text, "b.obj")->content();
    }
    TemporaryFolder folder_;
};

// What a picture sees of a mesh is its content: points, faces, normals, colours, to the bit.
TEST_F(UsdBody, IsThatOfAnObj) {
    Crate crate = layer_of_metres();
    const int ship = crate.prim(0, "Ship", "Xform"), mast = crate.prim(ship, "Mast", "Xform");
    crate.property(ship, "xformOp:translate", crate.stored<double>(Crate::kVec3d, {10.5, -3, 0.25}));
    crate.property(ship, "xformOp:rotateZ", Crate::real(0.0f));
    crate.property(ship, "xformOp:scale", Crate::inlined(Crate::kVec3f, 0x020202));
    crate.property(ship, "xformOpOrder",
                   crate.tokens({"xformOp:translate", "xformOp:rotateZ", "xformOp:scale"}));
    crate.property(mast, "xformOp:transform",
                   crate.stored<double>(Crate::kMatrix, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 8, 1}));
    crate.property(mast, "xformOp:translate:pivot", crate.stored<double>(Crate::kVec3d, {7, 7, 7}));
    crate.property(
        mast, "xformOpOrder",
        crate.tokens({"xformOp:translate:pivot", "xformOp:transform", "!invert!xformOp:translate:pivot"}));
    const int box = crate.prim(mast, "Box", "Mesh");
    add_box(crate, box);
    crate.property(box, "primvars:displayColor", crate.array<float>(Crate::kVec3f, {0.5f, 0.25f, 0.125f}, 3));
    const auto body = read(crate.bytes());
    EXPECT_TRUE(body->notes().empty()) << body->notes().front();
    EXPECT_EQ(body->content(), content_of_obj(obj_box([](glm::vec3 p) {
                                                  return glm::vec3(10.5, -3, 0.25) +
                                                         2.0f * (p + glm::vec3(0, 0, 8));
                                              }),
                                              "0.5 0.25 0.125"));
}

// Unauthored: centimetres and y up; x stays ahead. Turns by x, then y, then z.
TEST_F(UsdBody, StandsUprightInMetres) {
    Crate crate;
    const int box = crate.prim(0, "Box", "Mesh");
    add_box(crate, box);
    const auto body = read(crate.bytes());
    EXPECT_NEAR(body->most_m().x, 0.04, 1e-9);
    EXPECT_NEAR(body->most_m().z, 0.02, 1e-9);
    EXPECT_NEAR(body->least_m().y, -0.01, 1e-9);
    Crate turned = layer_of_metres();
    const int other = turned.prim(0, "Box", "Mesh");
    add_box(turned, other);
    turned.property(other, "xformOp:rotateXYZ", Crate::inlined(Crate::kVec3f, 0x5a005a));
    turned.property(other, "xformOpOrder", turned.tokens({"xformOp:rotateXYZ"}));
    // (x, y, z) → (x, −z, y) → (z, x, y)
    const auto turned_body = read(turned.bytes());
    EXPECT_NEAR(glm::length(turned_body->most_m() - glm::dvec3(1, 4, 2)), 0.0, 1e-6);
    EXPECT_NEAR(glm::length(turned_body->least_m()), 0.0, 1e-6);
}

TEST_F(UsdBody, IsSeenFromOutsideWhenItIsMirrored) {
    for (const bool is_left : {false, true}) {
        Crate crate = layer_of_metres();
        const int box = crate.prim(0, "Box", "Mesh");
        add_box(crate, box);
        if (is_left) {
            crate.property(box, "orientation", crate.token("leftHanded"));
        } else {
            crate.property(box, "xformOp:scale", Crate::inlined(Crate::kVec3f, 0x0101ff));
            crate.property(box, "xformOpOrder", crate.tokens({"xformOp:scale"}));
        }
        EXPECT_EQ(read(crate.bytes())->content(),
                  content_of_obj(
                      obj_box([&](glm::vec3 p) { return glm::vec3(is_left ? p.x : -p.x, p.y, p.z); }, true)));
    }
}

TEST_F(UsdBody, SaysWhatItPassesOver) {
    Crate crate = layer_of_metres();
    const int seen = crate.prim(0, "Seen", "Mesh");
    add_box(crate, seen, nullptr);  // the default is a subdivision surface
    for (const char* property : {"visibility", "purpose"}) {
        const int parent = crate.prim(0, std::string("Of") + property, "Xform");
        crate.property(parent, property,
                       crate.token(property == std::string("visibility") ? "invisible" : "guide"));
        add_box(crate, crate.prim(parent, "Hidden", "Mesh"));
    }
    add_box(crate, crate.prim(0, "Off", "Mesh", {{"active", Crate::boolean(false)}}));
    crate.prim(0, "Ball", "Sphere");
    crate.prim(0, "Other", "Xform", {{"references", Crate::boolean(true)}});
    const int moving = crate.prim(0, "Moving", "Mesh");
    add_box(crate, moving);
    crate.property(moving, "primvars:displayColor", crate.array<float>(Crate::kVec3f, {1, 0, 0, 0, 0, 1}, 3));
    crate.property(moving, "material:binding", crate.token("any"));
    const auto body = read(crate.bytes());
    EXPECT_EQ(body->data().triangles.size(), 2u * 6 * 2 * 3);
    EXPECT_EQ(body->data().materials.at(1).colour, glm::vec3(0.5f, 0.0f, 0.5f));
    EXPECT_EQ(body->notes(),
              (std::vector<std::string>{"of several display colours the mean counts: Moving",
                                        "of shapes, meshes alone are read; passed over: Ball",
                                        "references, payloads, classes and variants are passed over: Other",
                                        "subdivision is passed over, these are their cages: Seen"}));
}

TEST_F(UsdBody, HasItsNormals) {
    const auto body_with = [&](const char* how, const std::vector<float>& normals) {
        Crate crate = layer_of_metres();
        const int plate = crate.prim(0, "Plate", "Mesh");
        crate.property(plate, "points", crate.array<float>(Crate::kVec3f, {0, 0, 0, 1, 0, 0, 1, 1, 0}, 3));
        crate.property(plate, "faceVertexCounts", crate.integers({3}));
        crate.property(plate, "faceVertexIndices", crate.integers({0, 1, 2}));
        crate.property(plate, "subdivisionScheme", crate.token("none"));
        crate.property(plate, "normals", crate.array(Crate::kVec3f, normals, 3),
                       how ? Crate::Fields{{"interpolation", crate.token(how)}} : Crate::Fields{});
        return read(crate.bytes());
    };
    const glm::vec3 slant(0.6f, 0.0f, 0.8f), up(0.0f, 0.0f, 1.0f);
    EXPECT_EQ(body_with(nullptr, {0.6f, 0, 0.8f, 0, 0, 1, 0, 0, 7})->data().normals,
              (std::vector<glm::vec3>{slant, up, up}));
    EXPECT_EQ(body_with("faceVarying", {0, 0, 1, 0.6f, 0, 0.8f, 0, 0, 0})->data().normals,
              (std::vector<glm::vec3>{up, slant, up}));
    EXPECT_EQ(body_with("constant", {0.6f, 0, 0.8f})->data().normals,
              (std::vector<glm::vec3>{slant, slant, slant}));
    EXPECT_EQ(body_with("faceVarying", {0, 0, 1})->notes(),
              std::vector<std::string>{"normals that don't fit their mesh are passed over: Plate"});
}

TEST_F(UsdBody, RefusesWhatIsNone) {
    const auto with = [&](const std::function<void(Crate&, int)>& change) {
        Crate crate = layer_of_metres();
        const int box = crate.prim(0, "Box", "Mesh");
        change(crate, box);
        add_box(crate, box);
        return refusal(crate.bytes());
    };
    EXPECT_EQ(with([](Crate&, int) {}), "");
    EXPECT_NE(with([](Crate& c, int box) {
                  c.property(box, "points", c.array<float>(Crate::kVec3f, {0, 0, 0}, 3));
              }).find("a corner whose point isn't there"),
              std::string::npos);
    EXPECT_NE(with([](Crate& c, int box) {
                  c.property(box, "points",
                             c.array<float>(Crate::kVec3f, std::vector<float>(24, std::nanf("")), 3));
              }).find("a point that isn't finite"),
              std::string::npos);
    EXPECT_NE(with([](Crate& c, int box) {
                  c.property(box, "faceVertexCounts", c.integers({4, 4}));
              }).find("another number of corners"),
              std::string::npos);
    EXPECT_NE(with([](Crate& c, int box) {
                  c.property(box, "points", c.array<float>(Crate::kVec3f, std::vector<float>(24, 1e8f), 3));
              }).find("the mesh has a point outside the range"),
              std::string::npos);
    EXPECT_NE(with([](Crate& c, int box) {
                  c.property(box, "xformOpOrder", c.tokens({"xformOp:other"}));
              }).find("the transform 'xformOp:other', which isn't there"),
              std::string::npos);
    Crate empty = layer_of_metres();
    empty.prim(0, "Ball", "Sphere");
    EXPECT_NE(refusal(empty.bytes()).find("has no mesh that is read (of shapes, meshes alone are read"),
              std::string::npos);
    EXPECT_NE(
        refusal("#usda 1.0\n", "b.usda").find("the mesh is USD as text, which isn't read; accepted: a crate"),
        std::string::npos);
    EXPECT_NE(refusal("PXR-USDC").find("the mesh is cut short or damaged"), std::string::npos);
}

// Whatever is damaged, it is a body or a refusal.
TEST_F(UsdBody, SurvivesDamage) {
    Crate crate = layer_of_metres();
    const int box = crate.prim(crate.prim(0, "Ship", "Xform"), "Box", "Mesh");
    add_box(crate, box);
    crate.property(box, "primvars:displayColor", crate.array<float>(Crate::kVec3f, {0.5f, 0.25f, 0.125f}, 3));
    const std::string whole = crate.bytes();
    EXPECT_EQ(refusal(whole), "");
    for (std::size_t size = 0; size < whole.size(); size += 7)
        EXPECT_NE(refusal(whole.substr(0, size)), "") << size;
    std::mt19937 random(5);
    int refused = 0;
    for (int trial = 0; trial < 3000; ++trial) {
        std::string bytes = whole;
        for (int edits = 1 + static_cast<int>(random() % 3); edits-- > 0;)
            bytes[random() % bytes.size()] = static_cast<char>(random() % 3 == 0 ? 255 : random());
        refused += !refusal(bytes).empty();
    }
    EXPECT_GT(refused, 500);
    EXPECT_LT(refused, 2900);
}

}  // namespace
}  // namespace pelagic
