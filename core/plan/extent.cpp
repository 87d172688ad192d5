// How far the sea's surface goes from its rest. See extent.h.
#include "core/plan/extent.h"

#include <cmath>
#include <cstddef>
#include <limits>

#include "core/plan/filter.h"
#include "core/spectrum/gauss.h"

namespace pelagic {

Extent expected_extent(const DirectionalSpectrum& spectrum, const Choppiness& choppiness) {
    const auto& rule = GaussLegendre<8>::rule();
    const FootprintFilter filter;
    double reach_m2 = 0.0;
    std::array<double, UnresolvedHeight::kCells> unresolved_m2{};
    const auto add = [&](double from, double to, double share) {
        for (std::size_t node = 0; node < rule.node.size(); ++node) {
            const double half = 0.5 * (to - from);
            const double k = from + half * (1.0 + rule.node[node]);
            const double energy_m2 = half * rule.weight[node] * spectrum.omnidirectional(k);
            // Var|D| = ∫ S λ² coth²(kd) dk (Tessendorf 2001, Eq. 29, in water of depth d), here over the largest λ².
            const double ratio = share * spectrum.dispersion().horizontal_ratio(k);
            reach_m2 += energy_m2 * ratio * ratio;
            // ∫ S (1 − w)² dk: what a footprint w takes from each wave.
            for (std::size_t cell = UnresolvedHeight::kCells; cell-- > 0;) {
                const double lost = 1.0 - filter.weight(k, UnresolvedHeight::cell_m(cell));
                if (lost == 0.0) break;  // nor do shorter cells
                unresolved_m2[cell] += energy_m2 * lost * lost;
            }
        }
    };
    choppiness.for_panels(spectrum, 0.0, std::numeric_limits<double>::infinity(), add);
    Extent extent{.height_m = kExtentDeviations * std::sqrt(spectrum.m0()),
                  .reach_m = kExtentDeviations * choppiness.largest() * std::sqrt(reach_m2),
                  .significant_height_m = 4.0 * std::sqrt(spectrum.m0())};
    for (std::size_t cell = 0; cell < UnresolvedHeight::kCells; ++cell)
        extent.unresolved.deviation_m[cell] = std::sqrt(unresolved_m2[cell]);
    return extent;
}

}  // namespace pelagic
