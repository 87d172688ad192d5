// File names, declarations and checks, shared by text and crates. See layers.h.
#include "plugin/format/usd/layers.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <stdexcept>

namespace pelagic::usd {

namespace {

static_assert(sizeof(glm::vec3) == 3 * sizeof(float) && sizeof(glm::vec2) == 2 * sizeof(float),
              "arrays of vectors are handed on as arrays of floats");

constexpr VaryingAttribute kPoints{"points", "point3f", 3, false};
constexpr VaryingAttribute kExtent{"extent", "float3", 3, false};
constexpr VaryingAttribute kFaceVertexCounts{"faceVertexCounts", "int", 1, false};
constexpr VaryingAttribute kFaceVertexIndices{"faceVertexIndices", "int", 1, false};
constexpr VaryingAttribute kSt{"primvars:st", "texCoord2f", 2, true};
constexpr VaryingAttribute kNormals{"normals", "normal3f", 3, true};
constexpr VaryingAttribute kVelocities{"velocities", "vector3f", 3, false};
constexpr VaryingAttribute kSlopeVariance{"primvars:slopeVariance", "float3", 3, true};
constexpr VaryingAttribute kWhitecapCoverage{"primvars:whitecapCoverage", "float", 1, true};
constexpr VaryingAttribute kFoamActive{"primvars:foamActive", "float", 1, true};
constexpr VaryingAttribute kFoamAge{"primvars:foamAge", "float", 1, true};
constexpr VaryingAttribute kWet{"primvars:wet", "float", 1, true};

std::span<const float> floats(std::span<const glm::vec3> vectors) {
    return {vectors.empty() ? nullptr : &vectors[0].x, 3 * vectors.size()};
}

std::span<const float> floats(std::span<const glm::vec2> vectors) {
    return {vectors.empty() ? nullptr : &vectors[0].x, 2 * vectors.size()};
}

void check_finite(std::string_view name, std::span<const float> values, int components) {
    // All of them at once, in vectors: which one it is is asked only where there is one.
    constexpr std::uint32_t kSign = 0x80000000u, kInfinity = 0x7f800000u;
    std::uint32_t largest = 0;
    for (const float value : values)
        largest = std::max(largest, std::bit_cast<std::uint32_t>(value) & ~kSign);
    if (largest < kInfinity) return;
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (!std::isfinite(values[i])) {
            throw std::invalid_argument(
                "USD: " + std::string(name) + "[" + std::to_string(i / static_cast<std::size_t>(components)) +
                "] is " + std::to_string(values[i]) + ", and only finite values can be written");
        }
    }
}

// `vertices` as messages name them, and how many there are.
struct Vertices {
    std::string_view name;
    std::size_t count;
};

void check_faces(const Faces& faces, const Vertices& vertices) {
    std::size_t corners = 0;
    for (const std::int32_t count : faces.counts) {
        if (count < 3)
            throw std::invalid_argument("USD: faceVertexCounts: a face needs at least three vertices");
        corners += static_cast<std::size_t>(count);
    }
    if (corners != faces.indices.size()) {
        throw std::invalid_argument("USD: faceVertexIndices has " + std::to_string(faces.indices.size()) +
                                    " entries, and faceVertexCounts asks for " + std::to_string(corners));
    }
    for (const std::int32_t index : faces.indices) {
        if (index < 0 || static_cast<std::size_t>(index) >= vertices.count) {
            throw std::invalid_argument("USD: faceVertexIndices: " + std::to_string(index) +
                                        " is not the index of " + std::string(vertices.name));
        }
    }
    check_finite(kSt.name, floats(faces.st), kSt.components);
}

bool is_name_character(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
}

}  // namespace

std::string prim_name(std::string_view shot_name) {
    if (shot_name.empty() || !std::all_of(shot_name.begin(), shot_name.end(), is_name_character)) {
        throw std::invalid_argument("USD: the shot's name \"" + std::string(shot_name) +
                                    "\" must be letters, digits, _ and -, one at least");
    }
    std::string name(shot_name);
    std::replace(name.begin(), name.end(), '-', '_');
    if (name[0] >= '0' && name[0] <= '9') name.insert(name.begin(), '_');
    return name;
}

std::string root_file(std::string_view shot_name) {
    return std::string(shot_name) + ".usda";
}

std::string camera_file(std::string_view shot_name) {
    return std::string(shot_name) + ".camera.usdc";
}

std::string sky_file(std::string_view shot_name) {
    return std::string(shot_name) + ".sky.exr";
}

std::string topology_file(std::string_view shot_name, std::string_view extension) {
    return "mesh/" + std::string(shot_name) + ".topology." + std::string(extension);
}

std::string manifest_file(std::string_view shot_name) {
    return "mesh/" + std::string(shot_name) + ".manifest.usda";
}

std::string frame_number(int frame) {
    char number[16];
    std::snprintf(number, sizeof number, "%04d", frame);
    return number;
}

std::string frame_file(std::string_view shot_name, int frame, std::string_view extension) {
    return "mesh/" + std::string(shot_name) + "." + frame_number(frame) + "." + std::string(extension);
}

std::string frame_file_template(std::string_view shot_name, std::string_view extension) {
    return "mesh/" + std::string(shot_name) + ".####." + std::string(extension);
}

