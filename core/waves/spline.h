// Sampling a band-limited periodic field between the nodes of a grid.
//
// A uniform B-spline of order P (P taps) through coefficients c_j has the Fourier coefficients
// C_m sinc(m/N + l)^P at m + lN. The spectrum is divided by sinc(m/N)^P beforehand, C_m = h_m / sinc(m/N)^P,
// at next to no cost. The wave m itself (l = 0) then comes out exact. The error left is its images, smaller
// by (f/(1 − f))^P at f = m/N cycles per node: 1.2 % for P = 4 and 0.14 % for P = 6 at four nodes per
// wavelength, 4e-4 and 9e-6 at eight. This is a type-2 non-uniform FFT with a B-spline window.
#pragma once

#include <cmath>
#include <cstdlib>
#include "core/base/constants.h"

namespace pelagic {

#include "core/waves/spline.inl"

// 1 / sinc(m/N)^P: the factor on mode m of an axis of N nodes, |m| < N/2, that compensates for the spline.
inline double bspline_prefilter(int m, int n, int taps) {
    if (m == 0) return 1.0;
    const double x = kPi * std::abs(m) / n;
    return std::pow(x / std::sin(x), taps);
}

}  // namespace pelagic
