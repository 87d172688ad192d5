// Bodies from Wavefront OBJ and MTL: what is read, what is refused and with which line, and damaged files.
#include "plugin/format/obj/object_obj.h"

#include <gtest/gtest.h>

#include <clocale>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <random>

#include "core/scene/limits.h"

namespace pelagic {
namespace {

using Files = std::map<std::string, std::string>;

ObjectMesh read_body(const std::string& text, const Files& files = {}) {
    const MaterialText material_text = [&](const std::string& file) -> std::optional<std::string> {
        const auto found = files.find(file);
        if (found == files.end()) return std::nullopt;
        return found->second;
    };
    // Of two texels, black and white.
    const MaterialPicture picture = [](const std::string& file, std::size_t most_texels) {
        if (file != "checker.png" && file != "my glass.png")
            throw PictureRefused{"is no file", "one that is"};
        EXPECT_GE(most_texels, 2u);
        return std::make_shared<const ObjectImage>(
            2, 1, std::vector<std::uint16_t>{0, 0, 0, 0x3c00, 0x3c00, 0x3c00});
    };
    return parse_object_obj(text, "b.obj", material_text, picture);
}

std::string body_refusal(const std::string& text, const Files& files = {}) {
    try {
        read_body(text, files);
    } catch (const ObjError& error) {
        return error.what();
    }
    return "";
}

constexpr const char* kPlate = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

double area(const ObjectMeshData& mesh) {
    double sum = 0.0;
    for (std::size_t i = 0; i < mesh.triangles.size(); i += 3) {
        const auto at = [&](std::size_t k) { return glm::dvec3(mesh.points_m[mesh.triangles[i + k]]); };
        const glm::dvec3 twice = glm::cross(at(1) - at(0), at(2) - at(0));
        EXPECT_GT(glm::dot(twice, glm::dvec3(mesh.normals[i])), 0.0);  // none is turned over
        sum += 0.5 * glm::length(twice);
    }
    return sum;
}

TEST(ObjectObj, ReadsFacesOfAllForms) {
    const ObjectMesh body = read_body(
        "# a comment\r\nmtllib none.mtl\no thing\ng part\nvt 0 0\nvn 0 0 2\nvn 0.6 0 0.8\r\n"
        "v 0 0 0\r\nv\t+1.5 0 -2e-1\nv 1 1 0 1.0\nv 0 1 0 0.5 0.5 0.5\n"
        "f 1//1 2//2 \\\n   3//1\nf -4/1 -2/1 -1/-1\nf 1/1/1 2/1/2 3/1/1\nl 1 2\n");
    const ObjectMeshData& mesh = body.data();
    EXPECT_EQ(mesh.points_m.size(), 4u);
    EXPECT_EQ(mesh.points_m[1], glm::vec3(1.5f, 0.0f, -0.2f));
    EXPECT_EQ(mesh.triangles, (std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3, 0, 1, 2}));
    EXPECT_EQ(mesh.normals[0], glm::vec3(0.0f, 0.0f, 1.0f));
    EXPECT_EQ(mesh.normals[1], glm::vec3(0.6f, 0.0f, 0.8f));
    EXPECT_EQ(mesh.normals[5], glm::vec3(0.0f, 0.0f, 1.0f));  // its face's: it has none
    ASSERT_EQ(mesh.materials.size(), 1u);
    EXPECT_EQ(mesh.materials[0].name, "grey");
    EXPECT_EQ(mesh.materials[0].colour, glm::vec3(0.8f));
}

TEST(ObjectObj, CutsPolygons) {
    EXPECT_EQ(read_body(std::string(kPlate) + "f 1 2 3 4\n").data().triangles.size(), 6u);
    // A comb, an arrow whose first corner is its notch, a face with a hole on a bridge; seen from all sides.
    const struct {
        const char* points;
        const char* face;
        double area;
    } shapes[]{
        {"v 0 0 0\nv 7 0 0\nv 7 5 0\nv 6 5 0\nv 6 1 0\nv 4 1 0\nv 4 5 0\nv 3 5 0\nv 3 1 0\nv 1 1 0\nv 1 5 0\nv 0 5 0\n",
         "f 1 2 3 4 5 6 7 8 9 10 11 12\n", 7.0 + 3.0 * 4.0},
        {"v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nv 1 1 0\nv 1 3 0\nv 3 3 0\nv 3 1 0\n",
         "f 1 2 3 4 1 5 6 7 8 5\n", 12.0},
    };
    for (const auto& shape : shapes)
        EXPECT_NEAR(area(read_body(std::string(shape.points) + shape.face).data()), shape.area, 1e-6);
    const std::string arrow = "v 0 1 0\nv 2 0 0\nv 0 4 0\nv -2 0 0\n";
    const ObjectMeshData cut = read_body(arrow + "f 1 2 3 4\n").data();
    EXPECT_NEAR(area(cut), 6.0, 1e-6);
    EXPECT_EQ(cut.triangles.size(), 6u);
    for (const char* turned :
         {"v 1 0 0\nv 0 2 0\nv 4 0 0\nv 0 -2 0\n", "v 5 0 1\nv 5 2 0\nv 5 0 4\nv 5 -2 0\n",
          "v 0 5 1\nv 2 5 0\nv 0 5 4\nv -2 5 0\n"})
        for (const char* face : {"f 1 2 3 4\n", "f 4 3 2 1\n"})
            EXPECT_NEAR(area(read_body(std::string(turned) + face).data()), 6.0, 1e-6) << turned << face;
}

TEST(ObjectObj, LeavesOutWhatHasNoArea) {
    const ObjectMesh body =
        read_body(std::string(kPlate) + "v 2 0 0\nf 1 2 5\nf 1 1 2\nf 1 2 3\nf 1 2 5 2\nf 1 5 3 4\n");
    EXPECT_NEAR(area(body.data()), 0.5 + 1.5, 1e-6);
    EXPECT_EQ(read_body(std::string(kPlate) + "f 1 2 3 3\n").data().triangles.size(), 3u);
    EXPECT_NE(body_refusal(std::string(kPlate) + "v 2 0 0\nf 1 2 5\n").find("b.obj has no face with an area"),
              std::string::npos);
    EXPECT_NE(body_refusal(kPlate).find("b.obj has no faces"), std::string::npos);
    EXPECT_NE(body_refusal("").find("b.obj has no faces"), std::string::npos);
}

// Two squares that meet at an angle.
std::string fold(double degrees, const std::string& group) {
    const double a = degrees * 3.14159265358979 / 180.0;
    return group + "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 1 " + std::to_string(1.0 + std::cos(a)) + ' ' +
           std::to_string(std::sin(a)) + "\nv 0 " + std::to_string(1.0 + std::cos(a)) + ' ' +
           std::to_string(std::sin(a)) + "\nf 1 2 3 4\n" + "f 4 3 5 6\n";
}

bool is_smooth(const std::string& text) {
    const ObjectMeshData mesh = read_body(text).data();
    const auto normal_of = [&](std::size_t triangle_from, std::uint32_t point) {
        for (std::size_t i = triangle_from; i < mesh.triangles.size(); ++i)
            if (mesh.triangles[i] == point) return mesh.normals[i];
        return glm::vec3(0.0f);
    };
    EXPECT_NEAR(glm::length(mesh.normals[0]), 1.0, 1e-6);
    // Away from the fold each face has its own.
    EXPECT_LT(glm::length(normal_of(0, 0) - glm::vec3(0.0f, 0.0f, 1.0f)), 1e-6);
    return glm::length(normal_of(0, 3) - normal_of(6, 3)) < 1e-6;
}

TEST(ObjectObj, SmoothsWithinGroups) {
    EXPECT_TRUE(is_smooth(fold(45.0, "")));
    EXPECT_FALSE(is_smooth(fold(55.0, "")));
    EXPECT_TRUE(is_smooth(fold(45.0, "s 3\n")));
    EXPECT_FALSE(is_smooth(fold(60.0, "s 3\n")));
    EXPECT_FALSE(is_smooth(fold(45.0, "s off\n")));
    EXPECT_FALSE(is_smooth(fold(45.0, "s 0\n")));
    std::string two = fold(45.0, "s 1\n");
    two.insert(two.find("f 4 3"), "s 2\n");
    EXPECT_FALSE(is_smooth(two));
    // Normals of the file are as they stand.
    std::string with = fold(45.0, "vn 0 1 0\n");
    with.replace(with.find("f 1 2 3 4"), 9, "f 1//1 2//1 3//1 4//1");
    EXPECT_EQ(read_body(with).data().normals[0], glm::vec3(0.0f, 1.0f, 0.0f));
    // One of no length counts as none.
    std::string none = fold(45.0, "vn 0 0 0\n");
    none.replace(none.find("f 1 2 3 4"), 9, "f 1//1 2//1 3//1 4//1");
    EXPECT_TRUE(is_smooth(none));
}

TEST(ObjectObj, ReadsMaterials) {
    const Files files{
        {"my paint.mtl",
         "newmtl hull\nKd 0.5 0.25 2\nNs 250\nillum 2\nKs 0.5 0.5 0.5\n\nnewmtl lamp\r\nKe 4 2 0\r\n"
         "newmtl my glass\nPr 0.1\nNs 10\nd 0.3\nmap_Ks -s 1 1 1 glass.png\nnewmtl hull\nKd 0 0 0\n"
         "newmtl none\nKd spectral file.rfl\nd 1.0\nTr 0\n"}};
    const std::string text =
        std::string("mtllib my paint.mtl\n") + kPlate +
        "usemtl lamp\nf 1 2 3\nusemtl my  glass\nf 1 2 4\nusemtl hull\nf 1 3 4\nusemtl none\nf 2 3 4\n"
        "usemtl lost\nf 2 3 4\nusemtl lamp\nf 1 2 3 4\n";
    const ObjectMesh body = read_body(text, files);
    const std::vector<ObjectMaterial>& materials = body.data().materials;
    ASSERT_EQ(materials.size(), 5u);
    EXPECT_EQ(body.data().material, (std::vector<std::uint16_t>{0, 1, 2, 3, 4, 0, 0}));
    EXPECT_EQ(materials[0], (ObjectMaterial{.name = "lamp", .glow = {1.0f, 0.5f, 0.0f}}));
    EXPECT_EQ(materials[1], (ObjectMaterial{.name = "my glass", .roughness = 0.1f}));
    EXPECT_EQ(materials[2],
              (ObjectMaterial{.name = "hull", .colour = {0.5f, 0.25f, 1.0f}, .roughness = 0.5f}));
    EXPECT_EQ(materials[3], ObjectMaterial{.name = "none"});
    EXPECT_EQ(materials[4], ObjectMaterial{.name = "lost"});
    ASSERT_EQ(body.notes().size(), 3u);
    EXPECT_EQ(body.notes()[0], "materials that no MTL file of it has are grey: \"lost\"");
    EXPECT_EQ(body.notes()[1],
              "pictures of materials are passed over: \"my glass\" (map_Ks -s 1 1 1 glass.png)");
    EXPECT_EQ(body.notes()[2], "transparency is passed over, these are opaque: \"my glass\"");
    // Two files in a line, one of which is not there; the first of a name counts.
    const ObjectMesh two =
        read_body("mtllib a.mtl b.mtl c.mtl\nusemtl m\n" + std::string(kPlate) + "f 1 2 3\n",
                  {{"a.mtl", "newmtl m\nKe 0.5\n"}, {"c.mtl", "newmtl m\nKe 1 1 1\n"}});
    EXPECT_EQ(two.data().materials[0].glow, glm::vec3(0.5f));
    EXPECT_EQ(two.notes(), std::vector<std::string>{"\"b.mtl\", which has its materials, can't be read"});
    EXPECT_EQ(
        read_body("usemtl m\n" + std::string(kPlate) + "f 1 2 3\n").notes(),
        std::vector<std::string>{"materials that no MTL file of it has are grey: \"m\" (it has no mtllib)"});
    EXPECT_TRUE(read_body(std::string(kPlate) + "f 1 2 3\n").notes().empty());
    EXPECT_EQ(body_refusal("mtllib a.mtl\n" + std::string(kPlate) + "f 1 2 3\n",
                           {{"a.mtl", "newmtl m\n\nKd 1 x 1\n"}}),
              "a.mtl:3: \"x\" is no number; accepted: numbers");
}

TEST(ObjectObj, RefusesWithTheLine) {
    const std::string square(kPlate);
    EXPECT_EQ(body_refusal(square + "f 1 2 5\n"),
              "b.obj:5: the point 5 is outside the range; accepted: 1 … 4 or -1 … -4: so many stand above");
    for (const auto& [line, problem] : std::vector<std::pair<std::string, std::string>>{
             {"f 1 2\n", "b.obj:5: the face has 2 corners"},
             {"f 1 2 0\n", "b.obj:5: the point 0 is outside the range"},
             {"f 1/1 2 3\n", "the texture coordinate 1 is outside the range"},
             {"f 1//1 2 3\n", "the normal 1 is outside the range"},
             {"f 1/ 2 3\n", "\"1/\" is no corner"},
             {"f 1/1/1/1 2 3\n", "is no corner"},
             {"v 1 2\n", "a point has 2 numbers"},
             {"v 1 2 nan\n", "is not a finite number"},
             {"v 1 2 1e7\n", "the point is outside the range"},
             {"vn 1 2\n", "a normal has 2 numbers"},
             {"vt\n", "a texture coordinate has 0 numbers"},
             {"vt 1 nan\n", "is not a finite number"},
             {"vt 1 1e5\n", "the texture coordinate is outside the range"},
             {"s smooth\n", "\"smooth\" is no whole number"},
             {"surf 0 1 0 1 1 2\n", "\"surf\" begins no line that is known"}})
        EXPECT_NE(body_refusal(square + line).find(problem), std::string::npos)
            << line << body_refusal(square + line);
    std::string wide = square + "f";
    for (std::size_t i = 0; i <= limits::kObjectCorners; ++i) wide += " 1";
    EXPECT_NE(body_refusal(wide).find("the face has 1001 corners"), std::string::npos);
    std::string many = square;
    for (std::size_t i = 0; i <= limits::kObjectMaterials; ++i) many += "usemtl m" + std::to_string(i) + '\n';
    EXPECT_NE(body_refusal(many + "f 1 2 3\n").find("too many materials"), std::string::npos);
}

TEST(ObjectObj, IsTheSameWhateverTheCommentsAndTheLocale) {
    const std::string text = std::string(kPlate) + "v 0.5 0.5 1.25\nf 1 2 5\nf 2 3 5\n";
    const std::string content = read_body(text).content();
    EXPECT_EQ(read_body("# another\no thing\n" + text).content(), content);
    std::setlocale(LC_ALL, "de_DE.UTF-8");
    EXPECT_EQ(read_body(text).content(), content);
    std::setlocale(LC_ALL, "C");
}

TEST(ObjectObj, HasPicturesOfItsColours) {
    const std::string vt = "vt 0 0\nvt 1 0\nvt 1 1 0\nvt 0.25\n";
    const auto one = [&](const std::string& mtl, const std::string& faces = "usemtl m\nf 1/1 2/2 3/3\n") {
        return read_body("mtllib a.mtl\n" + std::string(kPlate) + vt + faces,
                         {{"a.mtl", "newmtl m\n" + mtl}});
    };
    // The picture takes the place of Kd, which is its mean for whoever draws no pictures.
    const ObjectMesh body = one("Kd 0.1 0.1 0.1\nmap_Kd checker.png\n");
    ASSERT_EQ(body.data().images.size(), 1u);
    EXPECT_EQ(body.data().materials[0], (ObjectMaterial{.name = "m", .colour = glm::vec3(0.5f), .image = 0}));
    EXPECT_EQ(body.data().image_at, (std::vector<glm::vec2>{{0, 0}, {1, 0}, {1, 1}}));
    EXPECT_TRUE(body.notes().empty());
    // Coordinates without a second number, names with spaces and options; triangles stay near 0.
    EXPECT_EQ(
        one("map_Kd -blendu on -s 2 4 -o 0.5 my glass.png\n", "usemtl m\nf 1/1 2/3 3/4\n").data().image_at,
        (std::vector<glm::vec2>{{0.5, 0}, {2.5, 4}, {1, 0}}));
    EXPECT_EQ(one("map_Kd -o -3.25 checker.png\n").data().image_at,
              (std::vector<glm::vec2>{{0.75, 0}, {1.75, 0}, {1.75, 1}}));
    // Two materials of a file share it. Faces without coordinates have the mean, and say so; all is cut as before.
    const ObjectMesh two =
        read_body("mtllib a.mtl\n" + std::string(kPlate) + vt +
                      "usemtl m\nf 1/1 2/2 3/3 4/4\nusemtl n\nf 1/1 2/2 3/3\nf 1 2/1 3/1\n",
                  {{"a.mtl", "newmtl m\nmap_Kd checker.png\nnewmtl n\nmap_Kd checker.png\n"}});
    EXPECT_EQ(two.data().images.size(), 1u);
    EXPECT_EQ(two.data().material, (std::vector<std::uint16_t>{0, 0, 1, 2}));
    EXPECT_EQ(two.data().materials[2], (ObjectMaterial{.name = "n", .colour = glm::vec3(0.5f)}));
    EXPECT_EQ(two.notes(),
              std::vector<std::string>{
                  "faces without texture coordinates show the mean of their material's picture"});
    // No picture of a material that no face has; no places where there is no picture.
    EXPECT_TRUE(one("newmtl other\nmap_Kd nowhere.png\n").data().images.empty());
    EXPECT_TRUE(one("Kd 1 1 1\n").data().image_at.empty());
    const auto refusal_of = [&](const std::string& mtl) {
        return body_refusal("mtllib a.mtl\n" + std::string(kPlate) + vt + "usemtl m\nf 1/1 2/2 3/3\n",
                            {{"a.mtl", "newmtl m\n" + mtl}});
    };
    EXPECT_EQ(refusal_of("\nmap_Kd nowhere.png\n"),
              "a.mtl:3: the picture \"nowhere.png\" is no file; accepted: one that is");
    EXPECT_NE(refusal_of("map_Kd\n").find("a.mtl:2: \"map_Kd\" names no picture"), std::string::npos);
    EXPECT_NE(refusal_of("map_Kd -s nan checker.png\n").find("a.mtl:2: the picture \"nan checker.png\""),
              std::string::npos);
    EXPECT_NE(refusal_of("map_Kd -s 1e9 checker.png\n").find("a.mtl:2: \"1e9\" is outside the range"),
              std::string::npos);
    EXPECT_NE(body_refusal("mtllib a.mtl\n" + std::string(kPlate) + "vt 0\nvt 2\nusemtl m\nf 1/1 2/2 3/2\n",
                           {{"a.mtl", "newmtl m\nmap_Kd -s 1e4 checker.png\n"}})
                  .find("a.mtl:2: the picture repeats too often on a triangle"),
              std::string::npos);
}

// Whatever is damaged, it is a body or a refusal.
TEST(ObjectObj, SurvivesDamage) {
    const Files files{{"a.mtl", "newmtl m\nKd 0.1 0.2 0.3\nKe 2 2 2\nnewmtl n\nmap_Kd checker.png\n"}};
    const std::string whole =
        "mtllib a.mtl\nusemtl m\n" + std::string(kPlate) +
        "v 0.5 0.2 1\nv 3 -2 0.5\nvt 0 1\nvn 0 0 1\nvn 1e-300 0 0\ns 1\nf 1//1 2//2 3//1 4//2\nf 1 2 5\ns off\n"
        "usemtl n\nf 2/1 6/1 3/1 5/1 4\nf -1 -2 -3 -4 -5 -6\n";
    std::mt19937 random(7);
    const std::string letters = "0123456789-./ \n\\vfns#e+";
    int read_whole = 0;
    for (int trial = 0; trial < 3000; ++trial) {
        std::string text = whole;
        for (int edits = 1 + static_cast<int>(random() % 6); edits-- > 0;) {
            const std::size_t at = random() % text.size();
            if (random() % 3 == 0)
                text.erase(at, random() % 4);
            else
                text[at] = letters[random() % letters.size()];
        }
        try {
            const ObjectMesh body = read_body(text, files);
            ++read_whole;
        } catch (const ObjError&) {
        }
    }
    EXPECT_GT(read_whole, 100);
    EXPECT_LT(read_whole, 2900);
}

}  // namespace
}  // namespace pelagic
