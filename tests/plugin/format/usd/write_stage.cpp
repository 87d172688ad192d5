// Writes two small stages of known numbers for the readers:
//   write_stage DIR usda|usdc
// 3-days-out.usda has one topology; a frame of the shot is missing on purpose. moving.usda has other faces at
// each frame and a camera that turns every way; moving-probe.usda puts a mesh under that camera. Beside them
// are DIR/expected.json and DIR/moving.json, for `read-stage.mjs --expect`, and a file for each camera, as
// read-crates.mjs takes it. Each crate has a twin in text. DIR/hard holds more pairs, with the extremes of
// what a layer may hold.
//   write_stage LARGE.usdc      a single crate of 2049² vertices, value i of its points and coverage being i
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <numbers>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/surface/rest_surface.h"
#include "plugin/format/usd/camera.h"
#include "plugin/format/usd/crate.h"
#include "plugin/format/usd/text.h"

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
    std::vector<float> whitecap_coverage, breaking, age_s;
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
    for (std::vector<float>* values : {&mesh.whitecap_coverage, &mesh.breaking, &mesh.age_s})
        for (std::size_t i = 0; i < kVertices; ++i) values->push_back(numbers.next());
    // The extremes of a float, and numbers whose shortest form is an integer or has an exponent.
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
        // Printed as a double, so that a reader of doubles rounds it to the same float.
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
           ", \"foamActive\": " + json_array(std::span<const float>(mesh.breaking)) +
           ", \"foamAge\": " + json_array(std::span<const float>(mesh.age_s)) +
           ", \"st\": " + json_array(std::span<const float>(&st[0].x, 2 * st.size())) + "}}";
}

// Hydra cuts a face (a, b, c, d, …) into the triangles (a, b, c), (a, c, d), …
std::string json_triangles(const pelagic::Faces& faces) {
    std::vector<std::int32_t> triangles;
    std::size_t first = 0;
    for (const std::int32_t corners : faces.counts) {
        const std::int32_t* face = &faces.indices[first];
        for (std::int32_t i = 1; i + 1 < corners; ++i)
            triangles.insert(triangles.end(), {face[0], face[i], face[i + 1]});
        first += static_cast<std::size_t>(corners);
    }
    return json_array(std::span<const std::int32_t>(triangles));
}

// What the reader should find besides the numbers of the frames.
std::string expected_rest(const pelagic::Faces& faces) {
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
  "double3 xformOp:rotateXYZ = (90, 0, -90)", "double3 xformOp:translate = (40, -60, 4)",
  "uniform token[] xformOpOrder = [\"xformOp:translate\", \"xformOp:rotateXYZ\"]",
  "float2 clippingRange = (0.1, 1000000)", "token projection = \"perspective\""],
"meshes": {
        "/_3_days_out/Sea" : {"material": "/_3_days_out/Materials/Water",
  "primvars": {"normals": {"dimension": 3, "interpolation": "vertex"},
    "slopeVariance": {"dimension": 3, "interpolation": "vertex"},
    "st": {"dimension": 2, "interpolation": "vertex"}},
  "indices": )json" +
           json_triangles(faces) + "}}";
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
    stage.has_camera = true;
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

// Writes layers as text, or as crates with their twins in text, and lists the twins.
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
    const pelagic::Faces quad = pelagic::grid_faces(1, 1);
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
    layers.frame("hard/far-out.0001", {.origin_m = glm::dvec3(0.1, std::numeric_limits<double>::lowest(),
                                                              std::numeric_limits<double>::denorm_min()),
                                       .points = points});
    layers.topology("hard/moves", {.attributes = {.faces = true, .origin = true}});
    layers.frame("hard/last.2147483647", {.frame = std::numeric_limits<int>::max(),
                                          .fingerprint = "0123456789abcdef",
                                          .points = points,
                                          .whitecap_coverage = coverage});
    layers.frame("hard/first.-2147483648", {.frame = std::numeric_limits<int>::min(),
                                            .fingerprint = fingerprint,
                                            .points = std::span(points).first(1),
                                            .velocities = std::span(points).first(1)});
}

