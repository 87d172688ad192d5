#include "core/plan/breaking.h"

#include <cmath>
#include <limits>

#include "core/base/constants.h"

namespace pelagic {

double Breaking::k_end() const {
    return from_m > 0.0 ? kTwoPi / from_m : std::numeric_limits<double>::infinity();
}

Breaking breaking_of(const Scene& scene, const FootprintFilter& filter) {
    const double from_m = scene.effects.breaking_from_m;
    const Choppiness choppiness = Choppiness::asked(scene).built();
    return {.from_m = from_m,
            .footprint_m = from_m / filter.n_min,
            .choppiness = choppiness.moves() ? choppiness : Breaking::kLeastChoppiness};
}

SpectralMoments moments_pressed(const DirectionalSpectrum& spectrum, double k_lo, double k_hi,
                                const Choppiness& choppiness) {
    SpectralMoments sum;
    choppiness.for_bands(k_lo, k_hi, [&](double from, double to, double share) {
        sum += moments(spectrum, from, to).scale_gradients(share * share);
    });
    return sum.scale_gradients(choppiness.largest() * choppiness.largest());
}

SpectralMoments moments_with_breaking(const DirectionalSpectrum& spectrum, double k_lo, double k_hi,
                                      const Breaking& breaking) {
    SpectralMoments all = moments_pressed(spectrum, k_lo, k_hi, breaking.choppiness);
    if (breaking.k_end() < k_hi)
        all.take_gradients(moments_pressed(spectrum, k_lo, breaking.k_end(), breaking.choppiness));
    return all;
}

double mean_choppiness(const DirectionalSpectrum& spectrum, const Breaking& breaking) {
    if (breaking.choppiness.is_of_all()) return breaking.choppiness.largest();
    const auto pressed = [&](const Choppiness& by) {
        const SpectralMoments of = moments_pressed(spectrum, 0.0, breaking.k_end(), by);
        return of.xxxx + 2.0 * of.xxyy + of.yyyy;
    };
    const double largest = breaking.choppiness.largest(), most = pressed(largest);
    return most > 0.0 ? largest * std::sqrt(pressed(breaking.choppiness) / most) : largest;
}

}  // namespace pelagic
