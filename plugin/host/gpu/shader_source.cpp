#include "plugin/host/gpu/shader_source.h"

#include <algorithm>
#include <regex>
#include <sstream>
#include <stdexcept>

namespace pelagic {
namespace {

// Larger than any file: line n of part p has the number p · kLinesEach + n. (Not every driver's messages
// include the file number of #line.)
constexpr std::size_t kLinesEach = 10000;

void replace_all(std::string& text, std::string_view from, std::string_view to) {
    for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
        text.replace(at, from.size(), to);
}

std::string line_of(std::string_view text, std::size_t line) {
    std::size_t begin = 0;
    for (std::size_t i = 1; i < line; ++i) {
        begin = text.find('\n', begin);
        if (begin == std::string_view::npos) return {};
        ++begin;
    }
    return std::string(text.substr(begin, text.find('\n', begin) - begin));
}

// Removes comments: #version 330 allows only ASCII.
std::string without_comments(std::string_view text) {
    std::string out;
    std::istringstream lines{std::string(text)};
    for (std::string line; std::getline(lines, line);) out += line.substr(0, line.find("//")) + "\n";
    return out;
}

}  // namespace

const ShaderFile& shader_file(std::string_view path) {
    for (const ShaderFile& file : shader_files())
        if (file.path == path) return file;
    throw std::logic_error("no shader file \"" + std::string(path) + "\" in this program");
}

std::string glsl_of_inl(std::string_view text) {
    static const std::regex detail(R"(\b\w+_detail::)"), array_argument(R"(T \(&(\w+)\)\[(\w+)\])");
    static const std::regex heads(R"(\s*(template\s*<[^>]*>|namespace \w+ \{)\s*)");
    static const std::regex closed_namespace(R"(\s*\}\s*//\s*namespace.*)");
    std::string out;
    std::istringstream lines{std::string(text)};
    for (std::string line; std::getline(lines, line);) {
        if (std::regex_match(line, heads) || std::regex_match(line, closed_namespace)) {
            out += "\n";
            continue;
        }
        line = line.substr(0, line.find("//"));
        replace_all(line, "inline ", "");
        replace_all(line, "const T ", "T ");
        replace_all(line, "constexpr double ", "const T ");
        replace_all(line, "<T>", "");
        line = std::regex_replace(line, detail, "");
        line = std::regex_replace(line, array_argument, "out T $1[$2]");
        out += line + "\n";
    }
    return out;
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
    text_ += path.ends_with(".inl") ? glsl_of_inl(file.text) : without_comments(file.text);
    parts_.push_back({std::string(path), std::string(file.text)});
}

std::string ShaderSource::explain(std::string_view messages) const {
    // Mesa and most others write "0:12(5): error: …", NVIDIA "0(12) : error …".
    static const std::regex place(R"(\d+(?::(\d+)\(\d+\)|\((\d+)\)))");
    std::string out;
    std::istringstream lines{std::string(messages)};
    for (std::string line; std::getline(lines, line);) {
        std::smatch match;
        if (std::regex_search(line, match, place)) {
            const std::size_t number = std::stoul(match[1].matched ? match[1] : match[2]);
            const std::size_t part = number / kLinesEach, at = number % kLinesEach;
            if (part < parts_.size()) {
                out += parts_[part].name + ":" + std::to_string(at) + match.suffix().str() + "\n    " +
                       line_of(parts_[part].text, at) + "\n";
                continue;
            }
        }
        out += line + "\n";
    }
    return out;
}

}  // namespace pelagic
