#include "plugin/files/read.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <vector>

namespace pelagic::files {
namespace {

constexpr std::size_t kPiece = std::size_t{1}
                               << 20;  // [bytes] large enough that calls of the system don't count

std::string kind_of(mode_t mode) {
    if (S_ISDIR(mode)) return "a folder";
    if (S_ISFIFO(mode)) return "a pipe";
    if (S_ISSOCK(mode)) return "a socket";
    return "a device";
}

}  // namespace

// Without O_NONBLOCK a pipe would wait for a writer.
FileReader::FileReader(const std::filesystem::path& path)
    : descriptor_(open(path.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC)) {
    struct stat status {};
    if (descriptor_ < 0 || fstat(descriptor_, &status) != 0) {
        if (errno == ENXIO)  // what opening a socket gives
            problem_ = "is " + kind_of(S_IFSOCK) + ", not a file";
        else
            fail(errno);
    } else if (!S_ISREG(status.st_mode)) {
        problem_ = "is " + kind_of(status.st_mode) + ", not a file";
    }
}

FileReader::~FileReader() {
    if (descriptor_ >= 0) close(descriptor_);
}

void FileReader::fail(int error) {
    is_missing_ = error == ENOENT || error == ENOTDIR;
    problem_ = is_missing_ ? "is missing" : "can't be read: " + std::generic_category().message(error);
}

std::size_t FileReader::read(std::span<char> bytes) {
    std::size_t filled = 0;
    while (problem_.empty() && filled < bytes.size()) {
        const ssize_t got =
            ::read(descriptor_, bytes.data() + filled, std::min(bytes.size() - filled, kPiece));
        if (got == 0) break;
        if (got < 0) {
            if (errno != EINTR) fail(errno);
            continue;
        }
        filled += static_cast<std::size_t>(got);
    }
    return filled;
}

void FileReader::seek(std::uintmax_t at) {
    if (problem_.empty() && lseek(descriptor_, static_cast<off_t>(at), SEEK_SET) < 0) fail(errno);
}

std::string read_pieces(const std::filesystem::path& path, const ByteSink& take) {
    FileReader file(path);
    std::vector<char> piece(kPiece);
    while (const std::size_t got = file.read(piece)) take({piece.data(), got});
    return file.problem();
}

}  // namespace pelagic::files
