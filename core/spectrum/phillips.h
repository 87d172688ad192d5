// Phillips' spectrum as Tessendorf 2001 (Eq. 40) uses it, for people who come from there.
//
//   S_k(k) = A k⁻³ exp(−1/(kL)²),  L = U10²/g
//
// His constant is a matter of taste. Here A = 2 m0/L² makes ∫S_k dk that of Pierson–Moskowitz at the same
// wind. His factor |k̂·ŵ|² is the spreading's business. A spectrum in k: depth changes its frequencies and not
// its heights.
#pragma once

#include <cmath>

#include "core/spectrum/pierson_moskowitz.h"

namespace pelagic {

struct Phillips {
    double length_m;   // L
    double amplitude;  // A, dimensionless

    explicit Phillips(double wind_speed_mps)
        : length_m(wind_speed_mps * wind_speed_mps / kGravity),
          amplitude(2.0 * PiersonMoskowitz(wind_speed_mps).m0() / (length_m * length_m)) {}

    // S_k [m³] at k > 0 [rad/m].
    double density_k(double k) const {
        const double kl = k * length_m;
        return amplitude * std::exp(-1.0 / (kl * kl)) / (k * k * k);
    }

    double peak_wavenumber() const { return std::sqrt(2.0 / 3.0) / length_m; }
};

}  // namespace pelagic
