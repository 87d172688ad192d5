#include "core/spectrum/band_gains.h"

#include <algorithm>
#include <cmath>

#include "core/base/constants.h"

namespace pelagic {
namespace {

constexpr double kHalfEdge = 0.11552453009332421;  // ln 2 / 6: a sixth of an octave to either side

// 0 … 1 where λ passes this edge.
double passed(double wavelength_m, double edge_m) {
    const double x = std::clamp(0.5 + 0.5 * std::log(wavelength_m / edge_m) / kHalfEdge, 0.0, 1.0);
    return x * x * x * (10.0 - x * (15.0 - 6.0 * x));
}

}  // namespace

double BandGains::of_energy(double k) const {
    const double wavelength_m = kTwoPi / k;
    double gain = 1.0;
    for (const BandGain& band : bands_) {
        const double shortest_m = std::min(band.from_m, band.to_m),
                     longest_m = std::max(band.from_m, band.to_m);
        gain *= 1.0 + (band.gain - 1.0) * passed(wavelength_m, shortest_m) *
                          (1.0 - passed(wavelength_m, longest_m));
    }
    return gain * gain;
}

std::vector<double> BandGains::kinks() const {
    std::vector<double> kinks;
    for (const BandGain& band : bands_)
        for (const double edge_m : {band.from_m, band.to_m})
            for (const double side : {-kHalfEdge, kHalfEdge})
                kinks.push_back(kTwoPi / edge_m * std::exp(side));
    return kinks;
}

}  // namespace pelagic
