// How fast the Jacobian of the waves that break changes: Rice's formula for the duration of breaking needs it.
#pragma once

#include "core/plan/breaking.h"
#include "core/plan/plan.h"
#include "core/spectrum/directional_spectrum.h"
#include "core/waves/whitecaps.h"

namespace pelagic {

// √(Var(dJ/dt)/Var(J)) [1/s] of the waves that break, to first order in the displacement gradient: the root of the
// mean of ω², weighted with λ² k² coth²(kd) Ψ, λ their choppiness. 0 without such waves.
double breaking_rate(const DirectionalSpectrum& spectrum, const Breaking& breaking);

// Of the plan's foam; all 0 without persistent foam.
FoamLife foam_life(const Plan& plan);

}  // namespace pelagic
