// Which samples of a picture look through water: those whose place on the camera's front glass is under the surface, or where water climbs
// it (core/lighting/meniscus.h). So a camera that
// is half under shows both, and the line between follows the waves.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "core/surface/view.h"

namespace pelagic {

// How far before the eye the glass is [m]: as of a dome port. Nothing nearer is seen.
inline constexpr double kFrontGlass_m = 0.1;

// The lowest and the highest z of the glass in a view [m].
struct GlassHeights {
    double lowest_m, highest_m;
};
GlassHeights glass_heights(const View& view);
// Whether a place of the glass may be in the water, or where water climbs it, by how high waves are at most [m].
bool may_be_in_water(const View& view, double highest_m);

class Waterline {
  public:
    // Of a view, and the displaced points of the sea that it draws, relative to origin_m. highest_m: of the sea above and
    // below its level. The points and triangles are copied as far as they matter.
    template <class T>
    Waterline(const View& view, double highest_m, glm::dvec2 origin_m,
              std::span<const glm::vec<3, T>> position_m, std::span<const std::uint32_t> triangles);

    // How high a place of the picture, in pixels, is on the glass above the surface, its highest sheet where it has folded [m]; negative
    // under it. Infinite where no wave reaches, or all do.
    double height_m(glm::dvec2 pixel) const;
    bool is_under(glm::dvec2 pixel) const { return height_m(pixel) < 0.0; }
    // Whether it does anywhere, as far as a coarse grid of places shows.
    bool is_any_under() const;

  private:
    static constexpr int kCells = 64;  // a side of a grid over the glass, seen from above

    glm::ivec2 cell_of(glm::dvec2 place_m) const;

    View view_;
    double highest_m_;
    glm::dvec2 low_m_, cell_m_;                  // of the grid
    std::vector<std::vector<glm::dmat3>> over_;  // by cell: corners of triangles
};

}  // namespace pelagic
