#include "core/waves/breaking_rate.h"

#include <algorithm>
#include <cmath>

#include "core/base/constants.h"
#include "core/spectrum/gauss.h"

namespace pelagic {
namespace {

class MeanSquare {
  public:
    void add(double variance, double omega) {
        variance_ += variance;
        of_rate_ += variance * omega * omega;
    }
    double root() const { return variance_ > 0.0 ? std::sqrt(of_rate_ / variance_) : 0.0; }

  private:
    double variance_ = 0.0, of_rate_ = 0.0;
};

}  // namespace

double breaking_rate(const DirectionalSpectrum& spectrum, double k_end) {
    const Dispersion& dispersion = spectrum.dispersion();
    const auto panels = spectrum.panels();
    const auto& rule = GaussLegendre<8>::rule();
    MeanSquare mean;
    for (std::size_t i = 0; i + 1 < panels.size() && panels[i] < k_end; ++i) {
        const double half = 0.5 * (std::min(panels[i + 1], k_end) - panels[i]);
        for (std::size_t node = 0; node < rule.node.size(); ++node) {
            const double k = panels[i] + half * (1.0 + rule.node[node]);
            const double strain = k * dispersion.horizontal_ratio(k);
            mean.add(rule.weight[node] * half * strain * strain * spectrum.omnidirectional(k),
                     dispersion.omega(k));
        }
    }
    return mean.root();
}

template <class T>
double breaking_rate(const Trains<T>& trains, double k_end) {
    MeanSquare mean;
    for (std::size_t i = 0; i < trains.count(); ++i) {
        if (!(kTwoPi / trains.wavelength_m[i] < k_end)) continue;
        const SpectralMoments& own = trains.alone[i];
        mean.add(own.xxxx + 2.0 * own.xxyy + own.yyyy, kTwoPi * trains.cycles_per_s[i]);
    }
    return mean.root();
}

template double breaking_rate(const Trains<float>&, double);
template double breaking_rate(const Trains<double>&, double);

}  // namespace pelagic
