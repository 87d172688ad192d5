// A coarse cage whose limit surface is the sea.
//
// Inside a regular grid of quads the limit surface of Catmull and Clark (1978) is the uniform bicubic B-spline of the
// vertices. So the cage through whose limit surface a grid of points goes is the solution of the spline's interpolation:
// along each axis (c₋₁ + 4 c₀ + c₁)/6 = p. Its inverse is c_i = √3 Σ z^|j| p_{i+j}, z = √3 − 2 (Unser, Aldroubi, Eden 1993).
// Waves are smooth: such a surface errs by up to (kh)⁴/384 of a wave's amplitude, h being the distance of the points, where a
// mesh errs by up to (kh)²/8, and its normals by less than a mesh's. The points outside the patch that the sum asks for are the sea's,
// so that the edges fit as well as the rest.
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace pelagic {

struct FittedCage {
    // Rings of vertices outside the patch: with interpolateBoundary "none" their faces are no part of the surface.
    static constexpr int kRing = 1;
    // How far the sum reaches: the next term is 5e-7 of the first.
    static constexpr int kReach = 10;
    static constexpr int kMargin = kRing + kReach;  // of points around the patch

    int quads = 1;  // of the patch, a side: as many faces of the cage have a part of the surface

    int vertices_per_side() const { return quads + 1 + 2 * kRing; }
    int points_per_side() const { return quads + 1 + 2 * kMargin; }

    // The cage whose limit points are these: points_per_side()² of them, columns fastest; vertices_per_side()² vertices are
    // written. The limit surface meets the point at each vertex of the patch. Velocities are fitted as well: the limit
    // surface of vertices that move with them moves with the sea. On all threads of the calling arena; a vertex depends on
    // the points round it alone.
    void fit(std::span<const glm::vec3> points, std::vector<glm::vec3>& vertices) const;
    // Without the outermost `rings`: kReach of them leave values at the vertices, for those that a renderer doesn't smooth
    // ("varying"), and kMargin the patch's own.
    template <class Value>
    void crop(std::span<const Value> values, int rings, std::vector<Value>& kept) const {
        kept.clear();
        const auto stride = static_cast<std::size_t>(points_per_side()),
                   first = static_cast<std::size_t>(rings);
        const std::size_t side = stride - 2 * first;
        for (std::size_t y = first; y < first + side; ++y) {
            const auto row = values.subspan(y * stride + first, side);
            kept.insert(kept.end(), row.begin(), row.end());
        }
    }
};

}  // namespace pelagic
