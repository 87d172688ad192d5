// A real sea: one hour of a directional buoy as energy law and spreading.
//
// Energy. Each bin is the mean density of a band [e_i, e_i+1] (bin_edges). Within it a parabola through the edges'
// values carries exactly density × bandwidth (after Colella & Woodward 1984, §1, with the edge values interpolated
// between the neighbours' means, and flattened where it would go negative). A buoy prints densities in steps of 0.01
// m²/Hz: beyond the last bin ≥ 0.02 there is mostly rounding. From that bin's upper edge on the spectrum is a tail A
// f⁻ⁿ. n is fitted by least squares in the logarithms to the last bins ≥ 0.05 above 1.5 fp, and kept within 4
// (equilibrium range, Toba 1973) and 5 (saturation range, Phillips 1958). A gives the tail the energy of the bins
// that it replaces, but stays within a factor 3 of continuing the last three bins before it. Beyond the buoy's band n
// = 5. Finally all is scaled so that ∫ over the buoy's band is Σ density × bandwidth: NDBC's Hs. What lies beyond the
// band comes on top.
//
// Direction. Each band has the maximum-entropy density of its bin's c1 and c2, so that each bin's mean direction
// comes back as measured. A bin without a direction takes coefficients interpolated between its neighbours' (valid
// ones are a convex set, so that these are valid too), at the ends its only neighbour's. The tail has the mean, by
// energy, of the bins that it replaces, or of the last three before it if those are empty.
#pragma once

#include <vector>

#include "core/spectrum/angular.h"
#include "pelagic/scene.h"

namespace pelagic {

// The edges [Hz] of the bins' bands, one more than bins. NDBC's archive gives centres only: 0.005 Hz apart at
// first, then 0.01 and 0.02. Bands that touch and have the given centres, e_{i+1} = 2 f_i − e_i, are
// determined but for one number; it is the one with which most edges lie midway between centres, and that
// recovers NDBC's own 0.005, 0.01 and 0.02. Where no such bands exist the edges are midway.
std::vector<double> bin_edges(const MeasuredSpectrum& measured);

// Σ density × bandwidth [m²], as the buoy's Hs counts it.
double binned_m0(const MeasuredSpectrum& measured);

class MeasuredEnergy {
  public:
    static constexpr double kReliableDensity =
        0.05;  // m²/Hz, five steps of the archive's rounding: good for a slope
    static constexpr double kLeastDensity = 0.02;  // m²/Hz, two steps: good for a sum

    // Throws std::invalid_argument when there are fewer than two bins, or frequencies that don't rise from
    // above 0, or a density that is negative or not a number.
    explicit MeasuredEnergy(const MeasuredSpectrum& measured);

    // S [m² s] at ω > 0 [rad/s].
    double density(double omega) const;

    double peak_omega() const { return peak_omega_; }  // centre of the fullest bin [rad/s]
    const std::vector<double>& edge_omegas() const { return edges_; }

  private:
    struct Band {
        double left, slope, bend;  // D(x) = left + x (slope + bend (1 − x)), x = 0 … 1 across the band
    };
    std::vector<double> edges_;  // rad/s, of the bands, then the end of the buoy's own
    std::vector<Band> bands_;
    double tail_amplitude_ = 0.0;  // density at the start of the tail
    double tail_exponent_ = 5.0;
    double peak_omega_ = 0.0;
};

class MeasuredSpreading {
  public:
    // A record without a single direction gets cos⁸(θ/2) about the wind.
    MeasuredSpreading(const MeasuredSpectrum& measured, double wind_direction_rad);

    const MaximumEntropy& at(double omega) const;

  private:
    std::vector<double> edges_;  // rad/s, upper ends of all bands but the tail's
    std::vector<MaximumEntropy> bands_;
};

}  // namespace pelagic
