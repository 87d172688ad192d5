// A camera's keys and field of view as a USD camera has them: a matrix a frame, a film back and a focal
// length.
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <span>

#include "plugin/usd/layers.h"

namespace pelagic::usd {

// Camera to world, as USD writes a matrix: a row each for the images of x (right), y (up) and z (backwards),
// then the position; row vectors stand on its left.
struct CameraMatrix {
    std::array<glm::dvec3, 4> rows;
    bool operator==(const CameraMatrix&) const = default;
};

// Throws std::invalid_argument without keys, with keys that don't rise, and with values that aren't finite.
void check(std::span<const CameraKey> keys);

// Where the camera is and what it looks at, at a frame: linear between the keys, constant outside. Of keys
// that check() accepts.
CameraKey key_at(std::span<const CameraKey> keys, int frame);

// The camera looks along its −z, with z up in the picture; looking along z, +y is up.
// Throws std::invalid_argument if the camera stands on its own target.
CameraMatrix camera_matrix(const CameraKey& key);

// In USD's unit, tenths of the stage's, here 0.1 m. Only their ratios matter to the picture: the film is 36
// mm wide, as that of a photographer.
struct FilmBack {
    double horizontal_aperture;
    double vertical_aperture;
    double focal_length;
};
// Throws std::invalid_argument unless 0 < fov_deg < 180 and the resolution is positive.
FilmBack film_back(const Camera& camera);

}  // namespace pelagic::usd
