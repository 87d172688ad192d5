// What a Sea is built for, the plain way: one mode after the other, from the spectrum's own formulas.
#pragma once

#include <complex>
#include <vector>

#include "core/plan/plan.h"
#include "core/waves/sea.h"

namespace pelagic::oracle {

struct ReferenceCascade {
    // By place in the lattice, as Cascade has them: h0(k) and conj(h0(−k)) [m].
    std::vector<std::complex<double>> forward, backward;
    double expected_m0 = 0.0;
};

struct ReferenceSea {
    std::vector<ReferenceCascade> cascades;
    // By query: resolved by level i, and by levels i and i + 1 together. What travels along a mode is
    // E(k) − E(−k).
    std::vector<std::vector<SpectralMoments>> resolved, resolved_next;
};

// On all threads of the calling arena.
ReferenceSea reference_sea(const Plan& plan);

}  // namespace pelagic::oracle
