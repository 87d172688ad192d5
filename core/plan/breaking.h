// Which waves break: those longer than effects.breaking_from_m. Ripples are steep, hold most of the Jacobian's variance,
// and don't break; with them foam would be a veil.
//
// The displacement gradient that decides about breaking is summed through no footprint finer than footprint_m, which
// lets none of the shorter waves pass. What that leaves unresolved of the waves that break counts as for coarser
// footprints: so the foam is the same at every resolution, and its edges are soft.
#pragma once

#include "core/plan/choppiness.h"
#include "core/plan/filter.h"
#include "core/spectrum/spectral_moments.h"
#include "pelagic/scene.h"

namespace pelagic {

struct Breaking {
    double from_m = 0.0;       // the shortest waves that break; 0: all do
    double footprint_m = 0.0;  // the finest footprint of their displacement gradient
    // Of the waves that break. A sea without horizontal displacement gets this small one, since J decides about
    // breaking: its foam is that of a sea whose surface isn't compressed.
    Choppiness choppiness{};

    static constexpr double kLeastChoppiness = 0.01;

    // The larger of a pixel's footprint and the finest of the waves that break [m].
    double footprint_of(double pixel_m) const { return pixel_m > footprint_m ? pixel_m : footprint_m; }
    // Wavenumbers from here on don't break [rad/m].
    double k_end() const;
};

Breaking breaking_of(const Scene& scene, const FootprintFilter& filter);

// moments() of k_lo ≤ k < k_hi with the displacement gradients of this choppiness.
SpectralMoments moments_pressed(const DirectionalSpectrum& spectrum, double k_lo, double k_hi,
                                const Choppiness& choppiness);

// The same with the displacement gradients of breaking waves alone.
SpectralMoments moments_with_breaking(const DirectionalSpectrum& spectrum, double k_lo, double k_hi,
                                      const Breaking& breaking);

// The one choppiness with which all waves that break would have the same Var(J), to first order ∫ λ² k² coth²(kd) S
// dk.
double mean_choppiness(const DirectionalSpectrum& spectrum, const Breaking& breaking);

}  // namespace pelagic
