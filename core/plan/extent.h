// How far the surface of a spectrum goes from its rest.
#pragma once

#include "core/plan/choppiness.h"
#include "core/spectrum/directional_spectrum.h"
#include "core/surface/extent.h"

namespace pelagic {

// Statistical, since nothing bounds a Gaussian sum: each of an extent's height and reach is this many standard
// deviations of the whole spectrum's. One crest in exp(½·5²) ≈ 270 000 waves is higher (Rayleigh's
// distribution of crests); a wave of 6 s passes that often a place in 19 days, so that among a thousand waves
// in view about one in 27 minutes may lack its outermost tip at the picture's border. Nothing else depends on
// it.
inline constexpr double kExtentDeviations = 5.0;

// Of everything that the spectrum holds, with this choppiness; 0 for a calm.
Extent expected_extent(const DirectionalSpectrum& spectrum, const Choppiness& choppiness);

}  // namespace pelagic
