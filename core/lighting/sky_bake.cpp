// Samples a dome into the stereographic map, and integrates its irradiance.
#include "core/lighting/sky_bake.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <glm/glm.hpp>
#include <utility>
#include <vector>

#include "core/base/constants.h"

namespace pelagic {
namespace {

namespace sky_shading {
using namespace glm;

struct Fresnel {
// clang-format off
#include "core/lighting/special.glsl"
#include "core/lighting/fresnel.glsl"
    // clang-format on
};

}  // namespace sky_shading

// Samples per side of a texel that the horizon crosses: the eye is sensitive to that line.
constexpr int kHorizonSamples = 8;

// The sums over a texel's samples.
struct Texel {
    glm::dvec3 radiance{0.0};    // sum over the samples above the horizon
    glm::dvec3 irradiance{0.0};  // [radiance sr]
    int above = 0, samples = 0;
    glm::dvec3 open{0.0};    // sum over all samples, with the sky extended past the horizon
    glm::dvec3 middle{0.0};  // that in the texel's middle, of a smooth dome
    bool is_open = false;
};

// Texels around the horizon to which the sky extends: a lookup reaches 1½ to each side.
constexpr double kOpenTexels = 2.5;

// The sky continued past the horizon, by ratios so that it isn't negative: from the place as far above the horizon to
// the horizon it changes by a factor, and by the same factor again to here.
glm::dvec3 beyond_horizon(const SkyDome& dome, glm::dvec2 u, double distance) {
    const auto at = [&](double place) {
        return glm::dvec3(dome.radiance(sky_map_direction(glm::vec2(u * (place / distance)))));
    };
    const glm::dvec3 horizon = at(1.0 - 1e-7);
    const glm::dvec3 above = glm::max(at(2.0 - distance), 0.5 * horizon + 1e-300);  // at most twice as bright
    return horizon * (horizon / above);
}

Texel sampled(const SkyDome& dome, glm::dvec2 corner, double side) {
    const glm::dvec2 middle = corner + 0.5 * side;
    const double distance = glm::length(middle), reach = side * std::sqrt(0.5);
    Texel texel;
    texel.is_open = distance - reach < 1.0 + kOpenTexels * side && distance + reach < 2.0;
    if (distance - reach >= 1.0 && !texel.is_open) {
        texel.samples = 1;
        return texel;
    }
    const auto angle = static_cast<float>(2.0 * side / (1.0 + distance * distance));
    const double nearest = std::min(distance, 1.0 - 1e-7);
    int n = dome.samples(
        sky_map_direction(glm::vec2(distance > 0.0 ? middle * (nearest / distance) : middle)), angle);
    if (distance - reach < 1.0 && distance + reach > 1.0) n = std::max(n, kHorizonSamples);
    const double step = side / n;
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            const glm::dvec2 u = corner + step * glm::dvec2(i + 0.5, j + 0.5);
            const double u2 = glm::dot(u, u);
            if (u2 >= 1.0) {
                if (texel.is_open) texel.open += beyond_horizon(dome, u, std::sqrt(u2));
                continue;
            }
            const glm::dvec3 radiance(dome.radiance(sky_map_direction(glm::vec2(u))));
            texel.open += radiance;
            // Stereographic projection: dω = 4/(1 + u²)² d²u, and cosθ = (1 − u²)/(1 + u²).
            const double up = 1.0 + u2;
            texel.radiance += radiance;
            texel.irradiance += radiance * (4.0 * (1.0 - u2) / (up * up * up) * step * step);
            ++texel.above;
        }
    texel.samples = n * n;
    if (dome.is_smooth && texel.is_open)
        texel.middle = distance < 1.0 ? glm::dvec3(dome.radiance(sky_map_direction(glm::vec2(middle))))
                                      : beyond_horizon(dome, middle, distance);
    return texel;
}

// Changes the finest level so that its spline (sky_map.glsl) passes through what a smooth dome has in the texels'
// middles, which means would flatten. Each pass takes a quarter of what is missing of a checkerboard, and of
// smooth skies nearly all. The outermost texels stay as they are: no lookup is theirs alone.
void make_spline(const std::vector<Texel>& texels, std::size_t size, std::vector<glm::vec3>& open) {
    constexpr int kPasses = 8;
    constexpr std::array kWeights{0.125f, 0.75f, 0.125f};
    std::vector<glm::vec3> changed(open.size());
    for (int pass = 0; pass < kPasses; ++pass) {
        tbb::parallel_for(std::size_t{0}, size, [&](std::size_t row) {
            for (std::size_t column = 0; column < size; ++column) {
                const std::size_t i = row * size + column;
                changed[i] = open[i];
                if (row == 0 || column == 0 || row + 1 == size || column + 1 == size) continue;
                glm::vec3 spline(0.0f);
                bool inside = true;
                for (std::size_t y = 0; y < 3; ++y)
                    for (std::size_t x = 0; x < 3; ++x) {
                        const std::size_t at = i + (y * size + x) - size - 1;
                        inside = inside && texels[at].is_open;
                        spline += kWeights[x] * kWeights[y] * open[at];
                    }
                if (inside) changed[i] = glm::max(open[i] + glm::vec3(texels[i].middle) - spline, 0.0f);
            }
        });
        open.swap(changed);
    }
}

// Texels whose middles lie in a ring round the zenith, and between which angles from it [rad] they reach.
struct Ring {
    std::vector<std::size_t> texels;
    double from_zenith = kPi, to_zenith = 0.0;
};

template <class Corner>
std::vector<Ring> rings_of(std::size_t texels, double side, double height, const Corner& corner) {
    std::vector<Ring> rings;
    for (std::size_t i = 0; i < texels; ++i) {
        const double distance = glm::length(corner(i) + 0.5 * side), reach = side * std::sqrt(0.5);
        // A place u of the stereographic projection is 2 arctan |u| from the zenith.
        const auto number = static_cast<std::size_t>(2.0 * std::atan(distance) / height);
        if (rings.size() <= number) rings.resize(number + 1);
        Ring& ring = rings[number];
        ring.texels.push_back(i);
        ring.from_zenith = std::min(ring.from_zenith, 2.0 * std::atan(std::max(0.0, distance - reach)));
        if (distance > 1.0)  // what is past the horizon comes from as far above it
            ring.from_zenith =
                std::min(ring.from_zenith, 2.0 * std::atan(std::max(0.0, 2.0 - distance - reach)));
        ring.to_zenith = std::max(ring.to_zenith, 2.0 * std::atan(distance + reach));
    }
    return rings;
}

}  // namespace

