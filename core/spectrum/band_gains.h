// Gains of amplitudes by wavelength: waves.band_gains.
#pragma once

#include <span>
#include <vector>

#include "pelagic/scene.h"

namespace pelagic {

// Each band's gain counts whole between its edges and not at all outside them. About an edge, where half of it counts, it goes
// from one to the other by a quintic in ln λ, a third of an octave wide (a narrower band never has its whole gain): twice
// differentiable. Where bands overlap, gains multiply.
class BandGains {
  public:
    BandGains() = default;
    explicit BandGains(std::span<const BandGain> bands) : bands_(bands.begin(), bands.end()) {}

    bool empty() const { return bands_.empty(); }
    double of_energy(double k) const;   // the square of the amplitudes' gain at this wavenumber [rad/m]
    std::vector<double> kinks() const;  // wavenumbers where an edge begins or ends [rad/m]

  private:
    std::vector<BandGain> bands_;
};

}  // namespace pelagic
