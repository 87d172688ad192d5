// See read_mesh.h.
#include "plugin/format/usd/read_mesh.h"

#include <cmath>

namespace pelagic::usd {

namespace {

template <class T>
std::span<const T> values_of(const MeshLayer& layer, std::string_view name) {
    for (const MeshArray& array : layer.arrays)
        if (array.name == name) return std::get<std::vector<T>>(array.values);
    return {};
}

template <class Vector>
std::span<const Vector> vectors_of(const MeshLayer& layer, std::string_view name) {
    const auto numbers = values_of<float>(layer, name);
    return {reinterpret_cast<const Vector*>(numbers.data()), numbers.size() / Vector::length()};
}

// By the writers' own rules.
void check(const MeshLayer& layer) {
    Faces faces{.counts = values_of<std::int32_t>(layer, "faceVertexCounts"),
                .indices = values_of<std::int32_t>(layer, "faceVertexIndices"),
                .st = vectors_of<glm::vec2>(layer, "primvars:st")};
    // Frames don't say whether st is of corners: their topology does. With as many corners as points either is
    // possible.
    const std::size_t points = vectors_of<glm::vec3>(layer, "points").size();
    faces.is_st_of_corners =
        faces.st.size() == faces.indices.size() && (!layer.frame || faces.st.size() != points);
    if (!layer.frame) {
        check(Topology{.face_vertex_counts = faces.counts,
                       .face_vertex_indices = faces.indices,
                       .st = faces.st,
                       .attributes = {.st_of_corners = faces.is_st_of_corners}});
        return;
    }
    if (!std::isfinite(*layer.frame)) throw ReadError("is damaged: its frame is no number");
    // The writers take an empty array for one that isn't given; in a file it is damage.
    for (const MeshArray& array : layer.arrays)
        if (points > 0 && std::visit([](const auto& values) { return values.empty(); }, array.values))
            throw ReadError("is damaged: " + array.name + " is empty");
    MeshSample sample{.origin_m = layer.origin_m,
                      .points = vectors_of<glm::vec3>(layer, "points"),
                      .normals = vectors_of<glm::vec3>(layer, "normals"),
                      .velocities = vectors_of<glm::vec3>(layer, "velocities"),
                      .slope_variance = vectors_of<glm::vec3>(layer, "primvars:slopeVariance"),
                      .whitecap_coverage = values_of<float>(layer, "primvars:whitecapCoverage"),
                      .breaking = values_of<float>(layer, "primvars:foamActive"),
                      .age_s = values_of<float>(layer, "primvars:foamAge"),
                      .wet = values_of<float>(layer, "primvars:wet")};
    if (!faces.counts.empty() || !faces.indices.empty() || !faces.st.empty()) sample.faces = faces;
    varying_values(sample, {});
}

}  // namespace

std::optional<VaryingAttribute> mesh_attribute(std::string_view name, std::string_view array_type) {
    static const std::vector<VaryingAttribute> known = varying_attributes({.normals = true,
                                                                           .velocities = true,
                                                                           .slope_variance = true,
                                                                           .whitecap_coverage = true,
                                                                           .foam_history = true,
                                                                           .wet = true,
                                                                           .faces = true});
    for (const VaryingAttribute& attribute : known)
        if (attribute.name == name && name != "extent" && array_type == std::string(attribute.type) + "[]")
            return attribute;
    return std::nullopt;
}

void refuse_twice(const MeshLayer& layer, std::string_view name) {
    for (const MeshArray& array : layer.arrays)
        if (array.name == name) throw ReadError("is damaged: " + array.name + " is there twice");
    if (layer.origin_m && name == kOrigin)
        throw ReadError("is damaged: " + std::string(name) + " is there twice");
}

bool is_integer(const VaryingAttribute& attribute) {
    return attribute.type == "int";
}

MeshLayer read_mesh_layer(std::string_view bytes) {
    const bool is_crate = bytes.starts_with(kCrateMagic);
    if (!is_crate && !bytes.starts_with(kTextMagic)) throw ReadError("is not a layer of USD");
    MeshLayer layer = is_crate ? read_crate(bytes) : read_text(bytes);
    try {
        check(layer);
    } catch (const std::invalid_argument& error) {
        throw ReadError(std::string("is damaged: ") + error.what());
    }
    return layer;
}

}  // namespace pelagic::usd
