// Files of volumes, as OpenVDB itself reads them.
#pragma once

#include <filesystem>
#include <functional>
#include <glm/vec3.hpp>
#include <memory>
#include <string>
#include <vector>

namespace pelagic::test {

struct VdbGrid {
    std::string name, grid_class;
    std::size_t active = 0;
    glm::dvec3 voxel_m{0.0};
    std::function<glm::dvec3(glm::ivec3)> place_m;  // of a voxel's middle
    std::function<glm::vec3(glm::ivec3)> value;     // of floats in x; also where nothing is allocated
    std::function<void(const std::function<void(glm::ivec3, glm::vec3)>&)> for_each;  // of active voxels
};

// In the file's order.
std::vector<VdbGrid> read_vdb(const std::filesystem::path& file);

}  // namespace pelagic::test
