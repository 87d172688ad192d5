// A coarse mesh of an artist's, whose limit surface the sea lies on (surface.kind = "cage"): data of a scene, as a
// measured spectrum is, wherever it came from.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "pelagic/version.h"

namespace pelagic {
inline namespace PELAGIC_VERSION_NAMESPACE {

// What the limit surface does at the cage's edges that have one face alone.
enum class CageBoundary {
    EdgeAndCorner,  // ends there, sharp at points that have one face alone: a square stays one. The default, as in USD
    EdgeOnly,  // ends there, and rounds such corners off
    None       // ends before: the faces at the boundary only shape the others
};

// How finely a cage is refined.
struct CageLevel {
    int splits = 2;            // halvings of each edge
    bool is_adaptive = false;  // instead: as finely as the camera sees it
    bool operator==(const CageLevel&) const = default;
};

// A mesh and its sharpness, plainly.
struct CageMesh {
    std::vector<glm::dvec3> points_m;       // z is up
    std::vector<std::int32_t> face_counts;  // corners of each face, 3 or more
    std::vector<std::int32_t>
        indices;                 // of the faces' corners into points_m, counter-clockwise seen from above
    std::vector<glm::dvec2> st;  // texture coordinates; none: empty
    std::vector<std::int32_t> st_indices;  // of the faces' corners into st; without st empty

    // Sharpness as in Catmull–Clark surfaces after DeRose et al. 1998: how many levels of refinement an edge or a point
    // stays sharp, with fractions between; 10 and more: at every one.
    struct Crease {
        std::int32_t from, to;  // points at the two ends of an edge
        double sharpness;
    };
    struct Corner {
        std::int32_t point;
        double sharpness;
    };
    std::vector<Crease> creases;
    std::vector<Corner> corners;
    std::vector<std::int32_t> holes;  // faces that are left out, and shape the others
    CageBoundary boundary = CageBoundary::EdgeAndCorner;
};

inline constexpr double kInfiniteSharpness = 10.0;

// A mesh that is no cage: what is wrong with which part of it, and what would be right.
class CageError : public std::runtime_error {
  public:
    enum class Part { Mesh, Point, TextureCoordinate, Face, Crease, Corner, Hole };
    struct Where {
        Part part = Part::Mesh;
        std::size_t index = 0;  // from 0
    };
    CageError(Where where, std::string problem, std::string accepted);
    const Where& where() const { return where_; }
    const std::string& problem() const { return problem_; }  // "has two corners"
    const std::string& accepted() const { return accepted_; }

  private:
    Where where_;
    std::string problem_, accepted_;
};

// "face 3": as messages call a part of a mesh that came from no file.
std::string text_of(CageError::Where where);

// A mesh that has passed all checks and never changes: a scene's copies share it.
class Cage {
  public:
    // Throws CageError: for no faces or more than 1e6 (before it looks at them), more than 256 corners of a face or faces
    // round a point, indices out of range, a point twice in a face, edges with more than two faces or with two that run
    // the same way along them, points where faces meet without an edge, points inside that have two faces alone, numbers that aren't finite, points farther than limits::kCagePoint_m from the origin along
    // an axis, creases that are no edges, and no face with a surface: nothing but holes, or with CageBoundary::None
    // nothing but faces that touch the boundary.
    explicit Cage(CageMesh mesh);

    const CageMesh& mesh() const { return mesh_; }
    // Faces, points and a hash of all that is in the mesh: "2 faces, 6 points, 0123456789abcdef". Equal texts, equal cages.
    const std::string& content() const { return content_; }

  private:
    CageMesh mesh_;
    std::string content_;
};
}  // namespace PELAGIC_VERSION_NAMESPACE
}  // namespace pelagic
