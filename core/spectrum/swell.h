// A swell from a far storm: one narrow hump.
//
//   S(ω) = m0 / (√(2π) σ) exp(−(ω − ωp)²/(2σ²)),  m0 = (height/4)²,  σ = 0.07 ωp
//
// The Gaussian swell spectrum of DNV-RP-C205 (2010); its relative width is ours, JONSWAP's peak width below
// the peak. ωp is 14 σ from 0, so that ∫S dω = m0 to rounding and 4√m0 is the height asked for, exactly.
//
// Spreading: cos²ˢ(θ/2), s = 75 tanh(ωp/ω)/tanh(1): the shape in ω of Horvath 2015 (his swell term is 16
// tanh(ωp/ω) ξ²), at the peak Goda's s_max = 75 for swell of long decay (Goda 2000, §2.3.2): 9° of standard
// deviation.
#pragma once

#include <cmath>
#include <numbers>

#include "core/spectrum/angular.h"
#include "pelagic/scene.h"

namespace pelagic {

struct SwellEnergy {
    static constexpr double kRelativeWidth = 0.07;

    double omega_p;    // rad/s
    double amplitude;  // m² s, S at the peak

    explicit SwellEnergy(const Swell& swell)
        : omega_p(2.0 * std::numbers::pi / swell.period_s),
          amplitude(swell.height_m * swell.height_m / 16.0 /
                    (std::sqrt(2.0 * std::numbers::pi) * kRelativeWidth * omega_p)) {}

    // S [m² s] at ω > 0 [rad/s].
    double density(double omega) const {
        const double x = (omega / omega_p - 1.0) / kRelativeWidth;
        return amplitude * std::exp(-0.5 * x * x);
    }

    double peak_omega() const { return omega_p; }
};

struct SwellSpreading {
    static constexpr double kPeakSharpness = 75.0;

    double omega_p;  // rad/s

    CosinePower at(double omega) const {
        return CosinePower(kPeakSharpness * std::tanh(omega_p / omega) / std::tanh(1.0));
    }
};

}  // namespace pelagic
