// The mesh's layers as text. See text.h; the root is in root_text.cpp.
#include "plugin/format/usd/text.h"

#include <charconv>

#include "plugin/format/usd/page.h"

namespace pelagic::usd {

namespace {

// Writes text and arrays into a buffer, and hands it to the sink whenever it is nearly full.
class ArrayWriter {
  public:
    explicit ArrayWriter(const Sink& sink) : sink_(sink) { buffer_.resize(kBufferBytes); }

    void text(std::string_view part) {
        if (part.size() > kBufferBytes - used_) flush();
        if (part.size() > kBufferBytes) {
            sink_(part);
            return;
        }
        part.copy(buffer_.data() + used_, part.size());
        used_ += part.size();
    }

    // [a, b] for one component, [(a, b), (c, d)] for more.
    template <class T>
    void array(std::span<const T> values, int components) {
        const auto step = static_cast<std::size_t>(components);
        text("[");
        for (std::size_t i = 0; i < values.size(); i += step) {
            // An element needs room for its numbers, commas and brackets.
            if (kBufferBytes - used_ < (step + 1) * (kLongestNumber + 4)) flush();
            if (i > 0) put(", ");
            if (step > 1) put("(");
            for (std::size_t c = 0; c < step; ++c) {
                if (c > 0) put(", ");
                char* const begin = buffer_.data() + used_;
                const auto [end, error] = std::to_chars(begin, begin + kLongestNumber, values[i + c]);
                static_cast<void>(error);  // none: the buffer holds the longest number
                used_ += static_cast<std::size_t>(end - begin);
            }
            if (step > 1) put(")");
        }
        text("]");
    }

    void flush() {
        if (used_ > 0) sink_(std::string_view(buffer_.data(), used_));
        used_ = 0;
    }

  private:
    static constexpr std::size_t kBufferBytes = std::size_t{1} << 20;

    void put(std::string_view part) {
        part.copy(buffer_.data() + used_, part.size());
        used_ += part.size();
    }

    const Sink& sink_;
    std::string buffer_;
    std::size_t used_ = 0;
};

std::string metadata(const VaryingAttribute& attribute, const Topology& topology) {
    return " (interpolation = \"" + std::string(interpolation(attribute, topology)) + "\")";
}

template <class Write>
std::string gathered(const Write& write) {
    std::string text;
    write([&text](std::string_view part) { text += part; });
    return text;
}

}  // namespace

std::string manifest_text(const Manifest& manifest) {
    Page page;
    write_timeless_head(page, manifest.fps);
    page.prim("over", kMeshName);
    for (const VaryingAttribute& attribute : varying_attributes(manifest.attributes)) {
        page.line({attribute.type, "[] ", attribute.name});
    }
    if (manifest.attributes.origin) page.line({kOriginType, " ", kOrigin});
    page.close("}");
    return page.text();
}

void write_topology_text(const Topology& topology, const Sink& sink) {
    check(topology);
    const bool cage = topology.scheme == SubdivisionScheme::CatmullClark;
    Page page;
    write_timeless_head(page, topology.fps);
    page.prim("def Mesh", kMeshName);
    page.line({"uniform bool doubleSided = 1"});
    if (cage) page.line({"token interpolateBoundary = \"none\""});
    page.line({"uniform token orientation = \"rightHanded\""});
    page.line({"uniform token subdivisionScheme = \"", cage ? "catmullClark" : "none", "\""});
    // Clips ignore metadata, so it is declared here. A value here would hide those of the clips.
    for (const VaryingAttribute& attribute : varying_attributes(topology.attributes)) {
        page.line({attribute.type, "[] ", attribute.name,
                   attribute.interpolates ? metadata(attribute, topology) : std::string()});
    }
    if (topology.attributes.origin) {
        page.line({kOriginType, " ", kOrigin});
        page.line({"uniform token[] xformOpOrder = [\"", kOrigin, "\"]"});
    }

    ArrayWriter writer(sink);
    writer.text(page.text());
    if (!topology.st.empty()) {
        writer.text("    texCoord2f[] primvars:st = ");
        writer.array(std::span<const float>(&topology.st[0].x, 2 * topology.st.size()), 2);
        writer.text(metadata(kTextureCoordinates, topology) + "\n");
    }
    if (!topology.attributes.faces) {
        writer.text("    int[] faceVertexCounts = ");
        writer.array(topology.face_vertex_counts, 1);
        writer.text("\n    int[] faceVertexIndices = ");
        writer.array(topology.face_vertex_indices, 1);
        writer.text("\n");
    }
    writer.text("}\n");
    writer.flush();
}

std::string topology_text(const Topology& topology) {
    return gathered([&](const Sink& sink) { write_topology_text(topology, sink); });
}

void write_frame_text(const MeshSample& sample, const Sink& sink) {
    const Extent extent = extent_of(sample.points);
    const std::vector<VaryingValues> all = varying_values(sample, extent);
    Page page;
    page.open({"("});
    if (!sample.fingerprint.empty()) {
        page.open({"customLayerData = {"});
        page.open({"dictionary pelagic = {"});
        page.line({"string fingerprint = \"", sample.fingerprint, "\""});
        page.close("}");
        page.close("}");
    }
    write_head(page, {.default_prim = kMeshName,
                      .fps = sample.fps,
                      .first_frame = sample.frame,
                      .last_frame = sample.frame});
    page.close(")");
    page.prim("over", kMeshName);

    ArrayWriter writer(sink);
    writer.text(page.text());
    for (const VaryingValues& varying : all) {
        writer.text("    " + std::string(varying.attribute.type) + "[] " +
                    std::string(varying.attribute.name) + ".timeSamples = {\n        " +
                    number(sample.frame) + ": ");
        std::visit([&](const auto& values) { writer.array(values, varying.attribute.components); },
                   varying.values);
        writer.text(",\n    }\n");
    }
    if (sample.origin_m) {
        const glm::dvec3& at = *sample.origin_m;
        writer.text("    " + std::string(kOriginType) + " " + std::string(kOrigin) +
                    ".timeSamples = {\n        " + number(sample.frame) + ": (" + number(at.x) + ", " +
                    number(at.y) + ", " + number(at.z) + "),\n    }\n");
    }
    writer.text("}\n");
    writer.flush();
}

std::string frame_text(const MeshSample& sample) {
    return gathered([&](const Sink& sink) { write_frame_text(sample, sink); });
}

}  // namespace pelagic::usd
