// The reference for core/spectrum/cell_energies: the energy of one cell of the wavevector grid from the
// spectrum's own formulas, each arc in closed form.
//
// A swell of 11 s sits at mode 2 of a 400 m tile: its whole spectrum fits between two samples. So near the
// origin, and where the edge of a cascade's band or a kink of the spectrum crosses the cell, the integral is
// done in polar coordinates with the exact arc of the rectangle at each radius; elsewhere by a 3 × 3 Gauss
// product.
#pragma once

#include <limits>

#include "core/spectrum/directional_spectrum.h"

namespace pelagic::oracle {

struct Cell {
    double kx0 = 0.0, kx1 = 0.0, ky0 = 0.0, ky1 = 0.0;                  // rad/m, kx0 ≤ kx1, ky0 ≤ ky1
    double k_lo = 0.0, k_hi = std::numeric_limits<double>::infinity();  // the band k_lo ≤ |k| < k_hi
};

// ∬ Ψ d²k over the rectangle within the band [m²], ≥ 0. The cells of a grid add up to the band's m0 within
// 1e-4.
double cell_energy(const DirectionalSpectrum& spectrum, const Cell& cell);

}  // namespace pelagic::oracle
