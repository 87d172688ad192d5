// What the camera sees, and where: the pinhole of a shot's camera at one frame.
#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "core/scene/scene.h"

namespace pelagic {

struct View {
    glm::dvec3 position_m{0.0};
    // Unit and orthogonal, world: right, up and forward of the picture.
    glm::dvec3 right{1.0, 0.0, 0.0}, up{0.0, 0.0, 1.0}, forward{0.0, 1.0, 0.0};
    double tan_half_width = 0.4663;  // of the horizontal field of view's half
    glm::ivec2 resolution{1280, 720};

    bool operator==(const View&) const = default;

    // Square pixels: tangents per pixel, across and up alike.
    double pixel_tangent() const { return 2.0 * tan_half_width / resolution.x; }
    // The unit direction through picture point (x, y) in pixels: (0, 0) is the top left corner, pixel (i,
    // j)'s centre is (i + ½, j + ½).
    glm::dvec3 direction(glm::dvec2 pixel) const;
    // Clip coordinates (OpenGL's, −w ≤ z ≤ w) of points relative to origin_m [m], by an infinite projection:
    // z/w = 1 − 2 near_m/d at distance d along forward, never clipped far away. The nearer the origin to the
    // camera, the less is lost when the matrix is rounded to single precision.
    glm::dmat4 clip_from(glm::dvec3 origin_m, double near_m) const;
};

// The shot's camera at a frame: camera.keys, linear between and constant outside, or its one pose. Up is z;
// looking along z, +y.
View view_at(const Camera& camera, double frame);

}  // namespace pelagic
