// Hasselmann, Dunckel & Ewing 1980: cos²ˢ(θ/2) spreading of a wind sea, sharpest at the peak.
//
//   s = 6.97 (ω/ωp)^4.06  below the peak,  9.77 (ω/ωp)^(−2.33 − 1.45 (U/cp − 1.17))  above
//
// The first rises and the second falls; they meet near 1.05 ωp. Changing over at ωp itself would make s jump,
// so the smaller one counts.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/spectrum/angular.h"

namespace pelagic {

struct HasselmannSpreading {
    double omega_p;           // rad/s
    double falling_exponent;  // −2.33 − 1.45 (U/cp − 1.17)

    HasselmannSpreading(double peak_omega, double inverse_wave_age)
        : omega_p(peak_omega), falling_exponent(-2.33 - 1.45 * (inverse_wave_age - 1.17)) {}

    double sharpness(double omega) const {
        const double ln_ratio = std::log(omega / omega_p);
        return std::exp(std::min(kLnRising + 4.06 * ln_ratio, kLnFalling + falling_exponent * ln_ratio));
    }

    // ω at which the branches meet.
    double meeting_omega() const {
        return omega_p * std::exp((kLnFalling - kLnRising) / (4.06 - falling_exponent));
    }

    CosinePower at(double omega) const { return CosinePower(sharpness(omega)); }

  private:
    static constexpr double kLnRising = 1.9416152247724325;   // ln 6.97
    static constexpr double kLnFalling = 2.2793164660546914;  // ln 9.77
};

}  // namespace pelagic
