#include "pelagic/object_mesh.h"

#include <bit>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <stdexcept>
#include <utility>

#include "core/base/hash.h"
#include "core/scene/limits.h"
#include "core/scene/text.h"

namespace pelagic {
namespace {

[[noreturn]] void refuse(const std::string& problem, const std::string& accepted) {
    throw std::invalid_argument(problem + "; accepted: " + accepted);
}

template <class Vector>
bool holds(Range range, const Vector& v) {
    return range.holds(v.x) && range.holds(v.y) && range.holds(v.z);
}

// Cheap checks first: a mesh that is too large is not traversed.
void check_counts(const ObjectMeshData& mesh) {
    const std::size_t corners = mesh.triangles.size();
    if (corners % 3 != 0) refuse("the triangles have " + std::to_string(corners) + " corners", "three each");
    if (corners == 0) refuse("there are no triangles", "at least one");
    if (corners / 3 > limits::kObjectTriangles)
        refuse("there are " + std::to_string(corners / 3) + " triangles",
               "at most " + std::to_string(limits::kObjectTriangles));
    if (mesh.normals.size() != corners)
        refuse("there are " + std::to_string(mesh.normals.size()) + " normals",
               "one for each of the " + std::to_string(corners) + " corners");
    if (mesh.material.size() != corners / 3)
        refuse("there are materials of " + std::to_string(mesh.material.size()) + " triangles",
               "of each of the " + std::to_string(corners / 3));
    if (!mesh.image_at.empty() && mesh.image_at.size() != corners)
        refuse("there are " + std::to_string(mesh.image_at.size()) + " places in pictures",
               "one for each of the " + std::to_string(corners) + " corners, or none");
    if (mesh.materials.empty() || mesh.materials.size() > limits::kObjectMaterials)
        refuse("there are " + std::to_string(mesh.materials.size()) + " materials",
               "1 … " + std::to_string(limits::kObjectMaterials));
}

void check_values(const ObjectMeshData& mesh) {
    const auto number = [](const char* what, std::size_t i) { return what + std::to_string(i); };
    for (std::size_t i = 0; i < mesh.points_m.size(); ++i)
        if (!holds(limits::kObjectPoint_m, mesh.points_m[i]))
            refuse(number("point ", i) + " is outside the range", text_of(limits::kObjectPoint_m) + " m");
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
        if (mesh.triangles[i] >= mesh.points_m.size())
            refuse(number("triangle ", i / 3) + " has the point " + std::to_string(mesh.triangles[i]),
                   "0 … " + std::to_string(static_cast<std::int64_t>(mesh.points_m.size()) - 1));
    constexpr Range kUnit{0.999, 1.001};  // rounding's, of floats and of files with four digits
    for (std::size_t i = 0; i < mesh.normals.size(); ++i)
        if (!kUnit.holds(glm::length(glm::dvec3(mesh.normals[i]))))
            refuse(number("the normal of corner ", i) + " has another length than 1", "unit vectors");
    for (std::size_t i = 0; i < mesh.material.size(); ++i)
        if (mesh.material[i] >= mesh.materials.size())
            refuse(number("triangle ", i) + " has the material " + std::to_string(mesh.material[i]),
                   "0 … " + std::to_string(mesh.materials.size() - 1));
    constexpr Range kShare{0.0, 1.0};
    for (const ObjectMaterial& material : mesh.materials)
        if (!holds(kShare, material.colour) || !holds(kShare, material.glow) ||
            !kShare.holds(material.roughness))
            refuse("the material " + quoted_text(material.name) + " has a number outside the range",
                   text_of(kShare));
    for (const auto& image : mesh.images)
        if (!image) refuse("a picture is missing", "one for each of images");
    for (const ObjectMaterial& material : mesh.materials)
        if (material.image != -1 &&
            (material.image < 0 || static_cast<std::size_t>(material.image) >= mesh.images.size() ||
             mesh.image_at.empty()))
            refuse("the material " + quoted_text(material.name) + " has the picture " +
                       std::to_string(material.image),
                   "-1 for none, or one of images, with places in it (image_at)");
    for (std::size_t i = 0; i < mesh.image_at.size(); ++i)
        if (!limits::kObjectImageAt.holds(mesh.image_at[i].x) ||
            !limits::kObjectImageAt.holds(mesh.image_at[i].y))
            refuse(number("the place in a picture of corner ", i) + " is outside the range",
                   text_of(limits::kObjectImageAt));
}

bool has_area(const ObjectMeshData& mesh) {
    const auto corner = [&](std::size_t i) { return glm::dvec3(mesh.points_m[mesh.triangles[i]]); };
    for (std::size_t i = 0; i < mesh.triangles.size(); i += 3)
        if (glm::cross(corner(i + 1) - corner(i), corner(i + 2) - corner(i)) != glm::dvec3(0.0)) return true;
    return false;
}

// The structured bindings name every member, so that a new member doesn't compile until it is added here.
std::string content_of(const ObjectMeshData& mesh) {
    const auto& [points_m, triangles, normals, material, materials, images, image_at] = mesh;
    ByteHash hash;
    const auto add_bits = [&](auto bits) {
        for (std::size_t byte = 0; byte < sizeof bits; ++byte)
            hash.add(static_cast<unsigned char>(bits >> 8 * byte));
    };
    const auto add_number = [&](float value) {
        add_bits(std::bit_cast<std::uint32_t>(value + 0.0f));
    };  // −0 is 0
    const auto add_vector = [&](const glm::vec3& v) { add_number(v.x), add_number(v.y), add_number(v.z); };
    const auto add_list = [&](const auto& list, const auto& add) {
        add_bits(static_cast<std::uint64_t>(list.size()));
        for (const auto& each : list) add(each);
    };
    add_list(points_m, add_vector);
    add_list(triangles, add_bits);
    add_list(normals, add_vector);
    add_list(material, add_bits);
    add_list(materials, [&](const ObjectMaterial& of) {
        const auto& [name, colour, roughness, glow, image] = of;
        add_list(name, [&](char letter) { hash.add(static_cast<unsigned char>(letter)); });
        add_vector(colour), add_number(roughness), add_vector(glow);
        if (image >= 0) add_bits(static_cast<std::uint32_t>(image));
    });
    // A body without pictures keeps the content that it had before there were any.
    if (!images.empty() || !image_at.empty()) {
        add_list(images, [&](const std::shared_ptr<const ObjectImage>& of) {
            const ObjectImage::Level& whole = of->levels().front();
            add_bits(static_cast<std::uint32_t>(whole.width));
            add_list(whole.rgb, add_bits);
        });
        add_list(image_at, [&](const glm::vec2& at) { add_number(at.x), add_number(at.y); });
    }
    return hash.text();
}

template <class List>
std::size_t bytes_of(const List& list) {
    return list.capacity() * sizeof(typename List::value_type);
}

}  // namespace

ObjectMesh::ObjectMesh(ObjectMeshData data, std::vector<std::string> notes)
    : data_(std::move(data)), notes_(std::move(notes)) {
    check_counts(data_);
    check_values(data_);
    if (!has_area(data_)) refuse("no triangle has an area", "at least one with an area");
    least_m_ = most_m_ = glm::dvec3(data_.points_m[data_.triangles.front()]);
    for (const std::uint32_t point : data_.triangles) {  // points of none don't count
        least_m_ = glm::min(least_m_, glm::dvec3(data_.points_m[point]));
        most_m_ = glm::max(most_m_, glm::dvec3(data_.points_m[point]));
    }
    content_ = content_of(data_);
}

std::size_t ObjectMesh::bytes() const {
    std::size_t pictures = bytes_of(data_.images) + bytes_of(data_.image_at);
    for (const auto& image : data_.images) pictures += image->bytes();
    return sizeof *this + bytes_of(data_.points_m) + bytes_of(data_.triangles) + bytes_of(data_.normals) +
           bytes_of(data_.material) + bytes_of(data_.materials) + pictures;
}

}  // namespace pelagic
