// Faces over a surface's points.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <vector>

namespace pelagic {

// Polygons over the points: counts[i] corners each, counter-clockwise seen from above.
struct Faces {
    std::vector<std::int32_t> counts, indices;
    std::vector<glm::vec2> st;      // of each point, 0 … 1 unless an artist gave others
    bool is_st_of_corners = false;  // st is of each corner of each face instead: the texture has seams
};

// [bytes] of a quad's count and corners, and of a point's texture coordinate. With seams each corner has one of its
// own: four for each quad, of which a mesh has as many as points.
inline constexpr std::size_t kQuadFaceBytes = 5 * sizeof(std::int32_t) + sizeof(glm::vec2);
inline constexpr std::size_t kQuadSeamBytes = 3 * sizeof(glm::vec2);

}  // namespace pelagic
