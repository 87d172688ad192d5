// Which wavenumbers each cascade holds: a function of the tiles' sizes alone, never of their resolutions, so that a
// finer grid adds detail and moves no energy to a cascade with other random numbers.
//
// Cascades count from the largest. Cascade i holds the wavenumbers from its lower edge up to the next
// cascade's lower edge: disjoint and together complete.
#pragma once

#include <span>
#include <vector>

namespace pelagic {

// Periods across a tile of the longest wave that it holds. Fewer, and the eye finds the tile's repetition
// (and its coarse wavevector cells miss the spectrum's shape); more, and the cascade above needs a larger
// grid to reach here.
inline constexpr double kBandModes = 8.0;

// The smallest and largest grid of a cascade, in samples a side. Below 16 a tile resolves less than its
// kBandModes periods; 8192² single-precision complex fields are 512 MiB each.
inline constexpr int kMinCascadeResolution = 16;
inline constexpr int kMaxCascadeResolution = 8192;

// Lower edges of the bands [rad/m] for tiles of these sizes [m], largest first: 0 for the largest, 2π
// kBandModes / L for the others.
std::vector<double> lower_edges(std::span<const double> sizes_m);

// The radius, in modes of a tile of this size [m], of the disc that holds every mode whose cell reaches below
// the edge [rad/m]: a cell's corner is √½ of a step from its mode. At most INT_MAX / 4.
int modes_within(double size_m, double edge);

// The smallest even resolution ≥ 16 of a tile of this size [m] whose grid holds that disc for the next
// cascade's lower edge [rad/m]: N/2 − 1 modes, because the Nyquist row is empty. May be larger than any grid
// we allow.
int sufficient_resolution(double size_m, double next_lower_edge);

}  // namespace pelagic
