#include "plugin/format/shot/object_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/text.h"
#include "core/scene/limits.h"
#include "core/scene/text.h"
#include "plugin/format/obj/object_obj.h"
#include "plugin/format/obj/polygons.h"
#include "plugin/format/shot/object_image_file.h"
#include "plugin/format/shot/text_file.h"
#include "plugin/format/usd/read_body.h"
#include "plugin/format/usd/read_mesh.h"

namespace pelagic {
namespace {

// One material a colour.
std::shared_ptr<const ObjectMesh> from_usd(std::string_view bytes) {
    usd::Body body;
    try {
        body = usd::read_body(bytes, 3 * limits::kObjectTriangles);
    } catch (const usd::ReadError& error) {
        throw ObjError(
            "the mesh " + line_text(error.what()),
            "a crate (.usdc) with meshes of its own: usdcat --flatten -o NAME.usdc, or export it as OBJ");
    }
    const auto refuse = [](const std::string& problem, const std::string& accepted) {
        throw ObjError("the mesh " + problem, accepted);
    };
    obj::Polygons polygons;
    std::vector<ObjectMaterial> materials;
    std::map<std::array<float, 3>, std::uint16_t> of_colour;
    std::size_t triangles = 0;
    for (const usd::BodyMesh& mesh : body.meshes) {
        const glm::vec3 colour(mesh.colour);
        const auto [material, is_new] = of_colour.try_emplace({colour.x, colour.y, colour.z},
                                                              static_cast<std::uint16_t>(materials.size()));
        if (is_new)
            materials.push_back({.name = "colour " + std::to_string(materials.size() + 1), .colour = colour});
        if (materials.size() > limits::kObjectMaterials)
            refuse("has too many colours", "at most " + std::to_string(limits::kObjectMaterials));
        const std::size_t first_point = polygons.points_m.size();
        for (const glm::dvec3& point : mesh.points_m) {
            for (int axis = 0; axis < 3; ++axis)
                if (!limits::kObjectPoint_m.holds(point[axis]))
                    refuse("has a point outside the range", text_of(limits::kObjectPoint_m) + " m");
            polygons.points_m.emplace_back(point);
        }
        std::vector<obj::Polygons::Corner> corners;
        std::size_t at = 0;
        for (const std::int32_t count : mesh.counts) {
            const auto n = static_cast<std::size_t>(count);
            if (n > limits::kObjectCorners)
                refuse("has a face of " + std::to_string(n) + " corners",
                       "at most " + std::to_string(limits::kObjectCorners));
            corners.clear();
            for (std::size_t i = at; i < at + n; ++i) {
                corners.push_back({.point = static_cast<std::uint32_t>(
                                       first_point + static_cast<std::size_t>(mesh.indices[i]))});
                if (mesh.normals.empty()) continue;
                corners.back().normal = static_cast<std::int32_t>(polygons.normals.size());
                const glm::dvec3& normal = mesh.normals[i];
                const double largest = std::max({std::abs(normal.x), std::abs(normal.y), std::abs(normal.z)});
                polygons.normals.emplace_back(largest > 0.0 ? glm::normalize(normal / largest) : normal);
            }
            at += n;
            if (n < 3) continue;  // a line
            triangles += n - 2;
            constexpr std::int64_t kSmooth = 1;
            polygons.add(corners, kSmooth, material->second);
        }
    }
    if (triangles > limits::kObjectTriangles || polygons.points_m.size() > limits::kObjectTriangles)
        refuse("has too many triangles or points", "at most " + std::to_string(limits::kObjectTriangles));
    ObjectMeshData made = polygons.triangles(std::move(materials), {});
    if (made.triangles.empty()) refuse("has no face with an area", "at least one with an area");
    for (std::string& note : body.notes) note = line_text(note);  // names in a crate may be anything
    return std::make_shared<const ObjectMesh>(std::move(made), std::move(body.notes));
}

}  // namespace

std::shared_ptr<const ObjectMesh> load_object(const std::filesystem::path& file) {
    constexpr const char* kAccepted = "a Wavefront OBJ or a USD crate of at most 1 GiB";
    const std::string name = file.filename().string();
    const bool is_usd = has_ending(name, ".usdc") || has_ending(name, ".usd") || has_ending(name, ".usda") ||
                        has_ending(name, ".usdz");
    if (!is_usd && !has_ending(name, ".obj"))
        throw ObjError("is neither Wavefront OBJ nor USD",
                       "a mesh exported as .obj, z up and in metres, or as .usdc");
    std::string text;
    try {
        text = read_text_file(file, kMostObjectBytes);
    } catch (const TextFileError& error) {
        throw ObjError("the mesh " + std::string(error.what()), kAccepted);
    }
    if (is_usd) return from_usd(text);
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
