// A mesh of the sea's floor, as depths.
#pragma once

#include <filesystem>
#include <glm/vec2.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "pelagic/cage.h"

namespace pelagic {

// What is wrong with a file that should be such a mesh, as the end of a sentence that begins with its name, and what would be right.
class FloorMeshError : public std::runtime_error {
  public:
    FloorMeshError(const std::string& problem, std::string accepted)
        : std::runtime_error(problem), accepted_(std::move(accepted)) {}
    const std::string& accepted() const { return accepted_; }

  private:
    std::string accepted_;
};

// Depths below the sea at rest [m], negative on land, rows from the south, over a rectangle of the world.
struct FloorDepths {
    glm::ivec2 columns_rows{0};
    std::vector<float> depths_m;
    glm::dvec2 from_m{0.0}, size_m{0.0};
};

// Beyond a map of depths the floor falls no deeper than anybody sees.
inline constexpr double kDeepestFloor_m = 500.0;
inline constexpr int kFloorMeshTexels = 1024;  // of the longer side

// Whether a path is that of a mesh (.obj), not of a picture.
bool is_floor_mesh(const std::string& path);
// A file (Wavefront OBJ, z up, in the world's metres). Throws FloorMeshError.
Cage read_floor_mesh(const std::filesystem::path& path);
// The highest of the mesh's faces at the middle of each texel, faces as fans of triangles; beyond_m where there is none. `rest_m`: the
// height of the sea at rest. Throws FloorMeshError for a mesh that has no area from above, or that covers itself hundreds of times.
FloorDepths depths_of(const CageMesh& mesh, double rest_m, double beyond_m);

}  // namespace pelagic
