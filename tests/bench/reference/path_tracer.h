// The reference: perfect mirrors with the exact Fresnel term, many samples a pixel.
#pragma once

#include <cstdint>

#include "tests/bench/reference/sea_geometry.h"
#include "tests/bench/reference/terms.h"

namespace pelagic::bench {

struct PathOptions {
    int strata = 4;              // strata² samples a pixel and pass, one at a random place in each stratum
    int passes = 4;              // independent: their scatter is the noise
    int bounces = 4;             // reflections of a path, the first included
    bool facet_normals = false;  // mirrors are the mesh's own facets; else the waves' exact normals
    int first_row = 0;           // of the picture: rows above it aren't rendered
    double refracted = 1.0;      // radiance of the water from below, where nothing is reflected
    std::uint64_t seed = 1;
};

// One pass' lines.
struct PathPass {
    Lines single;     // one reflection, in sight of what it mirrors: what the BRDF is a model of
    Lines all;        // all reflections; what the sea shows where another part of it is mirrored
    Lines small_sun;  // as `all`, only the sun: the disc as it is
    double rays = 0.0, missed = 0.0, blocked = 0.0, turned_away = 0.0;  // counts
};

// `sky` with its own sun, `wide` with a wider one of the same light.
std::vector<PathPass> trace_paths(const WaveTile& tile, const FinestSea& sea, const View& view,
                                  const Sky& sky, const Sky& wide, const PathOptions& options);

}  // namespace pelagic::bench
