// How fast the Jacobian of the waves that break changes: what Rice's formula for the length of a breaking needs.
#pragma once

#include "core/plan/breaking.h"
#include "core/plan/plan.h"
#include "core/spectrum/directional_spectrum.h"
#include "core/waves/whitecaps.h"

namespace pelagic {

// √(Var(dJ/dt)/Var(J)) [1/s] of the waves that break, to first order in the strain: the root of the mean of ω², weighted with
// λ² k² coth²(kd) Ψ, λ their choppiness. 0 without such waves.
double breaking_rate(const DirectionalSpectrum& spectrum, const Breaking& breaking);

// Of the plan's foam; none where it doesn't live.
FoamLife foam_life(const Plan& plan);

}  // namespace pelagic
