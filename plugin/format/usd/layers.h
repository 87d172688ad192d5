// The layers of an animated sea in USD, whether written as text or as crates: a root for the whole shot, the
// static part of the mesh, a manifest, and one layer for each frame, which value clips join (OpenUSD
// documentation, "Sequencable, Re-timeable Animated Value Clips").
//
//   DIR/NAME.usda                  the root: stage metadata, mesh with its clips, material, lights, camera
//   DIR/NAME.sky.exr               the dome's image, which someone else writes
//   DIR/NAME.camera.usdc           the camera's lens and its pose at each frame (camera.h)
//   DIR/NAME.volumes.usda          volumes and their files (volumes.h)
//   DIR/NAME.drops.usda            drops of spray and their files (drops.h)
//   DIR/mesh/NAME.topology.EXT     faces and st, and declarations of the attributes that vary
//   DIR/mesh/NAME.manifest.usda    names and types of the attributes that vary
//   DIR/mesh/NAME.####.EXT         one frame's values, as time samples at the frame's number
//
// Where the faces vary from frame to frame, they and st are in the frames' layers, and the topology only
// declares them. Between two frames with different numbers of points USD holds the first one's mesh; between
// others it mixes both.
//
// A float holds a place to a 16 millionth of its distance from the origin. So a mesh that follows a camera has an
// origin of its own: its points, and its extent with them, are relative to xformOp:translate. That is a double3 and a
// sample of the frame's own layer, so that it comes with the points, and is mixed where they are. It moves in long
// steps. Whoever blurs motion by velocities takes origin and points at the frame itself: the way to a frame with
// another origin is no motion.
//
// Space is right-handed, z up, in metres. A time code is a frame number. The structs here refer to the
// caller's arrays, which must live until the writer returns.
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

// Receives the bytes of a layer, piece after piece. The writers let its exceptions pass.
using Sink = std::function<void(std::string_view)>;

// The mesh prim: "/Sea" in topology, manifest and frames, "/ROOT/Sea" in the stage.
inline constexpr std::string_view kMeshName = "Sea";
// The mesh's attribute that holds where its points' origin is, and that attribute's type.
inline constexpr std::string_view kOrigin = "xformOp:translate", kOriginType = "double3";
// The camera prim: "/Camera" in its layer, "/ROOT/Camera" in the stage.
inline constexpr std::string_view kCameraName = "Camera";

enum class SubdivisionScheme {
    None,         // every vertex is on the sea; normals are given
    CatmullClark  // a cage; its outer ring of faces is not part of the surface (interpolateBoundary "none")
};

// Which attributes vary from frame to frame, besides points and extent, which always do. It must be the same
// for root, topology, manifest and every frame of a shot.
struct AttributeSet {
    bool normals = false;
    bool velocities = false;
    bool slope_variance = false;
    bool whitecap_coverage = false;
    bool foam_history = false;   // primvars:foamActive and primvars:foamAge, both
    bool wet = false;            // primvars:wet: hulls keep water out of the mesh
    bool faces = false;          // faceVertexCounts, faceVertexIndices and primvars:st, all three
    bool origin = false;         // kOrigin
    bool st_of_corners = false;  // primvars:st has a value for each corner of each face (faceVarying)
};

// The faces of a mesh, by reference.
struct Faces {
    std::span<const std::int32_t> counts{};   // vertices of each face, 3 or more
    std::span<const std::int32_t> indices{};  // counter-clockwise seen from above
    std::span<const glm::vec2> st{};          // one for each vertex, or for each index
    bool is_st_of_corners = false;            // the latter
};

