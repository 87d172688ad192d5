// The surface from near to far (after Hu, Velho, Tong, Guo, Shum 2006, §3): a near patch whose detail follows the
// viewpoint's height, and a far part of cones to the true horizon, all round the camera's nadir, as one mesh whose
// topology stays (near_far_mesh.h).
//
// Anchored in steps. Each square's points are those of a lattice that stays in the world, cell · (i, j), with the cell doubled
// from each square to the next. A camera that moves takes the squares along in steps of their own cells: a point of a
// vertex changes, but places don't move, and nothing swims. Cells are rounded to eleven binary digits, so that every place on
// every lattice is exact in single precision. The far part lies on circles round the largest square's middle and steps
// with it.
//
// The detail is by octaves. A camera higher than half the near patch's side sees it at less than a right angle: all cells
// are longer by the largest power of two that keeps the near patch's half side no longer than the height, and the rings
// within the horizon. The lattices of one octave are those of the others.
//
// Distance d, cell c: c/d is between 2/resolution and 4/resolution in all rings, whatever the height. Where waves are
// as steep at every length, such cells leave heights unresolved that look equally high from the eye at any distance;
// far away, where no wave is resolved, they look lower. Far rows begin with the cells of the last ring. They lie on
// cones round the vertical through the eye, and each is longer than the one before, up to the horizon.
//
// On the earth's sphere the far part ends where no crest rises over the horizon any more (earth_view.h), for the
// greatest height of the octave; otherwise where the sea is a millionth of a radian below the horizontal. The sphere
// touches z = 0 near the nadir, in steps of at most 128 m: the sea below the camera is no lower than 0.7 mm then.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>

#include "core/surface/near_far_mesh.h"
#include "core/surface/rest_surface.h"

namespace pelagic {

// Where the mesh lies under one camera, which decides it by steps.
struct NearFarPlace {
    glm::dvec2 nadir_m{0.0};  // the camera's, in steps
    double height_m = 0.0;    // the greatest of its octave
    double cell_m = 1.0;      // of the near patch
    double far_m = 1.0;       // the far part's last row reaches this far in all directions

    bool operator==(const NearFarPlace&) const = default;
};

class NearFar final : public RestSurface {
  public:
    // Of a valid scene.
    NearFar(const Scene& scene, const Extent& extent);

    const NearFarMesh& mesh() const { return mesh_; }
    // Of a camera anywhere; its height counts below the sea, too.
    NearFarPlace place_of(glm::dvec3 camera_m) const;

    std::string describe() const override;
    std::string remedy() const override { return "lower surface.resolution"; }
    bool is_constant() const override { return false; }
    bool has_constant_faces() const override { return true; }
    bool is_even() const override { return false; }
    // The place alone, in steps: where the camera looks, and through what lens, shapes nothing.
    std::optional<View> shaped_by(int frame) const override;
    KeyPartSet key_parts() const override { return pelagic::key_parts(KeyPart::Surface); }
    SurfaceNeeds needs(std::span<const int> frames) const override;
    void points_at(int frame, RestPoints<float>& points) const override;
    void points_at(int frame, RestPoints<double>& points) const override;
    void faces_at(int, Faces& faces) const override { mesh_.set_faces(faces); }

  private:
    NearFarPlace place_at(int frame) const;
    template <class T>
    void lay_out(const NearFarPlace& place, RestPoints<T>& points) const;
    template <class T>
    void lay_out_far(const NearFarPlace& place, glm::dvec2 middle_m, RestPoints<T>& points) const;

    Camera camera_;
    double size_m_, cell_m_;  // of the near patch, where the camera is low
    double crest_m_, curvature_per_m_;
    NearFarMesh mesh_;
    double begin_m_;  // the far part's first row has this half side, where the camera is low
};

}  // namespace pelagic
