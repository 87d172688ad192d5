#include "core/waves/breaking_rate.h"

#include <cmath>

#include "core/spectrum/gauss.h"

namespace pelagic {

double breaking_rate(const DirectionalSpectrum& spectrum, const Breaking& breaking) {
    const Dispersion& dispersion = spectrum.dispersion();
    const auto& rule = GaussLegendre<8>::rule();
    double variance = 0.0, of_rate = 0.0;
    const auto add = [&](double from, double to, double share) {
        const double half = 0.5 * (to - from);
        for (std::size_t node = 0; node < rule.node.size(); ++node) {
            const double k = from + half * (1.0 + rule.node[node]);
            const double gradient = share * k * dispersion.horizontal_ratio(k);
            const double part = rule.weight[node] * half * gradient * gradient * spectrum.omnidirectional(k);
            variance += part;
            of_rate += part * dispersion.omega(k) * dispersion.omega(k);
        }
    };
    breaking.choppiness.for_panels(spectrum, 0.0, breaking.k_end(), add);
    return variance > 0.0 ? std::sqrt(of_rate / variance) : 0.0;
}

FoamLife foam_life(const Plan& plan) {
    if (!plan.foam) return {};
    return {.rate_per_s = breaking_rate(plan.from->spectrum, plan.breaking),
            .lasting_s = plan.foam->weight(0.0, plan.foam->window_s).foam_s};
}

}  // namespace pelagic
