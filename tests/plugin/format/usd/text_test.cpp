// The layers as text. That OpenUSD reads them is tested by usd.openusd_reads_usda; here is what it would not
// notice.
#include "plugin/format/usd/text.h"

#include <gtest/gtest.h>

#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>

namespace pelagic::usd {
namespace {

// The floats between the first '[' or '(' after `key` and the end of its line.
std::vector<float> floats_after(const std::string& text, const std::string& key) {
    std::vector<float> values;
    std::size_t at = text.find(key);
    if (at == std::string::npos) return values;
    at = text.find_first_of("[(", at + key.size());
    const std::size_t end = text.find('\n', at);
    while (at < end) {
        float value = 0.0f;
        const auto [next, error] = std::from_chars(text.data() + at, text.data() + end, value);
        if (error == std::errc{}) {
            values.push_back(value);
            at = static_cast<std::size_t>(next - text.data());
        } else {
            ++at;
        }
    }
    return values;
}

TEST(UsdText, FrameIsThisPage) {
    const std::vector<glm::vec3> points{{-1, 0, 0.5f}, {1e-10f, 2, 0.1f}};
    const std::vector<float> coverage{0.25f, 1.0f};
    EXPECT_EQ(frame_text({.frame = 7, .fps = 29.97, .points = points, .whitecap_coverage = coverage}),
              R"(#usda 1.0
(
    defaultPrim = "Sea"
    endTimeCode = 7
    framesPerSecond = 29.97
    metersPerUnit = 1
    startTimeCode = 7
    timeCodesPerSecond = 29.97
    upAxis = "Z"
)

over "Sea"
{
    point3f[] points.timeSamples = {
        7: [(-1, 0, 0.5), (1e-10, 2, 0.1)],
    }
    float3[] extent.timeSamples = {
        7: [(-1, 0, 0.1), (1e-10, 2, 0.5)],
    }
    float[] primvars:whitecapCoverage.timeSamples = {
        7: [0.25, 1],
    }
}
)");
}

TEST(UsdText, ManifestDeclaresWhatFramesHold) {
    EXPECT_EQ(manifest_text({.fps = 24.0, .attributes = {.velocities = true, .slope_variance = true}}),
              R"(#usda 1.0
(
    defaultPrim = "Sea"
    framesPerSecond = 24
    metersPerUnit = 1
    timeCodesPerSecond = 24
    upAxis = "Z"
)

over "Sea"
{
    point3f[] points
    float3[] extent
    vector3f[] velocities
    float3[] primvars:slopeVariance
}
)");
}

TEST(UsdText, TopologyIsThisPage) {
    const std::vector<std::int32_t> counts{3}, indices{0, 1, 2};
    const std::vector<glm::vec2> st{{0, 0}, {1, 0}, {0, 0.5f}};
    const std::string text = topology_text({.face_vertex_counts = counts,
                                            .face_vertex_indices = indices,
                                            .st = st,
                                            .attributes = {.normals = true, .whitecap_coverage = true}});
    EXPECT_EQ(text.substr(text.find("def Mesh")), R"(def Mesh "Sea"
{
    uniform bool doubleSided = 1
    uniform token orientation = "rightHanded"
    uniform token subdivisionScheme = "none"
    point3f[] points
    float3[] extent
    normal3f[] normals (interpolation = "vertex")
    float[] primvars:whitecapCoverage (interpolation = "vertex")
    texCoord2f[] primvars:st = [(0, 0), (1, 0), (0, 0.5)] (interpolation = "vertex")
    int[] faceVertexCounts = [3]
    int[] faceVertexIndices = [0, 1, 2]
}
)");
}

TEST(UsdText, FacesAndOriginThatVaryStandInTheFrames) {
    const std::vector<std::int32_t> counts{3}, indices{0, 1, 2};
    const std::vector<glm::vec2> st{{0, 0}, {1, 0}, {0, 0.5f}};
    const std::vector<glm::vec3> points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    const MeshSample sample{.frame = 7,
                            .faces = Faces{counts, indices, st},
                            .origin_m = glm::dvec3(10002432.0, -1e9 - 0.1, 0.0),
                            .points = points};
    const std::string frame = frame_text(sample);
    EXPECT_EQ(frame.substr(frame.find("over")), R"(over "Sea"
{
    point3f[] points.timeSamples = {
        7: [(0, 0, 0), (1, 0, 0), (0, 1, 0)],
    }
    float3[] extent.timeSamples = {
        7: [(0, 0, 0), (1, 1, 0)],
    }
    int[] faceVertexCounts.timeSamples = {
        7: [3],
    }
    int[] faceVertexIndices.timeSamples = {
        7: [0, 1, 2],
    }
    texCoord2f[] primvars:st.timeSamples = {
        7: [(0, 0), (1, 0), (0, 0.5)],
    }
    double3 xformOp:translate.timeSamples = {
        7: (10002432, -1000000000.1, 0),
    }
}
)");
    const std::string topology = topology_text({.attributes = sample.attributes()});
    EXPECT_EQ(topology.substr(topology.find("def Mesh")), R"(def Mesh "Sea"
{
    uniform bool doubleSided = 1
    uniform token orientation = "rightHanded"
    uniform token subdivisionScheme = "none"
    point3f[] points
    float3[] extent
    int[] faceVertexCounts
    int[] faceVertexIndices
    texCoord2f[] primvars:st (interpolation = "vertex")
    double3 xformOp:translate
    uniform token[] xformOpOrder = ["xformOp:translate"]
}
)");
    const std::string manifest = manifest_text({.attributes = sample.attributes()});
    EXPECT_NE(manifest.find(
                  "    int[] faceVertexCounts\n    int[] faceVertexIndices\n    texCoord2f[] primvars:st\n"
                  "    double3 xformOp:translate\n"),
              std::string::npos);
}

TEST(UsdText, CageHasNoBoundaryFacesAndVaryingPrimvars) {
    const std::vector<std::int32_t> counts{3}, indices{0, 1, 2};
    const std::vector<glm::vec2> st(3, glm::vec2(0));
    const std::string text = topology_text({.scheme = SubdivisionScheme::CatmullClark,
                                            .face_vertex_counts = counts,
                                            .face_vertex_indices = indices,
                                            .st = st,
                                            .attributes = {.slope_variance = true}});
    EXPECT_NE(text.find("\n    token interpolateBoundary = \"none\"\n"), std::string::npos);
    EXPECT_NE(text.find("uniform token subdivisionScheme = \"catmullClark\"\n"), std::string::npos);
    EXPECT_NE(text.find("primvars:slopeVariance (interpolation = \"varying\")\n"), std::string::npos);
    EXPECT_NE(text.find("(0, 0)] (interpolation = \"varying\")\n"), std::string::npos);
    EXPECT_EQ(text.find("vertex\""), std::string::npos);
}

TEST(UsdText, EveryFiniteFloatReadsBackAsTheSameBits) {
    std::mt19937 bits(1);
    std::vector<float> coverage;
    while (coverage.size() < 100000) {
        const auto value = std::bit_cast<float>(static_cast<std::uint32_t>(bits()));
        if (std::isfinite(value)) coverage.push_back(value);
    }
    const std::vector<glm::vec3> points(coverage.size(), glm::vec3(0));
    // 100 000 floats of random bits are more than a megabyte: several pieces, cut anywhere.
    std::string text;
    int pieces = 0;
    write_frame_text({.points = points, .whitecap_coverage = coverage}, [&](std::string_view piece) {
        text += piece;
        ++pieces;
    });
    EXPECT_GT(pieces, 1);
    const std::vector<float> back = floats_after(text, "whitecapCoverage.timeSamples = {\n        1: ");
    ASSERT_EQ(back.size(), coverage.size());
    for (std::size_t i = 0; i < back.size(); ++i) {
        ASSERT_EQ(std::bit_cast<std::uint32_t>(back[i]), std::bit_cast<std::uint32_t>(coverage[i])) << i;
    }
    EXPECT_TRUE(text.ends_with("],\n    }\n}\n"));
}

TEST(UsdText, NothingIsWrittenOfAFrameThatIsRefused) {
    std::vector<glm::vec3> points(1000000, glm::vec3(0));
    points.back().y = std::numeric_limits<float>::quiet_NaN();
    bool called = false;
    EXPECT_THROW(write_frame_text({.points = points}, [&](std::string_view) { called = true; }),
                 std::invalid_argument);
    EXPECT_FALSE(called);
    EXPECT_THROW(frame_text({.fps = 0.0}), std::invalid_argument);
    EXPECT_THROW(manifest_text({.fps = std::numeric_limits<double>::infinity()}), std::invalid_argument);
}

TEST(UsdText, RootOfASmallShotIsThisPage) {
    const std::string text = root_text({.name = "a-b",
                                        .first_frame = 0,
                                        .last_frame = 12,
                                        .fps = 25.0,
                                        .frame_extension = "usdc",
                                        .custom_data = {{"seed", std::int64_t{1}},
                                                        {"spectrum", std::string("say \"x\\y\"\n")},
                                                        {"sizes_m", std::vector<double>{400.0, 57.5}}}});
    const std::string expected = R"(#usda 1.0
(
    customLayerData = {
        dictionary pelagic = {
            int64 seed = 1
            string spectrum = "say \"x\\y\"\n"
            double[] sizes_m = [400, 57.5]
        }
    }
    defaultPrim = "a_b"
    endTimeCode = 12
    framesPerSecond = 25
    metersPerUnit = 1
    startTimeCode = 0
    timeCodesPerSecond = 25
    upAxis = "Z"
)

def Xform "a_b" (
    assetInfo = {
        asset identifier = @./a-b.usda@
        string name = "a-b"
    }
    kind = "component"
)
{
    def Mesh "Sea" (
        prepend apiSchemas = ["MaterialBindingAPI"]
        clips = {
            dictionary default = {
                asset manifestAssetPath = @./mesh/a-b.manifest.usda@
                string primPath = "/Sea"
                string templateAssetPath = "./mesh/a-b.####.usdc"
                double templateEndTime = 12
                double templateStartTime = 0
                double templateStride = 1
            }
        }
        prepend references = @./mesh/a-b.topology.usda@
    )
    {
        rel material:binding = </a_b/Materials/Water>
        color3f[] primvars:displayColor = [(0, 0, 0)] (interpolation = "constant")
    }

    def Scope "Materials"
    {
        def Material "Water"
        {
            token outputs:mtlx:surface.connect = </a_b/Materials/Water/Surface.outputs:out>
            token outputs:surface.connect = </a_b/Materials/Water/Preview.outputs:surface>

            def Shader "Preview"
            {
                uniform token info:id = "UsdPreviewSurface"
                color3f inputs:diffuseColor = (0, 0, 0)
                float inputs:ior = 1.34
                float inputs:metallic = 0
                float inputs:opacity = 1
                float inputs:roughness = 0.1
                token outputs:surface
            }

            def Shader "Surface"
            {
                uniform token info:id = "ND_standard_surface_surfaceshader"
                float inputs:base = 1
                color3f inputs:base_color = (0, 0, 0)
                float inputs:specular = 1
                float inputs:specular_IOR = 1.34
                float inputs:specular_roughness = 0.1
                token outputs:out
            }
        }
    }
}
)";
    EXPECT_EQ(text, expected);
}

// The mesh's doc, in one line; none: "".
std::string doc_of(const Stage& stage) {
    const std::string text = root_text(stage), key = "        doc = \"";
    const std::size_t at = text.find(key);
    if (at == std::string::npos) return "";
    return text.substr(at + key.size(), text.find("\"\n", at) - at - key.size());
}

// An artist's surface far out has an origin that nothing moves; a camera moves points, their origin, or both.
TEST(UsdText, SaysWhatFollowsTheCamera) {
    const std::string origin = "Points are relative to xformOp:translate, which ",
                      why = ": far from the world's origin floats are too coarse for places.";
    const AttributeSet constant_faces{.origin = true}, varying_faces{.faces = true, .origin = true};
    EXPECT_EQ(doc_of({}), "");
    EXPECT_EQ(doc_of({.attributes = constant_faces}), origin + "is the same at all frames" + why);
    const std::string follows =
        origin + "follows the camera in steps" + why + " A step is no motion; velocities leave it out.";
    const std::string own_faces =
        " Each frame has points and faces of its own, as its camera sees them: blur by velocities.";
    EXPECT_EQ(
        doc_of({.attributes = constant_faces, .points_follow_camera = true, .origin_follows_camera = true}),
        follows +
            " Points follow the camera in steps, too, from place to place of a sea that stays: "
            "blur by velocities.");
    EXPECT_EQ(
        doc_of({.attributes = varying_faces, .points_follow_camera = true, .origin_follows_camera = true}),
        follows + own_faces);
    EXPECT_EQ(doc_of({.attributes = varying_faces, .points_follow_camera = true}),
              origin + "stays near the mesh" + why +
                  " It may step where the cells grow, which is no motion; velocities leave it out." +
                  own_faces);
}

TEST(UsdText, MaterialReadsTheMeshsPrimvarsOnlyWhereTheyAre) {
    const std::string both =
        root_text({.attributes = {.slope_variance = true, .whitecap_coverage = true, .wet = true}});
    EXPECT_NE(both.find("float inputs:opacity.connect = </sea/Materials/Water/WetReader.outputs:result>"),
              std::string::npos);
    EXPECT_NE(both.find("color3f inputs:opacity.connect = </sea/Materials/Water/Opacity.outputs:out>"),
              std::string::npos);
    EXPECT_EQ(root_text({.attributes = {.slope_variance = true}}).find("pacityThreshold"), std::string::npos);
    EXPECT_NE(both.find("string inputs:geomprop = \"whitecapCoverage\""), std::string::npos);
    EXPECT_NE(both.find("string inputs:geomprop = \"slopeVariance\""), std::string::npos);
    // Every connection inside the material leads to a node that is there.
    const std::string prefix = ".connect = </sea/Materials/Water/";
    for (std::size_t at = both.find(prefix); at != std::string::npos; at = both.find(prefix, at + 1)) {
        const std::size_t begin = at + prefix.size();
        const std::string node = both.substr(begin, both.find('.', begin) - begin);
        EXPECT_NE(both.find("def Shader \"" + node + "\""), std::string::npos) << node;
    }
    EXPECT_EQ(root_text({}).find("geomprop"), std::string::npos);
}

// USD's rotateXYZ: about x first, then y, then z.
glm::dvec3 rotated_by_text(const std::vector<float>& angles_deg, glm::dvec3 v) {
    for (int axis = 0; axis < 3; ++axis) {
        const double angle = angles_deg.at(static_cast<std::size_t>(axis)) * std::numbers::pi / 180.0;
        const int i = (axis + 1) % 3, j = (axis + 2) % 3;
        const glm::dvec3 before = v;
        v[i] = before[i] * std::cos(angle) - before[j] * std::sin(angle);
        v[j] = before[i] * std::sin(angle) + before[j] * std::cos(angle);
    }
    return v;
}

TEST(UsdText, SizeOfTheWholeShotIsAHint) {
    const std::string text =
        root_text({.extents_hint = Extent{glm::vec3(-1.5f, -2, -3), glm::vec3(1, 2, 3.25f)}});
    EXPECT_NE(text.find("(\n    prepend apiSchemas = [\"GeomModelAPI\"]\n    assetInfo = {"),
              std::string::npos)
        << text;
    EXPECT_NE(text.find("\n    float3[] extentsHint = [(-1.5, -2, -3), (1, 2, 3.25)]\n"), std::string::npos)
        << text;
    EXPECT_EQ(root_text({}).find("xtentsHint"), std::string::npos);
    EXPECT_THROW(
        root_text({.extents_hint = Extent{glm::vec3(std::numeric_limits<float>::infinity()), glm::vec3(1)}}),
        std::invalid_argument);
}

// Whoever asks at no time gets the first frame's light, and no fallback of the schema's.
TEST(UsdText, LightThatChangesHasDefaults) {
    FrameLight morning{
        .frame = 1, .sun = {.elevation_deg = 5.0, .intensity = 3.0}, .sky = {.lat_long_file = "./a.exr"}};
    FrameLight noon{
        .frame = 9, .sun = {.elevation_deg = 60.0, .intensity = 7.0}, .sky = {.lat_long_file = "./b.exr"}};
    const std::string text = root_text({.light = {morning, noon}});
    for (const char* attribute : {"color3f inputs:color", "float inputs:intensity",
                                  "float3 xformOp:rotateXYZ", "asset inputs:texture:file"}) {
        const std::string samples = std::string(attribute) + ".timeSamples = {\n";
        const std::size_t at = text.find(samples);
        ASSERT_NE(at, std::string::npos) << attribute;
        const std::size_t value = text.find("1: ", at) + 3, end = text.find(",\n", value);
        EXPECT_NE(text.find(std::string(attribute) + " = " + text.substr(value, end - value) + '\n'),
                  std::string::npos)
            << attribute << text;
    }
}

TEST(UsdText, SunShinesFromItsDirection) {
    for (const double elevation_deg : {-5.0, 0.0, 20.0, 90.0}) {
        for (const double azimuth_deg : {-30.0, 0.0, 90.0, 300.0}) {
            const std::string text =
                root_text({.sun = Sun{.elevation_deg = elevation_deg, .azimuth_deg = azimuth_deg}});
            // A distant light shines along −z: its +z points to where the light comes from.
            const glm::dvec3 towards =
                rotated_by_text(floats_after(text, "float3 xformOp:rotateXYZ = "), glm::dvec3(0, 0, 1));
            const double e = elevation_deg * std::numbers::pi / 180.0;
            const double a = azimuth_deg * std::numbers::pi / 180.0;
            const glm::dvec3 sun(std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e));
            EXPECT_LT(glm::distance(towards, sun), 1e-14)
                << elevation_deg << " " << azimuth_deg;  // roundings
            EXPECT_NE(text.find("float inputs:angle = 0.53\n"), std::string::npos);
        }
    }
}

