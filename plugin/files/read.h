// Reads files of unknown kind: never waits for a pipe, and says what is wrong in words.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "plugin/files/files.h"

namespace pelagic::files {

// A regular file, read from its beginning; links are followed.
class FileReader {
  public:
    explicit FileReader(const std::filesystem::path& path);
    ~FileReader();
    FileReader(const FileReader&) = delete;
    FileReader& operator=(const FileReader&) = delete;

    // What keeps the file from being read, as the end of a sentence that begins with its name: "is missing", "is a
    // pipe, not a file", "can't be read: permission denied". Empty: nothing so far.
    const std::string& problem() const { return problem_; }
    bool is_missing() const { return is_missing_; }
    // Fills `bytes` from the file, and returns how many: fewer only at the file's end or when a problem comes up.
    std::size_t read(std::span<char> bytes);
    void seek(std::uintmax_t at);  // read() goes on there

  private:
    void fail(int error);

    int descriptor_ = -1;
    bool is_missing_ = false;
    std::string problem_;
};

// Hands the file over piece by piece, and returns what kept it from being read to its end, as
// FileReader::problem(). What `take` throws passes through.
std::string read_pieces(const std::filesystem::path& path, const ByteSink& take);

}  // namespace pelagic::files