// The mesh at a frame of the second stage: a grid of another size each time. At frame 3 its first face is cut
// into two triangles, so that the counts differ too; frames 4 and 5 have as many points, but other faces.
pelagic::Faces moving_faces(int frame) {
    if (frame == 4 || frame == 5) return frame == 4 ? pelagic::grid_faces(7, 3) : pelagic::grid_faces(3, 7);
    pelagic::Faces faces = pelagic::grid_faces(2 + frame, 1 + frame % 3);
    if (frame != 3) return faces;
    faces.counts.insert(faces.counts.begin(), 3);
    faces.counts[1] = 3;
    const std::int32_t a = faces.indices[0], c = faces.indices[2];
    faces.indices.insert(faces.indices.begin() + 3, {a, c});
    return faces;
}

constexpr const char* kMoving = "moving";

// Where the points' origin is at a frame of the second stage: places that no float holds, and that move at once.
glm::dvec3 moving_origin_m(int frame) {
    return frame < 5 ? glm::dvec3(1e7 + 0.125, -1e9 - 3.0, 0.0)
                     : glm::dvec3(1e7 + 4096.125, -1e9 + 4093.0, 1e-3);
}

// A matrix as USD writes it.
std::string json_translation(const glm::dvec3& by) {
    const double numbers[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, by.x, by.y, by.z, 1};
    return json_array(std::span<const double>(numbers));
}

struct CameraState {
    glm::dvec3 position_m;
    glm::dvec3 angles_deg;  // pitch, roll, heading
};

// The camera at a time of the second stage, with angles that never jump. It stands still at both ends of the
// shot. In between it pans through 180 degrees, looks straight down, rolls by a quarter, looks straight up.
CameraState moving_camera(double time) {
    const std::vector<CameraState> at_frames{
        {{-3.5, 2.0, 4.0}, {90, 0, 150}},   {{-3.5, 2.0, 4.0}, {90, 0, 150}},
        {{1e5, 2.25, 4.0}, {90, 0, 170}},   {{1e5, -7.0, 40.0}, {60, 0, 190}},
        {{1e5, -7.1, 80.0}, {0, 0, 250}},   {{1e5, -7.2, 10.0}, {50, 90, 250}},
        {{1e5, -7.3, 0.25}, {180, 0, 250}}, {{1e5, -7.3, 0.25}, {180, 0, 250}}};
    const auto before = static_cast<std::size_t>(time) - 1;  // frame 1 is the first
    const CameraState& a = at_frames.at(before);
    const CameraState& b = at_frames[std::min(before + 1, at_frames.size() - 1)];
    const double t = time - std::floor(time);
    return {a.position_m + t * (b.position_m - a.position_m),
            a.angles_deg + t * (b.angles_deg - a.angles_deg)};
}

// The axes after a turn about x by the pitch, about y by the roll and about z by the heading.
usd::CameraPose pose_of(const CameraState& state) {
    glm::dvec3 axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int axis = 0; axis < 3; ++axis) {
        const double angle = state.angles_deg[axis] * (std::numbers::pi / 180.0);
        const int i = (axis + 1) % 3, j = (axis + 2) % 3;
        for (glm::dvec3& v : axes) {
            const glm::dvec3 before = v;
            v[i] = before[i] * std::cos(angle) - before[j] * std::sin(angle);
            v[j] = before[i] * std::sin(angle) + before[j] * std::cos(angle);
        }
    }
    return {state.position_m, axes[0], axes[1], axes[2]};
}

// Camera to world, as USD writes a matrix: the rows are the images of x, y and z, then the position.
std::string json_matrix(const usd::CameraPose& pose) {
    std::vector<double> numbers;
    const glm::dvec3* rows[] = {&pose.right, &pose.up, &pose.backward, &pose.position_m};
    for (int i = 0; i < 4; ++i)
        numbers.insert(numbers.end(), {rows[i]->x, rows[i]->y, rows[i]->z, i < 3 ? 0.0 : 1.0});
    return json_array(std::span<const double>(numbers));
}

