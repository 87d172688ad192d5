// Which waves break: those longer than effects.breaking_from_m. Ripples are steep, hold most of the Jacobian's variance,
// and don't break; with them foam would be a veil.
//
// The strain that breaking is told from is summed through no footprint finer than footprint_m, which lets none of the
// shorter waves pass. What that hides of the waves that break counts as hidden, as what coarser footprints hide does: so
// the foam is the same at every resolution, and its edges are soft.
#pragma once

#include "core/plan/filter.h"
#include "core/scene/scene.h"
#include "core/spectrum/spectral_moments.h"

namespace pelagic {

// The choppiness that a sea is built with: the scene's, or none where it is less than this. Such a sea is displaced by less
// than a ten-thousandth of its waves' height, and in single precision J, next to 1, keeps too few digits of its strain to
// tell where it breaks: half a step is 0.2 % of J's deviation here, and more of less.
inline constexpr double kLeastShownChoppiness = 1e-4;
double built_choppiness(const Scene& scene);

struct Breaking {
    double from_m = 0.0;       // the shortest waves that break; 0: all do
    double footprint_m = 0.0;  // the finest footprint of their strain
    // Of their strain. A sea without horizontal displacement breaks where the slightest would press it together: this
    // small, its foam is that of a sea whose surface isn't compressed.
    double choppiness = 1.0;

    static constexpr double kLeastChoppiness = 0.01;

    // The larger of a pixel's footprint and the finest of the waves that break [m].
    double footprint_of(double pixel_m) const { return pixel_m > footprint_m ? pixel_m : footprint_m; }
    // Wavenumbers from here on don't break [rad/m].
    double k_end() const;
};

Breaking breaking_of(const Scene& scene, const FootprintFilter& filter);

// moments() of k_lo ≤ k < k_hi, the strains of those that break alone, with their choppiness.
SpectralMoments moments_with_breaking(const DirectionalSpectrum& spectrum, double k_lo, double k_hi,
                                      const Breaking& breaking);

}  // namespace pelagic
