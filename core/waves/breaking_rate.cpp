#include "core/waves/breaking_rate.h"

#include <algorithm>
#include <cmath>

#include "core/spectrum/gauss.h"

namespace pelagic {

double breaking_rate(const DirectionalSpectrum& spectrum, double k_end) {
    const Dispersion& dispersion = spectrum.dispersion();
    const auto panels = spectrum.panels();
    const auto& rule = GaussLegendre<8>::rule();
    double variance = 0.0, of_rate = 0.0;
    for (std::size_t i = 0; i + 1 < panels.size() && panels[i] < k_end; ++i) {
        const double half = 0.5 * (std::min(panels[i + 1], k_end) - panels[i]);
        for (std::size_t node = 0; node < rule.node.size(); ++node) {
            const double k = panels[i] + half * (1.0 + rule.node[node]);
            const double strain = k * dispersion.horizontal_ratio(k);
            const double part = rule.weight[node] * half * strain * strain * spectrum.omnidirectional(k);
            variance += part;
            of_rate += part * dispersion.omega(k) * dispersion.omega(k);
        }
    }
    return variance > 0.0 ? std::sqrt(of_rate / variance) : 0.0;
}

}  // namespace pelagic
