#include "pelagic/mask_picture.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "core/base/hash.h"
#include "core/scene/limits.h"
#include "core/scene/text.h"

namespace pelagic {
namespace {

std::string size_text(int width, int height, const char* what) {
    return std::to_string(width) + " x " + std::to_string(height) + ' ' + what;
}

// Means over `count` equal parts of `size` numbers that lie `step` apart, of each of `lines` lines.
std::vector<float> means(const std::vector<float>& of, int size, int count, std::size_t step, int lines,
                         std::size_t line_step) {
    std::vector<float> out(of.size() / static_cast<std::size_t>(size) * static_cast<std::size_t>(count));
    const std::size_t to_line = step == 1 ? static_cast<std::size_t>(count) : line_step;
    for (int part = 0; part < count; ++part) {
        const double first = static_cast<double>(part) * size / count,
                     end = static_cast<double>(part + 1) * size / count;
        const int from = static_cast<int>(first), to = std::min(static_cast<int>(std::ceil(end)), size);
        for (int line = 0; line < lines; ++line) {
            double sum = 0.0;
            for (int i = from; i < to; ++i)
                sum +=
                    (std::min<double>(i + 1, end) - std::max<double>(i, first)) *
                    static_cast<double>(
                        of[static_cast<std::size_t>(i) * step + static_cast<std::size_t>(line) * line_step]);
            out[static_cast<std::size_t>(part) * step + static_cast<std::size_t>(line) * to_line] =
                static_cast<float>(sum / (end - first));
        }
    }
    return out;
}

}  // namespace

MaskPicture::MaskPicture(int width, int height, std::vector<float> shares)
    : size_(width, height), shares_(std::move(shares)) {
    const auto refuse = [](const std::string& problem) {
        throw MaskPictureError(problem, "a picture of " + text_of(limits::kMaskPicture) +
                                            " pixels a side, with values of 0 … 1");
    };
    if (!limits::kMaskPicture.holds(width) || !limits::kMaskPicture.holds(height))
        refuse("has " + size_text(width, height, "pixels"));
    if (shares_.size() != static_cast<std::size_t>(width) * static_cast<std::size_t>(height))
        refuse("has " + std::to_string(shares_.size()) + " values for " + size_text(width, height, "pixels"));
    const auto bad =
        std::find_if(shares_.begin(), shares_.end(), [](float s) { return !(s >= 0.0f && s <= 1.0f); });
    if (bad != shares_.end()) {
        const std::ptrdiff_t at = bad - shares_.begin();
        refuse("has a value of " + number_text(static_cast<double>(*bad)) + " in its row " +
               std::to_string(at / width + 1) + ", column " + std::to_string(at % width + 1));
    }
    ByteHash hash;
    for (const float share : shares_) {
        const auto bits = std::bit_cast<std::uint32_t>(share + 0.0f);  // −0 is 0
        for (int byte = 0; byte < 4; ++byte) hash.add(static_cast<unsigned char>(bits >> 8 * byte));
    }
    content_ = size_text(width, height, "texels") + ", " + hash.text();
}

std::shared_ptr<const MaskCells> MaskPicture::cells(glm::ivec2 count) const {
    count = {std::clamp(count.x, 1, size_.x), std::clamp(count.y, 1, size_.y)};
    const std::lock_guard<std::mutex> lock(lock_);
    std::erase_if(made_, [](const auto& each) { return each.second.expired(); });
    std::weak_ptr<const MaskCells>& kept = made_[{count.x, count.y}];
    if (auto known = kept.lock()) return last_ = std::move(known);
    auto made = std::make_shared<MaskCells>();
    made->count = count;
    const auto width = static_cast<std::size_t>(size_.x), columns = static_cast<std::size_t>(count.x);
    const std::vector<float> narrow = means(shares_, size_.x, count.x, 1, size_.y, width);
    made->shares = means(narrow, size_.y, count.y, columns, count.x, 1);
    for (int row = 0; row < count.y / 2; ++row) {
        const auto low = made->shares.begin() + row * std::ptrdiff_t{count.x};
        std::swap_ranges(low, low + count.x,
                         made->shares.begin() + (count.y - 1 - row) * std::ptrdiff_t{count.x});
    }
    const auto most = std::max_element(made->shares.begin(), made->shares.end());
    made->most = *most;
    const auto at = static_cast<int>(most - made->shares.begin());
    made->most_at = {at % count.x, at / count.x};
    kept = made;
    return last_ = std::move(made);
}

}  // namespace pelagic
