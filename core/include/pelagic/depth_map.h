// How deep the sea is from place to place, for waves that feel its floor (Waves::coast): data of a scene, as a cage is, wherever it came from.
#pragma once

#include <glm/vec2.hpp>
#include <string>
#include <vector>

#include "pelagic/version.h"

namespace pelagic {
inline namespace PELAGIC_VERSION_NAMESPACE {

// Depths that have passed all checks and never change: a scene's copies share them.
class DepthMap {
  public:
    // Depths below the sea at rest [m], below 0 on land, rows from the south, x fastest, over a rectangle of the world that begins at from_m.
    // Throws std::invalid_argument for sizes that aren't positive, another number of values, and values that are no numbers.
    DepthMap(glm::ivec2 columns_rows, std::vector<float> depths_m, glm::dvec2 from_m, glm::dvec2 size_m);

    glm::ivec2 columns_rows() const { return columns_rows_; }
    glm::dvec2 from_m() const { return from_m_; }
    glm::dvec2 size_m() const { return size_m_; }
    // The mean depth of a rectangle of the world [m]; beyond the map depths go on as at its edge.
    double mean_m(glm::dvec2 from_m, glm::dvec2 to_m) const;
    // Its place, its size and a hash of its depths. Equal texts, equal maps.
    const std::string& content() const { return content_; }

  private:
    glm::ivec2 columns_rows_{0};
    std::vector<float> depths_m_;
    glm::dvec2 from_m_{0.0}, size_m_{0.0};
    std::string content_;
};
}  // namespace PELAGIC_VERSION_NAMESPACE
}  // namespace pelagic
