#include "plugin/run/check.h"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <optional>
#include <system_error>

#include "plugin/files/checksum.h"
#include "plugin/files/read.h"
#include "plugin/run/fragments.h"
#include "plugin/run/seals.h"

namespace pelagic {
namespace {

std::string size_problem(std::uintmax_t bytes, std::uintmax_t recorded) {
    return "has " + std::to_string(bytes) + " bytes, and was written with " + std::to_string(recorded);
}

}  // namespace

void CheckProgress::add(std::size_t bytes) {
    stop_if(watch_.cancel);
    if (!watch_.progress) return;
    constexpr std::chrono::milliseconds kTellEvery{50};
    const std::lock_guard lock(mutex_);
    done_ += bytes;
    const auto now = Clock::now();
    if (now < tell_from_) return;
    tell_from_ = now + kTellEvery;
    const double share =
        total_ > 0 ? std::min(static_cast<double>(done_) / static_cast<double>(total_), 1.0) : 1.0;
    // Where it waits for tasks of its own, this thread takes up none of ours: they would wait for this lock.
    tbb::this_task_arena::isolate([&] { watch_.progress(share); });
}

void check_file(const std::filesystem::path& folder, FileCheck& check, CheckProgress& progress) {
    const std::filesystem::path file = folder / check.path;
    if (check.is_sealed()) {
        check.problem = picture_problem(file, progress);
        return;
    }
    const std::optional<std::uintmax_t> size = files::file_size(file);
    progress.add(0);
    if (size && *size != check.recorded.bytes) {  // no need to read it
        check.problem = size_problem(*size, check.recorded.bytes);
        return;
    }
    files::FileReader reader(file);
    files::Checksum sum;
    std::string piece(std::size_t{1} << 20, '\0');
    std::uintmax_t bytes = 0;
    while (const std::size_t got = reader.read(piece)) {
        sum.add(std::string_view(piece).substr(0, got));
        bytes += got;
        progress.add(got);
    }
    check.problem = reader.problem();
    check.is_missing = reader.is_missing();
    if (!check.problem.empty()) return;
    if (bytes != check.recorded.bytes)
        check.problem = size_problem(bytes, check.recorded.bytes);
    else if (sum.text() != check.recorded.checksum)
        check.problem = "holds other bytes than were written (its checksum differs)";
}

void check_files(const std::filesystem::path& folder, std::span<FileCheck> checks, const BuildWatch& watch) {
    std::uintmax_t total = 0;
    for (const FileCheck& file : checks) total += file.recorded.bytes;
    CheckProgress progress(watch, total);
    tbb::parallel_for(std::size_t(0), checks.size(),
                      [&](std::size_t i) { check_file(folder, checks[i], progress); });
}

void check_times(const std::filesystem::path& folder, std::span<FileCheck> checks,
                 const std::filesystem::path& record) {
    std::error_code error;
    auto saved = std::filesystem::last_write_time(record, error);
    for (const Fragment& fragment : fragments_of(record)) {
        std::error_code gone;
        const auto theirs = std::filesystem::last_write_time(fragment.file, gone);
        if (!gone) saved = std::max(saved, theirs);
    }
    for (FileCheck& file : checks) {
        const std::filesystem::path path = folder / file.path;
        if (file.is_sealed()) continue;
        const std::optional<std::uintmax_t> size = files::file_size(path);
        file.is_missing = !size;
        if (!size) {
            file.problem = "is missing";
        } else if (*size != file.recorded.bytes) {
            file.problem = size_problem(*size, file.recorded.bytes);
        } else if (!error && std::filesystem::last_write_time(path, error) > saved) {
            file.problem = "was written later than the record";
        }
        if (error) file.problem = "can't be looked at: " + error.message();
        error.clear();
    }
}

}  // namespace pelagic
