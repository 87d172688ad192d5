#include "plugin/format/shot/mask_files.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <system_error>
#include <utility>

#include "core/scene/keys.h"
#include "core/scene/limits.h"
#include "core/scene/text.h"
#include "plugin/format/exr/read.h"

namespace pelagic {
namespace {

std::shared_ptr<const MaskPicture> read_picture(const std::filesystem::path& file) {
    const exr::RgbFile picture(file);
    const int width = picture.width(), height = picture.height();
    // Before it takes memory for the pixels.
    if (!limits::kMaskPicture.holds(width) || !limits::kMaskPicture.holds(height))
        return std::make_shared<const MaskPicture>(width, height, std::vector<float>());
    std::vector<float> shares(static_cast<std::size_t>(width) * static_cast<std::size_t>(height)),
        rgb(3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(picture.rows_in_piece()));
    auto to = shares.begin();
    for (int row = 0; row < height; row += picture.rows_in_piece()) {
        const int rows = std::min(picture.rows_in_piece(), height - row);
        const std::span<float> piece =
            std::span(rgb).first(3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(rows));
        picture.read(row, piece);
        for (std::size_t i = 0; i < piece.size(); i += 3)
            *to++ = static_cast<float>((static_cast<double>(piece[i]) + static_cast<double>(piece[i + 1]) +
                                        static_cast<double>(piece[i + 2])) /
                                       3.0);
    }
    return std::make_shared<const MaskPicture>(width, height, std::move(shares));
}

// A file as it was when it was read, and what it held.
struct Kept {
    std::filesystem::file_time_type time;
    std::uintmax_t bytes = 0;
    std::weak_ptr<const MaskPicture> picture;
};

std::shared_ptr<const MaskPicture> picture_in(const std::filesystem::path& file) {
    static std::mutex lock;
    static auto& kept = *new std::map<std::string, Kept>;
    std::error_code no_time, no_size;
    const auto time = std::filesystem::last_write_time(file, no_time);
    const std::uintmax_t bytes = std::filesystem::file_size(file, no_size);
    const std::lock_guard<std::mutex> alone(lock);
    std::erase_if(kept, [](const auto& each) { return each.second.picture.expired(); });
    const bool is_known = !no_time && !no_size;
    if (const auto found = kept.find(file.string());
        is_known && found != kept.end() && found->second.time == time && found->second.bytes == bytes)
        if (auto picture = found->second.picture.lock()) return picture;
    auto picture = read_picture(file);
    if (is_known) kept[file.string()] = {time, bytes, picture};
    return picture;
}

}  // namespace

std::vector<Problem> read_mask_pictures(Waves& waves, const std::filesystem::path& folder) {
    std::vector<Problem> problems;
    std::map<std::string, std::shared_ptr<const MaskPicture>> pictures;
    for (std::size_t i = 0; i < waves.masks.size(); ++i) {
        std::optional<std::string>& name = waves.masks[i].picture;
        if (!name) continue;
        const auto refuse = [&](const std::string& problem, const std::string& accepted) {
            problems.push_back({"waves.masks[" + std::to_string(i) + "].picture", quoted_text(*name),
                                line_text(problem), accepted});
        };
        const std::filesystem::path file = folder / *name;
        try {
            // The system takes a path up to its first NUL.
            std::error_code ignored;
            if (name->find('\0') != std::string::npos || !std::filesystem::is_regular_file(file, ignored)) {
                refuse("is no file in " + quoted_text(folder.empty() ? "." : folder.string()),
                       key_of("waves.masks[].picture").accepted);
                continue;
            }
            pictures[file.string()] = picture_in(file);
            name = file.string();
        } catch (const exr::ReadError& error) {
            refuse(error.problem(), error.accepted());
        } catch (const MaskPictureError& error) {
            refuse(error.problem(), error.accepted());
        }
    }
    waves.mask_pictures = std::move(pictures);
    return problems;
}

}  // namespace pelagic
