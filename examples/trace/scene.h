// The sea and an object that floats in it, in one scene of Embree; rays in batches.
#pragma once

#include <embree3/rtcore.h>
#include <pelagic/procedural.h>

#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "embree_sea.h"
#include "obj.h"

namespace pelagic::trace {

struct RayQuery {
    glm::vec3 from{0.0f}, towards{0.0f, 0.0f, -1.0f};  // [m] relative to the scene's origin; unit
    float nearest_m = 0.0f, farthest_m = 1e9f;
    RayWidth width{};
};

enum class Met { Nothing, Sea, Object };
struct RayAnswer {
    Met met = Met::Nothing;
    float distance_m = 0.0f;
    glm::vec3 normal{0.0f};  // unit; of the sea up, of the object to where the ray comes from
    glm::vec2 rest_m{0.0f};  // of the sea: the place at rest
    glm::vec3 albedo{0.0f};  // of the object
};

struct Placement {
    glm::dvec2 at_m{0.0};      // in the world
    double heading_rad = 0.0;  // counter-clockwise from +x
};

class TracedScene {
  public:
    // `finest_cell_m`: the frame's; object: null is none. Throws std::runtime_error.
    TracedScene(const pelagic_frame* frame, EmbreeSea::Options options, const FloatingObject* object,
                const Placement& placement);

    // On all threads of the calling arena. Throws std::runtime_error for calls of the sea that failed.
    void trace(std::span<const RayQuery> rays, std::span<RayAnswer> answers) const;
    // Whether each ray meets anything.
    void occluded(std::span<const RayQuery> rays, std::span<std::uint8_t> blocked) const;
    // The object alone, which the water doesn't hide.
    void trace_object(std::span<const RayQuery> rays, std::span<RayAnswer> answers) const;

  private:
    struct ReleaseDevice {
        void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
    };
    struct ReleaseScene {
        void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
    };
    using Scene = std::unique_ptr<RTCSceneTy, ReleaseScene>;

    void float_on(const pelagic_frame* frame, const EmbreeSea::Options& options, const FloatingObject& object,
                  const Placement& placement);
    Scene scene_of_mesh(const Mesh& mesh);
    void trace_in(RTCScene scene, std::span<const RayQuery> rays, std::span<RayAnswer> answers) const;
    void check() const;

    std::unique_ptr<RTCDeviceTy, ReleaseDevice> device_;
    std::optional<EmbreeSea> sea_;
    Mesh shown_, dry_;  // floating, relative to the scene's origin
    Scene scene_, object_scene_, dry_scene_;
};

}  // namespace pelagic::trace
