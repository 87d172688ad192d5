// Colours of spectra: the standard observer, and linear Rec. 709.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace pelagic {

// The CIE 1931 colour-matching functions at a wavelength [nm], the multi-lobe fits of Wyman, Sloan, Shirley
// 2013.
inline glm::dvec3 observed_xyz(double nm) {
    // A Gaussian with different widths on either side.
    struct Lobe {
        double height, middle, below, above;  // all but the first [nm]
        double at(double x) const {
            const double deviate = (x - middle) / (x < middle ? below : above);
            return height * std::exp(-0.5 * deviate * deviate);
        }
    };
    constexpr Lobe x1{1.056, 599.8, 37.9, 31.0}, x2{0.362, 442.0, 16.0, 26.7}, x3{-0.065, 501.1, 20.4, 26.2};
    constexpr Lobe y1{0.821, 568.8, 46.9, 40.5}, y2{0.286, 530.9, 16.3, 31.1};
    constexpr Lobe z1{1.217, 437.0, 11.8, 36.0}, z2{0.681, 459.0, 26.0, 13.8};
    return {x1.at(nm) + x2.at(nm) + x3.at(nm), y1.at(nm) + y2.at(nm), z1.at(nm) + z2.at(nm)};
}

// IEC 61966-2-1: XYZ to linear Rec. 709 with white D65. Negative for colours outside its gamut.
inline glm::dvec3 rec709_of(glm::dvec3 xyz) {
    return {3.2406 * xyz.x - 1.5372 * xyz.y - 0.4986 * xyz.z,
            -0.9689 * xyz.x + 1.8758 * xyz.y + 0.0415 * xyz.z,
            0.0557 * xyz.x - 0.2040 * xyz.y + 1.0570 * xyz.z};
}

inline double luminance(glm::dvec3 rec709) {
    return glm::dot(rec709, glm::dvec3(0.2126, 0.7152, 0.0722));
}

// Moves a colour into the gamut: mixes it with grey of the same luminance until no component is negative.
// Keeps luminance, and hue as far as possible. Continuous; luminances ≤ 0 give black.
inline glm::dvec3 into_gamut(glm::dvec3 rec709) {
    const double y = luminance(rec709);
    if (!(y > 0.0)) return glm::dvec3(0.0);
    const double least = std::min({rec709.x, rec709.y, rec709.z});
    if (least >= 0.0) return rec709;
    return glm::max(glm::dvec3(y) + (rec709 - y) * (y / (y - least)), 0.0);
}

}  // namespace pelagic
