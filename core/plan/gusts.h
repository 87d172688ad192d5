// Gusts: a slow pattern of wind over the surface, which the wind carries along.
//
// Eight waves of wind, the longest first, each shifted by those before it, so that patches have fronts and no lattice
// shows. Whatever shifts them, their phases are independent and uniform: over area the pattern has mean 0 and variance 1.
// core/waves/gusts.inl adds them up.
//
// Fronts (sea.gust_fronts) are placed: a front's wind is w times the sea's where it blows whole. It is a wind and no mask of waves: what a
// cat's paw darkens is what the statistical gusts roughen, so it goes their way, by one factor f = (1 + strength · level) · w. A mask that moves
// would change the height of waves that no gust raises in a minute, would bring ∂m/∂t into their velocities, and would need a gain of
// its own for foam, which wouldn't know the law. Here positions and velocities are those of the sea without fronts, and so are their bounds.
// A front's place is a line in time, x = middle + v (t − t₀), so that each frame knows it by itself, and foam's past at each of its times.
#pragma once

#include <array>
#include <cstddef>
#include <glm/vec2.hpp>
#include <vector>

#include "core/scene/limits.h"
#include "pelagic/scene.h"

namespace pelagic {

struct GustsPlan {
    static constexpr int kWaves = 8;
    struct Wave {
        glm::dvec2 cycles_per_m{0.0}, along{1.0, 0.0};  // along: its direction, of length 1
        double cycles_per_s = 0.0;  // in a loop a whole number of cycles, which may be none
        double start_cycles = 0.0;  // at the origin, at t = 0
        double amplitude = 0.0;
        double shortest_m = 0.0;  // where those before press it together
    };
    double strength = 0.0;  // at most 1; of a shot the largest
    std::array<Wave, kWaves> waves{};

    struct Front {
        glm::dvec2 middle_m{0.0}, along{1.0, 0.0};  // at time_s
        glm::dvec2 velocity_mps{0.0};               // none in a loop
        glm::dvec2 half_m{0.0};                     // an ellipse's half axes, along and across
        double edge_m = 0.0;                        // round it
        double time_s = 0.0;
        double reach_m = 0.0;  // from the middle: beyond it there is none
        double wind = 1.0;

        glm::dvec2 middle_at(double time_s_) const { return middle_m + velocity_mps * (time_s_ - time_s); }
    };
    std::vector<Front> fronts;  // those that change something
    double weakest = 1.0,
           strongest =
               1.0;  // of fronts' winds, and of nowhere a front: where they overlap no less and no more

    // From each front's middle to a place [m].
    using FromFronts = std::array<glm::dvec2, limits::kGustFronts>;
    FromFronts from_fronts(glm::dvec2 origin_m, double time_s) const;
    // The wind of all fronts in a round footprint, times the sea's, as from far away, where no pattern is seen on their edges.
    double fronts_wind(glm::dvec2 place_m, double footprint_m, double time_s) const;

    // Each wave's phase at a place, 0 … 1, anywhere in the world and at any time.
    std::array<double, kWaves> cycles_at(glm::dvec2 origin_m, double time_within_loop_s) const;
};

// Whether a scene has fronts that change something.
bool has_fronts(const SeaState& sea);

// Of a scene that has gusts.
GustsPlan plan_gusts(const Scene& scene);

}  // namespace pelagic
