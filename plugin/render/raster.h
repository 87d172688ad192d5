// Which triangle each pixel shows, and where in it: the step between OpenGL's vertex and fragment shaders.
//
// A pixel is covered if its centre lies in a triangle whose corners are rounded to 1/256 of a pixel. A centre
// on an edge belongs to the triangle that has it as its top or left edge: of triangles that share an edge,
// exactly one. The arithmetic is in integers and therefore exact. The nearest triangle is shown; of equally
// near ones the first. Both sides are drawn. The part in front of the near plane is clipped.
//
// Where a pixel is looked at may be chosen for each (draw's `places`): the same holds with that place for its centre.
//
// Weights are perspective-correct. They come from the unrounded corners in homogeneous coordinates (Olano and
// Greer 1997), which need no clipping.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "plugin/render/picture_window.h"

namespace pelagic {

// Where a pixel is looked at, from its centre in 1/256 of a pixel: −128 … 127; or that it isn't.
struct PixelPlace {
    static constexpr std::int16_t kNowhere = std::numeric_limits<std::int16_t>::max();
    std::int16_t x = 0, y = 0;
    bool is_taken() const { return x != kNowhere; }
};

class Rasteriser {
  public:
    static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
    static constexpr int kBandRows = 16;
    static constexpr int kLargestSide = 1 << 18;                          // [pixels] limit of the integers
    static constexpr std::size_t kPieceBytes = 7 * sizeof(std::int32_t);  // held for each triangle in view

    // clip: OpenGL's clip coordinates by vertex, finite. indices: three per triangle. Both must stay alive
    // and unchanged until the last call. has_places: whether draw() gets any. Throws std::invalid_argument for a
    // resolution out of range. window: the pixels that are drawn, some of the picture's; by default all.
    void set(std::span<const glm::dvec4> clip, std::span<const std::uint32_t> indices, glm::ivec2 resolution,
             bool has_places = false, const std::optional<PixelWindow>& window = {});

    int band_count() const { return static_cast<int>(band_begin_.size()) - 1; }

    // Writes the triangle that each pixel of a band shows, or kNone. Rows begin at band·kBandRows, from the
    // window's top, x fastest, at its full width; the last band may have fewer rows. Bands may be drawn in parallel.
    // Without places each pixel is looked at in its centre; otherwise where its own says, and kNone is of those that
    // aren't.
    void draw(int band, std::span<std::uint32_t> triangles, std::span<const PixelPlace> places = {}) const;

    // The weights of a triangle's corners, in the order of its indices, at a point of the picture in pixels:
    // each 0 … 1, with the sum 1. A point outside the triangle (rounding may put a pixel's centre there) gets
    // the nearest weights.
    glm::dvec3 weights(std::uint32_t triangle, glm::dvec2 pixel) const;

    // How 1/w changes from one pixel to the next, to the right and down, as a part of what it is at the point. It is
    // linear on the triangle's plane.
    glm::dvec2 relative_change(std::uint32_t triangle, glm::dvec2 pixel) const;

  private:
    // A triangle on the screen, or a part of a clipped one, in 1/256 of a pixel from the top left corner.
    struct Piece {
        std::array<glm::ivec2, 3> corner;  // in the order that gives a positive area
        std::uint32_t triangle;
    };
    static_assert(sizeof(Piece) == kPieceBytes);

    void add_clipped(std::uint32_t triangle);
    void add_piece(std::uint32_t triangle, const std::array<glm::dvec4, 3>& corners);
    void sort_into_bands();
    // The corner's vertex as (X w, Y w, w), with X and Y in pixels.
    glm::dvec3 on_screen(const glm::dvec4& clip) const;
    std::array<glm::dvec3, 3> corners_on_screen(std::uint32_t triangle) const;

    std::span<const glm::dvec4> clip_;
    std::span<const std::uint32_t> indices_;
    glm::ivec2 resolution_{0};
    PixelWindow window_;
    int beside_ = 0;  // pixels that a triangle may meet beside those whose centres it does
    std::vector<Piece> pieces_;
    std::vector<std::size_t> band_begin_{0};  // into band_pieces_; one more for the end of the last band
    std::vector<std::uint32_t> band_pieces_;  // ascending within each band
};

}  // namespace pelagic
