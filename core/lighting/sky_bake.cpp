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

// What a texel's samples, or its spline, add up to.
struct Texel {
    float above = 0.0f;          // its share above the horizon
    glm::vec3 radiance{0.0f};    // mean of that, times the share
    glm::vec3 irradiance{0.0f};  // of it [radiance sr]
    glm::vec3 open{0.0f};        // of the sky as it is extended past the horizon, where the texel is_open
    bool is_open = false;
};

// Stereographic projection: dω = 4/(1 + u²)² d²u, and cosθ = (1 − u²)/(1 + u²).
double irradiance_weight(double u2, double side) {
    const double up = 1.0 + u2;
    return 4.0 * (1.0 - u2) / (up * up * up) * side * side;
}

// Texels around the horizon to which the sky extends: a lookup reaches 1½ to each side.
constexpr double kOpenTexels = 2.5;

// The sky continued past the horizon, by ratios so that it isn't negative: from the place as far above the horizon to
// the horizon it changes by a factor, and by the same factor again to here.
glm::dvec3 beyond_horizon(const SkyRadiance& radiance, glm::dvec2 u, double distance) {
    const auto at = [&](double place) {
        return glm::dvec3(radiance(sky_map_direction(glm::vec2(u * (place / distance)))));
    };
    const glm::dvec3 horizon = at(1.0 - 1e-7);
    const glm::dvec3 above = glm::max(at(2.0 - distance), 0.5 * horizon + 1e-300);  // at most twice as bright
    return horizon * (horizon / above);
}

// A texel of the map: where it lies, and how the horizon, |u| = 1, passes it.
struct TexelSquare {
    TexelSquare(std::size_t texel, std::size_t size)
        : side(2.0 * static_cast<double>(kSkyMapExtent) / static_cast<double>(size)),
          corner(glm::dvec2(static_cast<double>(texel % size), static_cast<double>(texel / size)) * side -
                 static_cast<double>(kSkyMapExtent)),
          middle(corner + 0.5 * side),
          distance(glm::length(middle)) {}
    double reach() const { return side * std::sqrt(0.5); }
    bool is_sky() const { return distance - reach() < 1.0; }  // some of it
    bool is_horizon() const { return is_sky() && distance + reach() > 1.0; }
    bool is_open() const { return distance - reach() < 1.0 + kOpenTexels * side && distance + reach() < 2.0; }

    double side;
    glm::dvec2 corner, middle;
    double distance;
};

// Over a texel's samples.
struct Sums {
    glm::dvec3 radiance{0.0}, irradiance{0.0}, open{0.0};
    int above = 0;

    // One above the horizon, of a square of u.
    void add(const glm::dvec3& sample, double u2, double side) {
        radiance += sample;
        irradiance += sample * irradiance_weight(u2, side);
        ++above;
    }
    void put(int samples, Texel& texel) const {
        texel.above = static_cast<float>(above) / static_cast<float>(samples);
        texel.radiance = radiance / static_cast<double>(samples);
        texel.irradiance = irradiance;
    }
};

Texel sampled(const SkyDome& dome, const TexelSquare& square) {
    Texel texel;
    texel.is_open = square.is_open();
    if (!square.is_sky() && !texel.is_open) return texel;
    const double distance = square.distance;
    const auto angle = static_cast<float>(2.0 * square.side / (1.0 + distance * distance));
    const double nearest = std::min(distance, 1.0 - 1e-7);
    int n = dome.samples(
        sky_map_direction(glm::vec2(distance > 0.0 ? square.middle * (nearest / distance) : square.middle)),
        angle);
    if (square.is_horizon()) n = std::max(n, kHorizonSamples);
    const double step = square.side / n;
    Sums sums;
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            const glm::dvec2 u = square.corner + step * glm::dvec2(i + 0.5, j + 0.5);
            const double u2 = glm::dot(u, u);
            if (u2 >= 1.0) {
                if (texel.is_open) sums.open += beyond_horizon(dome.radiance, u, std::sqrt(u2));
                continue;
            }
            const glm::dvec3 radiance(dome.radiance(sky_map_direction(glm::vec2(u))));
            sums.open += radiance;
            sums.add(radiance, u2, step);
        }
    sums.put(n * n, texel);
    texel.open = sums.open / static_cast<double>(n * n);
    return texel;
}

// A square of texels whose quadratic B-spline (sky_map.glsl) passes through given values in their middles.
class Spline {
  public:
    // Past the texels that are `known` it doesn't pass through what the values say. Each pass takes a quarter of what is
    // missing of a checkerboard, and of smooth skies nearly all.
    Spline(std::size_t size, const std::vector<glm::vec3>& values, const std::vector<char>& known)
        : size_(size), texels_(values) {
        std::vector<std::size_t> inside;
        for (std::size_t i = 0; i < known.size(); ++i) {
            const std::size_t row = i / size, column = i % size;
            if (row == 0 || column == 0 || row + 1 == size || column + 1 == size) continue;
            bool all = true;
            for (std::size_t y = 0; y < 3; ++y)
                for (std::size_t x = 0; x < 3; ++x) all = all && known[i + (y * size + x) - size - 1];
            if (all) inside.push_back(i);
        }
        constexpr int kPasses = 4;
        std::vector<glm::vec3> changed(texels_);
        for (int pass = 0; pass < kPasses; ++pass) {
            tbb::parallel_for(tbb::blocked_range<std::size_t>(0, inside.size(), 4096),
                              [&](const tbb::blocked_range<std::size_t>& range) {
                                  for (std::size_t k = range.begin(); k < range.end(); ++k) {
                                      const std::size_t i = inside[k];
                                      const glm::vec3 here = at(i, glm::vec2(0.0f));
                                      changed[i] = glm::max(texels_[i] + values[i] - here, 0.0f);
                                  }
                              });
            texels_.swap(changed);
        }
    }

