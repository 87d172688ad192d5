// GLSL put together from the files that C++ is compiled from too, which the program carries in itself.
//
// *.glsl files are taken as they are. *.inl files, written for core/base/number.h, become GLSL line by line:
//   lines that say no more than `template <…>`, or open or close a namespace, are left empty;
//   `inline ` and `<T>` are dropped, and so is `name_detail::`;
//   `const T ` becomes `T `, for GLSL 3.30 takes constants' values literally, and `constexpr double ` becomes
//   `const T `; an array `T (&w)[P]` becomes `out T w[P]`.
// T, and the functions of number.h, are the prelude's (prelude.glsl). Lines stay lines, so that a compiler's
// messages name the line of the source.
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

// Every file that the program carries (the generated shader_files.cpp), and one of them, by its path; throws
// std::logic_error where there is none.
const std::vector<ShaderFile>& shader_files();
const ShaderFile& shader_file(std::string_view path);

// The lines of a *.inl file as GLSL.
std::string glsl_of_inl(std::string_view text);

// A whole shader for `#version 330 core`.
class ShaderSource {
  public:
    // Lines of its own: constants that the files after it find in scope.
    void add_constants(std::string_view text);
    void add_file(std::string_view path);
    void add_files(std::span<const std::string_view> paths) {
        for (const std::string_view path : paths) add_file(path);
    }
    const std::string& text() const { return text_; }

    // A driver's messages, with their places named by path and line, and each line that it complains
    // about below the message.
    std::string explain(std::string_view messages) const;

  private:
    std::string text_ = "#version 330 core\n";
    std::string first_line() const;  // of the part that comes next

    struct Part {
        std::string name, text;
    };
    std::vector<Part> parts_;
};

}  // namespace pelagic