TEST(UsdText, SkysMiddleIsXAndItsTopTheZenith) {
    const std::string text = root_text({.sky = Sky{.lat_long_file = "./a sky@dusk.exr"}});
    const std::vector<float> angles = floats_after(text, "float3 xformOp:rotateXYZ = ");
    // Of a lat-long image the middle is a dome's +z, a quarter to the left +x, the top +y.
    EXPECT_LT(glm::distance(rotated_by_text(angles, {0, 0, 1}), glm::dvec3(1, 0, 0)), 1e-15);
    EXPECT_LT(glm::distance(rotated_by_text(angles, {1, 0, 0}), glm::dvec3(0, 1, 0)), 1e-15);
    EXPECT_LT(glm::distance(rotated_by_text(angles, {0, 1, 0}), glm::dvec3(0, 0, 1)), 1e-15);
    EXPECT_NE(text.find("asset inputs:texture:file = @@@./a sky@dusk.exr@@@\n"), std::string::npos);
    EXPECT_THROW(root_text({.sky = Sky{.lat_long_file = "a@@@b.exr"}}), std::invalid_argument);
}

TEST(UsdText, CameraIsReferenced) {
    EXPECT_EQ(root_text({}).find("Camera"), std::string::npos);
    EXPECT_NE(root_text({.name = "a-b", .has_camera = true}).find(R"(
    def Camera "Camera" (
        prepend references = @./a-b.camera.usdc@
    )
    {
    }
)"),
              std::string::npos);
}

