// What the USD layers of an animated sea hold, whatever the way they are written: a root for the whole shot,
// a static topology, a manifest, and one layer a frame that value clips follow (OpenUSD documentation,
// "Sequencable, Re-timeable Animated Value Clips").
//
//   DIR/NAME.usda                  the root: stage metadata, mesh with its clips, material, lights, camera
//   DIR/mesh/NAME.topology.EXT     faces, st, and the declarations of what varies
//   DIR/mesh/NAME.manifest.usda    the names and types of what varies
//   DIR/mesh/NAME.####.EXT         the values of one frame, as time samples at the frame's number
//
// Space: right-handed, z up, metres. A time code is a frame number. Everything here is a view: the arrays
// stay the caller's, and must live until the writer returns.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace pelagic::usd {

// Takes the bytes of a layer, piece after piece. What it throws passes through.
using Sink = std::function<void(std::string_view)>;

// The mesh prim, "/Sea" in topology, manifest and frames, "/ROOT/Sea" in the stage.
inline constexpr std::string_view kMeshName = "Sea";

enum class SubdivisionScheme {
    None,         // every vertex is on the sea; normals are given
    CatmullClark  // a cage: interpolateBoundary "none", so its outer ring of faces is not part of the surface
};

// Which attributes vary from frame to frame, besides points and extent, which always do. Root, topology,
// manifest and every frame of a shot must agree on it.
struct AttributeSet {
    bool normals = false;
    bool velocities = false;
    bool slope_variance = false;
    bool whitecap_coverage = false;
};

// One frame of the mesh: `size()` vertices, each array as long as points or empty (not written).
struct MeshSample {
    int frame = 1;
    double fps = 24.0;                        // > 0
    std::string_view fingerprint{};           // letters and digits; in customLayerData, empty: not written
    std::span<const glm::vec3> points{};      // [m]
    std::span<const glm::vec3> normals{};     // unit
    std::span<const glm::vec3> velocities{};  // [m/s]
    std::span<const glm::vec3> slope_variance{};  // (σxx, σyy, σxy) of what the mesh does not resolve
    std::span<const float> whitecap_coverage{};   // 0 … 1

    AttributeSet attributes() const {
        return {.normals = !normals.empty(),
                .velocities = !velocities.empty(),
                .slope_variance = !slope_variance.empty(),
                .whitecap_coverage = !whitecap_coverage.empty()};
    }
};

// The faces, the same for the whole shot.
struct Topology {
    double fps = 24.0;  // > 0
    SubdivisionScheme scheme = SubdivisionScheme::None;
    std::span<const std::int32_t> face_vertex_counts{};
    std::span<const std::int32_t> face_vertex_indices{};  // counter-clockwise seen from above
    std::span<const glm::vec2> st{};                      // per vertex; empty: not written
    AttributeSet attributes{};
};

struct Manifest {
    double fps = 24.0;  // > 0
    AttributeSet attributes{};
};

struct CameraKey {
    int frame = 1;
    glm::dvec3 position_m{0.0};
    glm::dvec3 look_at_m{0.0, 1.0, 0.0};
};

struct Camera {
    std::vector<CameraKey> keys{};       // one or more, by rising frame; linear between, constant outside
    double fov_deg = 50.0;               // horizontal, between 0 and 180
    glm::ivec2 resolution{1280, 720};    // pixels; gives the picture its shape
    glm::dvec2 clipping_m{0.1, 1000e3};  // near and far; far is beyond the horizon of any aircraft
};

struct Sun {
    double elevation_deg = 20.0;
    double azimuth_deg = 90.0;  // towards the sun, counter-clockwise from +x
    double angle_deg = 0.53;    // the disc's diameter as seen from the Earth
    // Irradiance across its rays (inputs:normalize), whatever the disc's size. A dome of intensity 1 gives π;
    // a clear sky's sun gives some five times as much as the sky.
    double intensity = 15.0;
    glm::vec3 color{1.0f, 1.0f, 1.0f};  // linear
};

struct Sky {
    double intensity = 1.0;
    glm::vec3 color{1.0f, 1.0f, 1.0f};  // linear
    // An asset path, "" for none; middle column +x, azimuth grows to the left, top row the zenith.
    std::string lat_long_file{};
};

