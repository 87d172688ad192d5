// Sunlight in clear air over the sea: what reaches the ground straight, and what is scattered on the way.
//
// A round earth under air, haze and ozone that depend on height alone; the light of a sun far away, absorbed
// and scattered by wavelength. The first scattering is integrated along the line of sight. All further ones
// are closed in the way of Hillaire 2020 ("A scalable and production ready sky and atmosphere rendering
// technique"): the second is gathered over all directions at each height and elevation of the sun, each later
// one is taken to be isotropic and, since what lights a place differs little from what lights its
// neighbourhood, the one before times one fraction f of the height; so that the sum of all is the geometric
// series 1/(1 − f).
//
// Values are by band (sunlight.h), as fractions of the sunlight outside: irradiance 1 gives radiance [1/sr].
// Heights and distances are in km, as the tables of air are.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "core/lighting/sunlight.h"

namespace pelagic {

class Atmosphere {
  public:
    // turbidity T: at 0.55 μm air and haze together have T times the optical thickness of air alone, ≥ 1.
    // The sun's elevation is that of the observer, at sea level.
    Atmosphere(double turbidity, double sun_elevation_rad);

    // What of the sunlight comes through to sea level from this elevation, ≥ 0, along the straight ray
    // (without refraction).
    BandValues transmittance(double elevation_rad) const;

    // Light scattered towards the sea from one direction. The first two are still to be multiplied with their
    // phase functions: without them they are smooth even at the sun.
    struct Scattered {
        BandValues by_air{}, by_haze{};  // once
        BandValues more{};               // more than once: radiance as it is
    };
    // From one elevation ≥ 0, for each of these azimuths from the sun's.
    std::vector<Scattered> scattered(double elevation_rad, std::span<const double> azimuths_rad) const;

    ~Atmosphere();

  private:
    class Tables;
    std::unique_ptr<const Tables> tables_;
};

// Phase functions [1/sr], of the cosine of the angle by which light is turned.
double air_phase(double cosine);
double haze_phase(double cosine);

}  // namespace pelagic
