// Cages from Wavefront OBJ: what is read, what is refused and with which line, and damaged files.
#include "plugin/format/obj/obj.h"

#include <gtest/gtest.h>

#include <clocale>
#include <random>

#include "core/scene/limits.h"

namespace pelagic {
namespace {

using namespace std::string_view_literals;

Cage read(const std::string& text) {
    return parse_obj(text, "c.obj");
}

std::string refusal(const std::string& text) {
    try {
        read(text);
    } catch (const ObjError& error) {
        return error.what();
    }
    return "";
}

constexpr const char* kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

TEST(Obj, ReadsPointsFacesAndTextureCoordinates) {
    const Cage cage = read(
        "# a comment\no thing\ng part\ns off\nusemtl water\nmtllib a.mtl\nvn 0 0 1\n"
        "v 0 0 0\r\nv\t+1.5 0 -2e-1\nv 1 1 0 1.0\nv 0 1 0 0.5 0.5 0.5\nv 2 0 0 # and one more\n"
        "vt 0 0\nvt 1 0.25 0\nvt 1 1\n"
        "f 1/1/1 2/2/1 \\\n   3/3/1 4/1/1\nf -4/-2 5/1 -3/3\nl 1 2\n");
    const CageMesh& mesh = cage.mesh();
    EXPECT_EQ(mesh.points_m.size(), 5u);
    EXPECT_EQ(mesh.points_m[1], glm::dvec3(1.5, 0.0, -0.2));
    EXPECT_EQ(mesh.face_counts, (std::vector<std::int32_t>{4, 3}));
    EXPECT_EQ(mesh.indices, (std::vector<std::int32_t>{0, 1, 2, 3, 1, 4, 2}));
    EXPECT_EQ(mesh.st.size(), 3u);
    EXPECT_EQ(mesh.st_indices, (std::vector<std::int32_t>{0, 1, 2, 0, 1, 0, 2}));
    EXPECT_EQ(mesh.boundary, CageBoundary::EdgeAndCorner);
    EXPECT_TRUE(cage.content().starts_with("2 faces, 5 points, ")) << cage.content();
    // Texture coordinates that no face has are none; v//vn has none either.
    EXPECT_TRUE(read(std::string(kSquare) + "vt 0 0\nvn 0 0 1\nf 1//1 2//1 3//1 4//-1\n").mesh().st.empty());
}

TEST(Obj, ReadsTheTags) {
    const CageMesh mesh = read(std::string(kSquare) +
                               "v 2 0 0\nv 2 1 0\nf 1 2 3 4\nf 2 5 6 3\n"
                               "t crease 2/1/0 0 1 4.7\nt crease 4/2/0 1 2 3 2 10 0.5\nt corner 1/1/0 2 3.5\n"
                               "t corner 2/1/0 0 1 2\nt hole 1/0/0 1\nt interpolateboundary 1/0/0 2\n")
                              .mesh();
    ASSERT_EQ(mesh.creases.size(), 3u);
    EXPECT_EQ(mesh.creases[0].to, 1);
    EXPECT_EQ(mesh.creases[0].sharpness, 4.7);
    EXPECT_EQ(mesh.creases[2].from, 3);
    EXPECT_EQ(mesh.creases[2].sharpness, 0.5);
    ASSERT_EQ(mesh.corners.size(), 3u);
    EXPECT_EQ(mesh.corners[0].sharpness, 3.5);
    EXPECT_EQ(mesh.corners[2].point, 1);
    EXPECT_EQ(mesh.holes, std::vector<std::int32_t>{1});
    EXPECT_EQ(mesh.boundary, CageBoundary::EdgeOnly);
    EXPECT_EQ(read(std::string(kSquare) + "f 1 2 3 4\nt interpolateboundary 1/0/0 1\n").mesh().boundary,
              CageBoundary::EdgeAndCorner);
}

struct Bad {
    std::string text, message, accepted;
};

// Every way in which a cage can be bad, with its line and what would be right.
TEST(Obj, BadCagesAreRefusedWithTheirLine) {
    const std::string square = kSquare;                              // four lines
    const std::string two = square + "v 2 0 0\nv 2 1 0\nv 3 3 3\n";  // seven
    const Bad all[] = {
        {"", "c.obj: has no faces", "1 … 1000000 faces"},
        {square, "c.obj: has no faces", "1 … 1000000 faces"},
        {"v 0 0\n", "c.obj:1: a point has 2 numbers", "three, in metres"},
        {"v 0 0 nan\n", "c.obj:1: \"nan\" is not a finite number", "finite"},
        {"\nv inf 0 0\n", "c.obj:2: \"inf\" is not a finite number", "finite"},
        {"v 0 1e999 0\n", "c.obj:1: \"1e999\" is not a finite number", "finite"},
        {"v 0 0 1,5\n", "c.obj:1: \"1,5\" is no number", "numbers"},
        {"v 0 0 0x1\n", "c.obj:1: \"0x1\" is no number", "numbers"},
        {"v 0 0 0 2\n", "c.obj:1: a point has the weight 2", "1, or no weight"},
        {square + "v 2e6 0 0\nf 1 2 3\n", "c.obj:5: the point is too far away: 2000000 m",
         "-1000000 … 1000000"},
        {"vt 0\n", "c.obj:1: a texture coordinate has 1 numbers", "two"},
        {"vt nan 0\n", "c.obj:1: \"nan\" is not a finite number", "finite"},
        {square + "vt 1e7 0\nf 1/1 2/1 3/1\n", "c.obj:5: the texture coordinate is 1e7", "-1000000"},
        {square + "f 1 2\n", "c.obj:5: the face has 2 corners", "3 … 256"},
        {square + "f 1 2 5\n", "c.obj:5: the point 5 is outside the range", "1 … 4 or -1 … -4"},
        {square + "f 0 1 2\n", "c.obj:5: the point 0 is outside", "1 … 4"},
        {square + "f -5 1 2\n", "c.obj:5: the point -5 is outside", "1 … 4"},
        {square + "f 99999999999999999999 1 2\n", "c.obj:5: \"99999999999999999999\" is no whole number",
         "from 1"},
        {square + "f 1/1 2/1 3/1\n", "c.obj:5: the texture coordinate 1 is outside the range", "faces after"},
        {square + "f 1//1 2 3\n", "c.obj:5: the normal 1 is outside the range", "faces after"},
        {square + "f 1 2 3x\n", "c.obj:5: \"3x\" is no whole number", "from 1"},
        {square + "f 1 2 3/\n", "c.obj:5: \"3/\" is no corner", "7/2/3"},
        {square + "f 1 2 3/1/1/1\n", "c.obj:5: \"3/1/1/1\" is no corner", "7/2/3"},
        {square + "f 1 2 2\n", "c.obj:5: the face has the point 1 (counted from 0) twice", "all different"},
        {square + "vt 0 0\nf 1/1 2/1 3\n", "c.obj:6: \"3\" has no texture coordinate", "for all"},
        {square + "vt 0 0\nf 1 2 3\nf 1/1 3/1 4/1\n", "c.obj:7: \"1/1\" has a texture coordinate", "for all"},
        {two + "f 1 2 3 4\nf 2 5 6 3\nf 3 2 7\n",
         "c.obj:10: the face is the third at the edge between the points 1 and 2", "one face or two"},
        {two + "f 1 2 3 4\nf 3 6 5 2\n", "c.obj:9: the face runs along the edge between the points 1 and 2",
         "same side"},
        {two + "f 1 2 4\nf 1 5 6\n", "c.obj:9: the face meets others at the point 0", "an edge"},
        // OpenSubdiv 3.5 crashes on it where an edge is sharp.
        {square + "v 2 2 0\nf 1 2 3 4\nf 3 2 1 5\n",
         "c.obj:7: the face meets one other face alone all round the point 1", "three faces"},
        {square + "f 1 2 3 4\nt crease 2/1/0 0 2 1\n", "c.obj:6: the crease lies between the points 0 and 2",
         "two points"},
        {square + "f 1 2 3 4\nt crease 2/1/0 0 9 1\n", "c.obj:6: the crease lies between the points 0 and 9",
         "two points"},
        {square + "f 1 2 3 4\nt crease 2/1/0 0 1 -1\n", "c.obj:6: the crease has the sharpness -1",
         "from 0 up"},
        {square + "f 1 2 3 4\nt crease 2/1/0 0 1 nan\n", "c.obj:6: \"nan\" is not a finite number", "finite"},
        {square + "t crease 2/1/0 0 1\n", "c.obj:5: \"2/1/0\" doesn't count what follows", "as many"},
        {square + "t crease 1/1/0 0 1\n", "c.obj:5: a crease has pairs of points", "t crease 2/1/0"},
        {square + "t crease 2/x/0 0 1\n", "c.obj:5: \"x\" is no whole number", "2/1/0"},
        {square + "t crease 99999999999/1/0 0 1\n", "c.obj:5: \"99999999999/1/0\" doesn't count", "as many"},
        {square + "f 1 2 3\nt corner 1/1/0 3 1\n", "c.obj:6: the corner is at the point 3",
         "a point of a face"},
        {square + "f 1 2 3\nt hole 1/0/0 1\n", "c.obj:6: the hole is the face 1", "faces 0 … 0"},
        {square + "f 1 2 3\nt hole 1/0/0 0\n", "c.obj: has holes alone", "no hole"},
        {square + "f 1 2 3 4\nt interpolateboundary 1/0/0 0\n", "c.obj: has no surface",
         "ends at the boundary"},
        {square + "t interpolateboundary 1/0/0 3\n", "c.obj:5: the boundary has one rule", "edge only"},
        {square + "t smooth 1/0/0 3\n", "c.obj:5: the tag \"smooth\" is not known", "crease, corner"},
        {square + "t\n", "c.obj:5: a tag has a name", "t crease"},
        {square + "curv 0 1 2\n", "c.obj:5: \"curv\" begins no line that is known", "v, vt, f"},
        {"v 0 0 \\\n 0\nf 1 \\\n 2 3\n", "c.obj:3: the point 2 is outside", "1 … 1"},
    };
    for (const Bad& bad : all) {
        const std::string message = refusal(bad.text);
        EXPECT_TRUE(message.starts_with(bad.message)) << bad.text << "→ " << message;
        EXPECT_NE(message.find(bad.accepted, message.find("; accepted: ")), std::string::npos) << message;
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    }
}

// Refused where it begins to be too much, without the time that looking at it all would take.
// Smaller than any double but 0.
TEST(Obj, NumbersThatAreTooSmallAreZero) {
    const auto cage = parse_obj("v 0 0 1e-400\nv 1 0 -2.5E-999\nv 1 1 0\nf 1 2 3\n", "c.obj");
    EXPECT_EQ(cage.mesh().points_m[0].z, 0.0);
    EXPECT_EQ(cage.mesh().points_m[1].z, 0.0);
}

TEST(Obj, TooManyFacesAreRefusedAtTheFirst) {
    std::string text = kSquare;
    for (std::size_t i = 0; i <= limits::kCageFaces; ++i) text += "f 1 2 3\n";
    EXPECT_EQ(refusal(text), "c.obj:1000005: there are too many faces; accepted: at most 1000000");
    CageMesh mesh;
    mesh.face_counts.assign(limits::kCageFaces + 1, 3);
    EXPECT_THROW(Cage{mesh}, CageError);
}

TEST(Obj, NumbersDoNotDependOnTheLocale) {
    const std::string before = std::setlocale(LC_ALL, nullptr);
    const bool is_german = std::setlocale(LC_ALL, "de_DE.UTF-8") != nullptr;
    const Cage cage = read("v 0.5 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    std::setlocale(LC_ALL, before.c_str());
    EXPECT_EQ(cage.mesh().points_m[0].x, 0.5) << is_german;
}

TEST(Obj, ContentCountsAndNotTheName) {
    const std::string text = std::string(kSquare) + "f 1 2 3 4\n";
    EXPECT_EQ(parse_obj(text, "a.obj").content(), parse_obj("# another\n" + text, "b.obj").content());
    for (const std::string& other : {std::string("v -0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n")})
        EXPECT_EQ(read(other).content(), read(text).content()) << "−0 is 0";
    std::string last = read(text).content();
    for (const char* more :
         {"t crease 2/1/0 0 1 1\n", "t corner 1/1/0 0 1\n", "t interpolateboundary 1/0/0 1\n"}) {
        EXPECT_NE(read(text + more).content(), last);
        last = read(text + more).content();
    }
    EXPECT_NE(read("v 0 0 1e-300\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n").content(), read(text).content());
}

// Damaged files are read or refused with a line of their own; nothing else happens.
TEST(Obj, DamagedFilesAreReadOrRefused) {
    const std::string whole =
        std::string(kSquare) +
        "v 2 0 0\nv 2 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nf 1/1 2/2 3/3 4/1\nf -5/1 5/2 6/3 -4/1\n"
        "t crease 2/1/0 1 2 4.7\nt corner 1/1/0 2 3.5\nt hole 1/0/0 1\n";
    std::mt19937 random(3);
    const auto below = [&](std::size_t n) {
        return std::uniform_int_distribution<std::size_t>(0, n - 1)(random);
    };
    constexpr std::string_view kTelling = "vtf #\\/-+.eE0123456789\n\r\t\0naninf"sv;
    int read_well = 0, refused = 0;
    for (int round = 0; round < 4000; ++round) {
        std::string text = whole;
        for (std::size_t changes = 1 + below(3); changes > 0; --changes) {
            const std::size_t at = below(text.size());
            switch (below(4)) {
                case 0:
                    text[at] = static_cast<char>(below(256));
                    break;
                case 1:
                    text[at] = kTelling[below(kTelling.size())];
                    break;
                case 2:
                    text.erase(at, 1 + below(6));
                    break;
                default:
                    text.insert(at, text.substr(below(text.size()), below(9)));
            }
            if (text.empty()) text = "\n";
        }
        const std::string message = refusal(text);
        ++(message.empty() ? read_well : refused);
        if (!message.empty()) {
            EXPECT_TRUE(message.starts_with("c.obj:")) << message;
            EXPECT_EQ(message.find('\n'), std::string::npos) << message;
        }
    }
    EXPECT_GT(read_well, 50);
    EXPECT_GT(refused, 1000);
}

}  // namespace
}  // namespace pelagic
