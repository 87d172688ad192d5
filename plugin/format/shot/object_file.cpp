#include "plugin/format/shot/object_file.h"

#include <algorithm>

#include "core/scene/text.h"
#include "plugin/format/obj/object_obj.h"
#include "plugin/format/shot/object_image_file.h"
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
    const auto beside = [&](const std::string& given) -> std::optional<std::filesystem::path> {
        // A mesh from elsewhere must not name any file of this machine.
        const std::filesystem::path path(given);
        if (given.find('\0') != std::string::npos || path.is_absolute() ||
            std::ranges::any_of(path, [](const std::filesystem::path& part) { return part == ".."; }))
            return std::nullopt;
        return file.parent_path() / path;
    };
    const MaterialText material_text = [&](const std::string& given) -> std::optional<std::string> {
        const auto path = beside(given);
        if (path) try {
                return read_text_file(*path, kMostMaterialBytes);
            } catch (const TextFileError&) {
            }
        return std::nullopt;
    };
    const MaterialPicture picture = [&](const std::string& given, std::size_t most_texels) {
        const auto path = beside(given);
        if (!path)
            throw PictureRefused{"lies outside the mesh's folder", "a PNG or an OpenEXR in it, or below it"};
        return read_object_image(*path, most_texels);
    };
    return std::make_shared<const ObjectMesh>(
        parse_object_obj(text, line_text(name), material_text, picture));
}

}  // namespace pelagic
