// Reading a whole text file, with a bound. See text_file.h.
#include "plugin/format/shot/text_file.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>

namespace pelagic {

namespace {

// /dev/stdin, or what "<(command)" becomes.
bool is_open_already(const std::filesystem::path& file) {
    const std::string folder = file.parent_path().string();
    return file == "/dev/stdin" || folder == "/dev/fd" || folder == "/proc/self/fd";
}

}  // namespace

std::string read_text_file(const std::filesystem::path& file, std::size_t most_bytes) {
    std::error_code error;
    const std::filesystem::file_status status = std::filesystem::status(file, error);
    if (status.type() == std::filesystem::file_type::not_found) throw TextFileError("does not exist");
    if (status.type() == std::filesystem::file_type::directory)
        throw TextFileError("is a folder, not a file");
    // Opening a pipe would wait for a writer. The shell's own pipes have one.
    if (status.type() == std::filesystem::file_type::fifo && !is_open_already(file))
        throw TextFileError("is a pipe, not a file");
    errno = 0;
    std::ifstream in(file, std::ios::binary);
    if (!in) throw TextFileError(std::string("can't be opened: ") + std::strerror(errno));
    // In pieces, and not by the file's own length: a device has none, or no end.
    std::string text;
    constexpr std::size_t kPiece = std::size_t{1} << 16;
    while (in && text.size() <= most_bytes) {
        const std::size_t before = text.size();
        text.resize(before + std::min(kPiece, most_bytes + 1 - before));
        in.read(text.data() + before, static_cast<std::streamsize>(text.size() - before));
        text.resize(before + static_cast<std::size_t>(in.gcount()));
    }
    if (text.size() > most_bytes) {
        throw TextFileError("is longer than " + std::to_string(most_bytes >> 20) + " MiB");
    }
    if (in.bad() || !in.eof()) throw TextFileError(std::string("can't be read: ") + std::strerror(errno));
    return text;
}

}  // namespace pelagic
