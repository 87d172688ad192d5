#include "plugin/format/usd/volumes.h"

#include "plugin/format/usd/page.h"

namespace pelagic::usd {
namespace {

std::string vector_text(const glm::vec3& v) {
    return "(" + real32("a volume's extent", static_cast<double>(v.x)) + ", " +
           real32("a volume's extent", static_cast<double>(v.y)) + ", " +
           real32("a volume's extent", static_cast<double>(v.z)) + ")";
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
        text += between + ("    def Volume \"" + volume.prim + "\"\n    {\n");
        between = "\n";
        text += "        float3[] extent = [" + vector_text(volume.extent[0]) + ", " +
                vector_text(volume.extent[1]) + "]\n";
        for (const VolumeField& field : volume.fields)
            text += "        rel field:" + field.name + " = </" + std::string(kVolumesName) + "/" +
                    volume.prim + "/" + field.name + ">\n";
        for (const VolumeField& field : volume.fields) {
            text += "\n        def OpenVDBAsset \"" + field.name + "\"\n        {\n";
            text += "            token fieldClass = \"" + field.field_class + "\"\n";
            text += std::string("            token fieldDataType = \"") +
                    (field.is_vector ? "float3" : "float") + "\"\n";
            text += "            token fieldName = \"" + field.name + "\"\n";
            if (field.is_vector) text += "            token vectorDataRoleHint = \"Vector\"\n";
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
        text += "    }\n";
    }
    sink(text + "}\n");
}

}  // namespace pelagic::usd
