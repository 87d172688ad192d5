// Where the spectrum ends: the shortest ripples die of viscosity before wind can raise them.
//
// Gravity spectra (∝ ω⁻⁵) have a mean square slope that grows without end as shorter waves are counted. Every
// spectrum here is therefore multiplied by exp(−(k/k_ν)²). The wavenumber is ours: the damping rate 2νk²
// (Lamb 1932, §348) overtakes what a strong wind puts in at wavelengths of about a millimetre, so that 1e3 …
// 1e4 rad/m is the range to choose from. It is kept in a shot's record.
#pragma once

#include <cmath>

namespace pelagic {

inline constexpr double kViscousWavenumber = 6e3;  // rad/m, wavelength 1.05 mm

// Factor on the energy at wavenumber k [rad/m].
inline double viscous_cutoff(double k) {
    const double ratio = k / kViscousWavenumber;
    return std::exp(-ratio * ratio);
}

}  // namespace pelagic
