// What the runs of a shot have recorded: DIR/NAME.json, and beside it what isn't merged into it yet, a fragment a run:
// DIR/record/NAME.FIRST-LAST.COUNT.ID.json. A fragment is a record of its own, written by its run alone, so that no run can
// lose what another one has recorded, whether locks hold or not, and a run's cost doesn't grow with the shot. Its name says how
// many frames it has, and the first and last of them: who wants others needn't read it.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "plugin/files/files.h"
#include "plugin/run/record.h"

namespace pelagic {

struct Fragment {
    std::filesystem::path file{};
    int first = 0, last = 0, frames = 0;
    files::FileIdentity identity{};  // when it was read

    // Of a wrong name that says a billion frames, nobody counts them.
    bool is_without_gaps() const {
        constexpr int kMost = 1 << 20;
        return frames <= kMost && std::int64_t{last} - first + 1 == frames;
    }
};

// The fragments beside the record DIR/NAME.json, as the folder lists them.
std::vector<Fragment> fragments_of(const std::filesystem::path& record);

// A name for another one.
std::filesystem::path fragment_file(const std::filesystem::path& record, int first, int last, int frames,
                                    const std::string& id);
std::string new_fragment_id();

// As read_record(), of the record and its fragments together, frames by rising number. Of a frame that several have the entry that
// isn't stale counts, of those the one that was written last; a fragment's entries are stale where it tells of another version of the
// shot than the record.
struct RecordsReading : RecordReading {
    std::vector<std::string> damaged{};  // fragments, by path below DIR, as lines: "record/… is damaged"
    bool has_changed = false;            // a fragment went while it was read: it may be in the record now
    std::vector<Fragment> read{};  // those that could be read; of damaged ones what is as it was written
};
RecordsReading read_records(const std::filesystem::path& record,
                            const std::function<void(int, FrameRecord)>& take,
                            const std::atomic<bool>* cancel = nullptr);

// The same of these frames. Where they are few it reads no fragment whose name says that it has none of them, and of a record that isn't
// small no other entry; what it reads beside it hands over as well. numbers: of all frames that are recorded and not known as stale.
RecordsReading read_some(const std::filesystem::path& record, std::span<const int> frames,
                         const std::function<void(int, FrameRecord)>& take, std::set<int>& numbers,
                         const std::atomic<bool>* cancel = nullptr);

}  // namespace pelagic
