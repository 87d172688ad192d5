// Hulls that keep water out, in the layout of the textures that hulls.glsl reads. Needs no OpenGL.
#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
#include <memory>
#include <span>
#include <vector>

#include "core/evaluate/hulls.h"
#include "core/scene/hull.h"

namespace pelagic {

inline constexpr int kHullColumns = 4096,
                     kHullPlaceColumns = 256;  // texels side by side, of the two textures
inline constexpr int kHullTexels = 6;          // of a hull in the second

// A hull where it is; hull, water: null without.
struct PlacedHull {
    const Hull* hull = nullptr;
    glm::dmat4 grid_from{1.0};  // from its own axes into the picture's grid: a turn, a scale and a place
    const Hulls::Beside* water = nullptr;
};

class PackedHulls {
  public:
    // Where each hull's nodes begin in hull_maps, in rows; one that is there twice has its nodes once.
    explicit PackedHulls(std::vector<std::shared_ptr<const Hull>> hulls);

    bool operator==(const PackedHulls&) const = default;
    int rows() const { return rows_; }
    // All nodes, rows() of kHullColumns; made anew at each call.
    std::vector<float> maps() const;
    // hull_places: rows of kHullPlaceColumns. All hulls must be among those given.
    std::vector<glm::vec4> places(std::span<const PlacedHull> hulls) const;

  private:
    std::vector<std::shared_ptr<const Hull>> hulls_;
    std::vector<int> first_row_;
    int rows_ = 0;
};

}  // namespace pelagic
