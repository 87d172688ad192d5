// TMA: JONSWAP in water of finite depth (Bouws, Günther, Rosenthal & Vincent 1985).
//
//   S(ω) = S_JONSWAP(ω) φ(ωh),  ωh = ω √(d/g)
//   φ = ½ ωh² (ωh ≤ 1),  1 − ½ (2 − ωh)² (ωh < 2),  1 above      (Thompson & Vincent's 1983 fit to
//   Kitaigorodskii)
#pragma once

#include <cmath>

#include "core/spectrum/jonswap.h"

namespace pelagic {

// φ at ωh: 0 … 1.
inline double kitaigorodskii(double h) {
    if (h <= 1.0) return 0.5 * h * h;
    if (h < 2.0) return 1.0 - 0.5 * (2.0 - h) * (2.0 - h);
    return 1.0;
}

struct Tma {
    JonswapShape jonswap;
    double sqrt_depth_over_g;  // s

    Tma(const JonswapShape& deep, double depth_m)
        : jonswap(deep), sqrt_depth_over_g(std::sqrt(depth_m / kGravity)) {}

    // φ at ω [rad/s]: 0 … 1.
    double depth_factor(double omega) const { return kitaigorodskii(omega * sqrt_depth_over_g); }

    // S [m² s] at ω > 0 [rad/s].
    double density(double omega) const { return jonswap.density(omega) * depth_factor(omega); }

    double peak_omega() const { return jonswap.peak_omega(); }
};

}  // namespace pelagic
