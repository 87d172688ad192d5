#include "core/surface/fitted_cage.h"

#include <tbb/parallel_for.h>

#include <array>
#include <cmath>
#include <cstddef>

namespace pelagic {
namespace {

// From the middle outwards; they add up to 1, so that constants and planes stay what they are.
std::array<double, FittedCage::kReach + 1> inverse_weights() {
    const double pole = std::sqrt(3.0) - 2.0;
    std::array<double, FittedCage::kReach + 1> weights{};
    double power = 1.0, sum = 0.0;
    for (std::size_t j = 0; j < weights.size(); ++j, power *= pole) {
        weights[j] = power;
        sum += j == 0 ? power : 2.0 * power;
    }
    for (double& weight : weights) weight /= sum;
    return weights;
}

// `at(j)`: the j-th value from here, |j| ≤ kReach.
template <class At>
glm::dvec3 weighted_sum(const std::array<double, FittedCage::kReach + 1>& weights, const At& at) {
    glm::dvec3 sum = weights[0] * at(0);
    for (int j = FittedCage::kReach; j > 0; --j)
        sum += weights[static_cast<std::size_t>(j)] * (at(-j) + at(j));
    return sum;
}

}  // namespace

void FittedCage::fit(std::span<const glm::vec3> points, std::vector<glm::vec3>& vertices) const {
    static const auto kWeights = inverse_weights();
    const int side = vertices_per_side(), stride = points_per_side();
    vertices.resize(static_cast<std::size_t>(side) * static_cast<std::size_t>(side));
    tbb::parallel_for(0, side, [&](int y) {
        // The sums across the row, at all of its columns.
        thread_local std::vector<glm::dvec3> across;
        across.resize(static_cast<std::size_t>(stride));
        for (int x = 0; x < stride; ++x)
            across[static_cast<std::size_t>(x)] = weighted_sum(kWeights, [&](int j) {
                return glm::dvec3(points[static_cast<std::size_t>(y + kReach + j) * stride + x]);
            });
        for (int x = 0; x < side; ++x)
            vertices[static_cast<std::size_t>(y) * side + x] = weighted_sum(
                kWeights, [&](int j) { return across[static_cast<std::size_t>(x + kReach + j)]; });
    });
}

}  // namespace pelagic
