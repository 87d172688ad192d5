// Columns of the atmosphere's matter along rays (atmosphere.h): what its model integrates light through.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "core/lighting/atmosphere.h"

namespace pelagic {

inline constexpr double kEarth_km = kEarthRadius_km, kTop_km = kAirTop_km;

// Air, haze and ozone: densities at a height, or columns along a ray, as fractions of the vertical column.
struct Matter {
    double air = 0.0, haze = 0.0, ozone = 0.0;
};

// Changes each x to exp(−x). Half of a sky's time goes into these, twice as fast so as one by one.
void exp_of_minus(std::span<double> values);

// [1/km]
Matter density(double height_km);

// Optical thickness of the whole air, vertically.
struct Thickness {
    BandValues air{}, haze{}, ozone{};
};
Thickness vertical_thickness(double turbidity);

// Of the haze's extinction this much is scattering: particles over a sea with some land around (purely marine: 0.99;
// continental: 0.93).
inline constexpr double kHazeAlbedo = 0.97;

// Distance to the top of the atmosphere along a ray [km], from its start's radius and its cosine with the vertical.
double to_top(double radius, double cosine);

// Distance to the horizon of the earth without its air [km].
double horizon_distance(double radius);

// Catmull and Rom's weights of the values at −1, 0, 1 and 2, for a place from 0 to 1: a cubic through the values, without
// kinks between one and the next.
std::array<double, 4> cubic_weights(double t);

// Between the values of a table, at x in steps from its first, by those weights. The first
// and the last value repeat past the ends.
struct Cubic {
    Cubic(double x, std::size_t size);
    std::array<std::size_t, 4> nodes;
    std::array<double, 4> weights;
};

// Columns of matter from a height to the top, along rays that miss the ground. The table's axes are the
// distance to the horizon and the distance to the top, which give resolution to grazing rays.
class Columns {
  public:
    Columns();

    // cosine: between the ray and the vertical. Rays that meet the ground get the column of the ray that
    // grazes it.
    Matter operator()(double radius, double cosine) const;

    // The same without the table, for the ray from this radius that reaches the top at distance d.
    static Matter integrated(double radius, double d);

  private:
    std::vector<Matter> table_;
};

}  // namespace pelagic
