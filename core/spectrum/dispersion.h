// The dispersion relation of water waves, the only one in the program: gravity, capillarity and depth
// together.
//
//   ω² = (g k + (γ/ρ) k³) tanh(k d)         (Lamb, Hydrodynamics, 6th ed. 1932, §266–267)
//
// Everything that turns a frequency spectrum into a wavenumber spectrum, or moves a wave, asks here, so that
// ω, dω/dk and the phase speed always belong together.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/constants.h"

namespace pelagic {

inline constexpr double kCapillarity = 7.3e-5;  // m³/s², surface tension over density, sea water at 20 °C

struct Dispersion {
    double depth_m = std::numeric_limits<double>::infinity();  // > 0

    // Angular frequency [rad/s] of wavenumber k ≥ 0 [rad/m].
    double omega(double k) const {
        if (!(k > 0.0)) return 0.0;
        return std::sqrt(k * (kGravity + kCapillarity * k * k) * std::tanh(k * depth_m));
    }

    // Group speed dω/dk [m/s]. At k = 0 the limit: √(g d), infinite in deep water.
    double domega_dk(double k) const {
        if (!(k > 0.0)) return std::sqrt(kGravity * depth_m);
        const double kd = k * depth_m;
        const double stiffness = kGravity + kCapillarity * k * k;
        const double t = std::tanh(kd);
        double twice_omega_slope = (kGravity + 3.0 * kCapillarity * k * k) * t;
        if (kd < kDeep) twice_omega_slope += k * stiffness * depth_m * (1.0 - t) * (1.0 + t);
        return twice_omega_slope / (2.0 * std::sqrt(k * stiffness * t));
    }

    // The k whose frequency is omega. Newton's method on log ω(log k), whose slope stays within ½ … 2 for
    // every depth and frequency, so that it cannot run away; to 1e-13 relative.
    double wavenumber(double angular_frequency) const {
        if (!(angular_frequency > 0.0)) return 0.0;
        const double squared = angular_frequency * angular_frequency;
        const double deep = squared / kGravity;
        const double shallow = angular_frequency / std::sqrt(kGravity * depth_m);
        double k = std::min(std::max(deep, shallow), std::max(std::cbrt(squared / kCapillarity), shallow));
        for (int i = 0; i < 60; ++i) {
            const double w = omega(k);
            const double step = std::log(w / angular_frequency) * w / (k * domega_dk(k));
            k *= std::exp(-step);
            if (std::abs(step) < 1e-15) break;
        }
        return k;
    }

    // Horizontal over vertical amplitude of the water's orbit at the surface, coth(k d): 1 when deep, ∞ for k
    // → 0.
    double horizontal_ratio(double k) const {
        const double kd = k > 0.0 ? k * depth_m : 0.0;
        return kd < kDeep ? 1.0 / std::tanh(kd) : 1.0;
    }

    static constexpr double kDeep =
        20.0;  // k d from which 1 − tanh(k d) = 2e-18 is below a double's rounding
};

}  // namespace pelagic
