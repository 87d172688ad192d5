// The stereographic map's levels and lookup. Projection: Bruneton, Neyret, Holzschuch 2010, §5.2. Lookup:
// OpenGL 3.3, sections 3.8.8 (mipmaps) and 3.8.11, so that a texture with the same levels gives the same
// values.
#include "core/lighting/sky_map.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <glm/glm.hpp>
#include <stdexcept>
#include <string>
#include <utility>

namespace pelagic {
namespace projection {
using namespace glm;
#include "core/lighting/special.glsl"

struct Lookup {
    const SkyMap& map;
    const float kSkyMapSize;

    vec3 sky_texel(ivec2 at) const {
        return map.level(0)[static_cast<std::size_t>(at.y) * static_cast<std::size_t>(map.size()) +
                            static_cast<std::size_t>(at.x)];
    }
    vec3 sky_filtered(vec2 u, float level) const { return map.trilinear(u, level); }

#include "core/lighting/sky_map.glsl"
};
}  // namespace projection

namespace {

constexpr int kSmallest = 4, kLargest = 4096;

bool is_radiance(glm::vec3 value) {
    for (int c = 0; c < 3; ++c)
        if (!(value[c] >= 0.0f) || !std::isfinite(value[c])) return false;
    return true;
}

std::vector<glm::vec3> halved(const std::vector<glm::vec3>& fine, std::size_t fine_size) {
    const std::size_t size = fine_size / 2;
    std::vector<glm::vec3> coarse(size * size);
    for (std::size_t j = 0; j < size; ++j)
        for (std::size_t i = 0; i < size; ++i) {
            const glm::vec3* low = &fine[2 * j * fine_size + 2 * i];
            const glm::vec3* high = low + fine_size;
            coarse[j * size + i] = 0.25f * ((low[0] + low[1]) + (high[0] + high[1]));
        }
    return coarse;
}

// Clamps x; NaN gives `low`.
float bounded(float x, float low, float high) {
    return x > low ? std::min(x, high) : low;
}

// The two samples around a coordinate in texels, clamped to the picture, and the weight of the second.
struct Between {
    std::size_t first, second;
    float weight;
};

Between between(float u, int size) {
    const float n = static_cast<float>(size);
    // Outside the picture both samples are at the edge, however far away u is.
    const float x = bounded((0.5f * u / kSkyMapExtent + 0.5f) * n - 0.5f, -1.0f, n);
    const float floor = std::floor(x);
    const int first = static_cast<int>(floor);
    const auto inside = [&](int i) { return static_cast<std::size_t>(std::clamp(i, 0, size - 1)); };
    return {inside(first), inside(first + 1), x - floor};
}

glm::vec3 bilinear(const std::vector<glm::vec3>& texels, int size, glm::vec2 u) {
    const Between x = between(u.x, size), y = between(u.y, size);
    const glm::vec3* low = texels.data() + y.first * static_cast<std::size_t>(size);
    const glm::vec3* high = texels.data() + y.second * static_cast<std::size_t>(size);
    return glm::mix(glm::mix(low[x.first], low[x.second], x.weight),
                    glm::mix(high[x.first], high[x.second], x.weight), y.weight);
}

}  // namespace

void SkyMap::check_size(int size) {
    if (size < kSmallest || size > kLargest || !std::has_single_bit(static_cast<unsigned>(size)))
        throw std::invalid_argument("a sky map of size " + std::to_string(size) +
                                    ": a power of two from 4 to 4096 is accepted");
}

SkyMap::SkyMap(int size, std::vector<glm::vec3> texels, std::vector<glm::vec3> open) : size_(size) {
    check_size(size);
    const auto n = static_cast<std::size_t>(size);
    if (texels.size() != n * n)
        throw std::invalid_argument(std::to_string(texels.size()) + " texels for a sky map of " +
                                    std::to_string(size) + " x " + std::to_string(size));
    const auto wrong = std::find_if_not(texels.begin(), texels.end(), is_radiance);
    if (wrong != texels.end()) {
        const auto i = static_cast<std::size_t>(wrong - texels.begin());
        throw std::invalid_argument("sky map texel (" + std::to_string(i % n) + ", " + std::to_string(i / n) +
                                    ") is negative or not finite: a radiance is neither");
    }
    if (!open.empty() && (open.size() != n * n || !std::all_of(open.begin(), open.end(), is_radiance)))
        throw std::invalid_argument("a sky map's open texels are as many as the others, and radiances");
    levels_.push_back(std::move(texels));
    for (std::size_t s = n; s > 1; s /= 2) levels_.push_back(halved(levels_.back(), s));
    if (!open.empty()) levels_.front() = std::move(open);
}

glm::vec3 SkyMap::radiance(glm::vec2 u, float level) const {
    return projection::Lookup{*this, static_cast<float>(size_)}.mapped_sky(u, level);
}

glm::vec3 SkyMap::open_radiance(glm::vec2 u) const {
    return projection::Lookup{*this, static_cast<float>(size_)}.sky_smooth(u);
}

glm::vec3 SkyMap::trilinear(glm::vec2 u, float level) const {
    const float l = bounded(level, 0.0f, static_cast<float>(level_count() - 1));
    const int fine = static_cast<int>(l);
    const int coarse = std::min(fine + 1, level_count() - 1);
    const auto at = [&](int i) { return bilinear(levels_[static_cast<std::size_t>(i)], size_ >> i, u); };
    return glm::mix(at(fine), at(coarse), l - static_cast<float>(fine));
}

glm::vec2 sky_map_place(glm::vec3 direction) {
    const glm::vec2 across(direction.x, direction.y);
    const float up = 1.0f + direction.z;
    // Straight down is the projection's pole. The map's edge has the same radiance.
    if (!(std::max(std::abs(across.x), std::abs(across.y)) < kSkyMapExtent * up)) {
        const float largest = std::max(std::abs(across.x), std::abs(across.y));
        return largest > 0.0f ? across * (kSkyMapExtent / largest) : glm::vec2(kSkyMapExtent, 0.0f);
    }
    return projection::sky_place(direction);
}

glm::vec3 sky_map_direction(glm::vec2 u) {
    const float u2 = glm::dot(u, u);
    return glm::vec3(2.0f * u, 1.0f - u2) / (1.0f + u2);
}

}  // namespace pelagic
