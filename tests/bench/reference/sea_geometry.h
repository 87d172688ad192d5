// Surfaces for tracing rays with Embree: the tile's finest geometry, repeated over the view, and the mesh of
// a projected grid.
#pragma once

#include <embree3/rtcore.h>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "core/surface/view.h"
#include "tests/bench/reference/wave_tile.h"

namespace pelagic::bench {

struct SeaRay {
    glm::vec3 origin_m{0.0f}, direction{0.0f};
    float from_m = 0.0f;  // nearer hits are ignored
};

struct SeaHit {
    glm::vec2 rest_m{0.0f};        // position at rest of the hit; within the tile for the finest geometry
    glm::vec3 facet_normal{0.0f};  // unit, upwards
    float distance_m = 0.0f;
    // Footprints at the hit, as in Points (core/evaluate/evaluate.h); of the projected grid only.
    float pixel_m = 0.0f, cell_m = 0.0f;
    glm::vec2 pixel_axis_m{0.0f}, cell_axis_m{0.0f};
};

class EmbreeScene {
  public:
    EmbreeScene();
    ~EmbreeScene();
    EmbreeScene(const EmbreeScene&) = delete;
    EmbreeScene& operator=(const EmbreeScene&) = delete;

  protected:
    bool intersect(const SeaRay& ray, RTCRayHit& hit) const;
    RTCDevice device_;
    RTCScene scene_;
};

// Every wave of the tile, on a lattice of `cells` × `cells` cells, repeated over the view up to a distance
// (and a margin behind it, for reflected rays).
class FinestSea : EmbreeScene {
  public:
    FinestSea(const WaveTile& tile, const View& view, double reach_m, int cells);
    ~FinestSea();
    bool trace(const SeaRay& ray, SeaHit& hit) const;
    float cell_m() const { return cell_m_; }

  private:
    RTCScene tile_scene_;
    float cell_m_;
    int patches_;  // per side
};

// What a rasteriser draws: the points of the projected grid, displaced by the waves that its cells resolve.
class ProjectedSea : EmbreeScene {
  public:
    ProjectedSea(const WaveTile& tile, const View& view, double cell_px);
    bool trace(const SeaRay& ray, SeaHit& hit) const;

  private:
    ProjectedGrid grid_;
    std::vector<std::uint32_t> triangles_;
};

}  // namespace pelagic::bench
