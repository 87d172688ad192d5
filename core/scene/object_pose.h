// Where the bodies of a scene are.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "pelagic/scene.h"

namespace pelagic {

// A point p of a body's mesh [m] lies at place_m + turn · (scale · p).
struct ObjectPose {
    glm::dvec3 place_m{0.0};
    glm::dmat3 turn{1.0};  // a rotation: its columns are the body's axes in the world
    double scale = 1.0;
};

// At a frame, also between two of them, in a calm sea: what `floats` adds is the waves' (core/evaluate/object_place.h). The object is one of the scene's.
ObjectPose object_pose(const Scene& scene, const SceneObject& object, double frame);

// Of a body that lies in calm water: as large as its waterplane and as what it displaces, along that plane's longer axis, as long to as wide as
// the waterline's box. The box itself where the mesh isn't closed.
struct FloatingBox {
    double length_m = 0.0, beam_m = 0.0;
    double draught_m = 0.0;    // 0: the water's level doesn't cut it
    glm::dvec2 middle_m{0.0};  // from its origin, along its own x and y as they lie over the water
    double turn = 0.0;         // of its length from its x, counter-clockwise [rad]
};
// The object has a mesh. O(triangles).
FloatingBox floating_box(const SceneObject& object);
// Whether it floats by its mass: what the water's level doesn't cut can't, and lies on the water.
bool answers_by_mass(const SceneObject& object);

// The footprint of the waves that move what floats [m]: a third of its length, or, of one that answers by its mass, a sixth of its beam, and
// of its length a sixtieth at least. The object has a mesh.
double floating_cell_m(const SceneObject& object);
double floating_cell_m(const FloatingBox& box);  // of one that answers by its mass

}  // namespace pelagic
