#include "plugin/bake/maps.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace pelagic {
namespace {

template <class Value, class Combine>
std::vector<MipLevel<Value>> mips(const FullMap<Value>& full, Combine&& combine) {
    std::vector<MipLevel<Value>> levels;
    FullMap<Value> fine = full;
    for (int level = 1; level < exr::mip_level_count(full.n, full.n); ++level) {
        const int n = exr::mip_level_size(full.n, full.n, level).first;
        MipLevel<Value> coarse{n, std::vector<Value>(static_cast<std::size_t>(n) * n)};
        const TentWeights weights = tent_weights(fine.n, n, fine.periodic);
        tbb::parallel_for(0, n, [&](int y) {
            for (int x = 0; x < n; ++x)
                coarse.texels[static_cast<std::size_t>(y) * n + x] =
                    combine(fine, weights.taps[x], weights.taps[y]);
        });
        levels.push_back(std::move(coarse));
        fine = {n, levels.back().texels, full.periodic};
    }
    return levels;
}

}  // namespace

TentWeights tent_weights(int fine, int coarse, bool periodic) {
    const double ratio = static_cast<double>(fine) / coarse;
    TentWeights weights;
    for (int i = 0; i < coarse; ++i) {
        const double centre = i * ratio;
        std::vector<TentWeights::Tap> taps;
        double sum = 0.0;
        for (int j = static_cast<int>(std::ceil(centre - ratio)); j <= static_cast<int>(centre + ratio);
             ++j) {
            const double weight = 1.0 - std::abs(j - centre) / ratio;
            if (weight <= 0.0 || (!periodic && (j < 0 || j >= fine))) continue;
            taps.push_back({((j % fine) + fine) % fine, weight});
            sum += weight;
        }
        for (TentWeights::Tap& tap : taps) tap.weight /= sum;
        weights.taps.push_back(std::move(taps));
    }
    return weights;
}

std::vector<MipLevel<JacobianMoments<float>>> moment_mips(const FullMap<JacobianMoments<float>>& full) {
    using Moments = FullMap<JacobianMoments<float>>;
    using Taps = std::vector<TentWeights::Tap>;
    return mips(full, [](const Moments& fine, const Taps& columns, const Taps& rows) {
        MomentSum<double> sum;
        for (const auto& row : rows)
            for (const auto& column : columns) {
                const JacobianMoments<float>& j =
                    fine.texels[static_cast<std::size_t>(row.texel) * fine.n + column.texel];
                sum.add({j.mean, j.variance, j.third}, row.weight * column.weight);
            }
        const JacobianMoments<double> j = sum.moments();
        return JacobianMoments<float>{static_cast<float>(j.mean), static_cast<float>(j.variance),
                                      static_cast<float>(j.third)};
    });
}

namespace {

glm::dvec3 mean_of(const FullMap<glm::vec3>& fine, const std::vector<TentWeights::Tap>& columns,
                   const std::vector<TentWeights::Tap>& rows) {
    glm::dvec3 sum(0.0);
    for (const auto& row : rows)
        for (const auto& column : columns)
            sum += row.weight * column.weight *
                   glm::dvec3(fine.texels[static_cast<std::size_t>(row.texel) * fine.n + column.texel]);
    return sum;
}

}  // namespace

std::vector<MipLevel<glm::vec3>> mean_mips(const FullMap<glm::vec3>& full) {
    return mips(full, [](const auto& fine, const auto& columns, const auto& rows) {
        return glm::vec3(mean_of(fine, columns, rows));
    });
}

std::vector<MipLevel<glm::vec3>> normal_mips(const FullMap<glm::vec3>& full) {
    return mips(full, [](const auto& fine, const auto& columns, const auto& rows) {
        const glm::dvec3 sum = mean_of(fine, columns, rows);
        const double length = std::sqrt(sum.x * sum.x + sum.y * sum.y + sum.z * sum.z);
        // Normals that cancel have no direction; up is as good as any.
        return length > 0.0 ? glm::vec3(sum / length) : glm::vec3(0.0f, 0.0f, 1.0f);
    });
}

}  // namespace pelagic
