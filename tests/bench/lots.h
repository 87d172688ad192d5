// What paths of light are drawn with.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <random>

namespace pelagic::bench {

// A unit vector at this angle from an axis.
inline glm::dvec3 turned(glm::dvec3 axis, double cosine, double round) {
    const glm::dvec3 other = std::abs(axis.x) < 0.6 ? glm::dvec3(1.0, 0.0, 0.0) : glm::dvec3(0.0, 1.0, 0.0);
    const glm::dvec3 x = glm::normalize(glm::cross(other, axis)), y = glm::cross(axis, x);
    const double sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
    return glm::normalize(axis * cosine + (x * std::cos(round) + y * std::sin(round)) * sine);
}

class Lot {
  public:
    explicit Lot(std::uint64_t seed) : engine_(seed) {}
    double operator()() { return static_cast<double>(engine_() >> 11) * 0x1.0p-53; }

  private:
    std::mt19937_64 engine_;
};

}  // namespace pelagic::bench
