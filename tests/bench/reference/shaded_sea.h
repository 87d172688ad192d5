// Our side of the comparison: what each pixel of a projected grid gets from evaluate() and shade_sea().
#pragma once

#include <vector>

#include "core/lighting/lighting.h"
#include "tests/bench/reference/sea_geometry.h"
#include "tests/bench/reference/terms.h"

namespace pelagic::bench {

struct SeaPixels {
    int per_line = 0;                // places in a line, those that show no sea included
    std::vector<SeaPoint> points;    // those that show the sea, row after row
    std::vector<std::size_t> first;  // each row's first, and the end of the last
};

struct PixelOptions {
    int first_row = 0;
    int samples = 1;       // samples² places in each pixel
    double cell_px = 8.0;  // the projected grid's
    double pixels = 1.0;   // normals are filtered by so many pixels; 0: by the cell, as positions are
};

// The pixels from first_row down: normals and hidden slope variance at the place at rest that each sample
// shows (the middle of the pixel, where there is one).
SeaPixels sea_pixels(const WaveTile& tile, const View& view, const PixelOptions& options);

// The same with the slope variance of the nearest line everywhere: the constant BRDF that the paper compares
// with.
SeaPixels with_constant_variance(SeaPixels pixels);

// Lines of the picture; `refracted` is the water's radiance from below that the reference has been given.
Lines shaded_lines(const SeaPixels& pixels, const LightingChoice& choice, const Sky& sky, double refracted);

}  // namespace pelagic::bench
