// The loops over modes that building a Sea spends its time in, in the vectors of the CPU at hand (Highway,
// chosen at run time). They write what they are asked for and nothing beyond; they may read Buffer<T>::kSlack
// values more.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/plan/filter.h"
#include "core/spectrum/dispersion.h"
#include "core/spectrum/spectral_moments.h"

namespace pelagic {

// h0(k) = ½ (ξr + iξi) √E(k) (Tessendorf 2001, Eq. 25, with the ½ that makes Var(η) = ΣE), and the conjugate
// of h0(−k), for modes (mx, first_my + i).
template <class T>
struct AmplitudeArgs {
    const double *energy, *opposite;  // E(k) and E(−k) [m²]
    int mx, first_my;
    std::size_t count;
    std::uint32_t cascade;
    std::uint64_t seed;
    T *forward_re, *forward_im, *backward_re, *backward_im;  // out [m]
};

// ω/2π, rounded to the loop as looped_cycles_per_s() does, and choppiness · coth(kd)/k, for the same modes.
template <class T>
struct FrequencyArgs {
    int mx, first_my;
    std::size_t count;
    double step;  // [rad/m] from mode to mode
    Dispersion dispersion;
    double loop_s, choppiness;
    double* cycles_per_s;  // out
    T* chop;               // out [m]; none without choppiness
};

// What moments are made of, by my from 0 up in column mx, a mode and its mirror image (mx, −my) together. Of
// a pair ±k the energy is E(k) + E(−k), what travels along k is E(k) − E(−k).
struct ColumnSums {
    double *even, *odd;    // energy of (mx, my) plus, and less, that of (mx, −my) [m²]
    double *east, *north;  // what travels along them, over k: their sum, and their difference [m³]
    double *per_k, *per_omega, *chop2;  // 1/k [m], 1/ω [s], the square of choppiness · coth(kd)/k [m²]
};
struct ColumnArgs {
    const double *same, *opposite, *below, *above;  // energies, as CellEnergies gives them
    int mx;
    std::size_t count;  // my = 0 … count − 1
    double step;
    Dispersion dispersion;
    double choppiness;
    ColumnSums out;
};

// A sum of moments, lane by lane, in the order of kSpectralMoments.
inline constexpr std::size_t kSumLanes = 8;
using MomentLanes = std::array<double, kSumLanes * kSpectralMoments.size()>;
SpectralMoments sum_of_lanes(const MomentLanes& lanes);

// Adds modes first_my … end_my − 1 of a column with weights w(footprint_a) w(footprint_b) of the filter.
struct MomentArgs {
    ColumnSums column;
    int mx, first_my, end_my;
    double step;
    FootprintFilter filter;
    double footprint_a = 0.0, footprint_b = 0.0;
    MomentLanes* sum;
};

template <class T>
struct ModeKernels {
    void (*amplitudes)(const AmplitudeArgs<T>&);
    void (*frequencies)(const FrequencyArgs<T>&);
    void (*column)(const ColumnArgs&);
    void (*moments)(const MomentArgs&);
};

// For the CPU that runs this.
template <class T>
ModeKernels<T> mode_kernels();

}  // namespace pelagic
