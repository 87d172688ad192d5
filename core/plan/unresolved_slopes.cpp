#include "core/plan/unresolved_slopes.h"

#include <limits>

#include "core/spectrum/gauss.h"

namespace pelagic {

namespace {

// ∫ k² S(k) of(k, λ over the largest) dk.
template <class Of>
double slope_integral(const DirectionalSpectrum& spectrum, const Choppiness& choppiness, const Of& of) {
    double sum = 0.0;
    const auto add = [&](double from, double to, double share) {
        sum += GaussLegendre<8>::rule().integrate(
            from, to, [&](double k) { return k * k * spectrum.omnidirectional(k) * of(k, share); });
    };
    choppiness.for_panels(spectrum, 0.0, std::numeric_limits<double>::infinity(), add);
    return sum;
}

}  // namespace

double unresolved_mean_square_slope(const DirectionalSpectrum& spectrum, const FootprintFilter& filter,
                                    double footprint_m) {
    return slope_integral(spectrum, Choppiness(), [&](double k, double) {
        const double weight = filter.weight(k, footprint_m);
        return 1.0 - weight * weight;
    });
}

double unresolved_slope_gain(const DirectionalSpectrum& spectrum, const FootprintFilter& filter,
                             double footprint_m, const Choppiness& choppiness) {
    return 1.0 + 0.5 * slope_integral(spectrum, choppiness, [&](double k, double share) {
                     const double moved = share * choppiness.largest() *
                                          spectrum.dispersion().horizontal_ratio(k) *
                                          filter.weight(k, footprint_m);
                     return moved * moved;
                 });
}

}  // namespace pelagic
