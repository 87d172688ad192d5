// Radiance by direction as one square picture with mip levels: what the lighting's filtered lookups read, on
// the CPU and, uploaded level by level, on the GPU.
//
// Stereographic projection (Bruneton, Neyret, Holzschuch 2010, §5.2): a direction r, z up, lies at
// u = (r_x, r_y)/(1 + r_z); the horizon is the circle |u| = 1. The picture covers −kSkyMapExtent ≤ u_x, u_y ≤
// kSkyMapExtent, a little of what lies below the horizon included, whose radiance is `below` (the water's own
// multiple reflections, §6) like all that lies farther out.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

namespace pelagic {

inline constexpr float kSkyMapExtent = 1.25f;  // of u: the wrong side of the horizon for the filters' tails

class SkyMap {
  public:
    SkyMap() = default;
    // texels: size × size, x fastest, y rising; texel (i, j) is the mean of its square of u, the first from
    // −kSkyMapExtent. size is a power of two, 4 … 4096. Levels are means of 2 × 2, down to 1 × 1. Throws
    // std::invalid_argument for another size or count, or a texel that is negative or not finite.
    SkyMap(int size, std::vector<glm::vec3> texels);

    // Throws for a size that the constructor refuses: before one fills the texels.
    static void check_size(int size);

    int size() const { return size_; }
    int level_count() const { return static_cast<int>(levels_.size()); }
    const std::vector<glm::vec3>& level(int i) const { return levels_.at(i); }  // (size >> i)² texels

    // As OpenGL's textureLod with GL_LINEAR_MIPMAP_LINEAR and GL_CLAMP_TO_EDGE does it: u in units of the
    // projection, level 0 … level_count() − 1 (clamped), 0 the finest.
    glm::vec3 radiance(glm::vec2 u, float level) const;

  private:
    int size_ = 0;
    std::vector<std::vector<glm::vec3>> levels_;
};

// Where a unit direction lies in the map; clamped to the map's square, so that r_z → −1 has a place.
glm::vec2 sky_map_place(glm::vec3 direction);
// The direction of a place: the inverse.
glm::vec3 sky_map_direction(glm::vec2 u);

}  // namespace pelagic