float diffuse_fresnel() {
    return sky_shading::Fresnel().kDiffuseFresnel;
}

BakedSky bake_sky_map(int size, const SkyDome& dome) {
    SkyMap::check_size(size);
    BakedSky baked;
    const auto n = static_cast<std::size_t>(size);
    const double side = 2.0 * kSkyMapExtent / size;
    std::vector<Texel> texels(n * n);
    const auto corner = [&](std::size_t texel) {
        return glm::dvec2(static_cast<double>(texel % n), static_cast<double>(texel / n)) * side -
               static_cast<double>(kSkyMapExtent);
    };
    for (const Ring& ring : rings_of(n * n, side, dome.ring, corner)) {
        dome.prepare(ring.from_zenith, ring.to_zenith);
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, ring.texels.size()),
                          [&](const tbb::blocked_range<std::size_t>& range) {
                              for (std::size_t i = range.begin(); i < range.end(); ++i)
                                  texels[ring.texels[i]] = sampled(dome, corner(ring.texels[i]), side);
                          });
    }

    glm::dvec3 irradiance(0.0);
    for (const Texel& texel : texels) irradiance += texel.irradiance;
    const glm::dvec3 below = static_cast<double>(diffuse_fresnel()) / kPi * irradiance;

    std::vector<glm::vec3> means(n * n), open(n * n);
    for (std::size_t i = 0; i < means.size(); ++i) {
        const Texel& texel = texels[i];
        means[i] = (texel.radiance + below * static_cast<double>(texel.samples - texel.above)) /
                   static_cast<double>(texel.samples);
        open[i] = texel.is_open ? glm::vec3(texel.open / static_cast<double>(texel.samples)) : means[i];
    }
    if (dome.is_smooth) make_spline(texels, n, open);
    baked.irradiance = irradiance;
    baked.map = SkyMap(size, std::move(means), std::move(open));
    return baked;
}

}  // namespace pelagic
