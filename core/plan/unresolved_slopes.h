// The slopes that a footprint leaves unresolved, in expectation.
#pragma once

#include "core/plan/choppiness.h"
#include "core/plan/filter.h"
#include "core/spectrum/directional_spectrum.h"

namespace pelagic {

// The mean square slope that is unresolved where every wave counts with its footprint's weight w: ∫ k² S(k) (1 − w²)
// dk [-], S the omnidirectional spectrum (Bruneton, Neyret, Holzschuch 2010, §7.1: total less resolved). footprint_m
// ≥ 0.
double unresolved_mean_square_slope(const DirectionalSpectrum& spectrum, const FootprintFilter& filter,
                                    double footprint_m);

// How much larger the unresolved slope variance is by area of sea than at rest, where the resolved waves carry it:
// E[J Σ′]/Σ of an isotropic Σ = E[|M|²/(2 J)] (core/evaluate/surface.inl), to second order 1 + ½ ∫ k² S λ² coth²(kd)
// w² dk.
double unresolved_slope_gain(const DirectionalSpectrum& spectrum, const FootprintFilter& filter,
                             double footprint_m, const Choppiness& choppiness);

}  // namespace pelagic
