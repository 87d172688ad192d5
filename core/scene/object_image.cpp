// A body's picture and its mip levels. The counterpart of what OpenGL does with a texture that has the same levels.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/gtc/packing.hpp>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "core/scene/limits.h"
#include "pelagic/object_mesh.h"

namespace pelagic {
namespace {

using Level = ObjectImage::Level;

// The shares of the texels of a side that lie in one of the half as long side, of which there are at most three.
struct Taps {
    int first = 0, count = 0;
    std::array<float, 3> share{};
};
Taps taps_of(int index, int side, int half) {
    // In parts of 1/half of a texel: texel i is from half · i to half · (i + 1).
    const auto begin = static_cast<std::int64_t>(index) * side, end = begin + side;
    Taps taps{.first = static_cast<int>(begin / half)};
    for (std::int64_t at = begin; at < end; ++taps.count) {
        const std::int64_t next = std::min((at / half + 1) * half, end);
        taps.share[static_cast<std::size_t>(taps.count)] =
            static_cast<float>(next - at) / static_cast<float>(side);
        at = next;
    }
    return taps;
}

std::size_t texel_at(const Level& level, int x, int y) {
    return 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(level.width) +
                static_cast<std::size_t>(x));
}
glm::vec3 texel(const Level& level, int x, int y) {
    const std::size_t at = texel_at(level, x, y);
    return {glm::unpackHalf1x16(level.rgb[at]), glm::unpackHalf1x16(level.rgb[at + 1]),
            glm::unpackHalf1x16(level.rgb[at + 2])};
}

Level half_of(const Level& whole) {
    Level half{.width = std::max(whole.width / 2, 1), .height = std::max(whole.height / 2, 1), .rgb = {}};
    half.rgb.resize(3 * static_cast<std::size_t>(half.width) * static_cast<std::size_t>(half.height));
    std::vector<Taps> columns;
    for (int x = 0; x < half.width; ++x) columns.push_back(taps_of(x, whole.width, half.width));
    for (int y = 0; y < half.height; ++y) {
        const Taps rows = taps_of(y, whole.height, half.height);
        for (int x = 0; x < half.width; ++x) {
            const Taps& across = columns[static_cast<std::size_t>(x)];
            glm::vec3 sum(0.0f);
            for (int j = 0; j < rows.count; ++j)
                for (int i = 0; i < across.count; ++i)
                    sum += rows.share[static_cast<std::size_t>(j)] *
                           across.share[static_cast<std::size_t>(i)] *
                           texel(whole, across.first + i, rows.first + j);
            const std::size_t at = texel_at(half, x, y);
            for (int c = 0; c < 3; ++c)
                half.rgb[at + static_cast<std::size_t>(c)] =
                    glm::packHalf1x16(std::min(sum[c], 1.0f));  // shares may add up to a little more
        }
    }
    return half;
}

glm::vec3 between_texels(const Level& level, glm::vec2 at) {
    const auto wrapped = [](float whole, int side) {  // a whole number, of any size
        const float side_f = static_cast<float>(side);
        return std::clamp(static_cast<int>(whole - side_f * std::floor(whole / side_f)), 0, side - 1);
    };
    const glm::vec2 place = (at - glm::floor(at)) * glm::vec2(level.width, level.height) - 0.5f,
                    low = glm::floor(place), share = place - low;
    const int x0 = wrapped(low.x, level.width), x1 = x0 + 1 < level.width ? x0 + 1 : 0,
              y0 = wrapped(low.y, level.height), y1 = y0 + 1 < level.height ? y0 + 1 : 0;
    return glm::mix(glm::mix(texel(level, x0, y0), texel(level, x1, y0), share.x),
                    glm::mix(texel(level, x0, y1), texel(level, x1, y1), share.x), share.y);
}

}  // namespace

ObjectImage::ObjectImage(int width, int height, std::vector<std::uint16_t> rgb) {
    const auto refuse = [&](const std::string& problem, const std::string& accepted) {
        throw std::invalid_argument("a picture of " + std::to_string(width) + " x " + std::to_string(height) +
                                    " texels" + problem + "; accepted: " + accepted);
    };
    const auto is_side = [](int side) { return side >= 1 && side <= limits::kObjectImageSide; };
    if (!is_side(width) || !is_side(height))
        refuse("", "1 … " + std::to_string(limits::kObjectImageSide) + " a side");
    const std::size_t count = 3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    if (rgb.size() != count)
        refuse(" has " + std::to_string(rgb.size()) + " numbers", std::to_string(count) + ", three a texel");
    constexpr std::uint16_t kOne =
        0x3c00;  // larger bits are larger numbers, infinities, those that are none, and below 0
    if (std::ranges::any_of(rgb, [](std::uint16_t bits) { return bits > kOne; }))
        refuse(" has a number outside the range", "0 … 1");
    levels_.push_back({width, height, std::move(rgb)});
    while (levels_.back().width > 1 || levels_.back().height > 1) levels_.push_back(half_of(levels_.back()));
}

glm::vec3 ObjectImage::mean() const {
    return texel(levels_.back(), 0, 0);
}

glm::vec3 ObjectImage::colour(glm::vec2 at, float level) const {
    const auto last = static_cast<float>(levels_.size() - 1);
    if (!(level > 0.0f)) return between_texels(levels_.front(), at);
    if (level >= last) return mean();
    const auto fine = static_cast<std::size_t>(level);
    return glm::mix(between_texels(levels_[fine], at), between_texels(levels_[fine + 1], at),
                    level - static_cast<float>(fine));
}

std::size_t ObjectImage::bytes() const {
    std::size_t all = sizeof *this;
    for (const Level& level : levels_) all += sizeof level + level.rgb.capacity() * sizeof(std::uint16_t);
    return all;
}

}  // namespace pelagic
