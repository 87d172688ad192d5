// Rays against a sea of wave trains that is a height field: sphere tracing (Darles, Crespin, Ghazanfarpour 2007, §3), with
// bounds of second order.
//
// Along a ray of unit direction d, at distance s, let F be the height over the sea: F = z + s d_z − Σ A_i cos θ_i. A step r is
// safe if no F before it can be 0. The paper's Algorithm 1 bounds train i by −A_i and by a slope of its own, L_i = A_i|k_i·d|.
// Here the slope is the sum's own at s, and what it may change by is bounded as well: of the n longest trains
//   F(s + r) ≥ F_n + F_n' r − ½ M_n r² − Σ_rest A_i,   M_n = Σ A_i (k_i·d)²,   with slopes no less than d_z − Σ L_i,
// and the largest first zero over n is the step. As in the paper, trains that can't matter yet aren't evaluated: the rest counts
// with its minimum. The order is by wavelength, once. The same bound from the other side, with + ½ M r², says how far away the
// hit is at most, and ends the search.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "core/base/buffer.h"
#include "core/base/strided.h"
#include "core/waves/frame.h"

namespace pelagic {

// The trains of one time, as the rays' loops read them: longest first, in groups, the last one filled up with trains of
// height 0.
struct TracedTrains {
    static constexpr std::size_t kGroup = 16;

    Buffer<double> kx_cycles_per_m, ky_cycles_per_m, start_cycles;  // θ/2π = start − κ·x
    Buffer<float> amplitude_m, omega;                               // ω [rad/s]
    std::size_t count = 0, groups = 0;
    std::vector<double> rest_m;  // by group: the sum of amplitudes from it on; at the end 0
    std::vector<double> bend;    // by number of groups: Σ A ω² of the first ones [m/s²]
    // What rounding may do to a height [m], to a slope along a ray and to a height's change in time [m/s], at most.
    double height_error_m = 0.0, slope_error = 0.0, rate_error = 0.0;
    double time_s = 0.0;
    std::uint64_t sea = 0;  // the same for the same trains at whatever time
};

// Distances count in lengths of the direction, from where the ray begins.
struct TracedRays {
    std::size_t count = 0;
    glm::dvec3 origin_m{0.0};                // of the batch, in the world
    Strided<const glm::vec3> offset_m{};     // of each ray's beginning from the origin; empty: 0
    Strided<const glm::vec3> direction{};    // of any length but 0
    Strided<const float> near{}, far{};      // between which a ray counts; empty: 0, and without end
    Strided<const float> tolerance_m{};      // where the ray begins; empty: 1 mm
    Strided<const float> tolerance_per_m{};  // by which it grows; empty: 0
    // Of a ray at most. One that has taken them ends where it stands, as a hit: it is known to be clear up to there. A ray takes
    // some ten; those that graze for kilometres take hundreds.
    int most_steps = 4096;
};

// The paper's temporal coherence (§3.3): what rays have seen, for the same rays at another time of the same sea, as from a camera
// that stands still. F moves with its own rate, which changes by Σ A ω² at most: a look at a ray still proves something a frame
// later. What doesn't fit, another ray in that place or another sea, is left out. It belongs to the caller, for one call at a
// time; 1 to 3 KB a ray.
struct SeenSpheres {
    struct Sphere {
        double s_m = 0.0, time_s = 0.0;
        float f_m = 0.0f, slope = 0.0f, rate_mps = 0.0f;  // F, at least; ∂F/∂s, at least; ∂F/∂t
        std::uint32_t groups = 0;                         // of trains that were evaluated
    };
    struct Ray {
        glm::dvec3 from_m{0.0}, unit{0.0};
        double side = 0.0;
        std::size_t first = 0, count = 0;  // of the spheres
    };
    std::uint64_t sea = 0;
    std::vector<Ray> rays;
    std::vector<Sphere> spheres, next;  // next: while they are looked for
};

// The sea is that of a frame's trains at its time, filtered for cells of one footprint. Immutable, and independent of the frame;
// any number of threads may use it. It works on the calling thread alone.
class SphereTracing {
  public:
    // Throws std::invalid_argument when the frame has no time, for a sea with cascades or with trains that move water to the side
    // (waves.choppiness above 0), and for a footprint that isn't one.
    explicit SphereTracing(const Frame<float>& frame, double cell_m = 0.0);

    // The first place where each ray meets the surface, from above or from below; infinity where there is none within most_steps. Returns how many
    // times a train was evaluated.
    //
    // A ray that crosses the surface has a hit, no later than tolerance after the crossing along the ray. A hit lies at most tolerance
    // (along the ray) from a crossing, or an eighth of it above or below the surface where the ray only grazes it. The tolerance is at
    // least 16 height_error_m: 2e-5 of the sum of all amplitudes. A ray that begins on the surface begins on the side that it
    // leaves to. A ray that isn't finite, or has no direction, hits nothing. A ray's result doesn't depend on the others.
    //
    // `seen`: read and written, where given. Hits are as good with it as without, though not the same to the last bit: they depend
    // on what was asked before.
    std::size_t trace(const TracedRays& rays, Strided<double> distance, SeenSpheres* seen = nullptr) const;

    // The step [m] that the bounds allow from there: the ray doesn't meet the surface before it. Infinite: it never does.
    double safe_step_m(glm::dvec3 from_m, glm::dvec3 direction) const;

    const TracedTrains& trains() const { return trains_; }

  private:
    TracedTrains trains_;
};

}  // namespace pelagic
