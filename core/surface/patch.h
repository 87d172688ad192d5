// The square patch: a regular grid of points at rest.
#pragma once

#include <glm/vec2.hpp>
#include <vector>

namespace pelagic {

struct PatchLattice {
    int per_side = 257;  // points per side
    double spacing_m = 0.78125;
    double first_m = -100.0;  // x and y of the first point
};

// per_side² points, x fastest, y rising [m].
template <class T>
std::vector<glm::vec<2, T>> rest_points(const PatchLattice& lattice) {
    const auto n = static_cast<std::size_t>(lattice.per_side);
    std::vector<glm::vec<2, T>> points(n * n);
    for (std::size_t y = 0; y < n; ++y)
        for (std::size_t x = 0; x < n; ++x)
            points[y * n + x] = glm::vec<2, T>(lattice.first_m + static_cast<double>(x) * lattice.spacing_m,
                                               lattice.first_m + static_cast<double>(y) * lattice.spacing_m);
    return points;
}

}  // namespace pelagic
