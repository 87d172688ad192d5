// What pictures draw of the sea, as points at rest and triangles over them: the open sea as the camera's projected grid,
// of which a patch that lies in nothing is cut out, and a cage's limit surface (surface.kind, surface.beyond).
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/plan/plan.h"
#include "core/surface/projected_grid.h"
#include "core/surface/rest_surface.h"
#include "core/surface/view.h"
#include "core/waves/frame.h"
#include "pelagic/scene.h"

namespace pelagic {

// Whether pictures show the sea to the horizon. Kinds that reach it themselves do, whatever lies beyond.
bool shows_open_sea(const Surface& surface);

struct SeaMesh {
    // Its columns and rows are those of the whole grid that its points begin with, otherwise 0.
    ProjectedGrid points;
    // How high each point rests, and the surface's unit normal there; empty: 0, and up.
    std::vector<float> height_m;
    std::vector<glm::vec3> normal;
    std::vector<std::uint32_t> triangles;
};

// The open sea's.
SeaMesh open_sea(ProjectedGrid grid);

// A view of the camera and the frame whose mesh it sees: a cage may be as fine as that frame's camera sees it.
struct SeaView {
    View view;
    int frame = 1;
};

class DrawnSea {
  public:
    // has_levels: as ProjectedGridOptions has it.
    DrawnSea(const PreparedScene& prepared, bool has_levels);

    const ProjectedGridOptions& grid_options() const { return grid_; }

    // As ProjectedGridNeeds has it, of what is drawn; points: the most that a view has.
    struct Needs {
        double finest_cell_m = 0.0, finest_pixel_m = 0.0;
        std::size_t points = 0;
    };
    // Of these views together, at least one.
    Needs needs(std::span<const SeaView> seen) const;
    Needs needs(const SeaView& seen) const { return needs(std::span(&seen, 1)); }

    // The memory of `mesh` is used again. No points and no triangles where there is no sea to be seen. cell_px: of the
    // projected grid, where that isn't the scene's.
    void lay_out(const SeaView& seen, SeaMesh& mesh, std::optional<double> cell_px = {}) const;

    // The height [m] at which it rests: a cage's mean, where that is all there is.
    double rest_m() const;
    // At a place: the cage's own, the highest there, and its mean beside it.
    double rest_m(glm::dvec2 place_m) const;

    // Whether it can be drawn from below as well: an open sea whose water has a body.
    bool has_below() const { return has_body_ && has_grid_ && !half_side_m_ && !cage_; }
    // Whether all of a picture looks through water, whatever the waves are.
    bool is_below(const View& view) const;
    // Whether the flat sea's waves may be over that camera: they are nowhere but where the sea is.
    bool may_be_under_waves(const View& view) const;
    // The height [m] of the cage's surface at rest over a camera whose way up meets it from below: it is in the pool.
    std::optional<double> cage_above(const View& view) const;
    // As under_water.h has it, for whatever is drawn.
    template <class T>
    void refuse_under_water(const Frame<T>& state, const Scene& scene, double frame) const;

    // What its meshes hold beside their points [bytes], for so many of them.
    std::size_t surface_bytes(std::size_t points) const;

    // What decides on the mesh and is in no key part of pictures; empty for the open sea.
    const std::string& made_of() const { return made_of_; }

  private:
    double finest_cage_pixel_m(std::span<const SeaView> seen) const;
    void add_cage(const SeaView& seen, SeaMesh& mesh) const;

    ProjectedGridOptions grid_;
    bool has_grid_ = true, has_body_ = false;
    std::optional<double> half_side_m_;  // of the patch that is all that there is
    std::shared_ptr<const RestSurface> cage_;
    // Of the cage: how near an eye comes, and whether it is below.
    RestPoints<double> coarse_;
    std::vector<std::uint32_t> coarse_triangles_;
    std::string made_of_;
};

// Cuts off what rests outside the square of this half side round the world's origin. Triangles that cross its sides get
// new points there, those that had a side in common the same ones. Others, and their points, stay as they are.
void cut_to_square(double half_side_m, SeaMesh& mesh);

}  // namespace pelagic
