// Files that appear under their name only when they are complete, and error messages that say what to do.
//
// Independent of formats: the caller passes bytes. POSIX only (Linux and macOS).
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

// A file or folder that can't be written. what() is a complete message for users: the path, the reason in
// words and the remedy.
class FileError : public std::runtime_error {
  public:
    FileError(const std::string& message, std::filesystem::path path, std::error_code code);

    const std::filesystem::path& path() const { return path_; }  // the path that the caller asked for
    std::error_code code() const { return code_; }               // the system's reason, e.g. ENOSPC

  private:
    std::filesystem::path path_;
    std::error_code code_;
};

// Puts `bytes` under the name `target`, replacing an existing file. At every moment, even if the process is
// killed or the power fails, the name has either the old file or the complete new one: the bytes go to a
// hidden file in the same folder, which is flushed to the disk and renamed; then the folder is flushed. The
// folder must exist. A symbolic link at `target` is replaced, not followed. Safe with several threads and
// processes, and with several machines that share the folder. Throws FileError; the name is then as it was,
// and the hidden file is gone. (One exception: if flushing the folder fails, the rename is done already, and
// the complete new file has the name.)
void write_atomically(const std::filesystem::path& target, std::span<const std::byte> bytes);
void write_atomically(const std::filesystem::path& target, std::string_view bytes);

// Receives the bytes of a file piece by piece.
using ByteSink = std::function<void(std::string_view)>;
// Passes the bytes of a file to the sink. They need to live during the call only.
using Content = std::function<void(const ByteSink&)>;

// What the bytes of a file were when it was written.
struct FileState {
    std::uintmax_t bytes = 0;
    std::string checksum;  // plugin/files/checksum.h
    bool operator==(const FileState&) const = default;
};

// The same for bytes that are never in memory all at once: each piece is written to the hidden file as it
// comes. Exceptions of `content` pass through, and nothing is changed then.
FileState write_atomically(const std::filesystem::path& target, const Content& content);

// Which file has a name at a moment: another one after each write_atomically().
struct FileIdentity {
    std::uint64_t device = 0, number = 0, bytes = 0;  // all zero: none has
    std::int64_t changed_s = 0, changed_ns = 0;
    bool operator==(const FileIdentity&) const = default;
};
FileIdentity identity_of(const std::filesystem::path& path);

// write_atomically(), unless the name has another file by then: nothing is changed then, and there is no result.
// Between the last look and the renaming lie microseconds: where locks don't work this makes a lost write rare, not
// impossible.
std::optional<FileIdentity> replace_if_same(const std::filesystem::path& target, const FileIdentity& same,
                                            const Content& content);

// The same, unless the file has exactly these bytes already; then it stays untouched.
FileState write_if_different(const std::filesystem::path& target, const Content& content);

// Deletes the hidden files in `folder` (not in its sub-folders) left by write_atomically() in processes that
// were killed, and returns how many. Files still being written stay. Does nothing, and reports no error, if
// there is no such folder or if nothing in it may be deleted: leftovers are harmless.
std::size_t remove_stale_temporaries(const std::filesystem::path& folder);

// Makes sure that files can be made in `folder`. Creates the folder and its parents if they are missing. An
// empty path is the working folder. Throws FileError.
void ensure_folder(const std::filesystem::path& folder);

// Whether ensure_folder() could succeed, without making anything. Throws FileError where it surely couldn't.
void check_folder(const std::filesystem::path& folder);

// Told how long a lock has been awaited [s], some times a second from the first second on. What it throws ends the
// waiting.
using LockWatch = std::function<void(double waited_s)>;

// Locks the folder for this process during the object's lifetime, and waits for other holders: for files that several
// runs read, change and write again. On network file systems it may lock only this machine's processes, and nothing
// tells.
class FolderLock {
  public:
    explicit FolderLock(const std::filesystem::path& folder, const LockWatch& watch = {});
    ~FolderLock();
    FolderLock(const FolderLock&) = delete;
    FolderLock& operator=(const FolderLock&) = delete;

    // Why there is no lock, in words; empty where there is one, as far as the system says.
    const std::string& problem() const { return problem_; }

  private:
    int descriptor_;
    std::string problem_{};
};

// Whether the text stands among the first or the last bytes of the file, 8 KiB at either end: where our
// formats have what a file says about itself. False where there is no such file.
bool carries(const std::filesystem::path& path, std::string_view text);

// The size in bytes of the regular file at `path` (links are followed); nullopt if there is none.
std::optional<std::uintmax_t> file_size(const std::filesystem::path& path);

}  // namespace pelagic::files
