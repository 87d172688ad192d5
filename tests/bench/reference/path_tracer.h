// The reference: perfect mirrors with the exact Fresnel term, many samples per pixel.
#pragma once

#include <cstdint>

#include "tests/bench/reference/sea_geometry.h"
#include "tests/bench/reference/terms.h"

namespace pelagic::bench {

struct PathOptions {
    int strata = 4;              // strata² samples per pixel and pass, one at random in each stratum
    int passes = 4;              // independent: their scatter is the noise
    int bounces = 4;             // reflections per path, including the first
    bool facet_normals = false;  // mirrors are the facets of the mesh, otherwise the waves' exact normals
    int first_row = 0;           // of the picture: rows above aren't rendered
    double refracted = 1.0;      // radiance of the water from below, where there is no reflection
    std::uint64_t seed = 1;
};

// The lines of one pass.
struct PathPass {
    Lines single;     // one reflection, where nothing blocks the ray: what the BRDF models
    Lines all;        // all reflections; the refracted term includes light from the water seen in other waves
    Lines small_sun;  // as `all`, of the sun only, with the true disc
    double rays = 0.0, missed = 0.0, blocked = 0.0, turned_away = 0.0;  // counts
};

// `sky` has the true sun, `wide` a wider one with the same irradiance.
std::vector<PathPass> trace_paths(const WaveTile& tile, const FinestSea& sea, const View& view,
                                  const Sky& sky, const Sky& wide, const PathOptions& options);

}  // namespace pelagic::bench
