// The pictures of objects that the sea shows, mirrored (sky_with_objects.glsl) and in its water (objects_in_water.glsl): what each is seen from,
// and how fine it is. Needs no OpenGL.
#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace pelagic {

inline constexpr int kObjectsSide = 1024;  // texels, at most

struct ViewedBody {
    glm::dmat4 grid_from_box{1.0};  // from a cube, −1 … 1, that is its box
    double water_m = 0.0;           // height of the water at it, in the grid
};

struct ObjectsView {
    glm::dvec3 eye_m{0.0};           // of who sees it, in the grid
    glm::dmat4 clip_from_grid{1.0};  // x and y; z is 0, and w the distance ahead
    glm::ivec2 size{0};              // texels, powers of two; 0: there is nothing to see
    double texels = 1.0;             // a tangent of 1, where it is less
};

// Upright pictures of all bodies, of which there is one at least, from eye_m's mirror image as far as they are above the water, and as far as they
// are in it, from where their middle there sees the eye through a level surface: n times as far behind it, where rays that pass beside that
// one meet. eye_m: in the grid; pixel_tangent: of the picture that shows the sea; largest: texels of a side.
ObjectsView mirrored_view(std::span<const ViewedBody> bodies, glm::dvec3 eye_m, double pixel_tangent,
                          int largest);
ObjectsView in_water_view(std::span<const ViewedBody> bodies, glm::dvec3 eye_m, double pixel_tangent,
                          int largest);

// The uniform object_boxes: of the bodies nearest to an eye, where there are more than it holds.
std::vector<glm::mat4> object_boxes(std::span<const ViewedBody> bodies, glm::dvec3 eye_m);

// The box as wide as least … most, in a body's own axes. No side is thinner than two millimetres, so that rays meet it.
glm::dmat4 grid_from_box(const glm::dmat4& grid_from, glm::dvec3 least, glm::dvec3 most);

}  // namespace pelagic
