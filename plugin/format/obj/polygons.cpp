#include "plugin/format/obj/polygons.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numeric>
#include <utility>

namespace pelagic::obj {
// Cuts a polygon's corners, in the plane that it is best seen in, counter-clockwise, into triangles. Where none can be cut off (it
// meets itself) one is all the same.
class Polygons::Ears {
  public:
    std::vector<glm::dvec2> flat;  // of the face at hand: its corners in that plane, and their normals
    std::vector<glm::vec3> normals_of_face;

    template <class Take>
    void cut(const Take& take) {
        const std::vector<glm::dvec2>& at = flat;
        left_.resize(at.size());
        std::iota(left_.begin(), left_.end(), std::size_t{0});
        reflex_.clear();
        for (std::size_t i = 0; i < at.size(); ++i)
            if (turn(before(i), i, after(i)) < 0.0) reflex_.push_back(i);
        std::size_t i = 0, tried = 0;
        while (left_.size() > 3) {
            const std::size_t a = before(i), b = i, c = after(i);
            if (tried < left_.size() && !is_ear(left_[a], left_[b], left_[c])) {
                i = c, ++tried;
                continue;
            }
            take(left_[a], left_[b], left_[c]);
            left_.erase(left_.begin() + static_cast<std::ptrdiff_t>(b));
            tried = 0;
            i = b % left_.size();
        }
        take(left_[0], left_[1], left_[2]);
    }

  private:
    std::size_t before(std::size_t i) const { return (i + left_.size() - 1) % left_.size(); }
    std::size_t after(std::size_t i) const { return (i + 1) % left_.size(); }
    double turn(std::size_t a, std::size_t b, std::size_t c) const {
        const glm::dvec2 u = flat[b] - flat[a], v = flat[c] - flat[a];
        return u.x * v.y - u.y * v.x;
    }
    bool is_ear(std::size_t a, std::size_t b, std::size_t c) const {
        if (!(turn(a, b, c) > 0.0)) return false;
        // A corner that lies on one of these is a bridge's to a hole.
        const auto is_one = [&](std::size_t i) {
            const glm::dvec2 p = flat[i];
            return p == flat[a] || p == flat[b] || p == flat[c];
        };
        return std::ranges::none_of(reflex_, [&](std::size_t i) {
            return !is_one(i) && turn(a, b, i) >= 0.0 && turn(b, c, i) >= 0.0 && turn(c, a, i) >= 0.0;
        });
    }

