// Rays against the sea of a frame, from above and from below.
//
// A ray reads the level of tiles (surface_tiles.h) that is within its tolerance, which widens with its footprint.
// Where it changes to the next level, both count for a while: a ray that slips between the two surfaces, which cross
// each other every few cells, meets one of them there.
#pragma once

#include <array>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <vector>

#include "core/surface/projected_grid.h"
#include "plugin/host/procedural/surface_tiles.h"

namespace pelagic::procedural {

// What the rays of a batch share.
struct RaySea {
    const SurfaceTiles* tiles = nullptr;
    SurfaceBounds everywhere;         // of all points, at any time of the shutter
    double finest_footprint_m = 0.0;  // finer ones count as that
    glm::dvec2 origin_m{0.0};         // what rays are relative to, at z = 0
    double curvature_per_m = 0.0;     // of the earth, which touches z = 0 at the origin; 0: flat
    double tolerance = 0.5;           // how far from the surface a hit may lie, in footprints
};

struct SeaRay {
    glm::dvec3 from_m{0.0}, direction{0.0};  // finite; of length 1
    double near_m = 0.0, far_m = 0.0;
    double time_s = 0.0;  // since the shutter's middle
    double footprint_m = 0.0,
           spread = 0.0;  // at least 0: the width at `from`, and by how much it grows in a metre
};

struct SeaHit {
    double distance_m = 0.0;
    glm::dvec2 rest_m{0.0};  // on the flat sea, relative to the origin
    double footprint_m = 0.0;
};

// Rays of one call, one after another: tiles that the last ones asked for are at hand for the next.
class RayTracer {
  public:
    explicit RayTracer(const RaySea& sea);

    // The first place between near and far; false, and `hit` as it was, if there is none. With `any`, some place, not the first.
    bool trace(const SeaRay& ray, bool any, SeaHit& hit);

  private:
    // A straight piece of a ray over the flat sea: from + s · direction, near_m ≤ s ≤ far_m.
    struct Piece {
        int level;
        glm::dvec3 from_m, direction, per_direction;
        double near_m, far_m;
        double time_s;
    };
    // A tile that the ray enters there.
    struct Entry {
        double near_m;
        const Tile* parent;  // null: a root
        int number;          // the parent's quarter; of a root its place in root_places_
    };

    struct Span {
        double near_m, far_m;  // none: far < near
    };
    Span within_sphere(const SeaRay& ray, double height_m) const;
    Span span_in_waves(const SeaRay& ray) const;
    double footprint_m(const SeaRay& ray, double s_m) const;
    Piece piece_of(const SeaRay& ray, int level, double near_m, double far_m) const;
    bool meets_rest_between(const SeaRay& ray, double begin_m, double end_m, SeaHit& best) const;
    bool hit_piece(Piece piece, bool any, SeaHit& best);
    void push_roots(const Piece& piece);
    void push(const Entry& entry);
    const Tile& root_of(const TilePlace& place);
    const Tile& tile_of(const Entry& entry);
    bool hit_tile(const Tile& tile, const Piece& piece, SeaHit& best) const;

    RaySea sea_;
    NearestInTile nearest_ = nearest_in_tile();
    EnterQuarters enter_ = enter_quarters();
    std::shared_ptr<TileStore> store_;
    struct Root {
        TilePlace place;
        const Tile* tile = nullptr;
    };
    std::array<Root, 256> roots_{};       // that were asked for lately
    std::vector<TilePlace> root_places_;  // of the piece at hand
    std::vector<Entry> waiting_;          // the nearest is the last
};

}  // namespace pelagic::procedural
