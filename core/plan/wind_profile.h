// The wind at heights over the sea: logarithmic, u(z) = (u*/κ) ln(z/z0), over a roughness that grows with it, z0 = α u*²/g
// (Charnock 1955). For what the air carries.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/spectrum/dispersion.h"

namespace pelagic {

class WindProfile {
  public:
    // wind_speed_mps: at 10 m, ≥ 0.
    explicit WindProfile(double wind_speed_mps) {
        if (!(wind_speed_mps > 0.0)) return;
        // u* = κ U/ln(10/z0) changes slowly with z0: a step leaves 0.16 of the error at 5 m/s, 0.39 at 80.
        friction_mps_ = 0.04 * wind_speed_mps;
        for (int i = 0; i < 30; ++i)
            friction_mps_ = kKarman * wind_speed_mps / std::log(kReference_m / roughness_m());
    }

    double friction_mps() const { return friction_mps_; }
    double roughness_m() const { return kCharnock * friction_mps_ * friction_mps_ / kGravity; }
    // 0 below the roughness, and without wind.
    double at(double height_m) const {
        const double roughness = roughness_m();
        if (!(height_m > roughness) || !(friction_mps_ > 0.0)) return 0.0;
        return friction_mps_ / kKarman * std::log(height_m / roughness);
    }

    static constexpr double kKarman = 0.4;

  private:
    static constexpr double kCharnock = 0.0144;  // α over the open sea, as Garratt 1977 found it
    static constexpr double kReference_m = 10.0;

    double friction_mps_ = 0.0;
};

}  // namespace pelagic
