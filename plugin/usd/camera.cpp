// See camera.h.
#include "plugin/usd/camera.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <stdexcept>
#include <string>

namespace pelagic::usd {

namespace {

bool is_finite(const glm::dvec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

}  // namespace

void check(std::span<const CameraKey> keys) {
    if (keys.empty()) throw std::invalid_argument("USD: a camera needs one key at least");
    for (std::size_t i = 0; i < keys.size(); ++i) {
        if (!is_finite(keys[i].position_m) || !is_finite(keys[i].look_at_m)) {
            throw std::invalid_argument("USD: the camera's position and target must be finite, at frame " +
                                        std::to_string(keys[i].frame));
        }
        if (i > 0 && keys[i].frame <= keys[i - 1].frame) {
            throw std::invalid_argument("USD: the camera's keys must rise, and frame " +
                                        std::to_string(keys[i].frame) + " follows " +
                                        std::to_string(keys[i - 1].frame));
        }
    }
}

CameraKey key_at(std::span<const CameraKey> keys, int frame) {
    const auto after = std::upper_bound(keys.begin(), keys.end(), frame,
                                        [](int f, const CameraKey& key) { return f < key.frame; });
    CameraKey key = after == keys.begin() ? keys.front() : *(after - 1);
    if (after != keys.begin() && after != keys.end()) {
        // In double: the distance between two ints need not be an int.
        const double t =
            (static_cast<double>(frame) - key.frame) / (static_cast<double>(after->frame) - key.frame);
        key.position_m += t * (after->position_m - key.position_m);
        key.look_at_m += t * (after->look_at_m - key.look_at_m);
    }
    key.frame = frame;
    return key;
}

CameraMatrix camera_matrix(const CameraKey& key) {
    const glm::dvec3 view = key.look_at_m - key.position_m;
    const double distance = glm::length(view);
    if (!(distance > 0.0)) {
        throw std::invalid_argument("USD: the camera stands on its own target at frame " +
                                    std::to_string(key.frame) + "; move one of them");
    }
    const glm::dvec3 back = -view / distance;
    // Below this the horizontal part of the view is rounding, and so would be the picture's upright.
    constexpr double kVertical = 1e-9;
    const bool vertical = std::hypot(back.x, back.y) < kVertical;
    const glm::dvec3 up = vertical ? glm::dvec3(0.0, 1.0, 0.0) : glm::dvec3(0.0, 0.0, 1.0);
    const glm::dvec3 right = glm::normalize(glm::cross(up, back));
    return {{right, glm::cross(back, right), back, key.position_m}};
}

FilmBack film_back(const Camera& camera) {
    if (!(camera.fov_deg > 0.0 && camera.fov_deg < 180.0)) {
        throw std::invalid_argument("USD: the camera's field of view must be between 0 and 180 degrees");
    }
    if (camera.resolution.x < 1 || camera.resolution.y < 1) {
        throw std::invalid_argument("USD: the camera's resolution must be positive");
    }
    constexpr double kFilmWidth = 0.36;  // 36 mm in tenths of a metre
    const double half_fov_rad = camera.fov_deg * (std::numbers::pi / 360.0);
    return {.horizontal_aperture = kFilmWidth,
            .vertical_aperture = kFilmWidth * camera.resolution.y / camera.resolution.x,
            .focal_length = 0.5 * kFilmWidth / std::tan(half_fov_rad)};
}

}  // namespace pelagic::usd
