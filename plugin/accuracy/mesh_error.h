// How far the faces of a mesh are from the sea, as a camera sees it: for surfaces that are made for one.
#pragma once

#include <cstddef>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <vector>

#include "core/plan/plan.h"
#include "core/surface/earth.h"
#include "core/surface/earth_view.h"
#include "core/surface/rest_surface.h"
#include "core/surface/view.h"
#include "core/waves/frame.h"

namespace pelagic {

// A sea at one time, finer than any mesh, and the camera.
struct SeenSurface {
    static constexpr double kFinest_m = 0.002;

    std::shared_ptr<const PreparedScene> prepared;
    std::unique_ptr<Frame<float>> sea;
    View view;
};
// The frame isn't set yet.
SeenSurface seen_surface(const Scene& scene, const View& view);

// Displaced, relative to the points' origin.
std::vector<glm::vec3> positions_of(const SeenSurface& seen, const RestPoints<float>& at);

// Points of triangles, and what they are to be compared with.
struct FaceSamples {
    std::vector<glm::vec2> rest_m;   // relative to the mesh's origin
    std::vector<glm::dvec3> face_m;  // relative to where the earth touches z = 0
};

// A mesh of these points through the camera.
class MeshPicture {
  public:
    MeshPicture(const SeenSurface& seen, const RestPoints<float>& at);

    glm::dvec3 place(glm::vec3 position_m) const;
    // In pixels from the picture's middle; z is positive before the camera.
    glm::dvec3 on_screen(glm::dvec3 place_m) const;
    bool holds(glm::dvec3 at_px) const;
    double pixel_m(glm::dvec3 place_m) const;

  private:
    const View& view_;
    double pixel_, curvature_per_m_;
    glm::dvec3 from_m_, eye_m_;
};

// Faces in view that turn to the camera, with samples in proportion to the pixels that they cover.
FaceSamples samples_of(const SeenSurface& seen, const RestPoints<float>& at, const Faces& faces,
                       const MeshPicture& picture);

// The distance of the samples from the exact surface, along its normal, over the width of a pixel there: the value
// that `share` of them don't exceed [px]. 0 without samples.
double error_px(const SeenSurface& seen, const RestPoints<float>& at, const MeshPicture& picture,
                const FaceSamples& samples, double share);

}  // namespace pelagic
