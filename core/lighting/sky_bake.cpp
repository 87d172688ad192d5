// Samples a dome into the stereographic map, and integrates its irradiance.
#include "core/lighting/sky_bake.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/glm.hpp>
#include <utility>
#include <vector>

#include "core/base/constants.h"

namespace pelagic {
namespace {

namespace shading {
using namespace glm;

struct Fresnel {
// clang-format off
#include "core/lighting/special.glsl"
#include "core/lighting/fresnel.glsl"
    // clang-format on
};

}  // namespace shading

// Samples per side of a texel that the horizon crosses: the eye is sensitive to that line.
constexpr int kHorizonSamples = 8;

// The sums over a texel's samples.
struct Texel {
    glm::dvec3 radiance{0.0};    // sum over the samples above the horizon
    glm::dvec3 irradiance{0.0};  // [radiance sr]
    int above = 0, samples = 0;
};

Texel sampled(const SkyDome& dome, glm::dvec2 corner, double side) {
    const glm::dvec2 middle = corner + 0.5 * side;
    const double distance = glm::length(middle), reach = side * std::sqrt(0.5);
    Texel texel;
    if (distance - reach >= 1.0) {
        texel.samples = 1;
        return texel;
    }
    const auto angle = static_cast<float>(2.0 * side / (1.0 + distance * distance));
    int n = dome.samples(sky_map_direction(glm::vec2(middle)), angle);
    if (distance + reach > 1.0) n = std::max(n, kHorizonSamples);
    const double step = side / n;
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            const glm::dvec2 u = corner + step * glm::dvec2(i + 0.5, j + 0.5);
            const double u2 = glm::dot(u, u);
            if (u2 >= 1.0) continue;
            const glm::dvec3 radiance(dome.radiance(sky_map_direction(glm::vec2(u))));
            // Stereographic projection: dω = 4/(1 + u²)² d²u, and cosθ = (1 − u²)/(1 + u²).
            const double up = 1.0 + u2;
            texel.radiance += radiance;
            texel.irradiance += radiance * (4.0 * (1.0 - u2) / (up * up * up) * step * step);
            ++texel.above;
        }
    texel.samples = n * n;
    return texel;
}

}  // namespace

float diffuse_fresnel() {
    return shading::Fresnel().kDiffuseFresnel;
}

BakedSky bake_sky_map(int size, const SkyDome& dome) {
    SkyMap::check_size(size);
    BakedSky baked;
    const auto n = static_cast<std::size_t>(size);
    const double side = 2.0 * kSkyMapExtent / size;
    std::vector<Texel> texels(n * n);
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, n), [&](const tbb::blocked_range<std::size_t>& rows) {
            for (std::size_t j = rows.begin(); j < rows.end(); ++j)
                for (std::size_t i = 0; i < n; ++i)
                    texels[j * n + i] =
                        sampled(dome,
                                glm::dvec2(static_cast<double>(i), static_cast<double>(j)) * side -
                                    static_cast<double>(kSkyMapExtent),
                                side);
        });

    glm::dvec3 irradiance(0.0);
    for (const Texel& texel : texels) irradiance += texel.irradiance;
    const glm::dvec3 below = static_cast<double>(diffuse_fresnel()) / kPi * irradiance;

    std::vector<glm::vec3> means(n * n);
    for (std::size_t i = 0; i < means.size(); ++i) {
        const Texel& texel = texels[i];
        means[i] = (texel.radiance + below * static_cast<double>(texel.samples - texel.above)) /
                   static_cast<double>(texel.samples);
    }
    baked.irradiance = irradiance;
    baked.map = SkyMap(size, std::move(means));
    return baked;
}

}  // namespace pelagic
