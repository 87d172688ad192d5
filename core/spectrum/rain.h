// Rain on the sea: sea.rain_mm_h.
//
// Drops make rings, which as a field are waves of some centimetres from all directions alike. Their spectrum, from a tank under
// artificial rain of R mm/h (Bliven, Sobieski & Craeye 1997; Lemaire, Bliven, Craeye & Sobieski 2002):
//
//   S(f) = S_p exp(−π (ln(f/f_p) f_p/Δf)²),  f_p = 5.772 − 0.0018 R Hz,  Δf = 4.42 + 0.0028 R Hz,  S_p = 6e-8 R^0.53 m² s
//
// The numbers are as later papers quote them; the tank's own papers weren't at hand. They give 1.2 mm of standard deviation and a
// mean square slope of 0.038 at 20 mm/h, what a wind of 7 m/s has.
//
// The drops also stir the water under the surface, and short waves lose their energy there: at the rate γ, 4 ν k² (Lamb
// 1932, §348) of the share of their orbits that lies in a layer δ deep, 1 − e^(−2kδ), with the eddies' viscosity ν in place of the
// water's. δ = 10 cm and ν = 1e-4 m²/s at 20 mm/h: a wave of 30 cm then dies in some seconds instead of minutes, as Nystuen
// (1990) has it. ν goes with the root of three of the rain's energy, as stirring does, so that from 100 mm/h on there is
// little difference (Peirson et al. 2013 saw none).
// What feeds these waves has to make up for their losses: β = 0.04 (u*/c)² ω of their energy without rain (Plant 1982), β + γ with
// it, so that 1/(1 + γ/β) of it stays. That is ours, as is the least of β, at u* = 0.05 m/s, by eye: a wind of 1.7 m/s, so that waves which have
// outrun their wind stay.
//
// Both are means over area. No ring is drawn alone, nor is what falls through the air.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/spectrum/angular.h"
#include "core/spectrum/elfouhaily.h"
#include "core/spectrum/wave_point.h"

namespace pelagic {

struct RainRings {
    double peak_hz, width_hz;
    double most;  // S at the peak [m² s]

    explicit RainRings(double rain_mm_h)
        : peak_hz(5.772 - 0.0018 * rain_mm_h),
          width_hz(4.42 + 0.0028 * rain_mm_h),
          most(6e-8 * std::pow(rain_mm_h, 0.53)) {}

    // By angular frequency [m² s], at ω > 0 [rad/s].
    double density(double omega) const {
        const double x = std::log(omega / peak_omega()) * peak_hz / width_hz;
        return most / (2.0 * std::numbers::pi) * std::exp(-std::numbers::pi * x * x);
    }
    double peak_omega() const { return 2.0 * std::numbers::pi * peak_hz; }
};

struct IsotropicSpreading {
    CosinePower at(double) const { return CosinePower(0.0); }
};

// What rain leaves of the energy of a wind's waves.
class RainDamping {
  public:
    RainDamping(double rain_mm_h, double wind_speed_mps) : eddies_m2_s_(1e-4 * std::cbrt(rain_mm_h / 20.0)) {
        constexpr double kLeastFriction_mps = 0.05;
        const double friction = std::max(elfouhaily::friction_velocity(wind_speed_mps), kLeastFriction_mps);
        input_m2_s2_ = 0.04 * friction * friction;
    }

    // 0 … 1. With c = ω/k the loss over the input is 4 ν ω (1 − e^(−2kδ))/(0.04 u*²).
    double of_energy(const WavePoint& point) const {
        constexpr double kLayer_m = 0.1;
        const double loss = -4.0 * eddies_m2_s_ * point.omega * std::expm1(-2.0 * point.k * kLayer_m);
        return 1.0 / (1.0 + loss / input_m2_s2_);
    }

  private:
    double eddies_m2_s_, input_m2_s2_ = 0.0;
};

}  // namespace pelagic
