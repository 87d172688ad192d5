// Persistent foam: what the waves that broke have left, as core/effects keeps it.
//
// A point's residual foam is a sum over intervals of absolute time, [n, n + 1] · step_s, of the share of its surroundings
// that broke then, each with the integral of e^{−age/decay} over the interval. Which intervals and where their sources lie
// depends on the scene alone: a frame alone has the foam that it has in a run.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <vector>

#include "core/plan/prepared_scene.h"
#include "core/plan/query.h"
#include "core/spectrum/directional_spectrum.h"
#include "pelagic/scene.h"

namespace pelagic {

struct FoamPlan {
    double decay_s = 0.0;       // e-folding time
    glm::dvec2 drift_mps{0.0};  // of the foam over the water at rest
    double step_s =
        0.0;  // of the lattice of times; a whole number of steps makes a loop, or of very short loops a step
    double window_s = 0.0;                  // nothing older counts
    double cell_m = 0.0;                    // of the finest level; each further one has cells twice as large
    double loop_s = 0.0;                    // of the sea; 0: none
    double past_m = 0.0, breaking_m = 0.0;  // the finest footprints of what broke, and of what breaks now
    double bubbles_m = 0.0;  // e-folding depth of the bubbles that breaking leaves; 0: nobody sees them

    // Levels with cells; beyond the last, foam is the sea's mean.
    static constexpr int kLevels = 8;
    static constexpr int kTileCells = 16;  // a side
    static constexpr std::size_t kTileNodes = (kTileCells + 1) * (kTileCells + 1);
    static constexpr std::size_t kTileStride = (kTileNodes + 15) / 16 * 16;  // whole vectors

    double cell_of(int level) const;
    // The drift of a level's cells: in a loop by whole cells, so that the last frame's lie where the first one's do.
    glm::dvec2 drift_of(int level) const;

    // Intervals that a frame reads.
    int intervals() const;
    // Bytes of a tile's history: half a float for each interval and a few more, for a picture that begins before the one before it ends, six deviates, and
    // what a frame adds up: two sums, and a third of bubbles.
    static constexpr int kSpareIntervals = 3;
    std::size_t sums() const { return bubbles_m > 0.0 ? 3 : 2; }
    std::size_t tile_bytes() const;

    // ∫ e^{−a/decay} da [s] and ∫ a e^{−a/decay} da [s²] over ages a within [from_s, to_s] and the window.
    struct Weight {
        double foam_s = 0.0, age_s2 = 0.0;
    };
    Weight weight(double from_s, double to_s) const;

    // ∫ of the bubbles that are left [s], of 1 at age 0, over ages within [from_s, to_s] and the window. A storm's stay longer than foam, but no
    // history reaches beyond its window: they fade over its last third.
    double bubbles_weight_s(double from_s, double to_s) const;
};

// Whether pictures of the scene show bubbles.
bool has_bubbles(const Scene& scene);
// Of what breaks most, the height [m], and how deep bubbles are under it, e-folding: `spectrum` is the scene's.
double breaker_height_m(const Scene& scene, const DirectionalSpectrum& spectrum);
double bubbles_depth_m(const Scene& scene, const DirectionalSpectrum& spectrum);
// Of the key of a sea that changes which has the highest.
double highest_breaker_m(const PreparedScene& prepared);

// Of a scene that has persistent foam. steps_a_period: Knobs::foam_steps_a_period. `finest_m`: no breaking is resolved
// below it.
FoamPlan plan_foam(const Scene& scene, double finest_m, double steps_a_period);

// Which level's cells serve a footprint, two cells a footprint: (1 − t) of `level` and t of the next.
struct FoamLevelBlend {
    int level = 0;
    float t = 0.0f;
};
FoamLevelBlend foam_level_blend(const FoamPlan& foam, float footprint_m);
// An ellipse counts as the circle of its area.
float foam_footprint_m(float width_m, float length_m);

// How many tiles the history for these queries has room for, by level. For a camera that moves or turns these are all
// round its places: at two successive times, or for pictures, which ask for all tiles at once, at one. For a camera
// at rest they are those in its frame, in expectation, and in a run of pictures their surroundings.
std::array<double, FoamPlan::kLevels> foam_tiles(const FoamPlan& foam, const Scene& scene,
                                                 const std::vector<Query>& queries, bool are_pictures);

}  // namespace pelagic
