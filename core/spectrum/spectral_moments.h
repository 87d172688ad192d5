// What the spectrum says about the sea between two wavenumbers: heights, periods, slopes, Jacobian.
//
// All are one radial integral, because the angular part of each is a Fourier coefficient of the spreading
// (∫ D e^{inθ} dθ, n = 1, 2, 4), known per wave system in closed form or by quadrature.
#pragma once

#include <array>
#include <glm/vec2.hpp>

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

    double east = 0.0, north = 0.0;  // ∬ Ψ k/|k| [m²]: where the energy travels

    double mss() const { return xx + yy; }
    double significant_height_m() const;
    double energy_period_s() const;  // Tm−1,0; 0 for an empty band
    double mean_direction() const;   // arg ∬ Ψ e^{iθ} [rad], towards; 0 for an empty band

    // Adds another band's waves.
    SpectralMoments& operator+=(const SpectralMoments& other);
    // All moments of waves whose energy is `factor` times as large.
    SpectralMoments& operator*=(double factor);
    // Multiplies the moments of the displacement gradient alone; choppiness λ is a factor of λ².
    SpectralMoments& scale_gradients(double factor);
    // Replaces the moments of the displacement gradient by those of other waves.
    SpectralMoments& take_gradients(const SpectralMoments& other);
};

// Every moment, for loops that treat all alike.
inline constexpr std::array<double SpectralMoments::*, 12> kSpectralMoments{
    &SpectralMoments::m0,   &SpectralMoments::m_minus1, &SpectralMoments::xx,   &SpectralMoments::xy,
    &SpectralMoments::yy,   &SpectralMoments::xxxx,     &SpectralMoments::xxxy, &SpectralMoments::xxyy,
    &SpectralMoments::xyyy, &SpectralMoments::yyyy,     &SpectralMoments::east, &SpectralMoments::north};

inline SpectralMoments& SpectralMoments::operator+=(const SpectralMoments& other) {
    for (double SpectralMoments::*m : kSpectralMoments) this->*m += other.*m;
    return *this;
}
inline SpectralMoments& SpectralMoments::operator*=(double factor) {
    for (double SpectralMoments::*m : kSpectralMoments) this->*m *= factor;
    return *this;
}
inline SpectralMoments& SpectralMoments::scale_gradients(double factor) {
    for (double* m : {&xxxx, &xxxy, &xxyy, &xyyy, &yyyy}) *m *= factor;
    return *this;
}

inline SpectralMoments& SpectralMoments::take_gradients(const SpectralMoments& other) {
    for (const auto m : {&SpectralMoments::xxxx, &SpectralMoments::xxxy, &SpectralMoments::xxyy,
                         &SpectralMoments::xyyy, &SpectralMoments::yyyy})
        this->*m = other.*m;
    return *this;
}

// One sinusoidal wave.
struct Wave {
    glm::dvec2 k{0.0};    // [rad/m], not 0
    double energy = 0.0;  // its part of m0 [m²]: half its amplitude squared
    double omega = 0.0;   // [rad/s]
    double chop = 0.0;    // horizontal amplitude over k times the vertical one: choppiness · coth(kd)/k [m]
};
SpectralMoments moments_of(const Wave& wave);

// The moments of k_lo ≤ k < k_hi [rad/m]; k_hi may be infinite. Relative error below 1e-6.
SpectralMoments moments(const DirectionalSpectrum& spectrum, double k_lo, double k_hi);

}  // namespace pelagic
