#include "tests/plugin/bake/read_vdb.h"

#include <openvdb/openvdb.h>

namespace pelagic::test {
namespace {

glm::vec3 vector_of(float value) {
    return {value, 0.0f, 0.0f};
}
glm::vec3 vector_of(const openvdb::Vec3s& value) {
    return {value.x(), value.y(), value.z()};
}

template <class Grid>
void add_values(VdbGrid& read, const typename Grid::ConstPtr& grid) {
    read.value = [grid](glm::ivec3 at) { return vector_of(grid->tree().getValue({at.x, at.y, at.z})); };
    read.for_each = [grid](const std::function<void(glm::ivec3, glm::vec3)>& take) {
        for (auto voxel = grid->cbeginValueOn(); voxel; ++voxel) {
            const openvdb::Coord at = voxel.getCoord();
            take({at.x(), at.y(), at.z()}, vector_of(*voxel));
        }
    };
}

}  // namespace

std::vector<VdbGrid> read_vdb(const std::filesystem::path& path) {
    openvdb::initialize();
    openvdb::io::File file(path.string());
    file.open(/*delayLoad=*/false);
    std::vector<VdbGrid> grids;
    const openvdb::GridPtrVecPtr all = file.getGrids();
    for (const openvdb::GridBase::Ptr& grid : *all) {
        VdbGrid read{.name = grid->getName(),
                     .grid_class = openvdb::GridBase::gridClassToString(grid->getGridClass()),
                     .active = grid->activeVoxelCount(),
                     .voxel_m = {grid->voxelSize().x(), grid->voxelSize().y(), grid->voxelSize().z()},
                     .place_m = {},
                     .value = {},
                     .for_each = {}};
        read.place_m = [grid](glm::ivec3 at) {
            const openvdb::Vec3d place = grid->indexToWorld(openvdb::Coord(at.x, at.y, at.z));
            return glm::dvec3(place.x(), place.y(), place.z());
        };
        if (grid->isType<openvdb::FloatGrid>())
            add_values<openvdb::FloatGrid>(read, openvdb::gridConstPtrCast<openvdb::FloatGrid>(grid));
        else
            add_values<openvdb::Vec3SGrid>(read, openvdb::gridConstPtrCast<openvdb::Vec3SGrid>(grid));
        grids.push_back(std::move(read));
    }
    return grids;
}

}  // namespace pelagic::test
