#include "core/plan/breaking.h"

#include <algorithm>
#include <limits>

#include "core/base/constants.h"

namespace pelagic {

double Breaking::k_end() const {
    return from_m > 0.0 ? kTwoPi / from_m : std::numeric_limits<double>::infinity();
}

double built_choppiness(const Scene& scene) {
    return scene.waves.choppiness < kLeastShownChoppiness ? 0.0 : scene.waves.choppiness;
}

Breaking breaking_of(const Scene& scene, const FootprintFilter& filter) {
    const double from_m = scene.effects.breaking_from_m, choppiness = built_choppiness(scene);
    return {.from_m = from_m,
            .footprint_m = from_m / filter.n_min,
            .choppiness = choppiness > 0.0 ? choppiness : Breaking::kLeastChoppiness};
}

SpectralMoments moments_with_breaking(const DirectionalSpectrum& spectrum, double k_lo, double k_hi,
                                      const Breaking& breaking) {
    SpectralMoments all = moments(spectrum, k_lo, k_hi);
    if (breaking.k_end() < k_hi) all.take_strain(moments(spectrum, k_lo, std::max(breaking.k_end(), k_lo)));
    return all.scale_strain(breaking.choppiness * breaking.choppiness);
}

}  // namespace pelagic
