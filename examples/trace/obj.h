// Wavefront OBJ, as much of it as a thing that floats needs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/vec3.hpp>
#include <vector>

namespace pelagic::trace {

struct Mesh {
    std::vector<glm::vec3> points;      // [m]
    std::vector<glm::vec3> colours;     // of the points: albedo, linear Rec. 709, 0 … 1
    std::vector<glm::uvec3> triangles;  // indices of points
};

// x forward, y to the left, z up; z = 0 floats on the water.
struct FloatingObject {
    Mesh shown;
    Mesh dry;  // a closed surface round where there is no water, not shown; empty: none
};

// Reads `v x y z [r g b]` (grey where there is no colour) and `f` (polygons, cut into triangles from their first corner). Faces after
// `o dry` or `g dry` are the dry space; all else is passed over. Throws std::runtime_error, naming the file and the line.
FloatingObject read_obj(const std::filesystem::path& file);

}  // namespace pelagic::trace
