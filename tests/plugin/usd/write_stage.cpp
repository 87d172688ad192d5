// Writes a small stage of known numbers for the readers: write_stage DIR usda|usdc. Beside the layers it
// leaves DIR/expected.json, in the form that `read-stage.mjs --expect` takes. One frame of the shot is
// missing on purpose. Of crates there is a twin in text for each, and DIR/hard holds more pairs: what is at
// the ends of what a layer may be.
//   write_stage LARGE.usdc      a single crate of 2049² vertices, value i of its points and coverage being i
#include <algorithm>
#include <charconv>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "plugin/usd/crate.h"
#include "plugin/usd/text.h"

namespace {

namespace usd = pelagic::usd;

constexpr int kQuads = 16;
constexpr std::size_t kVertices = (kQuads + 1) * (kQuads + 1);

// SplitMix64 (Steele, Lea & Flood 2014): the numbers only have to be the same everywhere.
class Numbers {
  public:
    explicit Numbers(std::uint64_t seed) : state_(seed) {}

    std::uint64_t bits() {
        std::uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        return z ^ (z >> 31);
    }
    // −1 … 1 with all the digits of a float.
    float next() { return static_cast<float>(static_cast<double>(bits() >> 11) * 0x1p-52 - 1.0); }

  private:
    std::uint64_t state_;
};

struct Mesh {
    std::vector<glm::vec3> points, normals, velocities, slope_variance;
    std::vector<float> whitecap_coverage;
};

std::vector<glm::vec3> random_vectors(Numbers& numbers, float scale) {
    std::vector<glm::vec3> values(kVertices);
    for (glm::vec3& v : values) {
        for (int i = 0; i < 3; ++i) v[i] = scale * numbers.next();
    }
    return values;
}

Mesh random_mesh(int frame) {
    Numbers numbers(1000u + static_cast<std::uint64_t>(static_cast<std::int64_t>(frame)));
    Mesh mesh;
    mesh.points = random_vectors(numbers, 100.0f);
    mesh.normals = random_vectors(numbers, 1.0f);
    mesh.velocities = random_vectors(numbers, 10.0f);
    mesh.slope_variance = random_vectors(numbers, 1e-3f);
    for (std::size_t i = 0; i < kVertices; ++i) mesh.whitecap_coverage.push_back(numbers.next());
    // The ends of what a float can hold, and numbers whose shortest form is an integer or has an exponent.
    const float hard[] = {std::numeric_limits<float>::denorm_min(),
                          std::numeric_limits<float>::min(),
                          std::numeric_limits<float>::max(),
                          std::numeric_limits<float>::lowest(),
                          -0.0f,
                          16777216.0f,
                          1e10f,
                          1e-10f,
                          0.1f};
    std::copy(std::begin(hard), std::end(hard), mesh.whitecap_coverage.begin());
    return mesh;
}

void save(const std::filesystem::path& file, const std::string& text) {
    std::filesystem::create_directories(file.parent_path());
    std::ofstream out(file, std::ios::binary);
    out << text;
    if (!out.flush()) throw std::runtime_error("cannot write " + file.string());
}

template <class T>
std::string json_array(std::span<const T> values) {
    std::string text = "[";
    char number[32];
    for (std::size_t i = 0; i < values.size(); ++i) {
        // As a double: JSON's reader then has the very float.
        const auto value = static_cast<double>(values[i]);
        const auto [end, error] = std::to_chars(number, number + sizeof number, value);
        if (error != std::errc{}) throw std::runtime_error("a number does not fit its buffer");
        if (i > 0) text += ',';
        text.append(number, end);
    }
    return text + "]";
}

std::string json_array(const std::vector<glm::vec3>& values) {
    return json_array(std::span<const float>(&values[0].x, 3 * values.size()));
}

constexpr const char* kMesh = "/_3_days_out/Sea";

std::string expected_frame(const Mesh& mesh, const std::vector<glm::vec2>& st) {
    const usd::Extent extent = usd::extent_of(mesh.points);
    return "{\"" + std::string(kMesh) + "\": {\"points\": " + json_array(mesh.points) +
           ", \"extent\": " + json_array(std::span<const float>(&extent[0].x, 6)) +
           ", \"normals\": " + json_array(mesh.normals) + ", \"velocities\": " + json_array(mesh.velocities) +
           ", \"slopeVariance\": " + json_array(mesh.slope_variance) +
           ", \"whitecapCoverage\": " + json_array(std::span<const float>(mesh.whitecap_coverage)) +
           ", \"st\": " + json_array(std::span<const float>(&st[0].x, 2 * st.size())) + "}}";
}

// What the reader should find besides the numbers of the frames. Hydra cuts a quad (a, b, c, d) into the
// triangles (a, b, c) and (a, c, d).
std::string expected_rest(const usd::GridFaces& faces) {
    std::vector<std::int32_t> triangles;
    for (std::size_t i = 0; i < faces.indices.size(); i += 4) {
        const std::int32_t* quad = &faces.indices[i];
        triangles.insert(triangles.end(), {quad[0], quad[1], quad[2], quad[0], quad[2], quad[3]});
    }
    return R"json("stage": {"startTimeCode": -2, "endTimeCode": 2, "timeCodesPerSecond": 23.976},
"prims": {"/_3_days_out": "Xform", "/_3_days_out/Sea": "Mesh", "/_3_days_out/Camera": "Camera",
  "/_3_days_out/Sun": "DistantLight", "/_3_days_out/Sky": "DomeLight",
  "/_3_days_out/Materials/Water": "Material", "/_3_days_out/Materials/Water/Preview": "Shader",
  "/_3_days_out/Materials/Water/Surface": "Shader"},
"materials": {"/_3_days_out/Materials/Water": {"/_3_days_out/Materials/Water/Preview":
  {"ior": 1.340000033378601, "roughness": 0.25, "opacity": 0.875}}},
"root": ["defaultPrim = \"_3_days_out\"", "upAxis = \"Z\"", "metersPerUnit = 1", "framesPerSecond = 23.976",
  "int64 seed = 9007199254740993", "double depth_m = inf", "double loop_s = 0.1", "bool whitecaps = 1",
  "double[] cascades_m = [400, 57.3]", "string spectrum = '''a \"quoted\" \\\\ name"],
"flattened": ["apiSchemas = [\"MaterialBindingAPI\"]", "uniform bool doubleSided = 1",
  "uniform token orientation = \"rightHanded\"", "uniform token subdivisionScheme = \"none\"",
  "float3 xformOp:rotateXYZ = (0, 70, 90)", "float inputs:angle = 0.53",
  "-2: ( (1, 0, 0, 0), (0, 0, 1, 0), (0, -1, 0, 0), (0, -60, 4, 1) ),",
  "2: ( (0, 1, 0, 0), (0, 0, 1, 0), (1, 0, 0, 0), (40, -60, 4, 1) ),"],
"meshes": {
        "/_3_days_out/Sea" : {"material": "/_3_days_out/Materials/Water",
  "primvars": {"normals": {"dimension": 3, "interpolation": "vertex"},
    "slopeVariance": {"dimension": 3, "interpolation": "vertex"},
    "st": {"dimension": 2, "interpolation": "vertex"}},
  "indices": )json" +
           json_array(std::span<const std::int32_t>(triangles)) + "}}";
}

usd::Stage stage_of(const std::string& name, const usd::AttributeSet& attributes) {
    usd::Stage stage;
    stage.name = name;
    stage.first_frame = -2;
    stage.last_frame = 2;
    stage.fps = 23.976;
    stage.attributes = attributes;
    stage.material.roughness = 0.25;
    stage.material.opacity = 0.875;
    // From looking along y to looking along -x, both level, so that the matrices are whole numbers.
    stage.camera = usd::Camera{
        .keys = {{-2, {0.0, -60.0, 4.0}, {0.0, 40.0, 4.0}}, {2, {40.0, -60.0, 4.0}, {-60.0, -60.0, 4.0}}}};
    stage.sun = usd::Sun{};
    stage.sky = usd::Sky{};
    stage.custom_data = {{"seed", std::int64_t{9007199254740993}},
                         {"depth_m", std::numeric_limits<double>::infinity()},
                         {"loop_s", 0.1},
                         {"whitecaps", true},
                         {"spectrum", std::string("a \"quoted\" \\ name\nof two lines")},
                         {"cascades_m", std::vector<double>{400.0, 57.3}}};
    return stage;
}

// Writes layers in one of the two ways, crates with their twins, of which it keeps a list.
class Layers {
  public:
    Layers(std::filesystem::path dir, bool crates) : dir_(std::move(dir)), crates_(crates) {}

    void frame(const std::string& stem, const usd::MeshSample& sample) {
        if (crates_) pair(stem, usd::frame_crate(sample));
        save(dir_ / (stem + ".usda"), usd::frame_text(sample));
    }
    void topology(const std::string& stem, const usd::Topology& topology) {
        if (crates_) pair(stem, usd::topology_crate(topology));
        save(dir_ / (stem + ".usda"), usd::topology_text(topology));
    }
    // A JSON array of [crate, text].
    std::string twins() const { return "[" + twins_ + "]"; }

  private:
    void pair(const std::string& stem, const std::string& crate) {
        save(dir_ / (stem + ".usdc"), crate);
        twins_ += std::string(twins_.empty() ? "" : ", ") + "[\"" + stem + ".usdc\", \"" + stem + ".usda\"]";
    }

    std::filesystem::path dir_;
    bool crates_;
    std::string twins_;
};

std::string without_extension(const std::string& file) {
    return file.substr(0, file.rfind('.'));
}

void write_hard_layers(Layers& layers) {
    const usd::GridFaces quad = usd::grid_faces(1);
    const usd::Topology bare{.face_vertex_counts = quad.counts, .face_vertex_indices = quad.indices};
    layers.topology("hard/bare-quad", bare);
    layers.topology("hard/no-faces", {.fps = 1e-3});
    usd::Topology cage = bare;
    cage.fps = 1.0 / 3.0;
    cage.scheme = usd::SubdivisionScheme::CatmullClark;
    cage.st = quad.st;
    cage.attributes = {
        .normals = true, .velocities = true, .slope_variance = true, .whitecap_coverage = true};
    layers.topology("hard/cage", cage);

    const std::vector<glm::vec3> points(4,
                                        glm::vec3(-0.0f, std::numeric_limits<float>::denorm_min(), -1e-40f));
    const std::vector<float> coverage(4, -0.0f);
    const std::string fingerprint(10000, 'f');
    layers.frame("hard/only-points.12345", {.frame = 12345, .fps = 1000.0 / 1001.0, .points = points});
    layers.frame("hard/no-points.0000", {.frame = 0});
    layers.frame("hard/last.2147483647", {.frame = std::numeric_limits<int>::max(),
                                          .fingerprint = "0123456789abcdef",
                                          .points = points,
                                          .whitecap_coverage = coverage});
    layers.frame("hard/first.-2147483648", {.frame = std::numeric_limits<int>::min(),
                                            .fingerprint = fingerprint,
                                            .points = std::span(points).first(1),
                                            .velocities = std::span(points).first(1)});
}

void write_stage(const std::filesystem::path& dir, const std::string& extension) {
    const std::string name = "3-days-out";
    std::filesystem::remove_all(dir);  // of an earlier run
    Layers layers(dir, extension == "usdc");
    const usd::GridFaces faces = usd::grid_faces(kQuads);
    std::string frames;
    usd::AttributeSet attributes;
    for (const int frame : {-2, 0, 1, 2}) {  // −1 is missing
        const Mesh mesh = random_mesh(frame);
        const usd::MeshSample sample{.frame = frame,
                                     .fps = 23.976,
                                     .fingerprint = "1234abcd",
                                     .points = mesh.points,
                                     .normals = mesh.normals,
                                     .velocities = mesh.velocities,
                                     .slope_variance = mesh.slope_variance,
                                     .whitecap_coverage = mesh.whitecap_coverage};
        attributes = sample.attributes();
        layers.frame(without_extension(usd::frame_file(name, frame, extension)), sample);
        frames += (frames.empty() ? "\"" : ",\n\"") + std::to_string(frame) +
                  "\": " + expected_frame(mesh, faces.st);
    }
    layers.topology(without_extension(usd::topology_file(name, extension)),
                    {.fps = 23.976,
                     .face_vertex_counts = faces.counts,
                     .face_vertex_indices = faces.indices,
                     .st = faces.st,
                     .attributes = attributes});
    if (extension == "usdc") write_hard_layers(layers);
    save(dir / usd::manifest_file(name), usd::manifest_text({.fps = 23.976, .attributes = attributes}));
    usd::Stage stage = stage_of(name, attributes);
    stage.frame_extension = stage.topology_extension = extension;
    save(dir / usd::root_file(name), usd::root_text(stage));

    save(dir / "expected.json", "{" + expected_rest(faces) + ",\n\"sameLayers\": " + layers.twins() +
                                    ",\n\"frames\": {" + frames + "}}\n");
}

void write_large(const std::filesystem::path& file) {
    constexpr std::size_t kLarge = 2049 * 2049;
    std::vector<glm::vec3> points(kLarge);
    std::vector<float> coverage(kLarge);
    // Whole numbers below 2^24, all of them floats.
    for (std::size_t i = 0; i < 3 * kLarge; ++i)
        points[i / 3][static_cast<int>(i % 3)] = static_cast<float>(i);
    for (std::size_t i = 0; i < kLarge; ++i) coverage[i] = static_cast<float>(i);
    std::filesystem::create_directories(file.parent_path());
    std::ofstream out(file, std::ios::binary);
    usd::write_frame_crate({.frame = 12345, .points = points, .whitecap_coverage = coverage},
                           [&](std::string_view part) { out << part; });
    if (!out.flush()) throw std::runtime_error("cannot write " + file.string());
}

}  // namespace

int main(int argc, char** argv) try {
    const std::vector<std::string> words(argv + 1, argv + argc);
    if (words.size() == 1) {
        write_large(words[0]);
    } else if (words.size() == 2 && (words[1] == "usda" || words[1] == "usdc")) {
        write_stage(words[0], words[1]);
    } else {
        std::fprintf(stderr, "usage: write_stage DIR usda|usdc, or write_stage LARGE.usdc\n");
        return 2;
    }
    return 0;
} catch (const std::exception& error) {
    std::fprintf(stderr, "write_stage: %s\n", error.what());
    return 1;
}
