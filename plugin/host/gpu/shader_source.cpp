#include "plugin/host/gpu/shader_source.h"

#include <cstdio>
#include <sstream>
#include <stdexcept>

namespace pelagic {
namespace {

// Larger than any file: line n of part p has the number p · kLinesEach + n. (Not every driver's messages
// include the file number of #line.)
constexpr std::size_t kLinesEach = 10000;

std::string line_of(std::string_view text, std::size_t line) {
    std::size_t begin = 0;
    for (std::size_t i = 1; i < line; ++i) {
        begin = text.find('\n', begin);
        if (begin == std::string_view::npos) return {};
        ++begin;
    }
    return std::string(text.substr(begin, text.find('\n', begin) - begin));
}

// Where a message says that it is: Mesa and most others write "0:12(5): error: …", NVIDIA "0(12) : error …". How many characters
// that takes from `text` on, and the line; 0 where it begins with none.
int read_place(const char* text, std::size_t& line) {
    int end = 0;
    if (std::sscanf(text, "%*u:%zu(%*u)%n", &line, &end) == 1 && end > 0) return end;
    return std::sscanf(text, "%*u(%zu)%n", &line, &end) == 1 ? end : 0;
}

}  // namespace

const ShaderFile& shader_file(std::string_view path) {
    for (const ShaderFile& file : shader_files())
        if (file.path == path) return file;
    throw std::logic_error("no shader file \"" + std::string(path) + "\" in this program");
}

std::string ShaderSource::first_line() const {
    return "#line " + std::to_string(parts_.size() * kLinesEach + 1) + "\n";
}

void ShaderSource::add_constants(std::string_view text) {
    text_ += first_line() + std::string(text);
    parts_.push_back({"constants", std::string(text)});
}

void ShaderSource::add_file(std::string_view path) {
    const ShaderFile& file = shader_file(path);
    text_ += first_line();
    text_ += file.glsl;
    parts_.push_back({std::string(path), std::string(file.text)});
}

std::string ShaderSource::explain(std::string_view messages) const {
    constexpr const char* kDigits = "0123456789";
    std::string out;
    std::istringstream lines{std::string(messages)};
    for (std::string line; std::getline(lines, line);) {
        int end = 0;
        std::size_t at = line.find_first_of(kDigits), number = 0;
        while (at != std::string::npos && (end = read_place(line.c_str() + at, number)) == 0)
            at = line.find_first_of(kDigits, at + 1);
        if (const std::size_t part = number / kLinesEach; end > 0 && part < parts_.size()) {
            const std::size_t row = number % kLinesEach;
            out += parts_[part].name + ":" + std::to_string(row) + line.substr(at + end) + "\n    " +
                   line_of(parts_[part].text, row) + "\n";
            continue;
        }
        out += line + "\n";
    }
    return out;
}

}  // namespace pelagic
