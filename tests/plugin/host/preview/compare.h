// Two pictures of the same frame, pixel by pixel.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "plugin/render/render.h"

namespace pelagic {

struct Difference {
    double median = 0.0, last_percent = 0.0, silhouettes = 0.0;
};

// Relative differences of the total radiance, over pixels that show the same kind (sea or sky) as all their
// neighbours in both pictures.
inline Difference compare(const Picture& a, const Picture& b) {
    const int width = a.resolution.x, height = a.resolution.y;
    std::vector<double> differences;
    for (int y = 1; y + 1 < height; ++y)
        for (int x = 1; x + 1 < width; ++x) {
            const auto at = [&](int i, int j) { return static_cast<std::size_t>((y + j) * width + x + i); };
            bool alike = true;
            for (int j = -1; j <= 1; ++j)
                for (int i = -1; i <= 1; ++i)
                    alike = alike && a.sea[at(i, j)] == a.sea[at(0, 0)] && b.sea[at(i, j)] == a.sea[at(0, 0)];
            if (!alike) continue;
            const glm::vec3 first = radiance_of(a.layers[at(0, 0)]), second = radiance_of(b.layers[at(0, 0)]);
            double worst = 0.0;
            for (int c = 0; c < 3; ++c)
                worst = std::max(worst, static_cast<double>(std::abs(first[c] - second[c])) /
                                            std::max(static_cast<double>(std::abs(first[c])), 1e-6));
            differences.push_back(std::isfinite(worst) ? worst : 1e30);
        }
    Difference difference;
    if (differences.empty()) return difference;
    std::sort(differences.begin(), differences.end());
    difference.median = differences[differences.size() / 2];
    difference.last_percent = differences[differences.size() * 99 / 100];
    difference.silhouettes = 1.0 - static_cast<double>(differences.size()) / (width - 2) / (height - 2);
    return difference;
}

}  // namespace pelagic
