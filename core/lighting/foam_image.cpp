#include "core/lighting/foam_image.h"

#include <oneapi/tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <stdexcept>
#include <string>
#include <tuple>

#include "core/base/constants.h"

namespace pelagic {
namespace {

// The next mip level.
std::vector<float> halved(const std::vector<float>& values, int side) {
    std::vector<float> means;
    means.reserve(values.size() / 4);
    for (int y = 0; y < side; y += 2)
        for (int x = 0; x < side; x += 2) {
            const float* const from = values.data() + static_cast<std::ptrdiff_t>(y) * side + x;
            means.push_back(0.25f * (from[0] + from[1] + from[side] + from[side + 1]));
        }
    return means;
}

// The z below which a normal variable lies with the chance p, 0 < p < 1: Newton's method on the rational approximation of Abramowitz
// and Stegun 26.2.23, whose error is 4.5e-4.
double normal_quantile(double p) {
    const double tail = std::min(p, 1.0 - p), t = std::sqrt(-2.0 * std::log(tail));
    double z = t - (2.515517 + t * (0.802853 + t * 0.010328)) /
                       (1.0 + t * (1.432788 + t * (0.189269 + t * 0.001308)));
    for (int i = 0; i < 2; ++i)
        z += (0.5 * std::erfc(z / std::sqrt(2.0)) - tail) * std::sqrt(kTwoPi) * std::exp(0.5 * z * z);
    return p < 0.5 ? -z : z;
}

// How bright the surroundings of each pixel are, near ones most: the sum of all further mip levels.
std::vector<float> surroundings(const std::vector<float>& values, int side) {
    if (side == 1) return {0.0f};
    const std::vector<float> means = halved(values, side), beyond = surroundings(means, side / 2);
    std::vector<float> out(values.size());
    const auto width = static_cast<std::size_t>(side);
    for (std::size_t i = 0; i < out.size(); ++i) {
        const std::size_t at = i / width / 2 * (width / 2) + i % width / 2;
        out[i] = means[at] + beyond[at];
    }
    return out;
}

// Normal scores by rank, variance 1. Of pixels of one brightness (much of a picture may be black) those are higher whose surroundings
// are brighter, and otherwise any.
std::vector<float> ranked(const std::vector<float>& values, int side) {
    const std::vector<float> around = surroundings(values, side);
    const auto any = [](std::uint32_t i) { return (i ^ (i >> 7)) * 0x9E3779B1u; };
    std::vector<std::uint32_t> order(values.size());
    std::iota(order.begin(), order.end(), 0u);
    tbb::parallel_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        return std::tuple(values[a], around[a], any(a), a) < std::tuple(values[b], around[b], any(b), b);
    });
    std::vector<float> out(values.size());
    double squares = 0.0;
    const auto count = static_cast<double>(order.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
        const double z = normal_quantile((static_cast<double>(i) + 0.5) / count);
        out[order[i]] = static_cast<float>(z);
        squares += z * z;
    }
    const auto scale = static_cast<float>(squares > 0.0 ? std::sqrt(count / squares) : 0.0);
    for (float& z : out) z *= scale;
    return out;
}

// Of a periodic square, read bilinearly, over all places: a linear blend has 2/3 and twice 1/6 of the correlations along an axis.
double variance_between(const std::vector<float>& values, int side) {
    const auto at = [&](int x, int y) {
        return static_cast<double>(
            values[static_cast<std::size_t>(y & (side - 1)) * static_cast<std::size_t>(side) +
                   static_cast<std::size_t>(x & (side - 1))]);
    };
    double sum = 0.0;
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
            const double here = 2.0 / 3.0 * at(x, y) + (at(x - 1, y) + at(x + 1, y)) / 6.0;
            const double above = 2.0 / 3.0 * at(x, y + 1) + (at(x - 1, y + 1) + at(x + 1, y + 1)) / 6.0;
            sum += at(x, y) * (2.0 / 3.0 * here + above / 3.0);
        }
    return std::max(sum / (static_cast<double>(side) * side), 0.0);
}

}  // namespace

void check_foam_image_side(int side) {
    if (side < FoamImage::kLeastSide || side > FoamImage::kMostSide || (side & (side - 1)) != 0)
        throw std::invalid_argument("has a side of " + std::to_string(side) + " pixels");
}

FoamImage make_foam_image(int side, std::span<const float> brightness) {
    check_foam_image_side(side);
    if (brightness.size() != static_cast<std::size_t>(side) * static_cast<std::size_t>(side))
        throw std::logic_error("a picture of foam without all of its pixels");
    if (!std::all_of(brightness.begin(), brightness.end(), [](float value) { return std::isfinite(value); }))
        throw std::invalid_argument("has pixels that aren't finite");
    FoamImage image{.side = side, .texels = {}};
    const auto width = static_cast<std::size_t>(side);
    image.texels.assign(width * static_cast<std::size_t>(image.rows()), 0.0f);
    float* const variances = image.texels.data() + width * static_cast<std::size_t>(image.rows() - 1);
    if (std::all_of(brightness.begin(), brightness.end(),
                    [&](float value) { return value == brightness[0]; }))
        throw std::invalid_argument("is of one brightness all over");
    std::vector<float> level = ranked({brightness.begin(), brightness.end()}, side);
    std::size_t row = 0;
    for (int i = 0, n = side;; ++i, n /= 2) {
        double squares = 0.0;
        for (const float value : level) squares += static_cast<double>(value * value);
        const auto deviation = static_cast<float>(std::sqrt(squares / static_cast<double>(level.size())));
        if (i > 0) {
            level = ranked(level, n);
            for (float& value : level) value *= deviation;
        }
        variances[i] = static_cast<float>(variance_between(level, n));
        for (int y = 0; y < n; ++y)
            std::copy_n(level.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(n), n,
                        image.texels.data() + (row + static_cast<std::size_t>(y)) * width);
        row += static_cast<std::size_t>(n);
        if (n == 1) break;
        level = halved(level, n);
    }
    return image;
}

}  // namespace pelagic
