// Veiling glare: the light that an eye or a lens scatters round bright points of a picture.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace pelagic {

// Of the scattered light, the density per square degree (to a factor) so many degrees from where it belongs: the two wide terms of
// the eye's point spread by day (Spencer, Shirley, Zimmerman, Greenberg 1995, "Physically-based glare effects for digital images",
// Eq. 4 and 6), without the narrow one, which is what is seen sharp. Lenses scatter much the same.
double glare_density(double angle_deg);

struct Glare {
    double share = 0.0;           // of the light that is scattered: 0 … 1
    double pixel_tangent = 1e-3;  // that a pixel covers
};

// What is scattered of a whole picture, rows one after another, the picture's own place first and what falls beside it after and
// below it, cyclically: at (−1, 0) stands the last column. Its sum is the picture's.
struct ScatteredLight {
    glm::ivec2 size{0};
    std::vector<glm::vec3> light;
};
ScatteredLight scattered_light(std::span<const glm::vec3> picture, glm::ivec2 size, double pixel_tangent);

// Takes the share from each pixel and adds what is scattered of the whole picture. Light from outside it isn't known: nothing comes
// from there. Linear in the picture; finite for finite values, and nowhere below 0 where the picture isn't.
void add_glare(std::span<glm::vec3> picture, glm::ivec2 size, const Glare& glare);

// What that takes for a picture of so many pixels [bytes].
std::size_t glare_bytes(glm::ivec2 size);

}  // namespace pelagic
