// How much brighter or darker pixels of one picture are than those of another.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <glm/geometric.hpp>
#include <vector>

#include "plugin/render/render.h"

namespace pelagic::test {

inline float luminance_of(const SeaRadiance& light) {
    return glm::dot(radiance_of(light), glm::vec3(0.2126f, 0.7152f, 0.0722f));
}

// |a − b|/b of the luminance of each pixel that counts, rising.
inline std::vector<float> differences(const Picture& a, const Picture& b,
                                      const std::function<bool(std::size_t)>& counts) {
    std::vector<float> all;
    for (std::size_t i = 0; i < b.layers.size(); ++i)
        if (counts(i)) {
            const float of = luminance_of(b.layers[i]);
            all.push_back(std::abs(luminance_of(a.layers[i]) - of) / std::max(of, 1e-6f));
        }
    std::sort(all.begin(), all.end());
    return all;
}

inline float at_share(const std::vector<float>& rising, double share) {
    if (rising.empty()) return 0.0f;
    return rising[std::min(rising.size() - 1,
                           static_cast<std::size_t>(share * static_cast<double>(rising.size())))];
}

// Whether none of the pixels round this one, so many to each side, is marked.
inline bool is_away_from(const std::vector<std::uint8_t>& marked, glm::ivec2 resolution, std::size_t pixel,
                         int by) {
    const int x = static_cast<int>(pixel) % resolution.x, y = static_cast<int>(pixel) / resolution.x;
    for (int j = std::max(y - by, 0); j <= std::min(y + by, resolution.y - 1); ++j)
        for (int i = std::max(x - by, 0); i <= std::min(x + by, resolution.x - 1); ++i)
            if (marked[static_cast<std::size_t>(j) * resolution.x + i]) return false;
    return true;
}

}  // namespace pelagic::test
