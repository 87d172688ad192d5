// What a footprint lets through (Bruneton, Neyret, Holzschuch 2010, §4.1): the weight of a wave of wavelength
// λ in a field that is sampled every L metres.
#pragma once

#include <algorithm>
#include <cmath>
#include "core/base/constants.h"

namespace pelagic {

#include "core/plan/filter.inl"

struct FootprintFilter {
    // In samples per wavelength. The paper uses 1 and 2.5 in practice and 2 by Nyquist; ours begins at
    // Nyquist, so that a mesh holds nothing that it cannot show, and keeps the paper's ratio of about two.
    double n_min = 2.0;
    double n_max = 4.0;

    // w(Nmin, Nmax, λ/L) = 3x̄² − 2x̄³, x̄ = clamp((λ/L − Nmin)/(Nmax − Nmin), 0, 1); 1 for a footprint of 0.
    double weight(double k, double footprint_m) const {
        if (footprint_m <= 0.0) return 1.0;
        const double wavelength_m = kTwoPi / k;
        return smooth_rise(std::clamp((wavelength_m / footprint_m - n_min) / (n_max - n_min), 0.0, 1.0));
    }
    // Waves with larger k have weight 0 [rad/m]; infinite for a footprint of 0.
    double cutoff(double footprint_m) const { return kTwoPi / (n_min * footprint_m); }
};

}  // namespace pelagic
