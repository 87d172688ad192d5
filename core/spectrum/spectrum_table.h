// A DirectionalSpectrum as polynomials, for loops that ask it millions of times.
//
// Between two kinks every law is smooth, so that in a panel at most 9 % wide each system's S_k/k and the
// parameter of its spreading are polynomials of degree 7 in k, through the Chebyshev nodes. S_k D is right to
// 3e-6 of itself (1e-3 in a gale on a metre of fetch) or, where it is small, to 1e-6 of the largest k S_k,
// over k. What depends on direction stays a closed form in cos θ and sin θ. No trigonometry, no dispersion
// relation and no power of ω is left for the loop.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/spectrum/directional_spectrum.h"

namespace pelagic {

// One wave system's part of Ψ(k, θ) = a(k) f(θ − direction; b(k)) in a panel; a and b are polynomials in
// t = (k − middle)/half width, lowest power first.
struct TableTerm {
    static constexpr int kCoefficients = 8;

    std::size_t shape;  // index into AngularShape, which f follows from
    double cos_direction, sin_direction;
    std::array<double, kCoefficients> amplitude{};  // S_k/k times the shape's norm [m⁴/rad]
    std::array<double, kCoefficients> parameter{};  // CosinePower's s, SechSquared's β, SecondHarmonic's Δ
    std::array<double, 5> denominator{};            // MaximumEntropy's, whose parameters are the panel's own
    double directionality = 1.0;                    // above 1: f is narrowed about the direction (directed.h)
};

struct TablePanel {
    double k_lo = 0.0, k_hi = 0.0;  // [rad/m]
    // How narrow the spectrum is here: 1 where it changes over 8° or 14 % of k or more slowly, less in
    // proportion.
    double width = 1.0;
    std::size_t first_term = 0, terms = 0;
};

class SpectrumTable {
  public:
    explicit SpectrumTable(const DirectionalSpectrum& spectrum);

    // Rising and touching; none for an empty sea. Outside of them Ψ is 0.
    std::span<const TablePanel> panels() const { return panels_; }
    std::span<const TableTerm> terms(const TablePanel& panel) const {
        return {terms_.data() + panel.first_term, panel.terms};
    }
    // Wavenumbers, rising, where Ψ has a kink or a jump, the ends of the panels included.
    std::span<const double> kinks() const { return kinks_; }

  private:
    std::vector<TablePanel> panels_;
    std::vector<TableTerm> terms_;
    std::vector<double> kinks_;
};

}  // namespace pelagic
