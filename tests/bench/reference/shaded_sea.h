// Our side of the comparison: pixels of a projected grid from evaluate() and shade_sea().
#pragma once

#include <vector>

#include "core/lighting/lighting.h"
#include "tests/bench/reference/sea_geometry.h"
#include "tests/bench/reference/terms.h"

namespace pelagic::bench {

struct SeaPixels {
    int per_line = 0;                // samples per line, including those that show no sea
    std::vector<SeaPoint> points;    // samples that show the sea, row by row
    std::vector<std::size_t> first;  // the first point of each row, and the end of the last row
};

struct PixelOptions {
    int first_row = 0;
    int samples = 1;       // samples² per pixel
    double cell_px = 8.0;  // of the projected grid
    double pixels = 1.0;   // normals are filtered by this many pixels; 0: by the cell, as positions are
};

// The pixels from first_row down: normals and unresolved slope variance at the position at rest of each sample
// (one sample is at the pixel's centre).
SeaPixels sea_pixels(const WaveTile& tile, const View& view, const PixelOptions& options);

// The same with the nearest line's slope variance everywhere: the constant BRDF of the paper's comparison.
SeaPixels with_constant_variance(SeaPixels pixels);

// Lines of the picture. `refracted` is the water's radiance from below, as in the reference.
Lines shaded_lines(const SeaPixels& pixels, const LightingChoice& choice, const Sky& sky, double refracted);

}  // namespace pelagic::bench