    const glm::vec3& texel(std::size_t i) const { return texels_[i]; }
    // Over a texel.
    glm::vec3 mean(std::size_t i) const { return weighted(i, kMean, kMean); }
    // At a place in a texel, from its middle, −½ … ½ of its side.
    glm::vec3 at(std::size_t i, glm::vec2 t) const { return weighted(i, weights(t.x), weights(t.y)); }

  private:
    using Weights = std::array<float, 3>;  // of the texel before, this one and the next
    static constexpr Weights kMean{1.0f / 6.0f, 2.0f / 3.0f, 1.0f / 6.0f};
    static Weights weights(float t) {
        return {0.5f * (0.5f - t) * (0.5f - t), 0.75f - t * t, 0.5f * (0.5f + t) * (0.5f + t)};
    }
    glm::vec3 weighted(std::size_t i, const Weights& x, const Weights& y) const {
        const std::size_t row = i / size_, column = i % size_;
        const std::array columns{column > 0 ? column - 1 : 0, column, std::min(column + 1, size_ - 1)};
        const std::array rows{row > 0 ? row - 1 : 0, row, std::min(row + 1, size_ - 1)};
        glm::vec3 sum(0.0f);
        for (std::size_t b = 0; b < 3; ++b) {
            const glm::vec3* from = &texels_[rows[b] * size_];
            sum += y[b] * (x[0] * from[columns[0]] + x[1] * from[columns[1]] + x[2] * from[columns[2]]);
        }
        return sum;
    }

    std::size_t size_;
    std::vector<glm::vec3> texels_;
};

// Texels whose middles lie in a ring round the zenith, and between which angles from it [rad] they reach.
struct Ring {
    std::vector<std::size_t> texels;
    double from_zenith = kPi, to_zenith = 0.0;
};

std::vector<Ring> rings_of(std::size_t size, double height) {
    std::vector<Ring> rings;
    for (std::size_t i = 0; i < size * size; ++i) {
        const TexelSquare square(i, size);
        const double distance = square.distance, reach = square.reach();
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

BakedSky baked_from(int size, const std::vector<Texel>& texels) {
    glm::dvec3 irradiance(0.0);
    for (const Texel& texel : texels) irradiance += texel.irradiance;
    const glm::vec3 below(static_cast<double>(diffuse_fresnel()) / kPi * irradiance);
    std::vector<glm::vec3> means(texels.size()), open(texels.size());
    for (std::size_t i = 0; i < means.size(); ++i) {
        const Texel& texel = texels[i];
        means[i] = texel.radiance + below * (1.0f - texel.above);
        open[i] = texel.is_open ? texel.open : means[i];
    }
    return {SkyMap(size, std::move(means), std::move(open)), glm::vec3(irradiance)};
}

}  // namespace

float diffuse_fresnel() {
    return sky_shading::Fresnel().kDiffuseFresnel;
}

BakedSky bake_sky_map(int size, const SkyDome& dome) {
    SkyMap::check_size(size);
    const auto n = static_cast<std::size_t>(size);
    std::vector<Texel> texels(n * n);
    for (const Ring& ring : rings_of(n, dome.ring)) {
        dome.prepare(ring.from_zenith, ring.to_zenith);
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, ring.texels.size()),
                          [&](const tbb::blocked_range<std::size_t>& range) {
                              for (std::size_t i = range.begin(); i < range.end(); ++i)
                                  texels[ring.texels[i]] = sampled(dome, TexelSquare(ring.texels[i], n));
                          });
    }
    return baked_from(size, texels);
}

BakedSky bake_smooth_sky_map(int size, const SkyRadiance& radiance) {
    SkyMap::check_size(size);
    const auto n = static_cast<std::size_t>(size);
    std::vector<glm::vec3> middles(n * n);
    std::vector<char> known(n * n);
    tbb::parallel_for(std::size_t{0}, n, [&](std::size_t row) {
        for (std::size_t i = row * n; i < (row + 1) * n; ++i) {
            const TexelSquare square(i, n);
            if (!square.is_open()) continue;
            known[i] = 1;
            middles[i] = square.distance < 1.0
                             ? radiance(sky_map_direction(glm::vec2(square.middle)))
                             : glm::vec3(beyond_horizon(radiance, square.middle, square.distance));
        }
    });
    const Spline spline(n, middles, known);
    std::vector<Texel> texels(n * n);
    tbb::parallel_for(std::size_t{0}, n, [&](std::size_t row) {
        for (std::size_t i = row * n; i < (row + 1) * n; ++i) {
            const TexelSquare square(i, n);
            Texel& texel = texels[i];
            texel.is_open = known[i] != 0;
            texel.open = spline.texel(i);
            if (!square.is_sky()) continue;
            Sums sums;
            if (!square.is_horizon()) {
                sums.add(glm::dvec3(spline.mean(i)), glm::dot(square.middle, square.middle), square.side);
                sums.put(1, texel);
                continue;
            }
            for (int k = 0; k < kHorizonSamples * kHorizonSamples; ++k) {
                const glm::dvec2 t = (glm::dvec2(k % kHorizonSamples, k / kHorizonSamples) + 0.5) /
                                         static_cast<double>(kHorizonSamples) -
                                     0.5;
                const glm::dvec2 u = square.middle + t * square.side;
                if (const double u2 = glm::dot(u, u); u2 < 1.0)
                    sums.add(glm::dvec3(spline.at(i, glm::vec2(t))), u2, square.side / kHorizonSamples);
            }
            sums.put(kHorizonSamples * kHorizonSamples, texel);
        }
    });
    return baked_from(size, texels);
}

}  // namespace pelagic
