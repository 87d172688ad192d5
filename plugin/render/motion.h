// Where neighbouring frames show what a frame shows: motion vectors.
#pragma once

#include <array>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "pelagic/scene.h"

namespace pelagic {

class Motion {
  public:
    // For pictures of the scene's camera at a frame, and points relative to origin_m [m].
    Motion(const Scene& scene, int frame, glm::dvec3 origin_m);

    // The way in the picture [px], x to the right and y up, that a point (x, y, z, 1) [m] takes until the next frame
    // (.xy) and, backwards, to the one before (.zw), when it moves with a velocity [m/s of the sea] and the camera as
    // its keys say; a direction (x, y, z, 0) is that of a point at infinity. (0, 0) for a frame that has it behind the
    // camera; no component beyond 1e6.
    glm::dvec4 of(glm::dvec4 point_m, glm::dvec3 velocity_mps) const;
    // The same of a point that is at these places in the frame before, this one, and the next.
    glm::dvec4 of(const std::array<glm::dvec3, 3>& places_m) const;

  private:
    glm::dvec4 between(const std::array<glm::dvec4, 3>& seen) const;

    std::array<glm::dmat4, 3> clip_from_;  // of the frame before, this one, and the next
    glm::dvec2 half_size_;                 // [px]
    double step_s_;                        // of the sea from frame to frame
};

}  // namespace pelagic
