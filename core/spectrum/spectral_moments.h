// What the spectrum says about the sea between two wavenumbers: heights, periods, slopes, Jacobian.
//
// All are one radial integral, because the angular part of each is a Fourier coefficient of the spreading
// (∫ D e^{inθ} dθ, n = 1, 2, 4), known per wave system in closed form or by quadrature.
#pragma once

#include "core/spectrum/directional_spectrum.h"

namespace pelagic {

struct SpectralMoments {
    double m0 = 0.0;        // ∬ Ψ [m²]; Hs = 4 √m0
    double m_minus1 = 0.0;  // ∬ Ψ / ω [m² s]; Tm−1,0 = 2π m_minus1 / m0

    // Slope (co)variances ∬ Ψ kp kq [-]; their trace is the mean square slope.
    double xx = 0.0, xy = 0.0, yy = 0.0;

    // ∬ Ψ coth²(kd) kp kq kr ks / k² [-]: the (co)variances of the horizontal displacement's derivatives at
    // choppiness 1, ⟨Dxx²⟩ = xxxx, ⟨Dxx Dxy⟩ = xxxy, ⟨Dxx Dyy⟩ = ⟨Dxy²⟩ = xxyy, …; choppiness λ multiplies
    // each by λ².
    double xxxx = 0.0, xxxy = 0.0, xxyy = 0.0, xyyy = 0.0, yyyy = 0.0;

    double mean_direction = 0.0;  // arg ∬ Ψ e^{iθ} [rad], towards; 0 for an empty band

    double mss() const { return xx + yy; }
    double significant_height_m() const;
    double energy_period_s() const;  // Tm−1,0; 0 for an empty band
};

// The moments of k_lo ≤ k < k_hi [rad/m]; k_hi may be infinite. Relative error below 1e-6.
SpectralMoments moments(const DirectionalSpectrum& spectrum, double k_lo, double k_hi);

}  // namespace pelagic
