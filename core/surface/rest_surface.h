// A surface: the points at rest at which a mesh of the sea has its vertices, frame after frame.
//
// Each kind is a class of its own behind this interface and a row of kSurfaceTable (rest_surface.cpp).
// Planning, baking and explaining ask the interface, never the kind.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/scene/keys.h"
#include "core/surface/extent.h"
#include "core/surface/faces.h"
#include "core/surface/fitted_cage.h"
#include "core/surface/view.h"
#include "pelagic/scene.h"

namespace pelagic {

// Points that lie at first_m + i·spacing_m in x and in y, i ≥ 0, seen from the world's origin.
struct Lattice {
    double first_m = 0.0;
    double spacing_m = 1.0;
    double last_m = std::numeric_limits<double>::infinity();  // no point lies further in x or y
    bool operator==(const Lattice&) const = default;
};

// What the query for a surface's points must be able to answer.
struct SurfaceNeeds {
    // The finest footprints of any point [m]: its cell (the distance to its neighbours) and its pixel.
    double finest_cell_m = 0.0, finest_pixel_m = 0.0;
    // Whether each point has footprints of its own, up to any size; otherwise all have the finest.
    bool own_footprints = false;
    std::optional<Lattice> lattice{};
    std::size_t points = 0;  // the most that a frame has; of faces there are hardly more
};

// The points of one frame, relative to an origin.
template <class T>
struct RestPoints {
    glm::dvec2 origin_m{0.0};
    // Of the earth on which displaced points are laid (earth.h), round the place where it touches z = 0.
    double curvature_per_m = 0.0;
    glm::dvec2 touches_at_m{0.0};
    std::vector<glm::vec<2, T>> rest_m{};
    // Footprints as in Points (core/evaluate/evaluate.h); empty: the query's own.
    std::vector<T> cell_m{}, pixel_m{};
    std::vector<glm::vec<2, T>> cell_axis_m{}, pixel_axis_m{};
    // Of surfaces that aren't flat: how high each point lies, and the surface's unit normal there. Empty: 0, and up.
    std::vector<T> height_m{};
    std::vector<glm::vec<3, T>> normal{};
};

// The origin of a mesh whose points are floats: the world's own for points round a place near that, and otherwise a
// point near the place, which moves in steps as the place does. It depends on these two arguments alone. The steps
// are powers of two, at most 4096 m: so long that the origin seldom moves, and so short that the finest cell, seen
// from the origin, is rounded by no more than a hundredth of itself. finest_cell_m > 0.
glm::dvec3 local_origin(glm::dvec3 place_m, double finest_cell_m);

// columns × rows quads over (columns + 1) × (rows + 1) points, columns fastest. The faces are counter-clockwise
// where columns run to the right and rows upwards; st is (0, 0) at the first point and (1, 1) at the last. The
// second form uses the memory of `faces` again. Throws std::invalid_argument without quads and for more than
// 2^29 − 1 of them, whose indices would be more than an int can count.
Faces grid_faces(int columns, int rows);
void set_grid_faces(int columns, int rows, Faces& faces);

// The memory of a surface [bytes]: kept from its first points on, and needed only while it makes them.
struct SurfaceBytes {
    std::size_t held = 0, making = 0;
};

class RestSurface {
  public:
    virtual ~RestSurface() = default;
    // One line for people: "a patch of 256 × 256 quads over 200 m".
    virtual std::string describe() const = 0;
    // What makes it smaller: "lower surface.resolution".
    virtual std::string remedy() const = 0;
    // Whether every frame has the same points and faces.
    virtual bool is_constant() const = 0;
    // Whether every frame has the same faces, wherever their points are.
    virtual bool has_constant_faces() const = 0;
    // Whether meshes of it have an origin of their own in each file, because their points may be far from the world's.
    virtual bool has_origin() const { return !is_constant(); }
    // Whether that origin is a place near the camera, and moves as it does.
    virtual bool origin_follows_camera() const { return !is_constant(); }
    // Whether each corner of a face has its own texture coordinate (Faces::is_st_of_corners).
    virtual bool has_st_of_corners() const { return false; }
    // Whether the points are spread evenly, so that their statistics are the sea's.
    virtual bool is_even() const = 0;
    // The camera's pose, where it shapes the frame's points: a frame depends on nothing else of the camera.
    virtual std::optional<View> shaped_by(int frame) const = 0;
    // The keys on which the points depend beyond what needs() says.
    virtual KeyPartSet key_parts() const = 0;
    // Of these frames together. Asked for one frame it looks at no other.
    virtual SurfaceNeeds needs(std::span<const int> frames) const = 0;
    // The memory of `points` is used again.
    virtual void points_at(int frame, RestPoints<float>& points) const = 0;
    virtual void points_at(int frame, RestPoints<double>& points) const = 0;
    // Of the mesh's vertices: the points, or those of the cage.
    virtual void faces_at(int frame, Faces& faces) const = 0;
    // For frames of so many points, with numbers of `scalar` bytes, beside their places at rest and a frame's faces.
    virtual SurfaceBytes bytes(std::size_t /*points*/, std::size_t /*scalar*/) const { return {}; }
    // The cage fitted to the points, where the mesh is one.
    virtual std::optional<FittedCage> fitted() const { return {}; }
};

// The surface of a valid scene.
std::unique_ptr<const RestSurface> make_surface(const Scene& scene, const Extent& extent);

// Some frames of the shot that stand for all where a look at each would take too long: those between which
// the camera moves, evenly spaced, both ends included, at most `most`.
std::vector<int> representative_frames(const Scene& scene, int most);

}  // namespace pelagic
