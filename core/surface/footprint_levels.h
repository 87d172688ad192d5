// The levels of footprints of a view: powers of two in metres, whatever the scene and whichever frames are asked for.
// A point between two levels reads both.
#pragma once

#include <cmath>

namespace pelagic {

// The finest level that a frame reads whose finest footprint is this [m], > 0: the nearest one. The level below would
// cost four times the samples, for at most a factor of √2 in footprint.
inline double first_level_m(double finest_footprint_m) {
    return std::exp2(std::round(std::log2(finest_footprint_m)));
}

// The coarsest level that is no coarser than the footprint.
inline double level_below_m(double footprint_m) {
    return std::exp2(std::floor(std::log2(footprint_m)));
}

}  // namespace pelagic
