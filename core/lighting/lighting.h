// The light that the sea sends to the eye: Bruneton, Neyret, Holzschuch 2010 with the whitecaps of Dupuy and
// Bruneton 2012. The formulas are in this folder's *.glsl files, which C++ includes and the preview hands to
// OpenGL as they are; here is what C++ needs to call them by the batch.
#pragma once

#include <glm/vec3.hpp>
#include <span>

#include "core/lighting/sky.h"
#include "core/lighting/water.h"

namespace pelagic {

// How the sky's reflection is found: accuracy against time, tests/bench/README.md.
enum class SkyQuality {
    One,       // one filtered lookup (Eq. 27)
    Nine,      // nine, at the nodes of a rule for the slopes that are seen
    Integral,  // the integral of Eq. 20 over the slopes, with visibility: the reference
};
enum class FresnelFit {
    Paper,  // Eq. 26, of Schlick's approximation
    Exact,  // our own, of the exact unpolarised term
};

// Which terms there are, and how: a variant. Each is code of its own, in C++ (a template's argument) and in
// GLSL (constants that the shader begins with), so that what is off costs nothing.
struct LightingChoice {
    bool sun = true, sky = true, water = true, whitecaps = true;
    SkyQuality sky_quality = SkyQuality::Nine;
    FresnelFit fresnel = FresnelFit::Exact;
    bool operator==(const LightingChoice&) const = default;
};

// Radiance towards the eye, by what it comes from: the reflected sun, the reflected sky, the light from under
// the water, the foam. Each already has its share of the pixel: they are added up.
struct SeaRadiance {
    glm::vec3 sun{0.0f}, sky{0.0f}, sea{0.0f}, foam{0.0f};
};

// A pixel of sea.
struct SeaPoint {
    glm::vec3 to_eye{0.0f, 0.0f, 1.0f};  // unit
    glm::vec3 normal{0.0f, 0.0f, 1.0f};  // unit, of the waves shown; may point away from the eye
    glm::vec3 slope_variance{0.0f};      // (σxx, σyy, σxy) of those hidden [-], world axes
    float coverage = 0.0f;               // whitecaps, 0 … 1
};

// radiance[i] is points[i]'s; throws std::invalid_argument where there are not the same number of both, or
// where the sky has no map and `choice.sky` asks for one. A point's radiance depends on nothing but the point
// and the arguments; finite for finite points. Runs on the calling thread.
void shade_sea(const LightingChoice& choice, const Sky& sky, const WaterBody& water,
               std::span<const SeaPoint> points, std::span<SeaRadiance> radiance);

}  // namespace pelagic
