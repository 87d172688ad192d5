// What a footprint lets through (Bruneton, Neyret, Holzschuch 2010, §3.2): the weight of a wave of wavelength
// λ in a field that is sampled every L metres.
#pragma once

#include "core/base/constants.h"
#include "core/base/number.h"

namespace pelagic {

#include "core/plan/filter.inl"

struct FootprintFilter {
    // In samples per wavelength. The paper uses 1 and 2.5 in practice and 2 by Nyquist; ours begins at
    // Nyquist, so that a mesh holds nothing that it cannot show, and keeps the paper's ratio of about two.
    double n_min = 2.0;
    double n_max = 4.0;

    // footprint_weight() of wave number k [rad/m]; 1 for a footprint of 0.
    double weight(double k, double footprint_m) const {
        if (footprint_m <= 0.0) return 1.0;
        return footprint_weight(kTwoPi / k / footprint_m, n_min, 1.0 / (n_max - n_min));
    }
    // Waves with larger k have weight 0 [rad/m]; infinite for a footprint of 0.
    double cutoff(double footprint_m) const { return kTwoPi / (n_min * footprint_m); }

    bool operator==(const FootprintFilter&) const = default;
};

}  // namespace pelagic
