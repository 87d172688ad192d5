// Colours of one set of primaries as those of another.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>

namespace pelagic {

// CIE 1931 x, y.
struct Primaries {
    glm::dvec2 red, green, blue, white;
};

inline constexpr Primaries kRec709{
    {0.64, 0.33}, {0.30, 0.60}, {0.15, 0.06}, {0.3127, 0.3290}};  // ITU-R BT.709
// SMPTE ST 2065-1 and the Academy's S-2014-004.
inline constexpr Primaries kAces2065{{0.7347, 0.2653}, {0.0, 1.0}, {0.0001, -0.077}, {0.32168, 0.33767}};
inline constexpr Primaries kAcesCg{{0.713, 0.293}, {0.165, 0.830}, {0.128, 0.044}, {0.32168, 0.33767}};

// Between cones and XYZ: Lam 1985, as in CIECAM97s.
glm::dmat3 bradford();
// From linear light to linear light; white stays white (Bradford's adaptation).
glm::dmat3 conversion(const Primaries& from, const Primaries& to);

}  // namespace pelagic
