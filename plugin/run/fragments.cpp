#include "plugin/run/fragments.h"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <map>
#include <optional>
#include <random>
#include <string_view>
#include <system_error>
#include <tuple>
#include <utility>

#include "core/base/text.h"
#include "plugin/run/run.h"

namespace pelagic {
namespace {

namespace fs = std::filesystem;

fs::path folder_of(const fs::path& record) {
    return record.parent_path() / "record";
}

// FIRST-LAST.COUNT.ID.json; nothing of any other name.
std::optional<Fragment> fragment_of(std::string_view rest) {
    Fragment fragment;
    const auto take = [&](int& number, std::string_view after) {
        const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), number);
        if (error != std::errc()) return false;
        rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
        if (!rest.starts_with(after)) return false;
        rest.remove_prefix(after.size());
        return true;
    };
    if (!take(fragment.first, "-") || !take(fragment.last, ".") || !take(fragment.frames, ".") ||
        !rest.ends_with(".json"))
        return {};
    if (fragment.frames < 0 || fragment.frames > std::int64_t{fragment.last} - fragment.first + 1) return {};
    return fragment;
}

std::string path_below(const fs::path& record, const fs::path& file) {
    return file.lexically_relative(record.parent_path()).generic_string();  // it may be gone by now
}

using Frames = std::map<int, FrameRecord>;

// Of those entries of a frame that aren't stale the later one counts, else the later one.
void add(Frames& frames, int number, FrameRecord frame) {
    const auto [there, is_new] = frames.try_emplace(number, frame);
    if (!is_new && (there->second.is_stale || !frame.is_stale)) there->second = std::move(frame);
}

// Reads a fragment's frames; version: the record's, empty: not known.
void read_fragment(const fs::path& record, Fragment fragment, const std::string& version, Frames& frames,
                   RecordsReading& found, const std::atomic<bool>* cancel) {
    std::vector<std::pair<int, FrameRecord>> read;
    fragment.identity = files::identity_of(fragment.file);
    const RecordReading reading = read_record(
        fragment.file, [&](int number, FrameRecord frame) { read.emplace_back(number, std::move(frame)); },
        cancel);
    if (reading.is_missing) {
        found.has_changed = true;
        return;
    }
    for (auto& [number, frame] : read) {
        frame.is_stale = frame.is_stale || (!version.empty() && reading.version != version);
        add(frames, number, std::move(frame));
    }
    const std::string path = line_text(path_below(record, fragment.file));
    if (!reading.problem.empty()) found.damaged.push_back(path + ' ' + reading.problem);
    if (!reading.altered.empty())
        found.damaged.push_back(path + " was altered in what it says about the frames " +
                                frames_text(reading.altered));
    if (!reading.is_blocked) found.read.push_back(std::move(fragment));
}

// In the order in which they were written: of a frame that several have the last counts.
Frames read_fragments(const fs::path& record, std::vector<Fragment> fragments, RecordsReading& found,
                      const std::atomic<bool>* cancel) {
    Frames frames;
    if (fragments.empty()) return frames;
    const std::string version = read_shot_part(record, cancel).version;
    for (Fragment& fragment : fragments) fragment.identity = files::identity_of(fragment.file);
    std::sort(fragments.begin(), fragments.end(), [](const Fragment& a, const Fragment& b) {
        return std::tie(a.identity.changed_s, a.identity.changed_ns, a.file) <
               std::tie(b.identity.changed_s, b.identity.changed_ns, b.file);
    });
    for (const Fragment& fragment : fragments)
        read_fragment(record, fragment, version, frames, found, cancel);
    return frames;
}

}  // namespace

std::vector<Fragment> fragments_of(const fs::path& record) {
    const std::string name = record.stem().string() + '.';
    std::vector<Fragment> fragments;
    std::error_code error;
    for (fs::directory_iterator entry(folder_of(record), error), end; !error && entry != end;
         entry.increment(error)) {
        const std::string file = entry->path().filename().string();
        if (!file.starts_with(name)) continue;
        auto fragment = fragment_of(std::string_view(file).substr(name.size()));
        if (!fragment) continue;
        fragment->file = entry->path();
        fragments.push_back(std::move(*fragment));
    }
    return fragments;
}

fs::path fragment_file(const fs::path& record, int first, int last, int frames, const std::string& id) {
    return folder_of(record) / (record.stem().string() + '.' + std::to_string(first) + '-' +
                                std::to_string(last) + '.' + std::to_string(frames) + '.' + id + ".json");
}

std::string new_fragment_id() {
    std::random_device device;
    char digits[17];
    std::snprintf(digits, sizeof digits, "%08x%08x", device(), device());
    return digits;
}

RecordsReading read_records(const fs::path& record, const std::function<void(int, FrameRecord)>& take,
                            const std::atomic<bool>* cancel) {
    RecordsReading found;
    Frames theirs = read_fragments(record, fragments_of(record), found, cancel);
    auto next = theirs.begin();
    static_cast<RecordReading&>(found) = read_record(
        record,
        [&](int number, FrameRecord frame) {
            for (; next != theirs.end() && next->first < number; ++next)
                take(next->first, std::move(next->second));
            if (next != theirs.end() && next->first == number) {
                if (!next->second.is_stale || frame.is_stale) frame = std::move(next->second);
                ++next;
            }
            take(number, std::move(frame));
        },
        cancel);
    for (; next != theirs.end(); ++next) take(next->first, std::move(next->second));
    return found;
}

RecordsReading read_some(const fs::path& record, std::span<const int> frames,
                         const std::function<void(int, FrameRecord)>& take, std::set<int>& numbers,
                         const std::atomic<bool>* cancel) {
    const auto take_numbered = [&](int number, FrameRecord frame) {
        if (!frame.is_stale) numbers.insert(number);
        take(number, std::move(frame));
    };
    if (frames.size() > kFewFrames) return read_records(record, take_numbered, cancel);
    RecordsReading found;
    const auto is_among = [&](int first, int last) {
        const auto at = std::lower_bound(frames.begin(), frames.end(), first);
        return at != frames.end() && *at <= last;
    };
    // Before the record: one that is taken into it meanwhile is seen there.
    std::vector<Fragment> wanted;
    for (Fragment& fragment : fragments_of(record)) {
        if (fragment.frames == 0) continue;
        if (fragment.is_without_gaps())
            for (int number = fragment.first; number <= fragment.last; ++number)
                numbers.insert(numbers.end(), number);
        if (is_among(fragment.first, fragment.last)) wanted.push_back(std::move(fragment));
    }
    Frames theirs = read_fragments(record, std::move(wanted), found, cancel);
    Frames read;
    static_cast<RecordReading&>(found) = read_frames(
        record, frames, [&](int number, FrameRecord frame) { read[number] = std::move(frame); }, &numbers,
        cancel);
    for (auto& [number, frame] : theirs) add(read, number, std::move(frame));
    for (auto& [number, frame] : read) take(number, std::move(frame));
    return found;
}

}  // namespace pelagic