// The surface of the water where a renderer has nothing better.
struct Material {
    double ior = 1.34;                           // sea water
    double roughness = 0.1;                      // UsdPreviewSurface's: √α
    double opacity = 1.0;                        // 0 … 1
    glm::vec3 color{0.004f, 0.016f, 0.024f};     // light coming back out of deep water, linear
    glm::vec3 whitecap_color{0.6f, 0.6f, 0.6f};  // foam, linear
};

// A value of the root's customLayerData. Infinity is allowed (deep water), NaN is refused.
using CustomValue = std::variant<bool, std::int64_t, double, std::string, std::vector<double>>;

// The root layer.
struct Stage {
    std::string name = "sea";  // letters, digits, _ and -
    int first_frame = 1;       // both included
    int last_frame = 48;
    double fps = 24.0;  // > 0
    AttributeSet attributes{};
    std::string frame_extension = "usda";     // without the dot
    std::string topology_extension = "usda";  // without the dot
    Material material{};
    std::optional<Camera> camera{};
    std::optional<Sun> sun{};
    std::optional<Sky> sky{};
    // customLayerData's dictionary "pelagic", in this order; a key is an identifier ([A-Za-z_][A-Za-z0-9_]*)
    std::vector<std::pair<std::string, CustomValue>> custom_data{};
};

// The root prim of a shot: "-" becomes "_", and a leading digit gets a "_" before it.
// Throws std::invalid_argument for anything but letters, digits, _ and -, and for an empty name.
std::string prim_name(std::string_view shot_name);

// Paths relative to the root layer's folder, without "./".
std::string root_file(std::string_view shot_name);
std::string topology_file(std::string_view shot_name, std::string_view extension);
std::string manifest_file(std::string_view shot_name);
// The number is printed as USD expands "####": at least four characters, zeros in front, a minus sign counted
// among them (7 → 0007, 12345 → 12345, 0 → 0000, −5 → -005). Every int has a file of its own.
std::string frame_number(int frame);
std::string frame_file(std::string_view shot_name, int frame, std::string_view extension);
// frame_file with "####" for the number.
std::string frame_file_template(std::string_view shot_name, std::string_view extension);

// How a varying attribute is declared. `type` is the element's: the attribute is an array of it.
struct VaryingAttribute {
    std::string_view name;
    std::string_view type;
    int components;
    bool interpolates;  // carries `interpolation` metadata: one value a vertex
};

struct VaryingValues {
    VaryingAttribute attribute;
    std::span<const float> values{};  // components of one element side by side
};

using Extent = std::array<glm::vec3, 2>;  // lower and upper corner [m]

// The box round the points; {0, 0} if there is none.
Extent extent_of(std::span<const glm::vec3> points);

// The varying attributes in the order in which every layer holds them: points and extent first.
std::vector<VaryingAttribute> varying_attributes(const AttributeSet& attributes);

// The same with a frame's values, as views into `sample` and `extent`, which must outlive the result.
// Throws std::invalid_argument naming the attribute if an array's length isn't that of points, or if it holds
// a NaN or an infinity.
std::vector<VaryingValues> varying_values(const MeshSample& sample, const Extent& extent);

// The `interpolation` metadata of a vertex's values: "vertex", or on a cage "varying", since vertex primvars
// would be smoothed by the subdivision, and overshoot, where varying ones are bilinear.
std::string_view interpolation(SubdivisionScheme scheme);

// Throws std::invalid_argument unless the frames per second are finite and above 0.
void check_rate(double fps);

// Throws std::invalid_argument naming the array: a face with fewer than three vertices, indices that don't
// match the counts, a negative index, an index without st where there is st, st that isn't finite.
void check(const Topology& topology);

// The faces and st of a grid of columns × rows quads over (columns + 1) × (rows + 1) vertices, columns
// fastest: counter-clockwise seen from +z where columns run to the right and rows upwards, st = (0, 0) at the
// first vertex, (1, 1) at the last.
struct GridFaces {
    std::vector<std::int32_t> counts{};
    std::vector<std::int32_t> indices{};
    std::vector<glm::vec2> st{};
};
// Throws std::invalid_argument without quads and beyond 2^29 − 1 of them, whose indices no longer fit an
// array's int count.
GridFaces grid_faces(int columns, int rows);
inline GridFaces grid_faces(int quads_per_side) {
    return grid_faces(quads_per_side, quads_per_side);
}

}  // namespace pelagic::usd
