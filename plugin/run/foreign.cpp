#include "plugin/run/foreign.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <optional>
#include <string_view>
#include <system_error>

#include "core/base/text.h"
#include "plugin/files/files.h"
#include "plugin/format/usd/layers.h"

namespace pelagic {
namespace {

namespace fs = std::filesystem;

// The name with its frame's number, the last part between dots that is one, as "####".
std::string without_number(const std::string& path) {
    const std::size_t suffix = path.rfind('.');
    const std::size_t number =
        suffix == std::string::npos || suffix == 0 ? suffix : path.rfind('.', suffix - 1);
    if (number == std::string::npos || number == suffix) return path;
    const FilePattern pattern{path.substr(0, number + 1), path.substr(suffix)};
    return frame_of(path, pattern) ? pattern.prefix + "####" + pattern.suffix : path;
}

struct Group {
    std::string example;
    int files = 0;
};
// By name without number, and by reason.
using Groups = std::map<std::pair<std::string, std::string>, Group>;

void add(Groups& groups, const std::string& path, const std::string& reason) {
    Group& group = groups[{without_number(path), reason}];
    if (group.files++ == 0) group.example = path;
}

std::vector<std::string> lines_of(const Groups& groups) {
    std::vector<std::string> lines;
    for (const auto& [key, group] : groups)
        lines.push_back(group.files == 1 ? line_text(group.example) + ": " + key.second
                                         : line_text(key.first) + ": " + std::to_string(group.files) +
                                               " files " + key.second);
    return lines;
}

}  // namespace

void for_each_bake_file(const fs::path& folder, const std::function<void(const std::string& path)>& take) {
    constexpr std::array kFolders{"", "mesh/", "maps/", "tiles/", "volumes/", "drops/"};
    for (const char* below : kFolders) {
        std::error_code error;
        for (const fs::directory_entry& entry : fs::directory_iterator(folder / below, error)) {
            if (entry.is_directory(error)) continue;
            const std::string name = entry.path().filename().string();
            const std::string extension = entry.path().extension().string();
            // Pictures and whatever people keep beside their bakes are none of a bake's business.
            const bool is_bakes =
                *below != '\0'
                    ? extension == ".usda" || extension == ".usdc" || extension == ".exr" ||
                          extension == ".vdb"
                    : extension == ".usda" || extension == ".json" || name.ends_with(".camera.usdc") ||
                          (name.ends_with(".exr") && name.find(".sky.") != std::string::npos);
            if (is_bakes && !name.starts_with('.')) take(below + name);
        }
    }
}

std::string shot_of(const std::string& path) {
    const std::string name = path.substr(path.rfind('/') + 1);  // all, without a folder
    return name.substr(0, name.find('.'));
}

std::optional<int> frame_of(std::string_view path, const FilePattern& pattern) {
    if (path.size() <= pattern.prefix.size() + pattern.suffix.size() || !path.starts_with(pattern.prefix) ||
        !path.ends_with(pattern.suffix))
        return {};
    path.remove_prefix(pattern.prefix.size());
    path.remove_suffix(pattern.suffix.size());
    int frame = 0;
    const auto [end, error] = std::from_chars(path.data(), path.data() + path.size(), frame);
    if (error != std::errc() || end != path.data() + path.size() || usd::frame_number(frame) != path)
        return {};
    return frame;
}

std::vector<std::string> foreign_files(const fs::path& folder, const Shot& shot,
                                       std::span<const RunPart> parts,
                                       const std::vector<std::string>& static_files) {
    // Whether the shot of that name has a record of its own here.
    std::map<std::string, bool> others;
    const auto has_record = [&](const std::string& name) {
        const auto [known, is_new] = others.try_emplace(name, false);
        if (is_new && name != shot.name)
            known->second = files::carries(folder / (name + ".json"), "\"pelagic\":");
        return known->second;
    };

    Groups groups;
    for_each_bake_file(folder, [&](const std::string& path) {
        if (std::find(static_files.begin(), static_files.end(), path) != static_files.end()) return;
        const std::string name = shot_of(path);
        if (has_record(name)) return;
        std::string reason = "of another shot";
        if (name == shot.name) reason = "of an output that the shot doesn't have";
        bool is_ours = false;
        for (const RunPart& part : parts)
            if (const auto frame = frame_of(path, part)) {
                is_ours = *frame >= shot.first_frame && *frame <= shot.last_frame;
                reason = "outside the shot's frames";
            }
        if (!is_ours) add(groups, path, reason);
    });
    return lines_of(groups);
}

std::string FilePattern::file(int frame) const {
    return prefix + usd::frame_number(frame) + suffix;
}

std::vector<int> frames_in(const fs::path& folder, const FilePattern& pattern) {
    std::vector<int> frames;
    std::error_code error;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, error))
        if (const auto frame = frame_of(entry.path().filename().string(), pattern)) frames.push_back(*frame);
    std::sort(frames.begin(), frames.end());
    return frames;
}

std::vector<std::string> foreign_pictures(const fs::path& folder, const Shot& shot,
                                          std::span<const RunPart> parts) {
    Groups groups;
    for (const RunPart& part : parts)
        for (const int frame : frames_in(folder, part))
            if (frame < shot.first_frame || frame > shot.last_frame)
                add(groups, part.file(frame), "outside the shot's frames");
    return lines_of(groups);
}

}  // namespace pelagic
