// The loops over modes of vessels' waves (core/waves/vessel_waves.h), vectorised with Highway for the CPU at run time. All are of one
// column, by my from −H up; each may read and write up to Buffer<float>::kSlack values beyond its range.
#pragma once

#include <cstddef>
#include <span>

namespace pelagic {

// e^{−ik·X} and e^{ik·a}: one number along x, an array along y.
struct PlanePhase {
    float x_re, x_im;
    const float *y_re, *y_im;
};

// What a hull displaces at a mode: Ŝ, of its dimensions and heading.
struct HullArgs {
    float ahead_x, ahead_y, half_length_m, half_beam_m;
    const float* depth;     // what the draught leaves, with all that is the same of all modes
    PlanePhase bow, board;  // e^{ik·a} to the bow and to the side
};

// A stretch of constant velocity U, half as long as `half_s`: turns both sums, of waves e^{±iω(t − s)}, by its duration, and adds what the
// water there has at its end.
struct StretchArgs {
    std::size_t count;
    float kx, ux, uy, half_s;
    const float *ky, *omega;     // [rad/m], [rad/s]
    const float *cosine, *sine;  // of ω half_s
    PlanePhase place, half_way;  // e^{−ik·X} at its middle, e^{ik·U half_s}
    HullArgs hull;
    float *later_re, *later_im;      // e^{iω(t − s)}
    float *earlier_re, *earlier_im;  // e^{−iω(t − s)}
};

// What it lifts at a moment, a second's of it: −i k·U Ŝ e^{−ik·X}, added.
struct LiftArgs {
    std::size_t count;
    float kx, ux, uy;
    const float* ky;
    PlanePhase place;
    HullArgs hull;
    float *re, *im;
};

// The water of a block.
struct Block {
    float from_x, from_y, age_s,
        share;  // from the tile's middle to where it was made [m]; how old it is; what age leaves of it
    PlanePhase place;                // e^{−ik·X}
    const float *turn_re, *turn_im;  // e^{iω duration}
    const float *later_re, *later_im, *earlier_re, *earlier_im;
};

// All blocks, the oldest first: each turns both sums by its duration, and adds its own, as far as it lies within the tile by now.
struct BlocksArgs {
    std::size_t count;
    std::span<const Block> blocks;
    float half_m, per_edge_m;        // of the tile; one over its edge's width
    const float *group_x, *group_y;  // [m/s]
    float *later_re, *later_im, *earlier_re, *earlier_im;
};

// Cosine and sine of ω times a duration of some turns at most.
struct TurnArgs {
    std::size_t count;
    double duration_s;
    const double* cycles_per_s;
    float *cosine, *sine;
};

struct VesselKernels {
    void (*stretch)(const StretchArgs&);
    void (*lift)(const LiftArgs&);
    void (*blocks)(const BlocksArgs&);
    void (*turn)(const TurnArgs&);
};

VesselKernels vessel_kernels();

}  // namespace pelagic
