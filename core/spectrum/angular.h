// Shapes over direction: the densities D(θ), ∫ D dθ = 1, that the spreading laws choose from at each
// wavenumber.
//
// Each shape knows three things, all in θ measured from its own direction:
//   density(θ)      D [1/rad], for any θ;
//   cumulative(θ)   ∫₀^θ D, with cumulative(θ + 2π) = cumulative(θ) + 1, so that any arc is a difference;
//   harmonic(n)     ∫ D e^{inθ} dθ, n ≥ 0.
// And scale(), the angle [rad] over which D changes by a notable part of itself: how finely it must be
// sampled.
#pragma once

#include <array>
#include <cmath>
#include <complex>
#include <variant>

namespace pelagic {

// N cos²ˢ(θ/2), N = Γ(s + 1) / (2 √π Γ(s + ½))  (Longuet-Higgins, Cartwright & Smith 1963). s ≥ 0; 0 is
// isotropic.
class CosinePower {
  public:
    explicit CosinePower(double s);
    double density(double theta) const;
    double cumulative(double theta) const;
    std::complex<double> harmonic(int n) const;
    double scale() const { return std::sqrt(2.0 / (s_ + 0.1)); }  // standard deviation where s is large
    double sharpness() const { return s_; }
    double norm() const { return norm_; }

  private:
    double s_;
    double norm_;
};

// β sech²(βθ) / (2 tanh(βπ))  (Donelan, Hamilton & Hui 1985; the tanh makes it a density on the circle). β >
// 0.
class SechSquared {
  public:
    explicit SechSquared(double beta);
    double density(double theta) const;
    double cumulative(double theta) const;
    std::complex<double> harmonic(int n) const;
    double scale() const { return 0.8 / beta_; }
    double beta() const { return beta_; }
    double norm() const { return norm_; }

  private:
    double beta_;
    double norm_;  // 1 / (2 tanh(βπ))
};

// (2/π) cos²θ within ±90°, 0 outside  (Pierson, Neumann & James 1955).
class CosineSquared {
  public:
    double density(double theta) const;
    double cumulative(double theta) const;
    std::complex<double> harmonic(int n) const;
    double scale() const { return 1.0; }
};

// (1/2π) (1 + Δ cos 2θ) (1 + m(θ)), m = (3 cos θ − cos³ θ)/2, |Δ| ≤ 1.
//
// The first bracket is Elfouhaily et al. 1997, Eq. 49. It describes a frozen surface, which cannot tell a
// wave from its opposite, and would send half of the energy against the wind. m is odd under θ → θ + π, so
// that the sum of both senses, the integral and every slope variance stay the paper's, while the waves travel
// downwind.
class SecondHarmonic {
  public:
    explicit SecondHarmonic(double delta) : delta_(delta) {}
    double density(double theta) const;
    double cumulative(double theta) const;
    std::complex<double> harmonic(int n) const;
    double scale() const { return 0.5; }
    double delta() const { return delta_; }

  private:
    double delta_;
};

// The maximum-entropy density with the two given Fourier coefficients (Lygre & Krogstad 1986):
//   D = σ² / (2π |1 − φ1 e^{−iθ} − φ2 e^{−2iθ}|²),  φ1 = (c1 − c2 c1*)/(1 − |c1|²),  φ2 = c2 − c1 φ1,
//   σ² = 1 − φ1 c1* − φ2 c2*.
// A density with these coefficients exists only where |c2 − c1²| ≤ 1 − |c1|². Noise makes measured ones miss that,
// and at the limit D is a pair of needles. They are moved to the nearest of |c1| ≤ kMaxFirst, |c2 − c1²| ≤ kMaxSecond
// (1 − |c1|²).
class MaximumEntropy {
  public:
    static constexpr double kMaxFirst =
        0.995;  // r1 comes in steps of 0.01: a printed 1.00 may have been 0.995
    static constexpr double kMaxSecond = 0.95;  // keeps the needles some degrees wide

    MaximumEntropy(std::complex<double> c1, std::complex<double> c2);
    double density(double theta) const;
    double cumulative(double theta) const;
    std::complex<double> harmonic(int n) const;
    double scale() const;  // the distance of the nearest pole of D from the real axis
    double centre() const { return std::arg(c1_); }
    // ∫ D f(e^{iθ}) dθ of a function that is analytic within the unit circle.
    template <class F>
    std::complex<double> mean(F&& f) const {
        const Poles poles = find_poles();
        return poles.share * f(poles.first) + (1.0 - poles.share) * f(poles.second);
    }

    // D = numerator / (d0 + d1 cos θ + d2 sin θ + d3 cos 2θ + d4 sin 2θ).
    double numerator() const;
    std::array<double, 5> denominator() const;

  private:
    // ∫ D e^{inθ} dθ = share firstⁿ + (1 − share) secondⁿ, n ≥ 0; both within the unit circle.
    struct Poles {
        std::complex<double> first, second, share;
    };
    Poles find_poles() const;

    std::complex<double> phi1_, phi2_;
    double variance_;  // σ²
    std::complex<double> c1_;
};

// ∫ D e^{inθ} dθ for the n that the moments of slopes and displacement gradients need.
struct Harmonics {
    std::complex<double> first{}, second{}, fourth{};

    Harmonics scaled(double by) const { return {by * first, by * second, by * fourth}; }
    // Of the shape turned by that angle.
    Harmonics turned(double by) const {
        return {first * std::polar(1.0, by), second * std::polar(1.0, 2.0 * by),
                fourth * std::polar(1.0, 4.0 * by)};
    }
};

using AngularShape = std::variant<CosinePower, SechSquared, CosineSquared, SecondHarmonic, MaximumEntropy>;

}  // namespace pelagic
