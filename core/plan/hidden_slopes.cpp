#include "core/plan/hidden_slopes.h"

#include "core/spectrum/gauss.h"

namespace pelagic {

namespace {

// ∫ k² S(k) of(k) dk.
template <class Of>
double slope_integral(const DirectionalSpectrum& spectrum, const Of& of) {
    double sum = 0.0;
    const auto panels = spectrum.panels();
    for (std::size_t i = 0; i + 1 < panels.size(); ++i)
        sum += GaussLegendre<8>::rule().integrate(
            panels[i], panels[i + 1], [&](double k) { return k * k * spectrum.omnidirectional(k) * of(k); });
    return sum;
}

}  // namespace

double hidden_mean_square_slope(const DirectionalSpectrum& spectrum, const FootprintFilter& filter,
                                double footprint_m) {
    return slope_integral(spectrum, [&](double k) {
        const double weight = filter.weight(k, footprint_m);
        return 1.0 - weight * weight;
    });
}

double hidden_slope_gain(const DirectionalSpectrum& spectrum, const FootprintFilter& filter,
                         double footprint_m, double choppiness) {
    return 1.0 + 0.5 * slope_integral(spectrum, [&](double k) {
                     const double moved = choppiness * spectrum.dispersion().horizontal_ratio(k) *
                                          filter.weight(k, footprint_m);
                     return moved * moved;
                 });
}

}  // namespace pelagic
