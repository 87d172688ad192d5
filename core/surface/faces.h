// Faces over a surface's points.
#pragma once

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

}  // namespace pelagic
