// The view of a shot's camera at one frame: a pinhole, and the pinholes in the aperture of a lens.
#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "pelagic/scene.h"

namespace pelagic {

struct View {
    glm::dvec3 position_m{0.0};
    // Orthonormal, in world axes: right, up and forward of the picture.
    glm::dvec3 right{1.0, 0.0, 0.0}, up{0.0, 0.0, 1.0}, forward{0.0, 1.0, 0.0};
    double tan_half_width = 0.4663;  // of half the horizontal field of view
    glm::ivec2 resolution{1280, 720};
    glm::dvec2 shift{
        0.0};  // of the picture's middle off the axis, to the right and up, in widths of the picture

    bool operator==(const View&) const = default;

    double fov_deg() const;  // horizontal
    // The tangent that a pixel covers. Pixels are square.
    double pixel_tangent() const { return 2.0 * tan_half_width / resolution.x; }
    // The tangents of the picture's middle off the axis.
    glm::dvec2 middle_tangents() const { return 2.0 * tan_half_width * shift; }
    // Half the picture's size in tangents.
    glm::dvec2 half_tangents() const {
        return {tan_half_width, tan_half_width * resolution.y / resolution.x};
    }
    // The unit direction through a point of the picture in pixels: (0, 0) is the top left corner, the centre
    // of pixel (i, j) is (i + ½, j + ½).
    glm::dvec3 direction(glm::dvec2 pixel) const;
    // OpenGL's clip coordinates (−w ≤ z ≤ w) of points relative to origin_m [m], without a far plane:
    // z/w = 1 − 2 near_m/d at distance d along forward. An origin near the camera keeps precision when the
    // matrix is rounded to single.
    glm::dmat4 clip_from(glm::dvec3 origin_m, double near_m) const;
};

// A host's view, whose axes may be rounded to single precision: made orthonormal. Throws std::invalid_argument, naming the
// member and what is accepted.
View checked_view(View view);

// The shot's camera at a frame: its single pose, or camera.keys. It is constant outside the keys. Between them it
// moves, angles too, on straight lines or, with camera.interpolation = "smooth", on C1 cubics whose heights and
// angles stay between their keys'. Up is z, for a vertical direction +y, and then the roll.
View view_at(const Camera& camera, double frame);

// The radius of the camera's aperture [m] at that view; 0: a pinhole.
double aperture_radius_m(const Camera& camera, const View& view);

// The same picture through a pinhole that lies so far to the right and up in the lens' aperture [m]: what is focus_m
// ahead stays where it is in the picture. Thin lens.
View through_lens(View view, glm::dvec2 offset_m, double focus_m);

}  // namespace pelagic
