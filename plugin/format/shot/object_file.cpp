#include "plugin/format/shot/object_file.h"

#include <algorithm>

#include "core/scene/text.h"
#include "plugin/format/obj/object_obj.h"
#include "plugin/format/shot/text_file.h"

namespace pelagic {

std::shared_ptr<const ObjectMesh> load_object(const std::filesystem::path& file) {
    constexpr const char* kAccepted = "a Wavefront OBJ of at most 1 GiB";
    const std::string name = file.filename().string();
    if (!has_ending(name, ".obj"))
        throw ObjError("is no Wavefront OBJ", "a mesh exported as OBJ, z up and in metres");
    std::string text;
    try {
        text = read_text_file(file, kMostObjectBytes);
    } catch (const TextFileError& error) {
        throw ObjError("the mesh " + std::string(error.what()), kAccepted);
    }
    const MaterialText material_text = [&](const std::string& beside) -> std::optional<std::string> {
        // A mesh from elsewhere must not name any file of this machine.
        const std::filesystem::path path(beside);
        if (beside.find('\0') != std::string::npos || path.is_absolute() ||
            std::ranges::any_of(path, [](const std::filesystem::path& part) { return part == ".."; }))
            return std::nullopt;
        try {
            return read_text_file(file.parent_path() / path, kMostMaterialBytes);
        } catch (const TextFileError&) {
            return std::nullopt;
        }
    };
    return std::make_shared<const ObjectMesh>(parse_object_obj(text, line_text(name), material_text));
}

}  // namespace pelagic
