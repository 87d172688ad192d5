// Vessels under way (waves.vessels), as the sea meets them: paths in its time, hulls, and the tile of water that their waves are
// computed on (core/waves/vessel_waves.h).
#pragma once

#include <bit>
#include <glm/vec2.hpp>
#include <vector>

#include "core/scene/course.h"
#include "pelagic/scene.h"

namespace pelagic {

struct VesselPlan {
    VesselPath path;
    double length_m = 0.0, beam_m = 0.0, draught_m = 0.0;
    double waves = 1.0;      // times their amplitude
    double foam = 1.0;       // times its coverage
    double speed_mps = 0.0;  // its greatest
    int radius = 0;          // of modes, at most kRadius: those that its waves need
    double size_m = 0.0;     // the tile's side
    double block_s = 0.0;    // of the lattice of times

    static constexpr int kRadius = 256;    // of modes at most: the shortest waves are a 256th of the tile
    static constexpr int kBlocks = 32;     // that are remembered
    static constexpr int kMostSteps = 16;  // of a block where the vessel turns
    static_assert(std::has_single_bit(static_cast<unsigned>(kMostSteps)));
    static constexpr int kStepLengths = std::bit_width(static_cast<unsigned>(kMostSteps));
    static constexpr double kEdge = 0.06;  // of the side, at each border: where waves fade to none

    // How high its waves are nowhere [m], and how far they move water to the side: of Froude's numbers from 0.15 to 3 they are up to
    // 1.8 U²B/(gL), and 0.9 of the draught; of a hull as wide as it is long twice that, and more where water is so shallow that they
    // are nearly as fast as any there.
    double highest_m(double depth_m) const;
    // The tile's, at a time: the vessel is ahead of it, with most of the tile behind.
    glm::dvec2 middle_m(double time_s) const;
    static std::size_t bytes(int radius);  // of what is remembered of the modes within
};

// ∫ (1 − z²/T²) e^{kz} dz from −T to 0, Wigley's hull below the water [m].
double below_water_m(double k, double draught_m);

// Slower ones make waves that are too short for a tile that holds the hull.
double least_wake_mps(const Vessel& vessel);
// Those that make waves.
std::vector<VesselPlan> plan_vessels(const Scene& scene);

}  // namespace pelagic
