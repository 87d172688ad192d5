// The waves of a vessel under way (waves.vessels), by linear theory, on any path and without a state.
//
// A hull in water is what presses the surface down into its own shape S, and fills the hole that it would leave (thin ships: Michell
// 1898; Havelock 1923; shared forms of both in Darmon, Benzaquen & Raphaël 2014). Together: wherever it goes, it lifts the water that
// its bow displaces and lowers what its stern leaves, ∂S/∂t, and each such lift spreads as cos ωt does (Cauchy and Poisson 1816):
//   η̂(k, t) = −i ∫ k·U(s) Ŝ(k) e^{−ik·X(s)} cos ω(t − s) ds.
// A hull at rest makes none; starts, turns and stops are in it. Ŝ is Wigley's hull's, parabolas along and below, and one across in
// the place of the thin ship's line. That it turns on the spot isn't counted, nor is its motion up and down.
//
// The integral is cut on an absolute lattice of times into blocks, each of up to kMostSteps stretches of constant velocity, exactly
// integrated: a block depends on the path alone, so that a frame alone is that frame of a run. What one made lies at
// X(s) ± c_g (t − s) k/k by now; beyond the tile it is left out, so that the tile's period isn't seen. Modes lie on the
// lattice of a periodic cascade in the world; the tile is the one period round middle_m(), which moves with the vessel
// and at whose border fade() is 0.
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "core/base/buffer.h"
#include "core/plan/vessels.h"
#include "core/spectrum/dispersion.h"
#include "core/waves/vessel_kernels.h"

namespace pelagic {

template <class T>
struct Cascade;

// 1 within the tile, 0 at its border, with its rate [1/m], along an axis: `from_m` from its middle.
struct TileFade {
    double share = 0.0, rate_per_m = 0.0;
};
TileFade tile_fade(double from_m, double size_m);

class VesselWaves {
  public:
    // `cascade`: whose modes they are, in its order; it may go away.
    template <class T>
    VesselWaves(const Cascade<T>& cascade, const VesselPlan& plan, const Dispersion& dispersion);

    // On all threads of the calling arena. Throws BuildCancelled.
    void set(double t_s, const std::atomic<bool>* cancel);
    const VesselPlan& plan() const { return plan_; }
    glm::dvec2 middle_m() const { return middle_m_; }
    // η̂/L² and, unless null, its rate, of these columns' modes, side by side.
    template <class T>
    void heights(int first_mx, int columns, T* re, T* im, T* rate_re, T* rate_im) const;

  private:
    // e^{−ik·X} by mx and by my from −R up.
    struct Phases {
        std::vector<float> x_re, x_im, y_re, y_im;
    };
    struct Sums {
        float *later_re, *later_im, *earlier_re, *earlier_im;
        Sums from(std::size_t at) const {
            return {later_re + at, later_im + at, earlier_re + at, earlier_im + at};
        }
    };
    struct Step {
        glm::dvec2 velocity_mps{0.0}, along{1.0, 0.0};
        Phases place, half_way, bow, board;  // from the leg's end
    };
    // Successive steps of one duration: their water's amplitudes at the end, relative to the place there.
    struct Leg {
        double from_s = 0.0, end_s = 0.0;
        glm::dvec2 middle_m{0.0};
        Phases place;  // of its end
        std::vector<Step> steps;
        int table = 0;  // of cosines and sines
        Sums sums{};    // of blocks: in what is remembered
    };

    Phases phases(glm::dvec2 place_m) const;
    int steps_of(double from_s, double lasts_s, double part, int most) const;
    int steps_of(std::int64_t block) const;
    // Where a block's are kept: a later one takes the place of one that is too old.
    Sums remembered(std::int64_t block);
    // Turns its hull as it lies at a time.
    void head(Step& step, double at_s) const;
    Leg leg(double from_s, double step_s, int steps) const;
    std::size_t first_of(int mx) const { return columns_[static_cast<std::size_t>(mx)]; }
    std::size_t count_of(int mx) const { return first_of(mx + 1) - first_of(mx); }
    const float* ky_of(int mx) const;
    PlanePhase phase(const Phases& of, int mx) const;
    HullArgs hull(const Step& step, int mx) const;
    // Whether some of a column's waves that a leg made can be within the tile by now.
    bool reaches_tile(const Leg& leg, int mx) const;
    // Of a column; cosine and sine of ω times half a step.
    void sum_up(const Leg& leg, int mx, const float* cosine, const float* sine, const Sums& sums) const;

    VesselPlan plan_;
    VesselKernels kernels_;
    int radius_ = 0;
    std::vector<std::size_t> columns_;
    std::vector<double> fastest_mps_;  // by column: the greatest group velocity
    Buffer<double> cycles_per_s_;
    Buffer<float> ky_, omega_, depth_, group_x_, group_y_, turn_re_, turn_im_;
    Buffer<float> cosine_[VesselPlan::kStepLengths],
        sine_[VesselPlan::kStepLengths];  // of half a step of 1, 2, 4, … in a block
    Buffer<float>
        remembered_;  // the sums of all blocks: in one piece, so that the system gives it in huge pages
    std::map<std::int64_t, Leg> blocks_;
    std::vector<const Leg*> order_;  // of the time that is set, the oldest first
    Leg begun_, last_;               // of the block that isn't over: its steps that are, and the rest
    Step now_;                       // its velocity and its hull
    double t_s_ = 0.0;
    glm::dvec2 middle_m_{0.0};
};

}  // namespace pelagic
