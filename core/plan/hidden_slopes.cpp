#include "core/plan/hidden_slopes.h"

#include "core/spectrum/gauss.h"

namespace pelagic {

double hidden_mean_square_slope(const DirectionalSpectrum& spectrum, const FootprintFilter& filter,
                                double footprint_m) {
    double sum = 0.0;
    const auto panels = spectrum.panels();
    for (std::size_t i = 0; i + 1 < panels.size(); ++i)
        sum += GaussLegendre<8>::rule().integrate(panels[i], panels[i + 1], [&](double k) {
            const double weight = filter.weight(k, footprint_m);
            return k * k * spectrum.omnidirectional(k) * (1.0 - weight * weight);
        });
    return sum;
}

}  // namespace pelagic
