// Where the objects of a scene are in its waves.
#pragma once

#include <functional>
#include <glm/vec2.hpp>

#include "core/scene/object_pose.h"
#include "core/waves/frame.h"
#include "pelagic/scene.h"

namespace pelagic {

// Over the flat sea, whose origin is the scene's.
struct PlacedObject {
    ObjectPose pose;
    double water_m = 0.0;  // height of the water at it
};

// At which the sea rests at a place [m]; null: 0 everywhere.
using RestHeight = std::function<double(glm::dvec2)>;

struct ObjectMoment {
    int query = 0;       // of the sea's plan; asked for what floats
    double frame = 1.0;  // also between two
    RestHeight rest_m{};
    double late_s = 0.0;  // beside the sea's time; other than 0 asks for Product::Velocity
};

// What floats lies on the plane through the water under it, in waves about as long as it is: it heaves, pitches and rolls with that, and
// turns about its origin; or as core/evaluate/floating_response.h has it, where some of it is under water. Others are as object_pose() has them. Any thread, for an object with a mesh and a frame that is set.
template <class T>
PlacedObject place_object(const Frame<T>& state, const Scene& scene, const SceneObject& object,
                          const ObjectMoment& at);

}  // namespace pelagic
