// Atomic writes in the classic order: write a hidden file, fsync it, rename it, fsync the folder. (POSIX
// rename() replaces a name atomically. Without the first fsync a power cut may leave the new name with an
// empty file.)
//
// Locks (flock()) tell which hidden files are still being written: a writer locks its own, and the kernel releases
// the lock when the process ends, however it ends. Process numbers alone wouldn't do: they are reused, and in
// containers every bake may have the same one. Where locks don't work, a file that its process has open is still
// being written.
#include "plugin/files/files.h"

#include <fcntl.h>
#include <linux/magic.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/statfs.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <ctime>
#include <thread>
#include <utility>

#include "core/base/text.h"
#include "plugin/files/checksum.h"
#include "plugin/files/read.h"

namespace pelagic::files {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kTemporaryPrefix = ".pelagic-";
// Locks may be invisible across machines (NFS with local locks). So another machine's hidden file must also
// be older than any single write can take [s].
constexpr std::int64_t kForeignAge_s = 24 * 3600;
// The largest single write() [bytes]: Linux limits it to just below 2^31.
constexpr std::size_t kLargestWrite = std::size_t{1} << 30;
constexpr std::size_t kSummedAtOnce = std::size_t{1} << 18;  // [bytes]
// A name is taken only where two processes have the same number (containers), and their numbers soon differ.
constexpr int kNameAttempts = 1000;

// A reason and a remedy, in words.
struct Advice {
    std::string reason;
    std::string remedy;
};

Advice advice(int error) {
    switch (error) {
        case ENOSPC:
            return {"no space left on the device", "free some room or choose another folder"};
        case EDQUOT:
            return {"your disk quota is used up", "free some room or choose another folder"};
        case EFBIG:
            return {"the file is larger than the file system or the process's limit (ulimit -f) allows",
                    "raise the limit or choose another folder"};
        case EACCES:
        case EPERM:
            return {"permission denied", "make the folder writable for you or choose another folder"};
        case EROFS:
            return {"the file system is read-only", "mount it for writing or choose another folder"};
        case EISDIR:
            return {"a folder of that name is in the way", "move it away or choose another folder"};
        case ENOENT:
            return {"its folder does not exist (any more)", "make the folder or choose another folder"};
        case ENOTDIR:
        case EEXIST:
            return {"a part of the path is a file, not a folder",
                    "move that file away or choose another folder"};
        case ELOOP:
            return {"the path contains a loop of symbolic links", "fix the links or choose another folder"};
        case ENAMETOOLONG:
            return {"the path is too long for the file system", "choose a shorter name or folder"};
        case EIO:
            return {"the device reports an input/output error", "check the disk or choose another folder"};
        case EMFILE:
        case ENFILE:
            return {"too many files are open", "close some programs or raise the limit (ulimit -n)"};
        case ESTALE:
            return {"the network folder is gone", "mount it again or choose another folder"};
        case ENOTSUP:
            return {"the system keeps no files there", "choose another folder"};
        default:
            return {std::generic_category().message(error), "fix that or choose another folder"};
    }
}

fs::path folder_of(const fs::path& target) {
    return target.has_parent_path() ? target.parent_path() : fs::path(".");
}

// The folder, or what it would be made in.
fs::path nearest_folder(fs::path folder) {
    std::error_code ignored;
    while (!folder.empty() && !fs::exists(folder, ignored) && folder != folder.parent_path())
        folder = folder.parent_path();
    return folder.empty() ? fs::path(".") : folder;
}

// /proc holds no files. Asked for one it answers that something is missing.
bool holds_no_files(const fs::path& folder) {
    struct statfs there {};
    return statfs(folder.c_str(), &there) == 0 && there.f_type == PROC_SUPER_MAGIC;
}

[[noreturn]] void fail_to_write(const fs::path& target, int error) {
    const Advice a = advice(error);
    throw FileError("cannot write '" + line_text(target.string()) + "': " + a.reason + ": " + a.remedy +
                        "; files already written are whole, run again to continue",
                    target, std::error_code(error, std::generic_category()));
}

[[noreturn]] void fail_to_make_folder(const fs::path& folder, int error) {
    const Advice a = advice(error);
    throw FileError(
        "cannot use the folder '" + line_text(folder.string()) + "': " + a.reason + ": " + a.remedy, folder,
        std::error_code(error, std::generic_category()));
}

// The end of a hidden file's name: the machine's name, with '/' replaced.
std::string host_suffix() {
    std::array<char, 256> host{};
    if (gethostname(host.data(), host.size() - 1) != 0) return "@";
    std::string suffix = std::string("@") + host.data();
    std::replace(suffix.begin(), suffix.end(), '/', '_');
    return suffix;
}

// An open file descriptor.
class Descriptor {
  public:
    explicit Descriptor(int number) : number_(number) {}
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    ~Descriptor() {
        if (number_ >= 0) ::close(number_);
    }

