// JONSWAP: the sea that a wind raises over a limited fetch.
//
//   S(ω) = α g² ω⁻⁵ exp(−5/4 (ωp/ω)⁴) γ^exp(−(ω − ωp)² / (2 σ² ωp²)),  σ = 0.07 (ω ≤ ωp), 0.09 above
//                                                                       (Hasselmann et al. 1973, §2)
// The shape is theirs. Its parameters are a choice:
//
//   Jonswap      heights and peaks of the growth law that later measurements agree on,
//                  ε̃ = 5.2e-7 X̃^0.9,  ω̃p = 13.7 X̃^−0.27,  ε̃ = m0 g²/U⁴,  ω̃ = ω U/g,  X̃ = g F/U²   (Kahma & Calkoen 1992)
//                each up to Pierson & Moskowitz', which they reach at X̃ = 1.5e4 and 2.9e4. γ falls from 3.3 to 1 on the way to
//                Pierson & Moskowitz' peak, by 6 a decade of wave age (Donelan, Hamilton & Hui 1985, their slope); α follows.
//   JonswapByHeight  the heights alone: up to X̃ = 1.5e4 γ falls likewise, α falls to Pierson & Moskowitz' 8.1e-3 as X̃^−0.22 (the
//                exponent of 1973), and the peak follows from all three: up to a third too long before that fetch. So it was
//                before edition 2.
//   Jonswap1973  as printed:
//                  α = 0.076 X̃^−0.22,  ωp = 22 (g²/(U F))^⅓,  γ = 3.3
//                Its Hs at 14 m/s and 300 km is 5.3 m, where the growth law has 4.4. Taken at its word, 10 000 km of fetch
//                make a sea of 37 m: growth stops where the peak reaches that of the fully developed sea, and the fetch at
//                which it does so is used for α too.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "core/spectrum/gauss.h"
#include "core/spectrum/pierson_moskowitz.h"

namespace pelagic {

struct JonswapShape {
    static constexpr double kLnSharpest = 1.1939224684724346;  // γ = 3.3
    static constexpr double kSigmaBelow = 0.07;
    static constexpr double kSigmaAbove = 0.09;

    double alpha;
    double omega_p;  // rad/s
    double ln_gamma;

    // S [m² s] at ω > 0 [rad/s].
    double density(double omega) const {
        const double r = omega_p / omega;
        const double off_peak = (omega - omega_p) / ((omega > omega_p ? kSigmaAbove : kSigmaBelow) * omega_p);
        return alpha * kGravity * kGravity / fifth_power(omega) *
               std::exp(-1.25 * (r * r) * (r * r) + ln_gamma * std::exp(-0.5 * off_peak * off_peak));
    }

    double peak_omega() const { return omega_p; }
};

// ∫S dω over α g²/ωp⁴: ⅕ for γ = 1.
inline double jonswap_unit_m0(double ln_gamma) {
    const JonswapShape unit{1.0 / (kGravity * kGravity), 1.0, ln_gamma};
    double peaked = 0.0;  // what γ adds, within a few σ of the peak
    for (const auto& [from, to] : {std::array{0.3, 0.75}, {0.75, 1.0}, {1.0, 1.3}, {1.3, 1.9}})
        peaked += GaussLegendre<16>::rule().integrate(from, to, [&](double omega) {
            return unit.density(omega) - JonswapShape{unit.alpha, 1.0, 0.0}.density(omega);
        });
    return 0.2 + peaked;
}

// Kahma & Calkoen's composite data.
namespace growth {

inline constexpr double kEnergy = 5.2e-7, kEnergyExponent = 0.9;
inline constexpr double kPeak = 13.7, kPeakExponent = 0.27;
inline constexpr double kGammaPerDecade = 6.0;  // of wave age
// At fetches far below those measured (a metre) waves would be steeper than they can be.
inline constexpr double kLargestAlpha = 0.03;

// X̃ at which the height is Pierson & Moskowitz'.
inline double developed_fetch(double wind_speed_mps) {
    const double square = wind_speed_mps * wind_speed_mps / kGravity;
    return std::pow(PiersonMoskowitz(wind_speed_mps).m0() / (kEnergy * square * square),
                    1.0 / kEnergyExponent);
}

// m0 [m²] at X̃.
inline double m0(double wind_speed_mps, double fetch) {
    const double square = wind_speed_mps * wind_speed_mps / kGravity;
    return kEnergy * std::pow(fetch, kEnergyExponent) * square * square;
}

}  // namespace growth

struct Jonswap : JonswapShape {
    Jonswap(double wind_speed_mps, double fetch_m) {
        const double fetch = kGravity * fetch_m / (wind_speed_mps * wind_speed_mps);  // X̃
        const double peak =
            growth::kPeak * std::pow(fetch, -growth::kPeakExponent) * kGravity / wind_speed_mps;
        const double developed_peak = PiersonMoskowitz(wind_speed_mps).peak_omega();
        omega_p = std::max(peak, developed_peak);
        ln_gamma = std::min(std::log(1.0 + growth::kGammaPerDecade * std::log10(omega_p / developed_peak)),
                            kLnSharpest);
        const double m0 =
            growth::m0(wind_speed_mps, std::min(fetch, growth::developed_fetch(wind_speed_mps)));
        const double unit = kGravity * kGravity * jonswap_unit_m0(ln_gamma);
        const double square = omega_p * omega_p;
        alpha = std::min(m0 * square * square / unit, growth::kLargestAlpha);
        if (alpha == growth::kLargestAlpha) omega_p = std::sqrt(std::sqrt(alpha * unit / m0));
    }
};

struct JonswapByHeight : JonswapShape {
    JonswapByHeight(double wind_speed_mps, double fetch_m) {
        constexpr double kFetchExponent = 0.22;
        const double developed = growth::developed_fetch(wind_speed_mps);
        const double fetch = std::min(kGravity * fetch_m / (wind_speed_mps * wind_speed_mps), developed);
        const double gamma =
            1.0 + growth::kGammaPerDecade * growth::kPeakExponent * std::log10(developed / fetch);
        ln_gamma = std::min(std::log(gamma), kLnSharpest);
        alpha = std::min(PiersonMoskowitz::kAlpha * std::pow(developed / fetch, kFetchExponent),
                         growth::kLargestAlpha);
        const double m0 = growth::m0(wind_speed_mps, fetch);
        omega_p = std::sqrt(std::sqrt(alpha * kGravity * kGravity * jonswap_unit_m0(ln_gamma) / m0));
    }
};

struct Jonswap1973 : JonswapShape {
    static constexpr double kDevelopedPeak = 0.877;  // ωp U19.5 / g of Pierson & Moskowitz

    Jonswap1973(double wind_speed_mps, double fetch_m) {
        const double effective_m = std::min(fetch_m, developed_fetch_m(wind_speed_mps));
        alpha = 0.076 * std::pow(wind_speed_mps * wind_speed_mps / (effective_m * kGravity), 0.22);
        omega_p = 22.0 * std::cbrt(kGravity * kGravity / (wind_speed_mps * effective_m));
        ln_gamma = kLnSharpest;
    }

    // The fetch [m] at which the sea is fully developed.
    static double developed_fetch_m(double wind_speed_mps) {
        const double developed_omega = kDevelopedPeak * kGravity / (kU195OverU10 * wind_speed_mps);
        return kGravity * kGravity / (wind_speed_mps * std::pow(developed_omega / 22.0, 3));
    }
};

}  // namespace pelagic
