// The mesh's layers as crates. See crate.h; the format is in crate_file.h.
#include "plugin/format/usd/crate.h"

#include <array>

#include "plugin/format/usd/crate_file.h"

namespace pelagic::usd {

namespace {

std::string array_type(const VaryingAttribute& attribute) {
    return std::string(attribute.type) + "[]";
}

ValueType value_type(std::span<const std::int32_t>, int) {
    return ValueType::Int;
}

ValueType value_type(std::span<const float>, int components) {
    if (components == 1) return ValueType::Float;
    return components == 2 ? ValueType::Vec2f : ValueType::Vec3f;
}

Crate topology_layer(const Topology& topology) {
    check(topology);
    check_rate(topology.fps);
    const bool cage = topology.scheme == SubdivisionScheme::CatmullClark;
    Crate crate;
    crate.add_layer(kMeshName, topology.fps, {});
    const Crate::Fields per_vertex{{"interpolation", crate.token(interpolation(topology.scheme))}};
    const auto interpolated = [&](const VaryingAttribute& attribute) {
        const std::string_view own = interpolation(attribute, topology);
        return own == interpolation(topology.scheme) ? per_vertex
                                                     : Crate::Fields{{"interpolation", crate.token(own)}};
    };
    std::vector<Crate::Attribute> attributes{
        {"doubleSided", "bool", Variability::Uniform, {{"default", crate.boolean(true)}}}};
    const auto add_token = [&](std::string_view name, Variability variability, std::string_view text) {
        attributes.push_back({name, "token", variability, {{"default", crate.token(text)}}});
    };
    if (cage) add_token("interpolateBoundary", Variability::Varying, "none");
    add_token("orientation", Variability::Uniform, "rightHanded");
    add_token("subdivisionScheme", Variability::Uniform, cage ? "catmullClark" : "none");
    // Declared without a value, as in text.cpp.
    for (const VaryingAttribute& varying : varying_attributes(topology.attributes)) {
        attributes.push_back({.name = varying.name,
                              .type = array_type(varying),
                              .more = varying.interpolates ? interpolated(varying) : Crate::Fields{}});
    }
    if (topology.attributes.origin) {
        attributes.push_back({.name = kOrigin, .type = std::string(kOriginType)});
        attributes.push_back({.name = "xformOpOrder",
                              .type = "token[]",
                              .variability = Variability::Uniform,
                              .more = {{"default", crate.token_array(std::array{kOrigin})}}});
    }
    if (!topology.st.empty()) {
        Crate::Fields fields = interpolated(kTextureCoordinates);
        fields.push_back({"default", crate.array(ValueType::Vec2f, topology.st, topology.st.size())});
        attributes.push_back({.name = "primvars:st", .type = "texCoord2f[]", .more = fields});
    }
    if (!topology.attributes.faces) {
        const auto add_integers = [&](std::string_view name, std::span<const std::int32_t> integers) {
            const CrateValue value = crate.array(ValueType::Int, integers, integers.size());
            attributes.push_back({.name = name, .type = "int[]", .more = {{"default", value}}});
        };
        add_integers("faceVertexCounts", topology.face_vertex_counts);
        add_integers("faceVertexIndices", topology.face_vertex_indices);
    }
    crate.add_prim(kMeshName,
                   {{"specifier", crate.specifier(Specifier::Def)}, {"typeName", crate.token("Mesh")}},
                   attributes);
    crate.finish();
    return crate;
}

// The crate refers to `extent` as it does to the sample's arrays.
Crate frame_layer(const MeshSample& sample, const Extent& extent) {
    const std::vector<VaryingValues> all = varying_values(sample, extent);
    check_rate(sample.fps);
    Crate crate;
    crate.add_frame_layer(kMeshName, sample.fps, sample.frame, sample.fingerprint);
    std::vector<Crate::Attribute> attributes;
    for (const VaryingValues& varying : all) {
        const auto add_array = [&](const auto& values) {
            return crate.array(value_type(values, varying.attribute.components), values, varying.count());
        };
        const CrateValue array = std::visit(add_array, varying.values);
        attributes.push_back({.name = varying.attribute.name,
                              .type = array_type(varying.attribute),
                              .more = {{"timeSamples", crate.time_samples(sample.frame, array)}}});
    }
    if (sample.origin_m) {
        const CrateValue origin = crate.stored(ValueType::Vec3d, *sample.origin_m);
        attributes.push_back({.name = kOrigin,
                              .type = std::string(kOriginType),
                              .more = {{"timeSamples", crate.time_samples(sample.frame, origin)}}});
    }
    crate.add_prim(kMeshName, {{"specifier", crate.specifier(Specifier::Over)}}, attributes);
    crate.finish();
    return crate;
}

}  // namespace

void write_topology_crate(const Topology& topology, const Sink& sink) {
    topology_layer(topology).write(sink);
}

std::string topology_crate(const Topology& topology) {
    return gathered(topology_layer(topology));
}

void write_frame_crate(const MeshSample& sample, const Sink& sink) {
    const Extent extent = extent_of(sample.points);
    frame_layer(sample, extent).write(sink);
}

std::string frame_crate(const MeshSample& sample) {
    const Extent extent = extent_of(sample.points);
    return gathered(frame_layer(sample, extent));
}

}  // namespace pelagic::usd
