#include "plugin/render/ray_scene.h"

#include <dlfcn.h>

#include <new>
#include <set>
#include <string>
#include <system_error>

namespace pelagic {
namespace {

// What this machine lacks, in these words alone: std::system_error adds the system's.
struct NotLoaded : std::system_error {
    explicit NotLoaded(std::string text)
        : system_error(std::make_error_code(std::errc::not_supported)), text_(std::move(text)) {}
    const char* what() const noexcept override { return text_.c_str(); }
    std::string text_;
};

// For as long as the process lives.
decltype(&pelagic_ray_scene) maker() {
    static const auto loaded = []() -> decltype(&pelagic_ray_scene) {
        void* const library = ::dlopen(PELAGIC_RAYS_MODULE, RTLD_NOW | RTLD_LOCAL);
        void* const symbol = library ? ::dlsym(library, "pelagic_ray_scene") : nullptr;
        if (!symbol)
            throw NotLoaded(
                std::string("Embree can't be loaded: ") + ::dlerror() +
                "; pictures of shots with objects need that file of Pelagic's, which the add-on for Blender is "
                "without, and Embree 3 (Debian: libembree3-3)");
        return reinterpret_cast<decltype(&pelagic_ray_scene)>(symbol);
    }();
    return loaded;
}

}  // namespace

std::unique_ptr<RayScene> make_ray_scene(std::span<const ObjectMesh* const> meshes) {
    RayScene* const scene = maker()(meshes.data(), meshes.size());
    if (!scene) throw std::bad_alloc();
    return std::unique_ptr<RayScene>(scene);
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
