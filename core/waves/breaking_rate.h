// How fast the Jacobian of the waves that break changes: what Rice's formula for the length of a breaking needs.
#pragma once

#include "core/spectrum/directional_spectrum.h"

namespace pelagic {

// √(Var(dJ/dt)/Var(J)) [1/s] of the waves with wavenumbers below k_end [rad/m], to first order in the strain: the root of
// the mean of ω², weighted with k² coth²(kd) Ψ. 0 without such waves.
double breaking_rate(const DirectionalSpectrum& spectrum, double k_end);

}  // namespace pelagic
