// The floor of the sea: how deep it lies from place to place, what it reflects there, and the light of the sun on it (floor.glsl).
#pragma once

#include <array>
#include <cstddef>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <vector>

namespace pelagic {

// As floor.glsl has it, from an eye.
struct FloorSeen {
    bool is_seen = false;
    float z_m = 0.0f, curvature_per_m = 0.0f, pixel = 0.0f, lowest_m = 0.0f;
    glm::vec4 depths{0.0f}, depths_per_m{0.0f}, colours{0.0f};
    float colours_first = 0.0f;
    glm::vec4 light{0.0f}, coarse{0.0f}, shafts{0.0f};
    glm::vec3 shafts_look{0.0f};
    std::span<const float> values{};
};

struct FloorEye {
    glm::dvec3 position_m{0.0};    // in the world
    double curvature_per_m = 0.0;  // of the earth, round which the sea lies below it
    double pixel_tangent = 0.0;    // that one of its pixels covers
};

// Values of a float's whole numbers: maps are no larger together.
inline constexpr std::size_t kMostFloorValues = std::size_t{1} << 24;

class Floor {
  public:
    // Level, so deep below a sea that rests at this height of the world [m].
    explicit Floor(double depth_m = 1e9, double rest_m = 0.0)
        : rest_m_(rest_m), z_m_(rest_m - depth_m), lowest_m_(z_m_) {}

    // Depths below the sea at rest [m], > 0, rows from the south, over a rectangle of the world that begins at from_m. Beyond it they go over to the
    // level floor.
    // Throws std::invalid_argument for sizes that aren't positive, another number of values, or too many.
    void set_depths(glm::ivec2 columns_rows, std::vector<float> depths_m, glm::dvec2 from_m,
                    glm::dvec2 size_m);
    // A picture of side × side texels, a power of two, rows from the south, that repeats every size_m from the world's origin on: times the floor's
    // colour. Throws as set_depths().
    void set_colours(int side, std::span<const glm::vec3> colours, double size_m);

    bool has_depths() const { return depth_size_.x > 0; }
    // Depth below the sea at rest at a place of the world [m].
    double depth_m(glm::dvec2 place_m) const;
    double rest_m() const { return rest_m_; }
    // How far from an eye in the water a sight (unit, downwards) meets it [m].
    double distance_m(const glm::dvec3& eye_m, const glm::dvec3& direction) const;

    // What waves make of the sun's light on the floor, times what a level sea lets fall there.
    struct Light {
        int side = 0;                        // texels of each of two maps, rows from the south; 0: none
        double texel_m = 0.0;                // of the finer one; kFloorLightStep times as much of the coarser
        std::array<glm::dvec2, 2> from_m{};  // corners of both, in the world
        double gain = 1.0;
    };
    // The maps' values, for who writes them: 2 · side², the finer one's first. Kept until the next call.
    std::span<float> set_light(const Light& light);
    bool has_light() const { return light_.side > 0; }

    // The same in the water on a level plane so deep below the sea at rest, for the shafts of light that an eye under water sees.
    struct Shafts {
        int side = 0;  // texels of the map, a power of two; 0: none
        double texel_m = 0.0, depth_m = 0.0;
        glm::dvec2 from_m{0.0};
        double gain = 1.0;
    };
    // The map's values, for who writes them, and then calls halve_shafts(). Kept until the next call, set_light() included, which takes the shafts away.
    std::span<float> set_shafts(const Shafts& shafts);
    // Makes the coarser levels.
    void halve_shafts();
    bool has_shafts() const { return shafts_.side > 0; }

    // Kept while the floor isn't changed.
    FloorSeen seen_from(const FloorEye& eye) const;
    const std::vector<float>& values() const { return values_; }

  private:
    double rest_m_, z_m_, lowest_m_;
    glm::ivec2 depth_size_{0};
    glm::dvec2 depth_from_m_{0.0}, depth_per_m_{0.0};
    int colour_side_ = 0;
    double colour_m_ = 1.0;
    std::size_t colours_first_ = 0, light_first_ = 0, shafts_first_ = 0;
    Light light_;
    Shafts shafts_;
    std::vector<float> values_;  // depths, colours, light, shafts
};

// Texels of the coarser map of light over those of the finer: as in floor.glsl.
inline constexpr double kFloorLightStep = 4.0;

}  // namespace pelagic
