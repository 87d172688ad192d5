// The limit surface of a cage: what Catmull–Clark subdivision (Catmull & Clark 1978; sharpness: DeRose, Kass, Truong 1998)
// comes to, by OpenSubdiv. What depends on the cage's faces and sharpness alone is built once and serves any places of
// its points.
//
// A face of the cage is meshed by its edges' rates, so many segments each, and its own inside: two faces beside each other
// share their edge's rate and its points, so that no mesh has a crack or a T-junction.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <vector>

#include "core/surface/faces.h"
#include "pelagic/cage.h"

namespace pelagic {

// How finely a cage is meshed: segments of each edge, and across the inside of each face: from its first edge to the third
// and the other way in quads; in other faces the first counts.
struct CageRates {
    std::vector<int> edges;
    std::vector<std::array<int, 2>> faces;
};

// A mesh on the limit surface: where its points are on the cage, and its faces, of three and four corners.
struct CageMeshing {
    struct Sample {
        std::int32_t point;
        bool is_own;  // gives the point its place; otherwise only another normal, where the surface is sharp
        glm::dvec2 uv;
    };
    std::size_t points = 0;
    std::vector<Sample> samples;             // by face of the cage
    std::vector<std::size_t> first_samples;  // of each face of the cage, and their end
    Faces faces;
    // The points at those of the cage, the first of those along each edge from its own first end, and the first inside each
    // face; −1: there is none.
    std::vector<std::int32_t> of_points, of_edges, of_faces;
};

// Weights of the cage's points for a mesh on its limit surface whose points move and whose faces stay.
struct CageStencils {
    std::vector<std::size_t> first;              // of each sample's weights, and their end
    std::vector<std::int32_t> control;           // the cage's points
    std::vector<std::array<double, 3>> weights;  // of the place and of its derivatives along u and v
};

// Cells count as no finer [m]: a spectrum ends there, and faces may have no size at all.
inline constexpr double kFinestCell_m = 1e-3;

// Of each point, how far the farthest of those is that a side of a face joins it to [m], and at least finest_m: no mesh can
// show more.
std::vector<double> cells_of(const Faces& faces, std::span<const glm::dvec3> places_m, double finest_m);

class CageLimit {
  public:
    // Keeps what it needs of the mesh, which a Cage has checked.
    explicit CageLimit(const CageMesh& mesh);
    ~CageLimit();

    std::size_t control_points() const { return control_points_; }
    std::size_t edges() const { return edge_points_.size(); }
    std::size_t faces() const { return first_corners_.size() - 1; }
    // The cage's points at the two ends of an edge.
    const std::array<std::int32_t, 2>& edge_points(std::size_t edge) const { return edge_points_[edge]; }
    // The edges of a face, each from a corner to the next; none of a face without a surface: a hole, and at a boundary that
    // only shapes the others.
    std::span<const std::int32_t> face_edges(std::size_t face) const;
    std::span<const std::int32_t> face_points(std::size_t face) const;

    // Whether a point has more than one texture coordinate.
    bool has_seams() const { return has_seams_; }

    // The same everywhere: edges in `segments` parts.
    CageRates uniform_rates(int segments) const;
    CageMeshing mesh(const CageRates& rates) const;
    // How many points mesh() gives.
    std::size_t count_points(const CageRates& rates) const;

    // The places of a mesh's points [m] and the unit normals there, of a cage with these points. Where the surface has no
    // tangents the normal points up; at infinitely sharp edges and points it is the mean of the faces'.
    void place(const CageMeshing& meshing, std::span<const glm::dvec3> points_m,
               std::vector<glm::dvec3>& places_m, std::vector<glm::dvec3>& normals) const;
    CageStencils stencils(const CageMeshing& meshing) const;
    // The same, with stencils: for points that move from frame to frame.
    static void place(const CageMeshing& meshing, const CageStencils& stencils,
                      std::span<const glm::dvec3> points_m, std::vector<glm::dvec3>& places_m,
                      std::vector<glm::dvec3>& normals);

  private:
    struct Surfaces;  // OpenSubdiv's
    std::unique_ptr<const Surfaces> surfaces_;
    std::size_t control_points_ = 0;
    std::vector<std::array<std::int32_t, 2>> edge_points_;
    std::vector<std::size_t> first_corners_;  // of each face, and their end
    std::vector<std::int32_t> corner_points_, corner_edges_;
    std::vector<bool> has_surface_;                     // by face
    std::vector<bool> is_sharp_edge_, is_sharp_point_;  // infinitely, with faces on both sides
    std::vector<glm::dvec2> corner_st_;
    bool has_seams_ = false;
};

}  // namespace pelagic
