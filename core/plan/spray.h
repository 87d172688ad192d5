// Spray: droplets over a sea that breaks, over the sea as a whole. A place's share of it follows from how much breaks there
// (core/effects/spray.h). A volume's density is its extinction. A flux isn't a density: the air holds as much as falls back in
// the same time.
//
// andreas-1998: film and jet drops by Smith, Park and Consterdine 1993, carried on to spume, which the wind tears off crests
// (Andreas 1998). r80, by which a source function counts, is a drop's radius when it has come to rest with air of 80 % humidity; over
// the crest that it comes from it still has r0, 0.518 r0^0.976 = r80 (Fitzgerald 1975), and is that large to light. It takes drops of
// r80 = 10 … 250 µm: smaller ones are haze of the whole air. They fall by Schiller and Naumann 1933, and are mixed by turbulence: v_d =
// v_s/(1 − e^{−v_s/v_t}), v_t = u*²/U, falls off as min(1, (z/h)^{−v_s/κu*}) over h = Hs/4, and counts up to h + 20 m. Published source
// functions differ by orders of magnitude: hence the gain. Smith's winds end at 32 m/s; what blows harder makes as much.
//
// monahan-1986: the bubbles' alone, 0.8 … 10 µm, as Darles et al. 2007 (§4.2) use it. Darles' Eq. 5 is misprinted (0.0057 for
// 0.057, e^{−B²} outside the exponent of 10, the logarithm's place in B); Eq. 6 counts the wind twice, since U10^3.41 is the
// coverage already: a place has the share s′/⟨s⟩ of what the law says.
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <string>

#include "pelagic/scene.h"

namespace pelagic {

// exp(−z/scale), z above the local surface.
struct SprayLayer {
    double extinction_per_m = 0.0;  // at the surface, on average over the sea
    double scale_m = 1.0;

    // Straight up, on average.
    double optical_thickness() const { return extinction_per_m * scale_m; }
};

// Of three heights above the local surface, linear between them, and none at a fourth. Where the surface falls off in front of the crest that they
// come from ribbons stay up, by a lift: they begin so much above it, and fade below that over half of the lift. Straight up they are as thick as without.
struct SprayRibbons {
    static constexpr std::array kHeights{0.0, 1.0, 2.5, 5.0};  // in steps
    static constexpr double kMostLift = 3.0;                   // in steps

    glm::dvec3 extinction_per_m{0.0};  // at three heights, on average over the sea
    double step_m = 1.0;

    // The mean over [from_m, to_m] above the surface, below which there is none, of one with these extinctions and that lift.
    double mean(glm::dvec3 extinctions, double from_m, double to_m, double lift_m = 0.0) const;
    // What is left of such extinctions, since it is thinner where it fades below.
    static double thinned(glm::dvec3 extinctions, double lift_steps);
    // Straight up, on average.
    double optical_thickness() const { return mean(extinction_per_m, 0.0, top_m()) * top_m(); }
    double top_m() const { return (kHeights.back() + kMostLift) * step_m; }
};

// Drops so large that each flies by itself: it falls, and takes a moment to reach the wind's speed.
struct SprayDropsLaw {
    static constexpr double kSmallest_um =
        37.5;  // r80: as spume, which they nearly all are, they fall by 0.4 m/s or more

    double optical_thickness = 0.0;     // straight up, on average
    std::array<double, 16> radii_um{};  // over the crest, rising: each stands for as much of that thickness
};

struct SprayLaw {
    static constexpr double kDroplet_kg_per_m3 = 1025.0;
    static constexpr double kExtinctionEfficiency = 2.0;  // Q_e of spheres much larger than the wavelength

    double number_flux_per_m2_s = 0.0;   // of droplets, upwards
    double mass_flux_kg_per_m2_s = 0.0;  // likewise
    // monahan-1986: over what breaks. andreas-1998: ribbons behind crests, and haze everywhere, whose extinctions and thicknesses add up to the law's.
    SprayLayer over_foam{};
    SprayRibbons ribbons{};
    SprayLayer haze{};
    SprayDropsLaw drops{};  // with effects.spray_drops; what they have, the ribbons lack

    bool is_torn() const { return ribbons.extinction_per_m.x > 0.0; }
    double extinction_per_m() const {
        return over_foam.extinction_per_m + ribbons.extinction_per_m.x + haze.extinction_per_m;
    }
    double optical_thickness() const {
        return over_foam.optical_thickness() + ribbons.optical_thickness() + haze.optical_thickness() +
               drops.optical_thickness;
    }
    // By which ribbons would be thicker if the drops were in them.
    double with_drops() const {
        return drops.optical_thickness > 0.0 ? 1.0 + drops.optical_thickness / ribbons.optical_thickness()
                                             : 1.0;
    }
};

// How fast a drop of this radius falls in air that rests [m/s].
double settling_mps(double radius_um);

// dF/dr [1/(m² µm s)] at a radius of so many µm, > 0: r80, for andreas-1998 10 … 250.
double spray_source(SpraySource source, double wind_speed_mps, double radius_um);

// Nature's, at gain 1. All 0 without wind, and andreas-1998 in less than 8 m/s: the wind tears crests from 9 on (Monahan et al. 1986).
// `has_drops`: the large drops by themselves, where the law has any.
SprayLaw spray_law(SpraySource source, double wind_speed_mps, double significant_height_m,
                   bool has_drops = false);

// The scene's: spray_gain times nature's, and none without spray or whitecaps. Of which waves: extent.h has their height.
SprayLaw spray_law(const Scene& scene, double significant_height_m);
bool has_spray(const Scene& scene);

// What an artist should know of it: that no picture shows it, and the gain from which on one does. Empty: nothing.
std::string spray_warning(const Scene& scene, double significant_height_m);

}  // namespace pelagic
