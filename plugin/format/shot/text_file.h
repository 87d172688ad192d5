// Reading a whole text file, with a bound.
#pragma once

#include <cstddef>
#include <filesystem>
#include <stdexcept>
#include <string>

namespace pelagic {

// what(): what is wrong with the file, as the end of a sentence that begins with its name: "does not exist".
class TextFileError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

// The bytes of the file. TextFileError if it is missing, a folder, unreadable or longer than `most_bytes`.
std::string read_text_file(const std::filesystem::path& file, std::size_t most_bytes);

}  // namespace pelagic
