// Elfouhaily, Chapron, Katsaros & Vandemark 1997 (JGR 102 C7, 15781): one spectrum from swell to capillaries.
//
//   S_k = (B_l + B_h)/k³                                                                       (Eq. 30)
//   B_l = ½ α_p (c_p/c) L_PM J_p exp(−(Ω/√10)(√(k/k_p) − 1)),  α_p = 6e-3 √Ω                   (Eq. 31–34)
//   B_h = ½ α_m (c_m/c) L_PM J_p exp(−¼ (k/k_m − 1)²)                                          (Eq. 40, 41, 44)
//   L_PM = exp(−1.25 (k_p/k)²),  J_p = γ^exp(−(√(k/k_p) − 1)²/(2δ²)),  δ = 0.08 (1 + 4 Ω⁻³)    (Eq. 2, 3)
//   Ω = 0.84 tanh((X/2.2e4)^0.4)^−0.75,  X = g F/U²,  k_p = (g/U²) Ω²                          (Eq. 4, 37)
//
// L_PM belongs in B_h too (the paper's Eq. 40 leaves it to the reader): without it Hs at 10 m/s is 88 m, with
// it 2.6 m. The paper is about deep water, and c here is deep water's; depth changes the frequencies and not
// the heights. The friction velocity, which the paper takes as given, is u* = √(C10) U, C10 = (0.8 + 0.065 U)
// 1e-3 (Wu 1982).
//
// Spreading, Eq. 49 and 57: Δ = tanh(a0 + a_p (c/c_p)^2.5 + a_m (c_m/c)^2.5), a0 = ln2/4, a_p = 4, a_m = 0.13
// u*/c_m; see SecondHarmonic for the sense of travel.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/spectrum/angular.h"
#include "core/spectrum/dispersion.h"

namespace pelagic {

namespace elfouhaily {

inline constexpr double kCapillaryWavenumber = 370.0;  // k_m, rad/m
inline constexpr double kCapillarySpeed = 0.23;        // c_m, m/s

// c [m/s] in deep water, as the paper has it (Eq. 24).
inline double phase_speed(double k) {
    const double r = k / kCapillaryWavenumber;
    return std::sqrt(kGravity / k * (1.0 + r * r));
}

inline double friction_velocity(double wind_speed_mps) {
    return std::sqrt((0.8 + 0.065 * wind_speed_mps) * 1e-3) * wind_speed_mps;
}

// Ω, the inverse wave age U/c_p: 0.84 when fully developed.
inline double inverse_wave_age(double wind_speed_mps, double fetch_m) {
    const double reduced_fetch = kGravity * fetch_m / (wind_speed_mps * wind_speed_mps);
    return 0.84 * std::pow(std::tanh(std::pow(reduced_fetch / 2.2e4, 0.4)), -0.75);
}

}  // namespace elfouhaily

struct Elfouhaily {
    double age;  // Ω
    double k_p;  // rad/m
    double c_p;  // m/s
    double ln_gamma;
    double inverse_2delta2;
    double alpha_p, alpha_m;

    Elfouhaily(double wind_speed_mps, double fetch_m)
        : Elfouhaily(wind_speed_mps, Age{elfouhaily::inverse_wave_age(wind_speed_mps, fetch_m)}) {}

    // Under waves of any inverse wave age.
    struct Age {
        double value;
    };
    Elfouhaily(double wind_speed_mps, Age inverse_wave_age)
        : age(inverse_wave_age.value),
          k_p(kGravity / (wind_speed_mps * wind_speed_mps) * age * age),
          c_p(elfouhaily::phase_speed(k_p)) {
        // γ is given for Ω up to 5 (Eq. 3): younger seas keep its value there.
        ln_gamma = std::log(age < 1.0 ? 1.7 : 1.7 + 6.0 * std::log10(std::min(age, 5.0)));
        const double delta = 0.08 * (1.0 + 4.0 / (age * age * age));
        inverse_2delta2 = 0.5 / (delta * delta);
        alpha_p = 6e-3 * std::sqrt(age);
        // Eq. 44; below u* = c_m/e (3 m/s of wind) the logarithm would make the capillaries' energy negative.
        const double reduced =
            std::log(elfouhaily::friction_velocity(wind_speed_mps) / elfouhaily::kCapillarySpeed);
        alpha_m = 1e-2 * std::max(0.0, 1.0 + (reduced > 0.0 ? 3.0 : 1.0) * reduced);
    }

    // Under the same wind, the peak's frequency `ratio` of this one's.
    Elfouhaily aged(double ratio) const { return {std::sqrt(kGravity * age * age / k_p), Age{age * ratio}}; }

    // S_k [m³] at k > 0 [rad/m].
    double density_k(double k) const {
        const double root = std::sqrt(k / k_p);
        const double peaked = std::exp(-1.25 * (k_p / k) * (k_p / k) +
                                       ln_gamma * std::exp(-(root - 1.0) * (root - 1.0) * inverse_2delta2));
        const double long_waves = alpha_p * c_p * std::exp(-age / std::sqrt(10.0) * (root - 1.0));
        const double from_capillary = k / elfouhaily::kCapillaryWavenumber - 1.0;
        const double short_waves =
            alpha_m * elfouhaily::kCapillarySpeed * std::exp(-0.25 * from_capillary * from_capillary);
        return 0.5 * peaked * (long_waves + short_waves) / (elfouhaily::phase_speed(k) * k * k * k);
    }

    double peak_wavenumber() const { return k_p; }
};

struct ElfouhailySpreading {
    double c_p;  // m/s
    double a_m;

    ElfouhailySpreading(double wind_speed_mps, double peak_speed_mps)
        : c_p(peak_speed_mps),
          a_m(0.13 * elfouhaily::friction_velocity(wind_speed_mps) / elfouhaily::kCapillarySpeed) {}

    SecondHarmonic at_wavenumber(double k) const {
        const double c = elfouhaily::phase_speed(k);
        return SecondHarmonic(std::tanh(0.25 * std::numbers::ln2 + 4.0 * std::pow(c / c_p, 2.5) +
                                        a_m * std::pow(elfouhaily::kCapillarySpeed / c, 2.5)));
    }
};

}  // namespace pelagic