Extent extent_of(std::span<const glm::vec3> points) {
    if (points.empty()) return {glm::vec3(0.0f), glm::vec3(0.0f)};
    Extent extent{points[0], points[0]};
    for (const glm::vec3& p : points) {
        for (int i = 0; i < 3; ++i) {
            extent[0][i] = std::min(extent[0][i], p[i]);
            extent[1][i] = std::max(extent[1][i], p[i]);
        }
    }
    return extent;
}

std::vector<VaryingAttribute> varying_attributes(const AttributeSet& attributes) {
    std::vector<VaryingAttribute> result{kPoints, kExtent};
    if (attributes.faces) result.insert(result.end(), {kFaceVertexCounts, kFaceVertexIndices, kSt});
    if (attributes.normals) result.push_back(kNormals);
    if (attributes.velocities) result.push_back(kVelocities);
    if (attributes.slope_variance) result.push_back(kSlopeVariance);
    if (attributes.whitecap_coverage) result.push_back(kWhitecapCoverage);
    if (attributes.foam_history) result.insert(result.end(), {kFoamActive, kFoamAge});
    if (attributes.wet) result.push_back(kWet);
    return result;
}

std::vector<VaryingValues> varying_values(const MeshSample& sample, const Extent& extent) {
    const Faces faces = sample.faces.value_or(Faces{});
    std::vector<VaryingValues> result;
    for (const VaryingAttribute& attribute : varying_attributes(sample.attributes())) {
        if (attribute.name == kFaceVertexCounts.name || attribute.name == kFaceVertexIndices.name) {
            result.push_back(
                {attribute, attribute.name == kFaceVertexCounts.name ? faces.counts : faces.indices});
            continue;
        }
        std::span<const float> values;
        if (attribute.name == kPoints.name) values = floats(sample.points);
        if (attribute.name == kExtent.name) values = floats(std::span<const glm::vec3>(extent));
        if (attribute.name == kSt.name) values = floats(faces.st);
        if (attribute.name == kNormals.name) values = floats(sample.normals);
        if (attribute.name == kVelocities.name) values = floats(sample.velocities);
        if (attribute.name == kSlopeVariance.name) values = floats(sample.slope_variance);
        if (attribute.name == kWhitecapCoverage.name) values = sample.whitecap_coverage;
        if (attribute.name == kFoamActive.name) values = sample.breaking;
        if (attribute.name == kFoamAge.name) values = sample.age_s;
        if (attribute.name == kWet.name) values = sample.wet;
        const VaryingValues& varying = result.emplace_back(VaryingValues{attribute, values});
        const bool is_of_corners = attribute.name == kSt.name && faces.is_st_of_corners;
        const std::size_t wanted = is_of_corners ? faces.indices.size() : sample.points.size();
        if (attribute.name != kExtent.name && varying.count() != wanted) {
            throw std::invalid_argument(
                "USD: " + std::string(attribute.name) + " has " + std::to_string(varying.count()) +
                " values for " + std::to_string(wanted) + (is_of_corners ? " corners" : " points") +
                "; it must have as many" + (attribute.name == kSt.name ? "" : ", or none"));
        }
        check_finite(attribute.name, values, attribute.components);
    }
    if (sample.faces) check_faces(faces, {"a point", sample.points.size()});
    if (sample.origin_m)
        for (int i = 0; i < 3; ++i)
            if (!std::isfinite((*sample.origin_m)[i]))
                throw std::invalid_argument("USD: the points' origin must be finite");
    return result;
}

std::string_view interpolation(SubdivisionScheme scheme) {
    return scheme == SubdivisionScheme::None ? "vertex" : "varying";
}

const VaryingAttribute kTextureCoordinates = kSt;

std::string_view interpolation(const VaryingAttribute& attribute, const Topology& topology) {
    if (attribute.name == kSt.name && topology.attributes.st_of_corners) return "faceVarying";
    return interpolation(topology.scheme);
}

void check_rate(double fps) {
    if (!(fps > 0.0)) throw std::invalid_argument("USD: the frames per second must be above 0");
    if (!std::isfinite(fps)) {
        throw std::invalid_argument("USD: the frames per second must be a finite number");
    }
}

void check(const Topology& topology) {
    if (topology.attributes.faces) {
        if (!topology.face_vertex_counts.empty() || !topology.face_vertex_indices.empty() ||
            !topology.st.empty()) {
            throw std::invalid_argument(
                "USD: faceVertexCounts, faceVertexIndices and primvars:st vary, so the topology has none");
        }
        return;
    }
    const bool is_of_corners = topology.attributes.st_of_corners;
    if (is_of_corners && topology.st.size() != topology.face_vertex_indices.size())
        throw std::invalid_argument("USD: primvars:st has " + std::to_string(topology.st.size()) +
                                    " values for " + std::to_string(topology.face_vertex_indices.size()) +
                                    " corners of faces");
    const bool is_known = !topology.st.empty() && !is_of_corners;
    check_faces({topology.face_vertex_counts, topology.face_vertex_indices, topology.st},
                {"a vertex that has primvars:st",
                 is_known ? topology.st.size() : std::numeric_limits<std::size_t>::max()});
}

}  // namespace pelagic::usd
