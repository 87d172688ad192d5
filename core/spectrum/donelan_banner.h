// Donelan, Hamilton & Hui 1985 with Banner 1990's short waves: sech²(βθ) spreading, x = ω/ωp.
//
//   β = 2.61 x^1.3 (0.56 < x < 0.95),  2.28 x^−1.3 (x ≤ 1.6),  10^(−0.4 + 0.8393 exp(−0.567 ln x²)) above
//
// Below x = 0.56, where nothing was measured, the value at the edge, 1.24, is kept.
#pragma once

#include <cmath>

#include "core/spectrum/angular.h"

namespace pelagic {

struct DonelanBannerSpreading {
    double omega_p;  // rad/s

    double beta(double omega) const {
        const double x = omega / omega_p;
        if (x <= 0.56) return 1.24;
        if (x < 0.95) return 2.61 * std::pow(x, 1.3);
        if (x <= 1.6) return 2.28 * std::pow(x, -1.3);
        return std::pow(10.0, -0.4 + 0.8393 * std::pow(x, -2.0 * 0.567));
    }

    SechSquared at(double omega) const { return SechSquared(beta(omega)); }
};

}  // namespace pelagic
