// How far the sea's surface goes from its rest. See extent.h.
#include "core/plan/extent.h"

#include <cmath>

#include "core/spectrum/gauss.h"

namespace pelagic {

Extent expected_extent(const DirectionalSpectrum& spectrum, double choppiness) {
    // Var|D| = λ² ∫ S coth²(kd) dk (Tessendorf 2001, Eq. 29, in water of depth d).
    double squares_m2 = 0.0;
    const auto panels = spectrum.panels();
    for (std::size_t i = 0; i + 1 < panels.size(); ++i)
        squares_m2 += GaussLegendre<8>::rule().integrate(panels[i], panels[i + 1], [&](double k) {
            const double ratio = spectrum.dispersion().horizontal_ratio(k);
            return spectrum.omnidirectional(k) * ratio * ratio;
        });
    return {.height_m = kExtentDeviations * std::sqrt(spectrum.m0()),
            .reach_m = kExtentDeviations * choppiness * std::sqrt(squares_m2),
            .significant_height_m = 4.0 * std::sqrt(spectrum.m0())};
}

}  // namespace pelagic
