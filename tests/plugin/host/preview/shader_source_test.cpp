// The conversion of shared formulas to GLSL, and of a driver's messages.
#include "plugin/host/gpu/shader_source.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/plugin/host/preview/gpu.h"

namespace pelagic {
namespace {

TEST(ShaderFiles, AreConvertedLineByLine) {
    int found = 0;
    for (const ShaderFile& file : shader_files()) {
        EXPECT_EQ(std::count(file.glsl.begin(), file.glsl.end(), '\n'),
                  std::count(file.text.begin(), file.text.end(), '\n'))
            << file.path;
        EXPECT_TRUE(file.glsl.ends_with('\n')) << file.path;  // what follows is a line of its own
        EXPECT_TRUE(std::all_of(file.glsl.begin(), file.glsl.end(), [](char c) { return c >= 0; }))
            << file.path;
        if (!file.path.ends_with(".inl")) continue;
        ++found;
        for (const char* cxx : {"inline ", "template", "namespace", "constexpr", "<T>", "::", "(&"})
            EXPECT_EQ(file.glsl.find(cxx), std::string_view::npos) << file.path << ": " << cxx;
    }
    EXPECT_EQ(found, 15);
    EXPECT_NE(shader_file("core/waves/spline.inl").glsl.find("out T "), std::string_view::npos);
    EXPECT_NE(shader_file("core/waves/gusts.inl").glsl.find("\n    T resolved = weight * amplitude;\n"),
              std::string_view::npos);
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
