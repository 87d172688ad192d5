// Which waves of a spectrum stand at a share of its energy: the inverse of the cumulated energy, over wavenumbers and
// over directions.
#pragma once

#include <vector>

#include "core/spectrum/directional_spectrum.h"

namespace pelagic {

// The waves k_lo ≤ k < k_hi.
class EnergyShares {
  public:
    EnergyShares(const DirectionalSpectrum& spectrum, double k_lo, double k_hi);
    double energy() const { return energy_; }  // [m²]
    // The quadrature node at which the cumulated energy reaches `share`, in [0, 1) [rad/m]. Requires energy() > 0.
    double wavenumber(double share) const;

  private:
    struct Node {
        double k, sum;
    };
    double energy_ = 0.0;
    std::vector<Node> nodes_;
};

// The direction up to which, counted from −π, the waves of wavenumber k have this share of their energy [rad].
double direction_of_share(const DirectionalSpectrum& spectrum, double k, double share);

}  // namespace pelagic
