// The sea to second order: what pairs of its waves add to the surface.
//
// Longuet-Higgins 1963 has the elevation over a place to second order in the waves' steepness, with two kernels of pairs,
//   η₂ = ¼ Σ_ij a_i a_j [K⁻ cos(ψ_i − ψ_j) + K⁺ cos(ψ_i + ψ_j)],
// in water of any depth as Sharma and Dean 1981 write them. Water that is displaced sideways has part of that already: a surface
// of points x + D, z has z₂ = η₂ + D·∇z over its points at rest, with the kernels
//   L^± = K^± ∓ cos θ (k_i coth(k_j d) + k_j coth(k_i d)).
// In deep water L⁺ is 0 where waves go the same way, and L⁻ is twice the smaller wavenumber: a group of waves stands higher than
// the displaced sum has it, so that crests are higher than troughs are deep.
#pragma once

#include <array>
#include <cstddef>

#include "core/spectrum/directional_spectrum.h"

namespace pelagic {

// L⁻ and L⁺ of two waves [rad/m], and what the displacement takes from K^± for them.
struct PairKernels {
    double difference = 0.0, sum = 0.0;  // L⁻, L⁺
    double displaced = 0.0;              // K^± = L^± ± this
};

// Wavenumbers > 0 [rad/m], directions [rad]; depth > 0, may be infinite.
PairKernels pair_kernels(double k1, double theta1, double k2, double theta2, double depth_m);

// Sums over the pairs of a spectrum, from which the second order of any band follows. Bins of wavenumbers hold the same energy each.
struct SecondOrder {
    static constexpr std::size_t kBins = 16;
    // Over pairs of a bin and another, of the products of both energies, each over m0:
    struct Sums {
        double difference = 0.0, sum = 0.0;    // L⁻, L⁺ [rad/m]
        double together = 0.0, against = 0.0;  // √(k_i k_j) (1 + cos θ), √(k_i k_j) (1 − cos θ) [rad/m]
        double shallow = 0.0;                  // √(q_i q_j), q: shallow_wavenumber()

        Sums& operator+=(const Sums& other);
    };
    std::array<double, kBins + 1> edges{};  // [rad/m], rising
    std::array<std::array<Sums, kBins>, kBins> pairs{};
    double deviation_m = 0.0;  // √m0

    // Bins first ≤ i, j < last.
    Sums sums(std::size_t first, std::size_t last) const;
    // E[η³]/m0^{3/2} of the elevation over a place (about its mean), before kLargestSkewness.
    double skewness() const;
    // What the second order is multiplied by so that its skewness isn't larger than kLargestSkewness: in shallow water it grows as
    // (kd)⁻³, and says nothing any more where it is as large as the first.
    double limit() const;

    static constexpr double kLargestSkewness = 0.6;
};

// Of a calm all is 0. Some milliseconds.
SecondOrder second_order(const DirectionalSpectrum& spectrum);

// 3 k (coth³ kd − coth kd): L⁺ of a wave with itself [rad/m], 0 in deep water.
double shallow_wavenumber(double k, double depth_m);

}  // namespace pelagic
