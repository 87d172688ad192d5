// Pierson & Moskowitz 1964: the fully developed sea.
//
//   S(ω) = α g² ω⁻⁵ exp(−β (ω0/ω)⁴),  α = 8.1e-3, β = 0.74, ω0 = g/U19.5      (Bruneton et al. 2010, Eq. 1)
//
// ∫S dω = α g² / (4 β ω0⁴), so that Hs = 2 U² √(α/β) / g; the peak is at (4β/5)^¼ ω0.
#pragma once

#include <cmath>

#include "core/spectrum/dispersion.h"

namespace pelagic {

// Pierson and Moskowitz measured the wind on weather ships, 19.5 m above the sea.
inline constexpr double kU195OverU10 = 1.026;

// ω⁵, without the general pow in the innermost loop.
inline double fifth_power(double omega) {
    const double square = omega * omega;
    return square * square * omega;
}

struct PiersonMoskowitz {
    static constexpr double kAlpha = 8.1e-3;
    static constexpr double kBeta = 0.74;

    double omega0;  // rad/s

    explicit PiersonMoskowitz(double wind_speed_mps) : omega0(kGravity / (kU195OverU10 * wind_speed_mps)) {}

    // S [m² s] at ω > 0 [rad/s].
    double density(double omega) const {
        const double r = omega0 / omega;
        return kAlpha * kGravity * kGravity * std::exp(-kBeta * (r * r) * (r * r)) / fifth_power(omega);
    }

    double peak_omega() const { return std::sqrt(std::sqrt(0.8 * kBeta)) * omega0; }

    double m0() const { return kAlpha * kGravity * kGravity / (4.0 * kBeta * std::pow(omega0, 4)); }
};

}  // namespace pelagic