// One frame of the mesh. An array other than points is as long as points, or empty: then it is not written.
struct MeshSample {
    int frame = 1;
    double fps = 24.0;                        // > 0
    std::optional<Faces> faces{};             // only where they vary from frame to frame
    std::optional<glm::dvec3> origin_m{};     // in the world; absent: the world's own
    std::string_view fingerprint{};           // letters and digits; in customLayerData, empty: not written
    std::span<const glm::vec3> points{};      // relative to the origin [m]
    std::span<const glm::vec3> normals{};     // unit
    std::span<const glm::vec3> velocities{};  // [m/s]
    std::span<const glm::vec3> slope_variance{};  // (σxx, σyy, σxy) of what the mesh does not resolve
    std::span<const float> whitecap_coverage{};   // 0 … 1
    std::span<const float> breaking{};            // of it, where waves break now, 0 … 1; with age_s
    std::span<const float> age_s{};               // the mean age of that foam [s]
    std::span<const float> wet{};                 // 1 water, 0 in a hull; ½ on its outline

    AttributeSet attributes() const {
        return {.normals = !normals.empty(),
                .velocities = !velocities.empty(),
                .slope_variance = !slope_variance.empty(),
                .whitecap_coverage = !whitecap_coverage.empty(),
                .foam_history = !breaking.empty() || !age_s.empty(),
                .wet = !wet.empty(),
                .faces = faces.has_value(),
                .origin = origin_m.has_value(),
                .st_of_corners = faces && faces->is_st_of_corners};
    }
};

// The static part of the mesh. Its arrays are empty where the faces vary (attributes.faces).
struct Topology {
    double fps = 24.0;  // > 0
    SubdivisionScheme scheme = SubdivisionScheme::None;
    std::span<const std::int32_t> face_vertex_counts{};
    std::span<const std::int32_t> face_vertex_indices{};  // counter-clockwise seen from above
    // One for each vertex, or with attributes.st_of_corners for each index; empty: not written.
    std::span<const glm::vec2> st{};
    AttributeSet attributes{};
};

struct Manifest {
    double fps = 24.0;  // > 0
    AttributeSet attributes{};
};

struct Sun {
    double elevation_deg = 20.0;
    double azimuth_deg = 90.0;  // towards the sun, counter-clockwise from +x
    double angle_deg = 0.53;    // the disc's diameter as seen from the Earth
    // Irradiance on a plane across its rays, for a disc of any size: UsdLux divides a distant light's emission
    // by π sin²(angle/2) where inputs:normalize is set.
    double intensity = 1.0;
    glm::vec3 color{1.0f, 1.0f, 1.0f};  // linear
};

struct Sky {
    double intensity = 1.0;             // times the image: radiance, in the sun's unit per steradian
    glm::vec3 color{1.0f, 1.0f, 1.0f};  // linear
    // An asset path, "" for none. The image's middle column is +x, azimuth grows to the left, and the top row
    // is the zenith.
    std::string lat_long_file{};
};

// Sun and sky from a frame on, until the next one's.
struct FrameLight {
    int frame = 1;
    Sun sun{};  // an intensity of 0: it doesn't shine
    Sky sky{};
};

// How the water looks in a renderer that has no material of its own for it.
struct Material {
    double ior = 1.34;               // sea water
    double roughness = 0.1;          // √α, as UsdPreviewSurface has it
    double opacity = 1.0;            // 0 … 1
    glm::vec3 color{0.0f};           // albedo of the water below the surface, linear
    glm::vec3 whitecap_color{1.0f};  // albedo of foam, linear
    // Of the water, for who lets light through it; without extinction: not written. Scattering is isotropic.
    glm::vec3 absorption_per_m{0.0f}, scattering_per_m{0.0f};
};

// A value of the root's customLayerData. Infinity is allowed (deep water), NaN is refused.
using CustomValue = std::variant<bool, std::int64_t, double, std::string, std::vector<double>>;

using Extent = std::array<glm::vec3, 2>;  // lower and upper corner [m]

