#include "pelagic/depth_map.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <glm/common.hpp>
#include <stdexcept>

#include "core/base/hash.h"
#include "core/scene/text.h"

namespace pelagic {
namespace {

// The parts of `count` texels, from the map's first one on, that an interval covers; at least one texel's worth is asked for, so that
// what is narrower is interpolated linearly.
struct Cover {
    int first, last;
    double from, to;
    Cover(double a, double b, int count) {
        const double middle = 0.5 * (a + b), half = std::max(0.5 * (b - a), 0.5);
        from = middle - half;
        to = middle + half;
        const auto within = [&](double at) {
            return static_cast<int>(std::clamp(std::floor(at), 0.0, count - 1.0));
        };
        first = within(from);
        last = within(std::ceil(to) - 1.0);
        last = std::max(first, last);
        count_ = count;
    }
    // Of texel i; those at the map's edges go on beyond it.
    double share(int i) const {
        const double low = i == 0 ? from : std::max<double>(i, from),
                     high = i == count_ - 1 ? to : std::min<double>(i + 1, to);
        return std::max(high - low, 0.0) / (to - from);
    }

  private:
    int count_;
};

}  // namespace

DepthMap::DepthMap(glm::ivec2 columns_rows, std::vector<float> depths_m, glm::dvec2 from_m, glm::dvec2 size_m)
    : columns_rows_(columns_rows), depths_m_(std::move(depths_m)), from_m_(from_m), size_m_(size_m) {
    if (!(columns_rows.x >= 1 && columns_rows.y >= 1 && size_m.x > 0.0 && size_m.y > 0.0) ||
        !std::isfinite(size_m.x + size_m.y + from_m.x + from_m.y))
        throw std::invalid_argument("a map of depths has no size");
    if (depths_m_.size() !=
        static_cast<std::size_t>(columns_rows.x) * static_cast<std::size_t>(columns_rows.y))
        throw std::invalid_argument("a map of depths has another number of values than texels");
    if (!std::ranges::all_of(depths_m_, [](float depth) { return std::isfinite(depth); }))
        throw std::invalid_argument("a map of depths has values that are no numbers");
    ByteHash hash;
    for (const float depth : depths_m_) {
        const auto bits = std::bit_cast<std::uint32_t>(depth + 0.0f);  // −0 is 0
        for (int byte = 0; byte < 4; ++byte) hash.add(static_cast<unsigned char>(bits >> 8 * byte));
    }
    content_ = std::to_string(columns_rows.x) + " x " + std::to_string(columns_rows.y) + " depths";
    for (const double number : {from_m.x, from_m.y, size_m.x, size_m.y})
        content_ += ' ' + number_text(number);
    content_ += ", " + hash.text();
}

double DepthMap::mean_m(glm::dvec2 from_m, glm::dvec2 to_m) const {
    const glm::dvec2 per_m = glm::dvec2(columns_rows_) / size_m_, from = (from_m - from_m_) * per_m,
                     to = (to_m - from_m_) * per_m;
    const Cover columns(from.x, to.x, columns_rows_.x), rows(from.y, to.y, columns_rows_.y);
    double sum = 0.0;
    for (int y = rows.first; y <= rows.last; ++y)
        for (int x = columns.first; x <= columns.last; ++x)
            sum += rows.share(y) * columns.share(x) *
                   static_cast<double>(
                       depths_m_[static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_rows_.x) +
                                 static_cast<std::size_t>(x)]);
    return sum;
}

}  // namespace pelagic
