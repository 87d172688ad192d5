// GLSL assembled from the files that C++ is compiled from too; the program contains their text.
//
// *.glsl files are used unchanged. *.inl files, written for core/base/number.h, are converted line by line:
//   lines with only `template <…>`, and lines that open or close a namespace, become empty;
//   `inline `, `<T>` and `name_detail::` are removed;
//   `const T ` becomes `T `, because constants of GLSL 3.30 need constant initialisers, `constexpr double `
// becomes
//   `const T `, and an array `T (&w)[P]` becomes `out T w[P]`.
// prelude.glsl defines T and the functions of number.h. Line numbers are kept, so that a compiler's messages
// refer to the source.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace pelagic {

struct ShaderFile {
    std::string_view path;  // from the project's root
    std::string_view text;
};

// All embedded files (the generated shader_files.cpp), and one of them by its path, which throws
// std::logic_error for an unknown path.
const std::vector<ShaderFile>& shader_files();
const ShaderFile& shader_file(std::string_view path);

// Converts the lines of an *.inl file to GLSL.
std::string glsl_of_inl(std::string_view text);

// A whole shader for `#version 330 core`.
class ShaderSource {
  public:
    // Adds lines of GLSL: constants for the files after them.
    void add_constants(std::string_view text);
    void add_file(std::string_view path);
    void add_files(std::span<const std::string_view> paths) {
        for (const std::string_view path : paths) add_file(path);
    }
    const std::string& text() const { return text_; }
    // The same without its first line, for hosts that add their own.
    std::string_view body() const { return std::string_view(text_).substr(text_.find('\n') + 1); }

    // A driver's messages with their places as path and line, and with the source line below each message.
    std::string explain(std::string_view messages) const;

  private:
    std::string text_ = "#version 330 core\n";
    std::string first_line() const;  // the #line of the next part

    struct Part {
        std::string name, text;
    };
    std::vector<Part> parts_;
};

}  // namespace pelagic
