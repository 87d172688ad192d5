// The ways to find where a ray meets a sea of wave trains that the core doesn't take, beside the one that it takes: for
// bench_sphere_tracing. Rays that come from above the waves alone.
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <vector>

#include "core/evaluate/sphere_tracing.h"

namespace pelagic::bench {

enum class Bounds {
    Brute,      // none: steps of one length, with no tolerance
    Plain,      // L = √(1 + (Σ A_i k_i)²)
    Sorted,     // Darles 2007, Algorithm 1, with slopes along the ray, sorted at each step
    Efficient,  // the same, sorted by wavelength once, in groups; those that can't matter aren't evaluated
    Curved,     // the core's: the sum's own slope, and the bound of its change
};
struct Ways {
    Bounds bounds = Bounds::Curved;
    // Of the last two bounds: what a ray has evaluated before, what the ray before it has; of Efficient: what the same ray had in
    // the last frame.
    bool spatial = false, image = false, temporal = false;
};

// What one look at a ray has shown: F there and then, at least, by the first groups of trains.
struct Sphere {
    double s_m = 0.0, time_s = 0.0, f = 0.0;
    std::size_t groups = 0;
    double radius_m = 0.0;  // of the ball round it that the sea doesn't reach
};
using Spheres = std::vector<Sphere>;

struct Picture {
    glm::dvec3 origin_m{0.0};
    std::vector<glm::vec3> direction;  // downward; a row after the other
    std::size_t width = 0;
    double tolerance_m = 1e-4, tolerance_per_m = 0.0, brute_step_m = 0.0;
};

// Distances [m]; returns how many times a train was evaluated. kept: by ray, of the frame before; read and written with `temporal`.
std::size_t trace_by(Ways ways, const TracedTrains& trains, const Picture& picture,
                     std::vector<Spheres>& kept, std::vector<double>& distance_m);

}  // namespace pelagic::bench
