// Rays and the meshes that they meet.
//
// Behind it is Embree 3, as a module of its own, pelagic_rays.so, that is loaded when the first scene is made: Embree is larger than the
// rest of the program, and only pictures of shots with objects need it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/mat4x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <span>

#include "pelagic/object_mesh.h"

namespace pelagic {

struct Ray {
    glm::vec3 from{0.0f}, towards{0.0f, 0.0f, 1.0f};  // [m]; unit
    float nearest_m = 0.0f, farthest_m = 1e30f;
    // What it stands for: a cone so wide where it begins [m], and by so much wider with each metre. Pictures on bodies are filtered by it.
    float width_m = 0.0f, spread = 0.0f;
};

struct RayHit {
    int body = -1;  // none
    std::uint32_t triangle = 0;
    glm::vec2 weights{0.0f};  // of the triangle's second and third corner
    float distance_m = 0.0f;
    bool is_hit() const { return body >= 0; }
};

// Of bodies in the order that they were given in. Rays may be traced by any number of threads at once.
class RayScene {
  public:
    virtual ~RayScene() = default;
    // Where the bodies are: the columns of a turn with a scale, and a place. On all threads. Throws as make_ray_scene().
    virtual void place(std::span<const glm::mat4x3> bodies) = 0;
    // The nearest that a ray meets, of both sides of triangles.
    virtual RayHit nearest(const Ray& ray) const = 0;
    virtual bool is_blocked(const Ray& ray) const = 0;
    // What it holds [bytes], at most until now.
    virtual std::size_t bytes() const = 0;
};

// The meshes must outlive the scene. Throws std::system_error where Embree can't be loaded, std::bad_alloc where it
// finds no memory, and std::runtime_error, which says what, for what else it reports.
std::unique_ptr<RayScene> make_ray_scene(std::span<const ObjectMesh* const> meshes);

// An estimate of RayScene::bytes(), from above.
std::size_t ray_scene_bytes(std::span<const ObjectMesh* const> meshes);

}  // namespace pelagic

// The module's only symbol: a scene that its caller deletes. Throws as make_ray_scene().
extern "C" pelagic::RayScene* pelagic_ray_scene(const pelagic::ObjectMesh* const* meshes, std::size_t count);
