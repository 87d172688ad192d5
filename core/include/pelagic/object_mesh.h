// The mesh of a body that stands in the light of the sea ([[objects]]): data of a scene, as a cage is, wherever it came from.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <string>
#include <vector>

#include "pelagic/version.h"

namespace pelagic {

class Hull;  // where a mesh keeps the water out (core/scene/hull.h)
inline namespace PELAGIC_VERSION_NAMESPACE {
class ObjectMesh;
}
std::shared_ptr<const Hull> hull_of(const ObjectMesh& mesh);

inline namespace PELAGIC_VERSION_NAMESPACE {

// A picture of a body's colour, linear Rec. 709, with its mip levels: each has half the sides of the one before, rounded down, and its mean.
class ObjectImage {
  public:
    // rgb: IEEE half floats, 0 … 1, three a texel; rows from the bottom, as texture coordinates go, x fastest. Throws
    // std::invalid_argument for sides out of their range, a count that isn't theirs, and numbers out of range.
    ObjectImage(int width, int height, std::vector<std::uint16_t> rgb);

    struct Level {
        int width = 0, height = 0;
        std::vector<std::uint16_t> rgb;  // as above
    };
    const std::vector<Level>& levels() const { return levels_; }  // the last is one texel
    glm::vec3 mean() const;
    // Round a place of the picture, (0, 0) its lower left corner and (1, 1) its upper right one, repeated beyond: between the four nearest
    // texels, and between two levels, as OpenGL does (its specification 3.3, 3.8.11). level: 0 … the last; others are the nearest of these.
    glm::vec3 colour(glm::vec2 at, float level) const;
    std::size_t bytes() const;

  private:
    std::vector<Level> levels_;
};

// What a part of a body is made of; colours are linear Rec. 709.
struct ObjectMaterial {
    std::string name;
    glm::vec3 colour{0.8f};  // of its diffuse reflection, 0 … 1
    float roughness = 0.5f;  // 0 … 1: a mirror's varnish … none; the square root of GGX's α
    glm::vec3 glow{0.0f};    // of the light that it gives, 0 … 1: times objects[].glow_cd_m2
    int image = -1;  // into images, whose colour takes the place of `colour`, which is its mean; −1: none
    bool operator==(const ObjectMaterial&) const = default;
};

// Triangles, plainly. Metres, z up.
struct ObjectMeshData {
    std::vector<glm::vec3> points_m;
    std::vector<std::uint32_t>
        triangles;  // three indices into points_m each, counter-clockwise seen from outside
    std::vector<glm::vec3>
        normals;  // unit, one for each corner of each triangle, in the order of `triangles`
    std::vector<std::uint16_t> material;    // of each triangle, into materials
    std::vector<ObjectMaterial> materials;  // at least one
    std::vector<std::shared_ptr<const ObjectImage>> images{};
    // Of each corner, in the order of `triangles`: the place in its material's picture. Empty where no material has one.
    std::vector<glm::vec2> image_at{};
};

class ObjectMesh {
  public:
    // Throws std::invalid_argument, which says what is wrong, for counts that disagree, indices out of range, numbers that aren't
    // finite or out of their range, and a mesh without area. `notes`: what its reader passed over, a sentence each.
    explicit ObjectMesh(ObjectMeshData data, std::vector<std::string> notes = {});

    const ObjectMeshData& data() const { return data_; }
    glm::dvec3 least_m() const { return least_m_; }  // its box
    glm::dvec3 most_m() const { return most_m_; }
    // 16 hexadecimal digits of all of the above.
    const std::string& content() const { return content_; }
    std::size_t bytes() const;
    const std::vector<std::string>& notes() const { return notes_; }  // not a part of the content

  private:
    ObjectMeshData data_;
    glm::dvec3 least_m_{0.0}, most_m_{0.0};
    std::string content_;
    std::vector<std::string> notes_;

    friend std::shared_ptr<const Hull>(::pelagic::hull_of)(const ObjectMesh& mesh);
    mutable std::shared_ptr<const Hull> hull_;
};

}  // namespace PELAGIC_VERSION_NAMESPACE
}  // namespace pelagic
