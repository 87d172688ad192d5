#include "plugin/render/raster.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <stdexcept>
#include <string>

namespace pelagic {
namespace {

constexpr int kSubpixels = 256;  // as GPUs have, and Mesa's software rasteriser
// Triangles are clipped this far outside the picture, in halves of its width and height, so that their
// corners fit the integers.
constexpr double kGuard = 2.0;

// Signed distances, ≥ 0 inside, from OpenGL's near plane and from the four planes of the guard band.
constexpr int kPlanes = 5;
double inside(int plane, const glm::dvec4& p) {
    switch (plane) {
        case 0:
            return p.z + p.w;
        case 1:
            return kGuard * p.w - p.x;
        case 2:
            return kGuard * p.w + p.x;
        case 3:
            return kGuard * p.w - p.y;
        default:
            return kGuard * p.w + p.y;
    }
}

std::int64_t cross(glm::ivec2 a, glm::ivec2 b, glm::ivec2 p) {
    return (std::int64_t{b.x} - a.x) * (std::int64_t{p.y} - a.y) -
           (std::int64_t{b.y} - a.y) * (std::int64_t{p.x} - a.x);
}

// Whether a pixel centre on the edge from a to b belongs to the triangle on the edge's right (y down).
bool is_top_or_left(glm::ivec2 a, glm::ivec2 b) {
    return b.y < a.y || (b.y == a.y && b.x > a.x);
}

int first_centre(int coordinate) {  // the first pixel whose centre is at or after the coordinate
    constexpr int kHalf = kSubpixels / 2;
    return (coordinate - kHalf + kSubpixels - 1) >> 8;  // rounds negative values down, too
}

static_assert(kSubpixels == 1 << 8);

}  // namespace

void Rasteriser::set(std::span<const glm::dvec4> clip, std::span<const std::uint32_t> indices,
                     glm::ivec2 resolution, bool has_places, const std::optional<PixelWindow>& window) {
    if (std::min(resolution.x, resolution.y) < 1 || std::max(resolution.x, resolution.y) > kLargestSide)
        throw std::invalid_argument("a picture of " + std::to_string(resolution.x) + " x " +
                                    std::to_string(resolution.y) + " samples: both must be 1 to " +
                                    std::to_string(kLargestSide));
    clip_ = clip;
    indices_ = indices;
    resolution_ = resolution;
    window_ = window.value_or(PixelWindow{.high = resolution});
    beside_ = has_places ? 1 : 0;
    pieces_.clear();
    for (std::uint32_t triangle = 0; triangle < indices.size() / 3; ++triangle) add_clipped(triangle);
    sort_into_bands();
}

void Rasteriser::add_clipped(std::uint32_t triangle) {
    // Each plane cuts off at most one corner, and adds one.
    std::array<glm::dvec4, 3 + kPlanes> polygon, cut;
    int count = 3;
    for (int i = 0; i < 3; ++i) polygon[i] = clip_[indices_[3 * std::size_t{triangle} + i]];
    for (int plane = 0; plane < kPlanes; ++plane) {
        int kept = 0;
        for (int i = 0; i < count; ++i) {
            const glm::dvec4 &a = polygon[i], &b = polygon[(i + 1) % count];
            const double at_a = inside(plane, a), at_b = inside(plane, b);
            if (at_a >= 0.0) cut[kept++] = a;
            // Always from inside to outside, so that both triangles of an edge get the same bits.
            if (at_a >= 0.0 && at_b < 0.0) cut[kept++] = a + (b - a) * (at_a / (at_a - at_b));
            if (at_a < 0.0 && at_b >= 0.0) cut[kept++] = b + (a - b) * (at_b / (at_b - at_a));
        }
        std::copy_n(cut.begin(), kept, polygon.begin());
        count = kept;
        if (count < 3) return;
    }
    for (int i = 2; i < count; ++i) add_piece(triangle, {polygon[0], polygon[i - 1], polygon[i]});
}

glm::dvec3 Rasteriser::on_screen(const glm::dvec4& p) const {
    return {0.5 * resolution_.x * (p.w + p.x), 0.5 * resolution_.y * (p.w - p.y), p.w};
}

std::array<glm::dvec3, 3> Rasteriser::corners_on_screen(std::uint32_t triangle) const {
    std::array<glm::dvec3, 3> corners;
    for (int i = 0; i < 3; ++i) corners[i] = on_screen(clip_[indices_[3 * std::size_t{triangle} + i]]);
    return corners;
}

void Rasteriser::add_piece(std::uint32_t triangle, const std::array<glm::dvec4, 3>& corners) {
    Piece piece{.corner = {}, .triangle = triangle};
    for (int i = 0; i < 3; ++i) {
        const glm::dvec3 p = on_screen(corners[i]);
        if (!(p.z > 0.0)) return;  // the near plane passes through the eye
        piece.corner[i] = {static_cast<int>(std::lround(p.x / p.z * kSubpixels)),
                           static_cast<int>(std::lround(p.y / p.z * kSubpixels))};
    }
    const std::int64_t area = cross(piece.corner[0], piece.corner[1], piece.corner[2]);
    if (area == 0) return;
    if (area < 0) std::swap(piece.corner[1], piece.corner[2]);
    pieces_.push_back(piece);
}

void Rasteriser::sort_into_bands() {
    const int bands = (window_.size().y + kBandRows - 1) / kBandRows;
    const auto rows_of = [&](const Piece& piece) {
        const auto [low, high] = std::minmax({piece.corner[0].y, piece.corner[1].y, piece.corner[2].y});
        const auto [left, right] = std::minmax({piece.corner[0].x, piece.corner[1].x, piece.corner[2].x});
        if (first_centre(left) - beside_ >= window_.high.x ||
            first_centre(right + 1) - 1 + beside_ < window_.low.x)
            return std::pair(0, -1);
        // Of the window's; up to and including the row whose centre is at the lowest corner. No rows: first > last.
        return std::pair(
            std::max(first_centre(low) - beside_ - window_.low.y, 0),
            std::min(first_centre(high + 1) - 1 + beside_ - window_.low.y, window_.size().y - 1));
    };
    band_begin_.assign(static_cast<std::size_t>(bands) + 1, 0);
    for (const Piece& piece : pieces_) {
        const auto [first, last] = rows_of(piece);
        for (int row = first; row <= last; row = (row / kBandRows + 1) * kBandRows)
            ++band_begin_[row / kBandRows + 1];
    }
    for (int band = 0; band < bands; ++band) band_begin_[band + 1] += band_begin_[band];
    band_pieces_.resize(band_begin_.back());
    std::vector<std::size_t> next(band_begin_.begin(), band_begin_.end() - 1);
    for (std::uint32_t i = 0; i < pieces_.size(); ++i) {
        const auto [first, last] = rows_of(pieces_[i]);
        for (int row = first; row <= last; row = (row / kBandRows + 1) * kBandRows)
            band_pieces_[next[row / kBandRows]++] = i;
    }
}

void Rasteriser::draw(int band, std::span<std::uint32_t> triangles,
                      std::span<const PixelPlace> places) const {
    const int first_row = window_.low.y + band * kBandRows;
    const int rows = std::min(kBandRows, window_.high.y - first_row);
    const auto width = static_cast<std::size_t>(window_.size().x);
    std::fill_n(triangles.begin(), width * rows, kNone);
    std::vector<double> nearness(width * rows, 0.0);  // 1/w of the triangle shown
    for (std::size_t at = band_begin_[band]; at < band_begin_[band + 1]; ++at) {
        const Piece& piece = pieces_[band_pieces_[at]];
        const auto& [a, b, c] = piece.corner;
        const auto [x_low, x_high] = std::minmax({a.x, b.x, c.x});
        const auto [y_low, y_high] = std::minmax({a.y, b.y, c.y});
        const int left = std::max(first_centre(x_low) - beside_, window_.low.x);
        const int right = std::min(first_centre(x_high + 1) - 1 + beside_, window_.high.x - 1);
        const int top = std::max(first_centre(y_low) - beside_, first_row);
        const int bottom = std::min(first_centre(y_high + 1) - 1 + beside_, first_row + rows - 1);
        if (left > right || top > bottom) continue;

        // 1/w is linear on the screen: the coefficients of its plane, from the unrounded corners.
        const auto corners = corners_on_screen(piece.triangle);
        const glm::dvec3 bc = glm::cross(corners[1], corners[2]), ca = glm::cross(corners[2], corners[0]),
                         ab = glm::cross(corners[0], corners[1]);
        const double determinant = glm::dot(corners[0], bc);
        if (determinant == 0.0) continue;  // seen edge-on
        const glm::dvec3 plane = (bc + ca + ab) / determinant;
        // 1/w is clamped to the corners' range: rounding may exceed it, in slivers without limit.
        double nearest = 0.0, farthest = std::numeric_limits<double>::infinity();
        for (const glm::dvec3& corner : corners) {
            const double own = corner.z > 0.0 ? 1.0 / corner.z : std::numeric_limits<double>::infinity();
            nearest = std::max(nearest, own);
            farthest = std::min(farthest, own);
        }

        const std::array<std::int64_t, 3> least{is_top_or_left(b, c) ? 0 : 1, is_top_or_left(c, a) ? 0 : 1,
                                                is_top_or_left(a, b) ? 0 : 1};
        const auto centre = [](int pixel) { return pixel * kSubpixels + kSubpixels / 2; };
        const auto step = [](glm::ivec2 from, glm::ivec2 to) {
            return -(std::int64_t{to.y} - from.y) * kSubpixels;
        };
        const std::array<std::int64_t, 3> steps{step(b, c), step(c, a), step(a, b)};
        // Of each edge's value, for a 1/256 of a pixel to the right and down.
        const auto turn = [](glm::ivec2 from, glm::ivec2 to) {
            return std::array<std::int64_t, 2>{-(std::int64_t{to.y} - from.y), std::int64_t{to.x} - from.x};
        };
        const std::array turns{turn(b, c), turn(c, a), turn(a, b)};
        for (int y = top; y <= bottom; ++y) {
            const glm::ivec2 start(centre(left), centre(y));
            std::array<std::int64_t, 3> edge{cross(b, c, start), cross(c, a, start), cross(a, b, start)};
            const std::size_t row = width * static_cast<std::size_t>(y - first_row);
            const double row_nearness = plane.y * (y + 0.5) + plane.z;
            if (!places.empty()) {
                for (int x = left; x <= right; ++x) {
                    const std::size_t sample = row + static_cast<std::size_t>(x - window_.low.x);
                    const PixelPlace place = places[sample];
                    if (!place.is_taken()) continue;
                    const std::int64_t right_by = std::int64_t{x - left} * kSubpixels + place.x;
                    bool is_inside = true;
                    for (int i = 0; i < 3; ++i)
                        is_inside =
                            is_inside && edge[i] + turns[i][0] * right_by + turns[i][1] * place.y >= least[i];
                    if (!is_inside) continue;
                    const double here =
                        std::clamp(plane.x * (x + 0.5 + place.x / double{kSubpixels}) + row_nearness +
                                       plane.y * (place.y / double{kSubpixels}),
                                   farthest, nearest);
                    if (here > nearness[sample]) {
                        nearness[sample] = here;
                        triangles[sample] = piece.triangle;
                    }
                }
                continue;
            }
            for (int x = left; x <= right; ++x) {
                if (edge[0] >= least[0] && edge[1] >= least[1] && edge[2] >= least[2]) {
                    const double here = std::clamp(plane.x * (x + 0.5) + row_nearness, farthest, nearest);
                    const std::size_t sample = row + static_cast<std::size_t>(x - window_.low.x);
                    if (here > nearness[sample]) {
                        nearness[sample] = here;
                        triangles[sample] = piece.triangle;
                    }
                }
                for (int i = 0; i < 3; ++i) edge[i] += steps[i];
            }
        }
    }
}

glm::dvec3 Rasteriser::weights(std::uint32_t triangle, glm::dvec2 pixel) const {
    const auto corners = corners_on_screen(triangle);
    const glm::dvec3 p(pixel, 1.0);
    glm::dvec3 weight(glm::dot(glm::cross(corners[1], corners[2]), p),
                      glm::dot(glm::cross(corners[2], corners[0]), p),
                      glm::dot(glm::cross(corners[0], corners[1]), p));
    // The signs depend on which side of the triangle is seen. If all corners are in front of the eye they
    // agree.
    if (glm::dot(corners[0], glm::cross(corners[1], corners[2])) < 0.0) weight = -weight;
    weight = glm::max(weight, 0.0);
    const double sum = weight.x + weight.y + weight.z;
    return sum > 0.0 ? weight / sum : glm::dvec3(1.0 / 3.0);
}

glm::dvec2 Rasteriser::relative_change(std::uint32_t triangle, glm::dvec2 pixel) const {
    const auto corners = corners_on_screen(triangle);
    const glm::dvec3 plane = glm::cross(corners[1], corners[2]) + glm::cross(corners[2], corners[0]) +
                             glm::cross(corners[0], corners[1]);
    const double here = glm::dot(plane, glm::dvec3(pixel, 1.0));
    return here != 0.0 ? glm::dvec2(plane) / here : glm::dvec2(0.0);
}

}  // namespace pelagic
