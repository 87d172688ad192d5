// Bruneton, Neyret & Holzschuch 2010, §7.1: trains of heights ∝ ω⁻², wavelengths in geometric progression.
//
// A progression has Δω ∝ ω, so h² ∝ ω⁻⁴ = S Δω means S ∝ ω⁻⁵. The paper leaves constant and range to the
// artist; here
//
//   S(ω) = α g² ω⁻⁵ for ω ≥ ωc, 0 below
//   α = 8.1e-3 (Phillips' constant, as in Pierson–Moskowitz), ωc = β^¼ g/U19.5
//
// with which ∫S dω = α g²/(4 ωc⁴) is Pierson–Moskowitz' at the same wind.
#pragma once

#include <cmath>

#include "core/spectrum/pierson_moskowitz.h"

namespace pelagic {

struct Omega2 {
    double cutoff_omega;  // rad/s

    explicit Omega2(double wind_speed_mps)
        : cutoff_omega(std::sqrt(std::sqrt(PiersonMoskowitz::kBeta)) *
                       PiersonMoskowitz(wind_speed_mps).omega0) {}

    // S [m² s] at ω > 0 [rad/s].
    double density(double omega) const {
        if (omega < cutoff_omega) return 0.0;
        return PiersonMoskowitz::kAlpha * kGravity * kGravity / fifth_power(omega);
    }

    double peak_omega() const { return cutoff_omega; }
};

}  // namespace pelagic