    int number() const { return number_; }
    explicit operator bool() const { return number_ >= 0; }

    // Closes, and returns the error or 0: some network file systems report a full disk only here. After EINTR
    // Linux has closed the descriptor, and the data were flushed before.
    int close() {
        const int number = std::exchange(number_, -1);
        return ::close(number) == 0 || errno == EINTR ? 0 : errno;
    }

  private:
    int number_;
};

// Whether this process got the lock. `without_locks`: the answer on a file system without locks.
bool take_lock(int descriptor, bool without_locks) {
    while (flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
        if (errno == EINTR) continue;
        return errno != EWOULDBLOCK && without_locks;
    }
    return true;
}

// A new, locked hidden file in the target's folder; the destructor deletes it unless it was renamed.
class Temporary {
  public:
    explicit Temporary(const fs::path& target)
        : target_(target), file_(create()), lock_(fcntl(file_.number(), F_DUPFD_CLOEXEC, 0)) {
        if (!lock_) {
            const int error = errno;
            unlink(path_.c_str());
            fail_to_write(target_, error);
        }
    }
    Temporary(const Temporary&) = delete;
    Temporary& operator=(const Temporary&) = delete;
    ~Temporary() {
        if (!renamed_) unlink(path_.c_str());
    }

    void write(std::span<const std::byte> bytes) {
        while (!bytes.empty()) {
            const ssize_t written =
                ::write(file_.number(), bytes.data(), std::min(bytes.size(), kLargestWrite));
            if (written < 0) {
                if (errno == EINTR) continue;
                fail_to_write(target_, errno);
            }
            bytes = bytes.subspan(static_cast<std::size_t>(written));
        }
    }

    const fs::path& path() const { return path_; }

    void flush() {
        while (fsync(file_.number()) != 0) {
            if (errno != EINTR) fail_to_write(target_, errno);
        }
    }

    // Closes before the rename, because only close() may report a full network disk. `lock_` keeps the lock
    // until the file has the target's name, so that nobody deletes it as a leftover.
    void rename_to_target() {
        if (const int error = file_.close(); error != 0) fail_to_write(target_, error);
        if (::rename(path_.c_str(), target_.c_str()) != 0) fail_to_write(target_, errno);
        renamed_ = true;
    }

