// Files that appear under their name only when they are whole, and messages that say what to do when they
// can't.
//
// Knows no format: every format hands its bytes over. POSIX only (Linux and macOS).
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>

namespace pelagic::files {

// A file or folder that can't be written. what() is a whole message for a person: the path, the reason in
// words and what to do about it.
class FileError : public std::runtime_error {
  public:
    FileError(const std::string& message, std::filesystem::path path, std::error_code code);

    const std::filesystem::path& path() const { return path_; }  // the path that the caller asked for
    std::error_code code() const { return code_; }               // the system's reason, e.g. ENOSPC

  private:
    std::filesystem::path path_;
    std::error_code code_;
};

// Puts `bytes` under the name `target`, replacing what is there, so that at every moment, also across a kill
// or a power cut, the name has either the old file or the whole new one: written to a hidden file in the same
// folder, flushed to the disk, renamed, the folder flushed. The folder must exist. A symbolic link at
// `target` is replaced, not followed. Safe from several threads and processes, also on several machines that
// share the folder. Throws FileError; then what stood under the name is as it was, and the hidden file is
// gone. (One exception: an error in the folder's own flush comes after the rename; the whole new file is then
// under its name.)
void write_atomically(const std::filesystem::path& target, std::span<const std::byte> bytes);
void write_atomically(const std::filesystem::path& target, std::string_view bytes);

// Takes the bytes of a file, piece after piece.
using ByteSink = std::function<void(std::string_view)>;
// Hands the bytes of a file over; they need to live for the call only.
using Content = std::function<void(const ByteSink&)>;

// The same with bytes that need never be in memory as a whole: each piece goes to the hidden file as it
// comes. Returns how many they were. What `content` throws passes through, and nothing is changed then.
std::uintmax_t write_atomically(const std::filesystem::path& target, const Content& content);

// Deletes the hidden files that write_atomically() left in `folder` (not in its sub-folders) when its process
// was killed, and returns how many. Files of writers still at work stay. Without effect, and without an
// error, where there is no such folder or nothing may be deleted in it: leftovers harm nobody.
std::size_t remove_stale_temporaries(const std::filesystem::path& folder);

// Makes sure that `folder` is a folder in which files can be made, making it and its parents where they are
// missing; an empty path is the working folder. Throws FileError.
void ensure_folder(const std::filesystem::path& folder);

// Holds the folder for this process until it is destroyed, waiting for others that do: for files that several
// runs read, change and write again. Without effect on file systems that have no locks.
class FolderLock {
  public:
    explicit FolderLock(const std::filesystem::path& folder);
    ~FolderLock();
    FolderLock(const FolderLock&) = delete;
    FolderLock& operator=(const FolderLock&) = delete;

  private:
    int descriptor_;
};

// Whether the text stands among the first or the last bytes of the file, 8 KiB at either end: where our
// formats have what a file says about itself. False where there is no such file.
bool carries(const std::filesystem::path& path, std::string_view text);

// The size in bytes of the regular file at `path` (links followed); none where there is no such file.
std::optional<std::uintmax_t> file_size(const std::filesystem::path& path);

}  // namespace pelagic::files