TEST(UsdText, RootHasOneLengthWhateverTheNumberOfFrames) {
    // Numbers of the same length.
    const auto bytes = [](int last_frame) {
        return root_text({.first_frame = 1000001, .last_frame = last_frame, .has_camera = true}).size();
    };
    EXPECT_EQ(bytes(1000002), bytes(9000002));
}

TEST(UsdText, RefusesWhatNoStageCanSay) {
    EXPECT_THROW(root_text({.name = "a/b"}), std::invalid_argument);
    EXPECT_THROW(root_text({.first_frame = 2, .last_frame = 1}), std::invalid_argument);
    EXPECT_THROW(root_text({.fps = 0.0}), std::invalid_argument);
    EXPECT_THROW(root_text({.custom_data = {{"two words", true}}}), std::invalid_argument);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(root_text({.custom_data = {{"depth_m", nan}}}), std::invalid_argument);
    EXPECT_THROW(root_text({.material = {.roughness = nan}}), std::invalid_argument);
    EXPECT_THROW(root_text({.material = {.absorption_per_m = glm::vec3(nan)}}), std::invalid_argument);
    EXPECT_THROW(root_text({.sun = Sun{.azimuth_deg = nan}}), std::invalid_argument);
}

}  // namespace
}  // namespace pelagic::usd
