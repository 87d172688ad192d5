// Gusts: a slow pattern of wind over the surface, which the wind carries along.
//
// Eight waves of wind, the longest first, each shifted by those before it, so that patches have fronts and no lattice
// shows. Whatever shifts them, their phases are independent and uniform: over area the pattern has mean 0 and variance 1.
// core/waves/gusts.inl adds them up.
#pragma once

#include <array>
#include <glm/vec2.hpp>

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

    // Each wave's phase at a place, 0 … 1, anywhere in the world and at any time.
    std::array<double, kWaves> cycles_at(glm::dvec2 origin_m, double time_within_loop_s) const;
};

// Of a scene that has gusts.
GustsPlan plan_gusts(const Scene& scene);

}  // namespace pelagic