// The camera's layer, and what read-crates.mjs should find in it.
void write_camera(const std::filesystem::path& dir, const std::string& name, const usd::Camera& camera,
                  const std::vector<int>& sampled) {
    const std::string file = usd::camera_file(name);
    save(dir / file, usd::camera_crate(camera));
    const usd::FilmBack film = usd::film_back(camera.pose_at(sampled.front()).fov_deg, camera.resolution);
    const auto single = [](double value) {
        const auto rounded = static_cast<float>(value);
        return json_array(std::span<const float>(&rounded, 1));
    };
    std::string frames;
    std::vector<float> focal_lengths;
    for (const int frame : sampled)
        focal_lengths.push_back(static_cast<float>(
            usd::film_back(camera.pose_at(frame).fov_deg, camera.resolution).focal_length));
    for (const int frame : sampled)
        frames += (frames.empty() ? "\"" : ", \"") + std::to_string(frame) +
                  "\": " + json_matrix(camera.pose_at(frame));
    save(dir / (without_extension(file) + ".json"),
         "{\"focalLength\": " + json_array(std::span<const float>(focal_lengths)) +
             ",\n\"horizontalAperture\": " + single(film.horizontal_aperture) + ",\n\"verticalAperture\": " +
             single(film.vertical_aperture) + ",\n\"first\": " + std::to_string(camera.first_frame) +
             ",\n\"last\": " + std::to_string(camera.last_frame) + ",\n\"matrices\": {" + frames + "}}\n");
}

// So many samples that the writer hands them over in several pieces, with an odd number of frames before
// them.
void write_long_camera(const std::filesystem::path& dir) {
    const usd::Camera camera{
        .first_frame = -1000, .last_frame = 3000, .key_frames = {-1000, 3000}, .pose_at = [](int frame) {
            const double moved = std::max(frame, -7);
            usd::CameraPose pose = pose_of({{moved, -0.1 * moved, 9.0}, {70, 0, 0.3 * moved}});
            pose.fov_deg = 40.0 + 0.01 * moved;
            return pose;
        }};
    std::vector<int> sampled;
    for (int frame = -7; frame <= 3000; ++frame) sampled.push_back(frame);
    write_camera(dir, "hard/long", camera, sampled);
}

