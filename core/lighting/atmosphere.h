// Sunlight in clear air over the sea: direct light at the ground, and light scattered on the way.
//
// The model: a spherical earth with air, haze and ozone whose densities depend on height alone, and parallel
// light from a distant sun, absorbed and scattered by wavelength. Single scattering is integrated along the
// line of sight. Higher orders are tabulated by height and the sun's elevation: what is scattered once reaches a place from
// rays all round, and each of them is scattered into others by the true phase functions of air and haze, again and again
// (discrete ordinates, Chandrasekhar 1950, with the azimuth's cosines and the earth's curvature along each ray). For these
// orders the sun is equally high over all that a place's rays pass through.
//
// Values are per band (sunlight.h), relative to the sunlight outside the atmosphere: irradiance 1 gives
// radiance in 1/sr. Heights and distances are in km, as in the published tables of air.
#pragma once

#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "core/base/constants.h"
#include "core/lighting/sunlight.h"

namespace pelagic {

// Of the model's spherical earth and of its air, of which 1e-6 lies higher.
inline constexpr double kEarthRadius_km = 1e-3 * kEarthRadius_m, kAirTop_km = 100.0;
inline constexpr double kSunAngularRadius = 0.00465;  // of its disc [rad]
inline constexpr double kHazeScale_km = 1.2;          // of height, in which haze thins out e-fold

// A straight line of sight, without refraction. It ends at the latest on the ground or in space.
struct SightLine {
    double height_km = 0.0;      // of the observer above sea level, ≥ 0; may be in space
    double elevation_rad = 0.0;  // at the observer, −π/2 … π/2
    double length_km = std::numeric_limits<double>::infinity();
};

class Atmosphere {
  public:
    // turbidity T ≥ 1: at 0.55 μm, air and haze together have T times the optical thickness of air alone. The
    // sun's elevation is as seen by the observer at sea level. highest_km: from how high up the air will be looked at;
    // above 1 km it takes up to twice as long. What is seen from further down is the same. After another of the same turbidity it takes
    // less: what suns near this one's place scatter is kept.
    Atmosphere(double turbidity, double sun_elevation_rad, double highest_km = 1.0);
    double turbidity() const;
    double sun_elevation_rad() const;
    double highest_km() const;

    // Transmittance along a line of sight.
    BandValues transmittance(const SightLine& line) const;

    // Light scattered towards the observer from one direction. by_air and by_haze lack their phase functions,
    // which the caller multiplies in: without them they are smooth even at the sun.
    struct Scattered {
        BandValues by_air{}, by_haze{};  // scattered once
        BandValues more{};               // scattered more than once: complete
    };
    // For one elevation ≥ 0 and each of these azimuths relative to the sun's.
    std::vector<Scattered> scattered(double elevation_rad, std::span<const double> azimuths_rad) const {
        return scattered(SightLine{.elevation_rad = elevation_rad}, azimuths_rad);
    }
    // Along a line of sight, without what its end itself sends. The azimuths are relative to the sun's at the place below
    // the observer, and so is the sun's elevation.
    std::vector<Scattered> scattered(const SightLine& line, std::span<const double> azimuths_rad) const {
        return scattered(line, azimuths_rad, sun_elevation_rad());
    }
    // The same under another sun. Where the atmosphere isn't made for an eye above 1 km, light that is scattered more than
    // once is that of a sun at most 11° away from its own.
    std::vector<Scattered> scattered(const SightLine& line, std::span<const double> azimuths_rad,
                                     double sun_elevation_rad) const;

    ~Atmosphere();

  private:
    class Tables;
    std::unique_ptr<const Tables> tables_;
};

// From space to sea level, along a straight ray (no refraction) from this elevation ≥ 0. It needs no atmosphere to be made.
BandValues transmittance_to_sea(double turbidity, double elevation_rad);

// Phase functions [1/sr] of the cosine of the scattering angle.
double air_phase(double cosine);
double haze_phase(double cosine);

}  // namespace pelagic
