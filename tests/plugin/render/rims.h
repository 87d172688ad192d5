// Pixels on silhouettes that have a colour which their own surface hasn't beside them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <limits>
#include <vector>

#include "plugin/render/render.h"

namespace pelagic {

inline double luminance(const SeaRadiance& layers) {
    const glm::vec3 c = radiance_of(layers);
    return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z;
}

struct Rims {
    int silhouette = 0, outside = 0;
};

// Pixels in front of something else that are by 15 % darker than the darkest, or brighter than the brightest, of
// their 5 × 5 neighbours on the same surface. It goes on where the depth changes by no more from pixel to pixel than
// three times what it does on the flat sea.
inline Rims rims(const Picture& picture, const std::vector<float>& depth_m, double height_m,
                 double pixel_tangent) {
    const int width = picture.resolution.x, height = picture.resolution.y;
    const auto at = [&](int x, int y) { return static_cast<std::size_t>(y * width + x); };
    Rims rims;
    for (int y = 2; y < height - 2; ++y)
        for (int x = 2; x < width - 2; ++x) {
            if (!picture.sea[at(x, y)]) continue;
            const double depth = depth_m[at(x, y)], step_m = 3.0 * depth * depth / height_m * pixel_tangent;
            const auto behind = [&](int i, int j) { return depth_m[at(i, j)] - depth > step_m; };
            if (!behind(x, y - 1) && !behind(x - 1, y) && !behind(x + 1, y) && !behind(x, y + 1)) continue;
            double least = std::numeric_limits<double>::infinity(), most = 0.0;
            int neighbours = 0;
            for (int j = -2; j <= 2; ++j)
                for (int i = -2; i <= 2; ++i) {
                    if ((i == 0 && j == 0) ||
                        std::abs(depth_m[at(x + i, y + j)] - depth) > step_m * (std::abs(i) + std::abs(j)))
                        continue;
                    ++neighbours;
                    const double own = luminance(picture.layers[at(x + i, y + j)]);
                    least = std::min(least, own);
                    most = std::max(most, own);
                }
            if (neighbours < 6) continue;
            ++rims.silhouette;
            const double own = luminance(picture.layers[at(x, y)]);
            rims.outside += own < 0.85 * least || own > 1.15 * most;
        }
    return rims;
}

}  // namespace pelagic