    std::vector<std::size_t> left_, reflex_;
};

void Polygons::add(std::span<const Corner> corners, std::int64_t group, std::uint16_t material) {
    faces_.push_back({corners_.size(), corners.size(), group, material});
    corners_.insert(corners_.end(), corners.begin(), corners.end());
}

ObjectMeshData Polygons::triangles(std::vector<ObjectMaterial> materials,
                                   std::vector<std::shared_ptr<const ObjectImage>> images) {
    mesh_.materials = std::move(materials);
    mesh_.images = std::move(images);
    plain_of_.assign(mesh_.materials.size(), kNone);
    set_normals_of_faces();
    find_faces_of_points();
    Ears ears;
    for (const Face& face : faces_) add_triangles(face, ears);
    mesh_.points_m = std::move(points_m);
    return std::move(mesh_);
}

std::uint16_t Polygons::material_of(const Face& face) {
    const ObjectMaterial& material = mesh_.materials[face.material];
    const auto corners = std::span(corners_).subspan(face.first, face.count);
    if (material.image < 0 ||
        std::ranges::none_of(corners, [](const Corner& corner) { return corner.image_at == kNone; }))
        return face.material;
    has_lost_picture_ = true;
    std::int32_t& plain = plain_of_[face.material];
    if (plain == kNone) {
        plain = static_cast<std::int32_t>(mesh_.materials.size());
        ObjectMaterial in_mean = material;
        in_mean.image = -1;
        mesh_.materials.push_back(std::move(in_mean));
    }
    return static_cast<std::uint16_t>(plain);
}

// Newell's: the mean over a face that isn't flat.
void Polygons::set_normals_of_faces() {
    for (Face& face : faces_) {
        const glm::dvec3 from = place(face.first);
        glm::dvec3 twice_area(0.0);
        for (std::size_t i = 1; i + 1 < face.count; ++i)
            twice_area += glm::cross(place(face.first + i) - from, place(face.first + i + 1) - from);
        const double length = glm::length(twice_area);
        if (length > 0.0) face.normal = twice_area / length;
    }
}

// Only where a corner has no normal of its own.
void Polygons::find_faces_of_points() {
    const auto has_none = [&](const Corner& corner) { return !has_normal(corner); };
    if (std::ranges::none_of(corners_, has_none)) return;
    first_of_point_.assign(points_m.size() + 1, 0);
    for (const Corner& corner : corners_) ++first_of_point_[corner.point + 1];
    std::partial_sum(first_of_point_.begin(), first_of_point_.end(), first_of_point_.begin());
    corners_of_points_.resize(corners_.size());
    std::vector<std::size_t> next(first_of_point_.begin(), first_of_point_.end() - 1);
    for (std::size_t f = 0; f < faces_.size(); ++f)
        for (std::size_t i = 0; i < faces_[f].count; ++i)
            corners_of_points_[next[corners_[faces_[f].first + i].point]++] = {static_cast<std::uint32_t>(f),
                                                                               static_cast<std::uint32_t>(i)};
}

bool Polygons::has_normal(const Corner& corner) const {
    return corner.normal != kNone && normals[static_cast<std::size_t>(corner.normal)] != glm::vec3(0.0f);
}

// The angle of a face at its corner.
double Polygons::angle_at(const Face& face, std::size_t i) const {
    const glm::dvec3 at = place(face.first + i);
    const glm::dvec3 to = place(face.first + (i + 1) % face.count) - at,
                     from = place(face.first + (i + face.count - 1) % face.count) - at;
    return std::atan2(glm::length(glm::cross(to, from)), glm::dot(to, from));
}

glm::vec3 Polygons::normal_at(const Face& face, std::size_t i) const {
    constexpr double kSmooth = 0.642787609686539;  // the cosine of 50°: an octagon's corners are smooth
    constexpr std::size_t kMostFaces = 256;        // of a point: work goes with the square
    const Corner& corner = corners_[face.first + i];
    if (has_normal(corner)) return normals[static_cast<std::size_t>(corner.normal)];
    const std::size_t first = first_of_point_[corner.point], last = first_of_point_[corner.point + 1];
    if (face.group == kFlat || last - first > kMostFaces) return glm::vec3(face.normal);
    glm::dvec3 sum(0.0);
    for (std::size_t at = first; at < last; ++at) {
        const Face& other = faces_[corners_of_points_[at].face];
        if (other.group == face.group && glm::dot(other.normal, face.normal) > kSmooth)
            sum += angle_at(other, corners_of_points_[at].corner) * other.normal;
    }
    return glm::vec3(glm::dot(sum, face.normal) > 0.0 ? glm::normalize(sum) : face.normal);
}

void Polygons::add_triangles(const Face& face, Ears& ears) {
    if (face.normal == glm::dvec3(0.0)) return;
    const std::uint16_t material = material_of(face);
    const bool has_places = !mesh_.images.empty();
    // Seen along the axis that it faces most.
    const glm::dvec3 facing = glm::abs(face.normal);
    const int away = facing.x > facing.y ? (facing.x > facing.z ? 0 : 2) : (facing.y > facing.z ? 1 : 2);
    const int right = (away + 1) % 3, up = (away + 2) % 3;
    ears.flat.clear();
    ears.normals_of_face.clear();
    for (std::size_t i = 0; i < face.count; ++i) {
        const glm::dvec3 at = place(face.first + i);
        ears.flat.emplace_back(face.normal[away] > 0.0 ? at[right] : -at[right], at[up]);
        ears.normals_of_face.push_back(normal_at(face, i));
    }
    ears.cut([&](std::size_t a, std::size_t b, std::size_t c) {
        const std::array corners{a, b, c};
        const glm::dvec3 from = place(face.first + a);
        if (glm::cross(place(face.first + b) - from, place(face.first + c) - from) == glm::dvec3(0.0)) return;
        for (const std::size_t i : corners) {
            mesh_.triangles.push_back(corners_[face.first + i].point);
            mesh_.normals.push_back(ears.normals_of_face[i]);
            if (!has_places) continue;
            const std::int32_t at = corners_[face.first + i].image_at;
            mesh_.image_at.push_back(at == kNone ? glm::vec2(0.0f) : image_at[static_cast<std::size_t>(at)]);
        }
        mesh_.material.push_back(material);
    });
}

}  // namespace pelagic::obj
