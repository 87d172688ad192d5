#include "plugin/render/ray_scene.h"

#include <set>

#include "plugin/files/module.h"

namespace pelagic {
namespace {

// For as long as the process lives.
decltype(&pelagic_ray_scene) maker() {
    static const auto loaded = reinterpret_cast<decltype(&pelagic_ray_scene)>(files::load(
        {.file = PELAGIC_RAYS_MODULE,
         .symbol = "pelagic_ray_scene",
         .what = "Embree",
         .needs =
             "pictures of shots with objects need that file of Pelagic's, which the add-on for Blender is "
             "without, and Embree 3 (Debian: libembree3-3)"}));
    return loaded;
}

}  // namespace

std::unique_ptr<RayScene> make_ray_scene(std::span<const ObjectMesh* const> meshes) {
    return std::unique_ptr<RayScene>(maker()(meshes.data(), meshes.size()));
}

std::size_t ray_scene_bytes(std::span<const ObjectMesh* const> meshes) {
    // Embree's own count (RayScene::bytes()) is 75 to 200 bytes a triangle while it builds, and some 100 kB for any scene.
    constexpr std::size_t kTriangle = 224, kBody = 4096, kScene = std::size_t{1} << 20;
    const std::set<const ObjectMesh*> each(meshes.begin(), meshes.end());
    std::size_t bytes = kScene + kBody * meshes.size();
    for (const ObjectMesh* mesh : each)
        bytes += kTriangle * (mesh->data().triangles.size() / 3) +
                 sizeof(glm::vec3) * mesh->data().points_m.size();
    return bytes;
}

}  // namespace pelagic
