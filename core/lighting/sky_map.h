// Radiance by direction as a square picture with mip levels, for the lighting's filtered lookups on the CPU
// and, once uploaded, on the GPU.
//
// Stereographic projection (Bruneton, Neyret, Holzschuch 2010, §5.2): a direction r, z up, maps to
// u = (r_x, r_y)/(1 + r_z), and the horizon to the circle |u| = 1. The picture covers −kSkyMapExtent ≤ u_x,
// u_y ≤ kSkyMapExtent. Directions below the horizon, in the picture and beyond it, all have the radiance of
// the sea's own multiple reflections (§6).
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

namespace pelagic {

inline constexpr float kSkyMapExtent = 1.25f;  // of u: room below the horizon for the filters' tails

class SkyMap {
  public:
    SkyMap() = default;
    // texels: size × size, x fastest, y rising. Texel (i, j) is the mean over its square of u; (0, 0) begins
    // at −kSkyMapExtent. size is a power of two, 4 … 4096. Coarser levels are 2 × 2 means, down to 1 × 1.
    // Throws std::invalid_argument for another size or count, or a texel that is negative or not finite.
    //
    // `open` is as large, and the finest level where it is given: the same without the ground, with the sky extended
    // past the horizon by some texels (sky_map.glsl). The coarser levels are means of `texels`.
    SkyMap(int size, std::vector<glm::vec3> texels, std::vector<glm::vec3> open = {});

    // Throws for a size that the constructor rejects, so that callers needn't fill the texels first.
    static void check_size(int size);

    int size() const { return size_; }
    int level_count() const { return static_cast<int>(levels_.size()); }
    const std::vector<glm::vec3>& level(int i) const { return levels_.at(i); }  // (size >> i)² texels

    // u in units of the projection; level 0 (finest) … level_count() − 1, clamped. From level 1 on equivalent to
    // OpenGL's textureLod with GL_LINEAR_MIPMAP_LINEAR and GL_CLAMP_TO_EDGE; below that smooth (sky_map.glsl).
    glm::vec3 radiance(glm::vec2 u, float level) const;
    // The finest level, smooth and without the ground; |u| ≤ 1.
    glm::vec3 open_radiance(glm::vec2 u) const;

    // All levels alike, trilinear.
    glm::vec3 trilinear(glm::vec2 u, float level) const;

  private:
    int size_ = 0;
    std::vector<std::vector<glm::vec3>> levels_;
};

// The place of a unit direction in the map, clamped to its square so that r_z → −1 has one.
glm::vec2 sky_map_place(glm::vec3 direction);
// The inverse: the direction at a place.
glm::vec3 sky_map_direction(glm::vec2 u);

}  // namespace pelagic
