// A sky as a picture: the inverse of picture_sky.cpp, without the sun.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/base/constants.h"
#include "core/lighting/background.h"
#include "core/lighting/sky.h"

namespace pelagic {

LatLong lat_long(const Sky& sky, int width) {
    if (width < kLeastLatLong || width > kLargestLatLong || width % 2 != 0)
        throw std::invalid_argument("a sky picture of " + std::to_string(width) +
                                    " columns: even numbers from " + std::to_string(kLeastLatLong) + " to " +
                                    std::to_string(kLargestLatLong) + " are accepted");
    if (sky.map.size() == 0) throw std::invalid_argument("a sky picture of a sky without a map");
    LatLong picture{.width = width, .height = width / 2, .radiance = {}};
    picture.radiance.resize(static_cast<std::size_t>(picture.width) * picture.height);
    const double pixel = kTwoPi / width;  // [rad], in both directions
    // Samples at most a texel of the map apart, where those are narrowest: at the horizon.
    const double texel = 2.0 * static_cast<double>(kSkyMapExtent) / sky.map.size();
    const int n = static_cast<int>(std::ceil(pixel / texel));
    std::vector<glm::dvec2> headings(static_cast<std::size_t>(width) * n);  // of the samples in a row
    for (int column = 0; column < width; ++column)
        for (int i = 0; i < n; ++i) {
            const double azimuth = kPi - pixel * (column + (i + 0.5) / n);
            headings[static_cast<std::size_t>(column) * n + i] = {std::cos(azimuth), std::sin(azimuth)};
        }
    const glm::vec3 below = sky.map.radiance(glm::vec2(kSkyMapExtent), 0.0f);
    tbb::parallel_for(0, picture.height, [&](int row) {
        std::vector<glm::dvec2> elevations;  // cosine and sine
        for (int j = 0; j < n; ++j) {
            const double elevation = 0.5 * kPi - pixel * (row + (j + 0.5) / n);
            elevations.emplace_back(std::cos(elevation), std::sin(elevation));
        }
        for (int column = 0; column < width; ++column) {
            glm::vec3 sum(0.0f);
            double weights = 0.0;
            for (const glm::dvec2& elevation : elevations)
                for (int i = 0; i < n; ++i) {
                    const glm::dvec2 heading = headings[static_cast<std::size_t>(column) * n + i];
                    const glm::vec3 direction(elevation.x * heading.x, elevation.x * heading.y, elevation.y);
                    sum += static_cast<float>(elevation.x) *
                           (direction.z < 0.0f ? below : background_sky(sky, direction));
                    weights += elevation.x;  // of equal steps in angle
                }
            picture.radiance[static_cast<std::size_t>(row) * width + column] =
                sum / static_cast<float>(weights);
        }
    });
    return picture;
}

}  // namespace pelagic
