// The quantity that pictures are compared by: the mean luminance of each line, by term.
#pragma once

#include <cmath>
#include <glm/vec3.hpp>
#include <vector>

#include "core/lighting/colour.h"
#include "core/lighting/sky.h"

namespace pelagic::bench {

enum Term { kSun, kRefracted, kSky, kTerms };
inline constexpr const char* kTermNames[kTerms] = {"sun", "refracted", "sky"};

struct Line {
    double term[kTerms] = {};
};
using Lines = std::vector<Line>;  // from the first row below the horizon down

inline double luminance(const glm::vec3& colour) {
    return pelagic::luminance(glm::dvec3(colour));
}

// The sky with its sun spread over a disc `factor` times as wide, with the same irradiance.
inline Sky with_wider_sun(Sky sky, float factor) {
    const auto cap = [](float radius) { return 1.0 - std::cos(static_cast<double>(radius)); };
    sky.sun_radiance *=
        static_cast<float>(cap(sky.sun_angular_radius) / cap(factor * sky.sun_angular_radius));
    sky.sun_angular_radius *= factor;
    return sky;
}

}  // namespace pelagic::bench
