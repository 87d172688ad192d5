// Which triangle each pixel shows, and where in it: what OpenGL does between a vertex and a fragment shader.
//
// A pixel is covered where its centre lies in a triangle whose corners are rounded to 1/256 of a pixel, and
// centres on an edge belong to the triangle whose top or left edge it is: of triangles that share an edge,
// exactly one. Integers, so that this is exact. The nearest triangle is shown; of equally near ones the
// first. Both sides are drawn. What is nearer than the clip coordinates' near plane is cut off.
//
// Weights are those of the true, unrounded corners, in homogeneous coordinates (Olano and Greer 1997), which
// need no clipping: perspective-correct.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <limits>
#include <span>
#include <vector>

namespace pelagic {

class Rasteriser {
  public:
    static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
    static constexpr int kBandRows = 16;
    static constexpr int kLargestSide = 1 << 18;  // [pixels] what the integers hold

    // clip: OpenGL's clip coordinates by vertex, finite; indices: three a triangle. Both must live, and stay
    // as they are, until the last call. Throws std::invalid_argument for a resolution out of range.
    void set(std::span<const glm::dvec4> clip, std::span<const std::uint32_t> indices, glm::ivec2 resolution);

    int band_count() const { return static_cast<int>(band_begin_.size()) - 1; }

    // The triangle that each pixel of a band shows, kNone where there is none: rows band·kBandRows and on,
    // from the top, x fastest, of whole width, the last band's fewer rows. Bands may be drawn side by side.
    void draw(int band, std::span<std::uint32_t> triangles) const;

    // The weights of a triangle's corners, in the order of its indices, at a picture point in pixels: each 0
    // … 1, their sum 1. Where it lies outside of the triangle, as a pixel's centre by the rounding may, the
    // nearest that are.
    glm::dvec3 weights(std::uint32_t triangle, glm::dvec2 pixel) const;

  private:
    // A triangle of the screen, or a piece of a clipped one. In 1/256 of a pixel, from the top left corner.
    struct Piece {
        std::array<glm::ivec2, 3> corner;  // to the right in rising y: positive area
        std::uint32_t triangle;
    };

    void add_clipped(std::uint32_t triangle);
    void add_piece(std::uint32_t triangle, const std::array<glm::dvec4, 3>& corners);
    void sort_into_bands();
    // The corner's vertex, in (X w, Y w, w), X and Y in pixels.
    glm::dvec3 on_screen(const glm::dvec4& clip) const;
    std::array<glm::dvec3, 3> corners_on_screen(std::uint32_t triangle) const;

    std::span<const glm::dvec4> clip_;
    std::span<const std::uint32_t> indices_;
    glm::ivec2 resolution_{0};
    std::vector<Piece> pieces_;
    std::vector<std::size_t> band_begin_{0};  // into band_pieces_, and the end of the last
    std::vector<std::uint32_t> band_pieces_;  // rising in each band
};

}  // namespace pelagic
