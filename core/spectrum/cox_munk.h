// Cox & Munk 1954: slope variances of a clean sea surface, measured in the sun's glitter.
//
//   σ²_up = 3.16e-3 U,  σ²_cross = 3e-3 + 1.92e-3 U,  total 3e-3 + 5.12e-3 U (± 4e-3),  U at 41 ft = 12.5 m
//
// up: along the wind; the published total is a fit of its own, a little more than the sum.
#pragma once

#include <cmath>

namespace pelagic {

struct CoxMunk {
    double up = 0.0, cross = 0.0, total = 0.0;

    static constexpr double kScatter = 4e-3;  // of the total

    // From the wind [m/s] 10 m above the sea.
    static CoxMunk at_wind(double u10_mps) {
        const double u = wind_at_12_5_m(u10_mps);
        return {3.16e-3 * u, 3e-3 + 1.92e-3 * u, 3e-3 + 5.12e-3 * u};
    }

    // A neutral log profile over the sea, U(z) = (u*/0.4) ln(z/z0), with the drag of Wu 1982: u*/U10 =
    // √(C10).
    static double wind_at_12_5_m(double u10_mps) {
        const double drag = (0.8 + 0.065 * u10_mps) * 1e-3;
        constexpr double kKarman = 0.4;
        return u10_mps * (1.0 + std::sqrt(drag) / kKarman * std::log(12.5 / 10.0));
    }
};

}  // namespace pelagic
