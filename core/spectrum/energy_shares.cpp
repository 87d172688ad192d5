#include "core/spectrum/energy_shares.h"

#include <algorithm>

#include "core/base/constants.h"
#include "core/spectrum/gauss.h"

namespace pelagic {

EnergyShares::EnergyShares(const DirectionalSpectrum& spectrum, double k_lo, double k_hi) {
    const auto& rule = GaussLegendre<8>::rule();
    spectrum.for_panels(k_lo, k_hi, [&](double from, double to) {
        const double half = 0.5 * (to - from), middle = 0.5 * (to + from);
        for (std::size_t i = 0; i < rule.node.size(); ++i) {
            const double k = middle + half * rule.node[i];
            energy_ += half * rule.weight[i] * spectrum.omnidirectional(k);
            nodes_.push_back({k, energy_});
        }
    });
}

double EnergyShares::wavenumber(double share) const {
    const auto at = std::upper_bound(nodes_.begin(), nodes_.end(), share * energy_,
                                     [](double sum, const Node& node) { return sum < node.sum; });
    return at != nodes_.end() ? at->k : nodes_.back().k;
}

double direction_of_share(const DirectionalSpectrum& spectrum, double k, double share) {
    const double wanted = share * spectrum.arc(k, -kPi, kPi);
    double low = -kPi, high = kPi;
    for (int i = 0; i < 60; ++i) {  // to the last bit of an angle
        const double middle = 0.5 * (low + high);
        (spectrum.arc(k, -kPi, middle) <= wanted ? low : high) = middle;
    }
    return 0.5 * (low + high);
}

}  // namespace pelagic
