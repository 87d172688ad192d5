// Whether the files that a record knows are still those that were written.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <span>
#include <string>

#include "core/base/build_watch.h"
#include "plugin/run/record.h"

namespace pelagic {

// How much of a check is done: the share of the bytes that are read, told from the first second on. Any thread may call.
class CheckProgress {
  public:
    CheckProgress(const BuildWatch& watch, std::uintmax_t total_bytes) : watch_(watch), total_(total_bytes) {}

    // So many bytes were read. Throws BuildCancelled.
    void add(std::size_t bytes);

  private:
    using Clock = std::chrono::steady_clock;

    const BuildWatch& watch_;
    const std::uintmax_t total_;
    std::mutex mutex_;
    std::uintmax_t done_ = 0;
    Clock::time_point tell_from_ = Clock::now() + std::chrono::seconds(1);
};

// One file; what check_files() finds out is the rest.
struct FileCheck {
    std::string path;  // below the folder, with /
    FileRecord recorded{};
    // A picture, which has no record and says itself what it is (plugin/run/seals.h).
    bool is_sealed() const { return recorded.checksum.empty(); }
    // The end of a sentence that begins with the path; empty: the file is as it was written.
    std::string problem{};
    bool is_missing = false;
};

// Reads the file in full. Throws BuildCancelled.
void check_file(const std::filesystem::path& folder, FileCheck& check, CheckProgress& progress);

// The same for all of them, side by side. Throws BuildCancelled.
void check_files(const std::filesystem::path& folder, std::span<FileCheck> checks,
                 const BuildWatch& watch = {});

// Looks at sizes and times alone: a file is as it was written if it has its size and is no newer than the record and its fragments,
// which are saved after the files that it tells of. Not at pictures.
void check_times(const std::filesystem::path& folder, std::span<FileCheck> checks,
                 const std::filesystem::path& record);

}  // namespace pelagic
