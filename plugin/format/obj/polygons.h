// Polygons of a body's file into the triangles of an ObjectMesh. For the readers of Wavefront OBJ and USD.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <vector>

#include "pelagic/object_mesh.h"

namespace pelagic::obj {

// Faces of up to limits::kObjectCorners corners, counter-clockwise seen from outside. Those of more than three are cut into triangles (by
// ears; they may be concave, and are best flat); those without an area are left out. Corners without a normal are smooth where faces of one
// group meet at less than 50°.
class Polygons {
  public:
    static constexpr std::int32_t kNone = -1;
    static constexpr std::int64_t kFlat = 0;  // the group whose faces are never smooth

    struct Corner {
        std::uint32_t point = 0;
        std::int32_t normal = kNone, image_at = kNone;  // into the lists below
    };
    std::vector<glm::vec3> points_m;
    std::vector<glm::vec3> normals;  // unit, or 0: as none
    std::vector<glm::vec2> image_at;

    void add(std::span<const Corner> corners, std::int64_t group, std::uint16_t material);
    bool empty() const { return faces_.empty(); }

    // The mesh; without triangles where no face has an area. A face with a picture and a corner that has no place in it shows the
    // material's colour: has_lost_picture says whether there is one. Once.
    ObjectMeshData triangles(std::vector<ObjectMaterial> materials,
                             std::vector<std::shared_ptr<const ObjectImage>> images);
    bool has_lost_picture() const { return has_lost_picture_; }

  private:
    struct Face {
        std::size_t first;  // its corners, up to the next face's
        std::size_t count;
        std::int64_t group;
        std::uint16_t material;
        glm::dvec3 normal{0.0};  // of no length: it has no area
    };
    // Of each point, from first_of_point_[p] to the next.
    struct FaceCorner {
        std::uint32_t face, corner;
    };

    glm::dvec3 place(std::size_t corner) const { return glm::dvec3(points_m[corners_[corner].point]); }
    bool has_normal(const Corner& corner) const;
    void set_normals_of_faces();
    void find_faces_of_points();
    double angle_at(const Face& face, std::size_t i) const;
    glm::vec3 normal_at(const Face& face, std::size_t i) const;
    class Ears;
    void add_triangles(const Face& face, Ears& ears);
    std::uint16_t material_of(const Face& face);

    std::vector<Corner> corners_;
    std::vector<Face> faces_;
    std::vector<std::size_t> first_of_point_;
    std::vector<FaceCorner> corners_of_points_;
    ObjectMeshData mesh_;
    std::vector<std::int32_t>
        plain_of_;  // of each material, the one in the picture's mean; kNone: not there yet
    bool has_lost_picture_ = false;
};

}  // namespace pelagic::obj
