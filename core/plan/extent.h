// How far the sea's surface goes from its rest, by expectation: what a view must look beyond its border for.
#pragma once

#include "core/spectrum/directional_spectrum.h"
#include "core/surface/hidden_height.h"

namespace pelagic {

// Statistical, since nothing bounds a Gaussian sum: each of height and reach is kExtentDeviations standard
// deviations of the whole spectrum's. One crest in exp(½·5²) ≈ 270 000 waves is higher (Rayleigh's
// distribution of crests); a wave of 6 s passes that often a place in 19 days, so that among a thousand waves
// in view about one in 27 minutes may lack its outermost tip at the picture's border. Nothing else depends on
// it.
struct Extent {
    double height_m = 0.0;              // |z|
    double reach_m = 0.0;               // of the horizontal displacement, choppiness included
    double significant_height_m = 0.0;  // Hs = 4 √m0
    HiddenHeight hidden{};              // by the footprints of a mesh's cells
};

inline constexpr double kExtentDeviations = 5.0;

// Of everything that the spectrum holds, with this choppiness; 0 for a calm.
Extent expected_extent(const DirectionalSpectrum& spectrum, double choppiness);

}  // namespace pelagic
