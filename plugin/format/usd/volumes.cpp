#include "plugin/format/usd/volumes.h"

#include "plugin/format/usd/page.h"

namespace pelagic::usd {
namespace {

std::string vector_text(const glm::vec3& v) {
    return "(" + real32("a volume's extent", static_cast<double>(v.x)) + ", " +
           real32("a volume's extent", static_cast<double>(v.y)) + ", " +
           real32("a volume's extent", static_cast<double>(v.z)) + ")";
}

// MaterialX's volume: anisotropic_vdf scatters by Henyey and Greenstein's function. Beside it renderers whose own shader takes the field
// "density" need nothing.
std::string material_text(const std::string& volume, float mean_cosine) {
    const std::string path = "/" + std::string(kVolumesName) + "/" + volume + "/Medium";
    const auto input = [&](const char* type, const char* name, const char* node) {
        return std::string("                ") + type + " inputs:" + name + ".connect = <" + path + "/" +
               node + ".outputs:out>\n";
    };
    const auto shader = [](const char* name, const char* id, const char* type, const std::string& inputs) {
        return std::string("\n            def Shader \"") + name +
               "\"\n            {\n                uniform token info:id = \"" + id + "\"\n" + inputs +
               "                " + type + " outputs:out\n            }\n";
    };
    return "\n        def Material \"Medium\"\n        {\n            token outputs:mtlx:volume.connect = <" +
           path + "/Volume.outputs:out>\n" +
           shader("Density", "ND_geompropvalue_float", "float",
                  "                string inputs:geomprop = \"density\"\n") +
           shader("Extinction", "ND_combine3_vector3", "float3",
                  input("float", "in1", "Density") + input("float", "in2", "Density") +
                      input("float", "in3", "Density")) +
           shader("Scattering", "ND_anisotropic_vdf", "token",
                  "                float3 inputs:absorption = (0, 0, 0)\n"
                  "                float inputs:anisotropy = " +
                      real32("a volume's mean cosine", static_cast<double>(mean_cosine)) + "\n" +
                      input("float3", "scattering", "Extinction")) +
           shader("Volume", "ND_volume", "token", input("token", "vdf", "Scattering")) + "        }\n";
}

}  // namespace

std::string volumes_file(std::string_view shot_name) {
    return std::string(shot_name) + ".volumes.usda";
}

void write_volumes_text(const VolumeLayer& layer, const Sink& sink) {
    constexpr std::size_t kPiece = std::size_t{1} << 20;
    Page head;
    head.open({"("});
    write_head(head, {.default_prim = kVolumesName,
                      .fps = layer.fps,
                      .first_frame = layer.first_frame,
                      .last_frame = layer.last_frame});
    head.close(")");
    std::string text = head.text() + "\ndef Scope \"" + std::string(kVolumesName) + "\"\n{\n";
    const char* between = "";
    for (const Volume& volume : layer.volumes) {
        text += between + ("    def Volume \"" + volume.prim + "\"");
        if (volume.mean_cosine) text += " (\n        prepend apiSchemas = [\"MaterialBindingAPI\"]\n    )";
        text += "\n    {\n";
        between = "\n";
        text += "        float3[] extent = [" + vector_text(volume.extent[0]) + ", " +
                vector_text(volume.extent[1]) + "]\n";
        for (const VolumeField& field : volume.fields)
            text += "        rel field:" + field.name + " = </" + std::string(kVolumesName) + "/" +
                    volume.prim + "/" + field.name + ">\n";
        if (volume.mean_cosine)
            text += "        rel material:binding = </" + std::string(kVolumesName) + "/" + volume.prim +
                    "/Medium>\n";
        for (const VolumeField& field : volume.fields) {
            text += "\n        def OpenVDBAsset \"" + field.name + "\"\n        {\n";
            text += "            token fieldClass = \"" + field.field_class + "\"\n";
            text += std::string("            token fieldDataType = \"") +
                    (field.is_vector ? "float3" : "float") + "\"\n";
            text += "            token fieldName = \"" + field.name + "\"\n";
            if (field.is_vector) text += "            token vectorDataRoleHint = \"Vector\"\n";
            // For who asks at no time: a default value.
            if (!layer.frames.empty())
                text += "            asset filePath = @./" + volume.file_prefix +
                        frame_number(layer.frames.front()) + ".vdb@\n";
            text += "            asset filePath.timeSamples = {\n";
            for (const int frame : layer.frames) {
                text += "                " + number(frame) + ": @./" + volume.file_prefix +
                        frame_number(frame) + ".vdb@,\n";
                if (text.size() < kPiece) continue;
                sink(text);
                text.clear();
            }
            text += "            }\n        }\n";
        }
        if (volume.mean_cosine) text += material_text(volume.prim, *volume.mean_cosine);
        text += "    }\n";
    }
    sink(text + "}\n");
}

}  // namespace pelagic::usd
