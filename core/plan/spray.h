// Spray: droplets that bursting bubbles throw up, over the sea as a whole. Monahan et al. 1986, as Darles et al. 2007
// (§4.2) use it. A place's share of it follows from how much breaks there (core/effects/spray.h).
//
// A volume's density is its extinction. A flux isn't a density: the air holds as much as falls back in the same time. The
// source function's radii are those of droplets in air of 80 % humidity; it holds for 0.8 … 10 µm. Darles' Eq. 5 is
// misprinted (0.0057 for 0.057, e^{−B²} outside the exponent of 10, the logarithm's place in B); Eq. 6 counts the wind
// twice, since U10^3.41 is the coverage already: a place has the share s′/⟨s⟩ of what the law says.
#pragma once

#include <string>

#include "pelagic/scene.h"

namespace pelagic {

struct SprayLaw {
    static constexpr double kSmallest_um = 0.8, kLargest_um = 10.0;
    static constexpr double kScaleHeight_m = 2.0;    // of the profile exp(−z/H), z above the local surface
    static constexpr double kDeposition_mps = 0.01;  // concentration = flux / this
    static constexpr double kDroplet_kg_per_m3 = 1025.0;
    static constexpr double kExtinctionEfficiency = 2.0;  // Q_e of spheres much larger than the wavelength

    double number_flux_per_m2_s = 0.0;   // of droplets, upwards
    double mass_flux_kg_per_m2_s = 0.0;  // likewise
    double extinction_per_m = 0.0;       // at the surface, on average over the sea

    // Straight up through the whole layer, on average.
    double optical_thickness() const { return extinction_per_m * kScaleHeight_m; }
};

// dF/dr [1/(m² µm s)] at a radius of so many µm, > 0.
double spray_source(double wind_speed_mps, double radius_um);

// Nature's, at gain 1. All 0 without wind.
SprayLaw spray_law(double wind_speed_mps);

// The scene's: spray_gain times nature's, and none without spray or whitecaps.
SprayLaw spray_law(const Scene& scene);

// What an artist should know of it: that no picture shows it, and the gain from which on one does. Empty: nothing.
std::string spray_warning(const Scene& scene);

}  // namespace pelagic
