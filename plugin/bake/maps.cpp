#include "plugin/bake/maps.h"

#include <algorithm>
#include <cmath>

namespace pelagic {
namespace {

template <class Value, class Combine>
std::vector<MipLevel<Value>> mips(MipLevel<Value> full, bool periodic, Combine&& combine) {
    const int n = full.n;
    std::vector<MipLevel<Value>> levels{std::move(full)};
    for (int level = 1; level < exr::mip_level_count(n, n); ++level) {
        const MipLevel<Value>& fine = levels.back();
        MipLevel<Value> coarse;
        coarse.n = exr::mip_level_size(n, n, level).first;
        const TentWeights weights = tent_weights(fine.n, coarse.n, periodic);
        coarse.texels.reserve(static_cast<std::size_t>(coarse.n) * coarse.n);
        for (int y = 0; y < coarse.n; ++y)
            for (int x = 0; x < coarse.n; ++x)
                coarse.texels.push_back(combine(fine, weights.taps[x], weights.taps[y]));
        levels.push_back(std::move(coarse));
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

std::vector<MipLevel<JacobianMoments<float>>> moment_mips(MipLevel<JacobianMoments<float>> full,
                                                          bool periodic) {
    using Level = MipLevel<JacobianMoments<float>>;
    using Taps = std::vector<TentWeights::Tap>;
    return mips(std::move(full), periodic, [](const Level& fine, const Taps& columns, const Taps& rows) {
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

std::vector<MipLevel<glm::vec3>> normal_mips(MipLevel<glm::vec3> full, bool periodic) {
    using Level = MipLevel<glm::vec3>;
    using Taps = std::vector<TentWeights::Tap>;
    return mips(std::move(full), periodic, [](const Level& fine, const Taps& columns, const Taps& rows) {
        glm::dvec3 sum(0.0);
        for (const auto& row : rows)
            for (const auto& column : columns)
                sum += row.weight * column.weight *
                       glm::dvec3(fine.texels[static_cast<std::size_t>(row.texel) * fine.n + column.texel]);
        const double length = std::sqrt(sum.x * sum.x + sum.y * sum.y + sum.z * sum.z);
        // Normals that cancel have no direction; up is as good as any.
        return length > 0.0 ? glm::vec3(sum / length) : glm::vec3(0.0f, 0.0f, 1.0f);
    });
}

}  // namespace pelagic
