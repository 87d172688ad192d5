// Which waves break: those longer than effects.breaking_from_m. Ripples are steep, hold most of the Jacobian's variance,
// and don't break; with them foam would be a veil.
//
// The strain that breaking is told from is summed through no footprint finer than footprint_m, which lets none of the
// shorter waves pass. What that hides of the waves that break counts as hidden, as what coarser footprints hide does: so
// the foam is the same at every resolution, and its edges are soft.
#pragma once

#include "core/plan/choppiness.h"
#include "core/plan/filter.h"
#include "core/scene/scene.h"
#include "core/spectrum/spectral_moments.h"

namespace pelagic {

struct Breaking {
    double from_m = 0.0;       // the shortest waves that break; 0: all do
    double footprint_m = 0.0;  // the finest footprint of their strain
    // Of their strain. A sea without horizontal displacement breaks where the slightest would press it together: this
    // small, its foam is that of a sea whose surface isn't compressed.
    Choppiness choppiness{};

    static constexpr double kLeastChoppiness = 0.01;

    // The larger of a pixel's footprint and the finest of the waves that break [m].
    double footprint_of(double pixel_m) const { return pixel_m > footprint_m ? pixel_m : footprint_m; }
    // Wavenumbers from here on don't break [rad/m].
    double k_end() const;
};

Breaking breaking_of(const Scene& scene, const FootprintFilter& filter);

// moments() of k_lo ≤ k < k_hi with the strains of this choppiness.
SpectralMoments moments_pressed(const DirectionalSpectrum& spectrum, double k_lo, double k_hi,
                                const Choppiness& choppiness);

// The same, the strains of those that break alone.
SpectralMoments moments_with_breaking(const DirectionalSpectrum& spectrum, double k_lo, double k_hi,
                                      const Breaking& breaking);

// The one choppiness that would press the waves that break as much, by Var(J) to first order, ∫ λ² k² coth²(kd) S dk.
double mean_choppiness(const DirectionalSpectrum& spectrum, const Breaking& breaking);

}  // namespace pelagic
