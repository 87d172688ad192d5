// The conversion of shared formulas to GLSL, and of a driver's messages.
#include "plugin/host/gpu/shader_source.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/plugin/host/preview/gpu.h"

namespace pelagic {
namespace {

TEST(GlslOfInl, FollowsItsRulesLineByLine) {
    EXPECT_EQ(glsl_of_inl("// σ² of it\n"
                          "namespace some_detail {\n"
                          "inline constexpr double kMost = 2.0;  // [-]\n"
                          "template <class T>\n"
                          "struct Pair {\n"
                          "    T first, second;\n"
                          "};\n"
                          "}  // namespace some_detail\n"
                          "template <int P, class T>\n"
                          "inline Pair<T> pair_of(T x, T (&w)[P]) {\n"
                          "    const T y = x;\n"
                          "    return some_detail::Pair<T>(x, T(1));\n"
                          "}\n"),
              "\n"
              "\n"
              "const T kMost = 2.0;  \n"
              "\n"
              "struct Pair {\n"
              "    T first, second;\n"
              "};\n"
              "\n"
              "\n"
              "Pair pair_of(T x, out T w[P]) {\n"
              "    T y = x;\n"
              "    return Pair(x, T(1));\n"
              "}\n");
}

TEST(GlslOfInl, KeepsEachLineOfEachFile) {
    int found = 0;
    for (const ShaderFile& file : shader_files()) {
        if (!file.path.ends_with(".inl")) continue;
        ++found;
        const std::string glsl = glsl_of_inl(file.text);
        EXPECT_EQ(std::count(glsl.begin(), glsl.end(), '\n'),
                  std::count(file.text.begin(), file.text.end(), '\n'))
            << file.path;
        EXPECT_TRUE(std::all_of(glsl.begin(), glsl.end(), [](char c) { return c >= 0; })) << file.path;
    }
    EXPECT_EQ(found, 11);
}

TEST(ShaderFiles, AreFoundByPathOrMissedByName) {
    EXPECT_NE(shader_file("core/lighting/sea.glsl").text.find("sea_radiance"), std::string_view::npos);
    EXPECT_THROW(shader_file("core/lighting/see.glsl"), std::logic_error);
}

TEST(ShaderSource, SaysWhichLineOfWhichFileADriverMeans) {
    ShaderSource source;
    source.add_constants("const int kOne = 1;\n");
    source.add_file("core/lighting/special.glsl");
    // Messages of Mesa and of NVIDIA; those without a place are unchanged.
    EXPECT_EQ(source.explain("0:1(7): error: odd\n"), "constants:1: error: odd\n    const int kOne = 1;\n");
    EXPECT_EQ(source.explain("0(10001) : error C0000: odd\n"),
              "core/lighting/special.glsl:1 : error C0000: odd\n"
              "    // Constants, the sky map's projection and special functions of the sea's lighting.\n");
    EXPECT_EQ(source.explain("linking failed\n"), "linking failed\n");
}

TEST(ShaderProgram, ThatDoesNotCompileNamesTheLine) {
    gpu::need_context();
    ShaderSource source;
    source.add_file("core/lighting/special.glsl");
    source.add_constants("out vec4 colour;\nvoid main() {\n    colour = no_such_thing;\n}\n");
    try {
        gpu::program_of(source);
        FAIL() << "compiled";
    } catch (const PreviewError& error) {
        EXPECT_NE(std::string(error.what()).find("constants:3"), std::string::npos) << error.what();
        EXPECT_NE(std::string(error.what()).find("    colour = no_such_thing;"), std::string::npos);
    }
}

}  // namespace
}  // namespace pelagic
