// JONSWAP: the sea that a wind raises over a limited fetch.
//
//   S(ω) = α g² ω⁻⁵ exp(−5/4 (ωp/ω)⁴) γ^exp(−(ω − ωp)² / (2 σ² ωp²))
//   α = 0.076 (U²/(F g))^0.22,  ωp = 22 (g²/(U F))^⅓,  γ = 3.3,  σ = 0.07 (ω ≤ ωp), 0.09 above
//                                                                       (Hasselmann et al. 1973, §2)
// Taken at its word, 10 000 km of fetch make a sea of 37 m: growth stops where the peak reaches that of the
// fully developed sea, ωp = 0.877 g/U19.5. The longest fetch that counts follows from it, and is used for α
// too.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/spectrum/pierson_moskowitz.h"

namespace pelagic {

struct Jonswap {
    static constexpr double kLnGamma = 1.1939224684724346;  // γ = 3.3
    static constexpr double kSigmaBelow = 0.07;
    static constexpr double kSigmaAbove = 0.09;
    static constexpr double kDevelopedPeak = 0.877;  // ωp U19.5 / g of Pierson & Moskowitz

    double alpha;
    double omega_p;  // rad/s

    Jonswap(double wind_speed_mps, double fetch_m) {
        const double effective_m = std::min(fetch_m, developed_fetch_m(wind_speed_mps));
        alpha = 0.076 * std::pow(wind_speed_mps * wind_speed_mps / (effective_m * kGravity), 0.22);
        omega_p = 22.0 * std::cbrt(kGravity * kGravity / (wind_speed_mps * effective_m));
    }

    // The fetch [m] at which the sea is fully developed.
    static double developed_fetch_m(double wind_speed_mps) {
        const double developed_omega = kDevelopedPeak * kGravity / (kU195OverU10 * wind_speed_mps);
        return kGravity * kGravity / (wind_speed_mps * std::pow(developed_omega / 22.0, 3));
    }

    // S [m² s] at ω > 0 [rad/s].
    double density(double omega) const {
        const double r = omega_p / omega;
        const double off_peak = (omega - omega_p) / ((omega > omega_p ? kSigmaAbove : kSigmaBelow) * omega_p);
        return alpha * kGravity * kGravity / fifth_power(omega) *
               std::exp(-1.25 * (r * r) * (r * r) + kLnGamma * std::exp(-0.5 * off_peak * off_peak));
    }

    double peak_omega() const { return omega_p; }
};

}  // namespace pelagic