// The root layer.
struct Stage {
    std::string name = "sea";  // letters, digits, _ and -
    int first_frame = 1;       // both included
    int last_frame = 48;
    double fps = 24.0;  // > 0
    AttributeSet attributes{};
    // Of the mesh's surface: whether its vertices are at other places when the camera moves, and whether the places'
    // origin (attributes.origin) is one near the camera.
    bool points_follow_camera = false, origin_follows_camera = false;
    std::string frame_extension = "usda";     // without the dot
    std::string topology_extension = "usda";  // without the dot
    Material material{};
    bool has_camera = false;               // camera_file() is beside the root
    bool has_volumes = false;              // volumes_file() is
    bool has_drops = false;                // drops_file() (drops.h) is
    std::optional<Extent> extents_hint{};  // round everything at all frames, where that is known [m]
    std::optional<Sun> sun{};
    std::optional<Sky> sky{};
    std::vector<FrameLight>
        light{};  // by rising frame, at least one; instead of the two: a light that changes
    // The entries of customLayerData's dictionary "pelagic", in this order. A key is an identifier:
    // [A-Za-z_][A-Za-z0-9_]*.
    std::vector<std::pair<std::string, CustomValue>> custom_data{};
};

// The root prim of a shot: "-" becomes "_", and a leading digit gets a "_" before it.
// Throws std::invalid_argument for anything but letters, digits, _ and -, and for an empty name.
std::string prim_name(std::string_view shot_name);

// Paths relative to the root layer's folder, without "./".
std::string root_file(std::string_view shot_name);
std::string camera_file(std::string_view shot_name);
std::string sky_file(std::string_view shot_name);
std::string topology_file(std::string_view shot_name, std::string_view extension);
std::string manifest_file(std::string_view shot_name);
// A frame's number as USD expands "####": at least four characters with zeros in front, and a minus sign is
// one of them (7 → 0007, 12345 → 12345, 0 → 0000, −5 → -005). No two frames share a file.
std::string frame_number(int frame);
std::string frame_file(std::string_view shot_name, int frame, std::string_view extension);
// frame_file with "####" for the number.
std::string frame_file_template(std::string_view shot_name, std::string_view extension);

// How a varying attribute is declared, except the origin. The attribute is an array; `type` is its element's.
struct VaryingAttribute {
    std::string_view name;
    std::string_view type;
    int components;
    bool interpolates;  // one value for each vertex, with `interpolation` metadata
};

struct VaryingValues {
    VaryingAttribute attribute;
    // The components of an element are side by side.
    std::variant<std::span<const float>, std::span<const std::int32_t>> values{};

    std::size_t count() const {  // of elements
        const auto numbers = std::visit([](const auto& span) { return span.size(); }, values);
        return numbers / static_cast<std::size_t>(attribute.components);
    }
};

// The box round the points; {0, 0} if there are none.
Extent extent_of(std::span<const glm::vec3> points);

// The varying attributes, in the order in which every layer has them. Points and extent are the first two.
std::vector<VaryingAttribute> varying_attributes(const AttributeSet& attributes);

// The same with a frame's values. They refer to `sample` and `extent`, which must outlive the result.
// Throws std::invalid_argument, naming the attribute, if the length of a vertices' array isn't that of
// points, if an array or the origin holds a NaN or an infinity, and if the faces don't fit: see check(const Topology&).
std::vector<VaryingValues> varying_values(const MeshSample& sample, const Extent& extent);

// The `interpolation` metadata of an attribute with a value for each vertex: "vertex", or "varying" on a
// cage. Subdivision smooths "vertex" primvars, so that they overshoot; it interpolates "varying" ones
// linearly.
std::string_view interpolation(SubdivisionScheme scheme);
// The same for an attribute of a topology: "faceVarying" of primvars:st where each corner has its own.
std::string_view interpolation(const VaryingAttribute& attribute, const Topology& topology);
// primvars:st.
extern const VaryingAttribute kTextureCoordinates;

// Throws std::invalid_argument unless the frames per second are finite and above 0.
void check_rate(double fps);

// Throws std::invalid_argument, naming the array, for a face with fewer than three vertices, indices that
// don't match the counts, a negative index, an index beyond st where st is given, st that isn't finite, and
// arrays that aren't empty although the faces vary.
void check(const Topology& topology);

}  // namespace pelagic::usd