  private:
    int create() {
        static std::atomic<unsigned> counter{0};
        for (int attempt = 0; attempt < kNameAttempts; ++attempt) {
            path_ = folder_of(target_) / (std::string(kTemporaryPrefix) + std::to_string(getpid()) + "-" +
                                          std::to_string(counter++) + host_suffix());
            const int number = open(path_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
            if (number < 0) {
                if (errno == EEXIST || errno == EINTR) continue;
                const int error = errno;
                fail_to_write(target_, holds_no_files(folder_of(target_)) ? ENOTSUP : error);
            }
            // A process that deletes leftovers may have locked the file first, and may have deleted it.
            struct stat status {};
            if (take_lock(number, true) && fstat(number, &status) == 0 && status.st_nlink > 0) return number;
            ::close(number);
            unlink(path_.c_str());
        }
        fail_to_write(target_, EEXIST);
    }

    const fs::path& target_;
    fs::path path_;
    bool renamed_ = false;
    Descriptor file_;  // declared after path_, which create() fills
    Descriptor lock_;  // the same open file description, and so the same lock
};

void flush_folder(const fs::path& target) {
    const Descriptor folder(open(folder_of(target).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    // A folder may be writable but not readable. Its flush is then left to the system.
    if (!folder) {
        if (errno == EACCES) return;
        fail_to_write(target, errno);
    }
    while (fsync(folder.number()) != 0) {
        if (errno == EINTR) continue;
        if (errno == EINVAL || errno == ENOTSUP) return;  // this file system can't flush folders
        fail_to_write(target, errno);
    }
}

// Whether the process that a hidden file's name begins with has it open on this machine.
bool is_being_written(const fs::path& path, const struct stat& file) {
    const std::string name = path.filename().string();
    int process = 0;
    std::from_chars(name.data() + kTemporaryPrefix.size(), name.data() + name.size(), process);
    std::error_code error;
    for (fs::directory_iterator open("/proc/" + std::to_string(process) + "/fd", error), end;
         !error && open != end; open.increment(error)) {
        struct stat status {};
        if (process != getpid() && stat(open->path().c_str(), &status) == 0 && status.st_dev == file.st_dev &&
            status.st_ino == file.st_ino)
            return true;
    }
    return false;
}

// Deletes the hidden file at `path` if the process that wrote it is gone. Returns whether it did.
bool remove_if_stale(const fs::path& path, const std::string& own_host) {
    const Descriptor file(open(path.c_str(), O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
    struct stat status {};
    if (!file || fstat(file.number(), &status) != 0 || !S_ISREG(status.st_mode)) return false;
    const std::int64_t age_s = std::time(nullptr) - status.st_mtime;
    const bool old = age_s > kForeignAge_s;
    if (!old && (!path.filename().string().ends_with(own_host) || is_being_written(path, status)))
        return false;
    // Deletes while holding the lock: a writer that has just made the file notices either the lock or the
    // deletion.
    return take_lock(file.number(), old) && unlink(path.c_str()) == 0;
}

}  // namespace

FileError::FileError(const std::string& message, std::filesystem::path path, std::error_code code)
    : std::runtime_error(message), path_(std::move(path)), code_(code) {}

FileState write_atomically(const std::filesystem::path& target, const Content& content) {
    Temporary temporary(target);
    std::uintmax_t written = 0;
    Checksum sum;
    content([&](std::string_view piece) {
        written += piece.size();
        // In parts that are still in the cache when they are written.
        for (; !piece.empty(); piece.remove_prefix(std::min(piece.size(), kSummedAtOnce))) {
            const std::string_view part = piece.substr(0, kSummedAtOnce);
            sum.add(part);
            temporary.write(std::as_bytes(std::span(part)));
        }
    });
    temporary.flush();
    temporary.rename_to_target();
    flush_folder(target);
    return {written, sum.text()};
}

// Opens the file instead of asking for its name's state: network file systems answer that from what they knew seconds
// ago.
FileIdentity identity_of(const fs::path& path) {
    const Descriptor file(open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
    struct stat status {};
    if (!file || fstat(file.number(), &status) != 0) return {};
    return {.device = status.st_dev,
            .number = status.st_ino,
            .bytes = static_cast<std::uint64_t>(status.st_size),
            .changed_s = status.st_mtim.tv_sec,
            .changed_ns = status.st_mtim.tv_nsec};
}

std::optional<FileIdentity> replace_if_same(const fs::path& target, const FileIdentity& same,
                                            const Content& content) {
    Temporary temporary(target);
    content([&](std::string_view piece) { temporary.write(std::as_bytes(std::span(piece))); });
    temporary.flush();
    const FileIdentity ours = identity_of(temporary.path());
    if (identity_of(target) != same) return {};
    temporary.rename_to_target();
    flush_folder(target);
    return ours;
}

FileState write_if_different(const std::filesystem::path& target, const Content& content) {
    FileReader file(target);
    Checksum sum;
    std::uintmax_t bytes = 0;
    bool is_same = file.problem().empty();
    std::string there;
    content([&](std::string_view piece) {
        sum.add(piece);
        bytes += piece.size();
        if (!is_same) return;
        there.resize(piece.size());
        is_same = file.read(there) == piece.size() && there == piece;
    });
    char more = 0;
    if (is_same && file.read({&more, 1}) == 0 && file.problem().empty()) return {bytes, sum.text()};
    return write_atomically(target, content);
}

void write_atomically(const std::filesystem::path& target, std::span<const std::byte> bytes) {
    write_atomically(target, std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

void write_atomically(const std::filesystem::path& target, std::string_view bytes) {
    write_atomically(target, [bytes](const ByteSink& sink) { sink(bytes); });
}

std::size_t remove_stale_temporaries(const std::filesystem::path& folder) {
    const std::string own_host = host_suffix();
    std::size_t removed = 0;
    std::error_code error;
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
        if (!entry->path().filename().string().starts_with(kTemporaryPrefix)) continue;
        if (remove_if_stale(entry->path(), own_host)) ++removed;
    }
    return removed;
}

void ensure_folder(const std::filesystem::path& asked) {
    const fs::path folder = asked.empty() ? fs::path(".") : asked;
    std::error_code error;
    fs::create_directories(folder, error);
    if (error) fail_to_make_folder(folder, holds_no_files(nearest_folder(folder)) ? ENOTSUP : error.value());
    // The system's answer, not the mode bits': it includes root, access lists and read-only file systems.
    if (faccessat(AT_FDCWD, folder.c_str(), W_OK | X_OK, AT_EACCESS) != 0) fail_to_make_folder(folder, errno);
}

void check_folder(const std::filesystem::path& folder) {
    std::error_code ignored;
    const fs::path there = nearest_folder(folder);
    if (!fs::is_directory(there, ignored)) fail_to_make_folder(folder, ENOTDIR);
    if (holds_no_files(there)) fail_to_make_folder(folder, ENOTSUP);
    if (faccessat(AT_FDCWD, there.c_str(), W_OK | X_OK, AT_EACCESS) != 0) fail_to_make_folder(folder, errno);
}

bool carries(const std::filesystem::path& path, std::string_view text) {
    constexpr std::size_t kEnd = 8192;
    const std::optional<std::uintmax_t> size = files::file_size(path);
    FileReader file(path);
    const auto stands_from = [&](std::uintmax_t begin) {
        std::string bytes(kEnd, '\0');
        file.seek(begin);
        bytes.resize(file.read(bytes));
        return bytes.find(text) != std::string::npos;
    };
    return size && (stands_from(0) || stands_from(*size > kEnd ? *size - kEnd : 0));
}

std::optional<std::uintmax_t> file_size(const std::filesystem::path& path) {
    std::error_code error;
    const std::uintmax_t size = fs::file_size(path, error);
    if (error) return std::nullopt;
    return size;
}

FolderLock::FolderLock(const std::filesystem::path& folder, const LockWatch& watch)
    : descriptor_(open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
    using Clock = std::chrono::steady_clock;
    constexpr std::chrono::milliseconds kAskAgain{20};
    constexpr double kSaidAfter_s = 1.0;
    const Clock::time_point start = Clock::now();
    if (descriptor_ < 0) problem_ = std::generic_category().message(errno);
    // Asks again and again instead of waiting in the kernel, where nobody could report progress or give up.
    while (descriptor_ >= 0 && flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
        if (errno == EINTR) continue;
        if (errno != EWOULDBLOCK) {
            problem_ = std::generic_category().message(errno);
            return;
        }
        const double waited_s = std::chrono::duration<double>(Clock::now() - start).count();
        try {
            if (watch && waited_s > kSaidAfter_s) watch(waited_s);
        } catch (...) {
            close(descriptor_);
            throw;
        }
        std::this_thread::sleep_for(kAskAgain);
    }
}

FolderLock::~FolderLock() {
    if (descriptor_ >= 0) close(descriptor_);
}

}  // namespace pelagic::files