void write_moving_stage(const std::filesystem::path& dir, const std::string& extension) {
    constexpr int kLast = 8;
    Layers layers(dir, extension == "usdc");
    std::map<double, std::string> expected;
    usd::AttributeSet attributes;
    std::vector<glm::vec3> points, normals, points_before, normals_before;
    for (int frame = 1; frame <= kLast; ++frame) {
        const pelagic::Faces faces = moving_faces(frame);
        Numbers numbers(static_cast<std::uint64_t>(frame));
        points_before = std::exchange(points, {});
        normals_before = std::exchange(normals, {});
        for (std::size_t i = 0; i < faces.st.size(); ++i) {
            points.emplace_back(numbers.next(), numbers.next(), numbers.next());
            normals.emplace_back(numbers.next(), numbers.next(), numbers.next());
        }
        const usd::MeshSample sample{
            .frame = frame,
            .faces = usd::Faces{.counts = faces.counts, .indices = faces.indices, .st = faces.st},
            .origin_m = moving_origin_m(frame),
            .points = points,
            .normals = normals};
        attributes = sample.attributes();
        layers.frame(without_extension(usd::frame_file(kMoving, frame, extension)), sample);
        // Between two frames arrays of one length are mixed, as the points' origin is: places are mixed as they were
        // without it. Those of different lengths hold their value until the next frame.
        if (frame == 5) {
            const auto mixed = [](const std::vector<glm::vec3>& a, const std::vector<glm::vec3>& b) {
                std::vector<glm::vec3> mean(a.size());
                for (std::size_t i = 0; i < a.size(); ++i) mean[i] = 0.5f * a[i] + 0.5f * b[i];
                return json_array(mean);
            };
            expected[4.5] = "\"/moving/Sea\": {\"points\": " + mixed(points_before, points) +
                            ", \"normals\": " + mixed(normals_before, normals) + ", \"transform\": " +
                            json_translation(0.5 * (moving_origin_m(4) + moving_origin_m(5))) + "}";
        }
        for (const double time : {frame + 0.0, frame + 0.5}) {
            if (time > kLast || time == 4.5) continue;
            expected[time] = "\"/moving/Sea\": {\"points\": " + json_array(points) +
                             ", \"transform\": " + json_translation(moving_origin_m(frame)) +
                             ", \"normals\": " + json_array(normals) + ", \"st\": " +
                             json_array(std::span<const float>(&faces.st[0].x, 2 * faces.st.size())) +
                             ", \"indices\": " + json_triangles(faces) + "}";
        }
    }
    layers.topology(without_extension(usd::topology_file(kMoving, extension)), {.attributes = attributes});
    save(dir / usd::manifest_file(kMoving), usd::manifest_text({.attributes = attributes}));
    const usd::Camera camera{.fingerprint = "1234abcd",
                             .first_frame = 1,
                             .last_frame = kLast,
                             .key_frames = {1, kLast},
                             // It zooms while it moves.
                             .pose_at = [](int frame) {
                                 usd::CameraPose pose = pose_of(moving_camera(frame));
                                 pose.fov_deg = 65.0 + 2.0 * std::clamp(frame, 2, 7);
                                 return pose;
                             }};
    write_camera(dir, kMoving, camera, {2, 3, 4, 5, 6, 7});
    usd::Stage stage{.name = kMoving, .first_frame = 1, .last_frame = kLast, .attributes = attributes};
    stage.frame_extension = stage.topology_extension = extension;
    stage.has_camera = true;
    save(dir / usd::root_file(kMoving), usd::root_text(stage));

    // The reader's renderer is told of meshes only: one in the camera's place says where the camera is.
    save(dir / "moving-probe.usda", R"(#usda 1.0
(
    defaultPrim = "moving"
    metersPerUnit = 1
    subLayers = [@./moving.usda@]
    timeCodesPerSecond = 24
    upAxis = "Z"
)
over "moving" {
    over "Camera" {
        def Mesh "Probe" {
            int[] faceVertexCounts = [3]
            int[] faceVertexIndices = [0, 1, 2]
            point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
            uniform token subdivisionScheme = "none"
        }
    }
}
)");
    std::string frames;
    for (const auto& [time, sea] : expected) {
        char number[32];
        const auto [end, error] = std::to_chars(number, number + sizeof number, time);
        if (error != std::errc{}) throw std::runtime_error("a time does not fit its buffer");
        frames += (frames.empty() ? "\"" : ",\n\"") + std::string(number, end) + "\": {" + sea +
                  ", \"/moving/Camera/Probe\": {\"transform\": " + json_matrix(pose_of(moving_camera(time))) +
                  "}}";
    }
    // The transforms above are floats; the text has all digits.
    save(dir / "moving.json", R"({"prims": {"/moving/Camera": "Camera", "/moving/Sea": "Mesh"},
"flattened": ["4: (10000000.125, -1000000003, 0),", "5: (10004096.125, -999995907, 0.001),"],
"sameLayers": )" + layers.twins() +
                                  ",\n\"frames\": {" + frames + "}}\n");
}

void write_stage(const std::filesystem::path& dir, const std::string& extension) {
    const std::string name = "3-days-out";
    std::filesystem::remove_all(dir);  // of an earlier run
    Layers layers(dir, extension == "usdc");
    const pelagic::Faces faces = pelagic::grid_faces(kQuads, kQuads);
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
                                     .whitecap_coverage = mesh.whitecap_coverage,
                                     .breaking = mesh.breaking,
                                     .age_s = mesh.age_s};
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
    if (extension == "usdc") {
        write_hard_layers(layers);
        write_long_camera(dir);
    }
    // It stands still and looks along +x.
    const usd::CameraPose pose{{40.0, -60.0, 4.0}, {0, -1, 0}, {0, 0, 1}, {-1, 0, 0}};
    write_camera(dir, name,
                 {.fps = 23.976,
                  .first_frame = -2,
                  .last_frame = 2,
                  .key_frames = {-2, 2},
                  .pose_at = [&](int) { return pose; }},
                 {-2});
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
        write_moving_stage(words[0], words[1]);
    } else {
        std::fprintf(stderr, "usage: write_stage DIR usda|usdc, or write_stage LARGE.usdc\n");
        return 2;
    }
    return 0;
} catch (const std::exception& error) {
    std::fprintf(stderr, "write_stage: %s\n", error.what());
    return 1;
}
