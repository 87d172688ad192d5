// The lines of Wavefront OBJ and MTL: words, numbers, and corners of faces. For readers of this folder.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace pelagic::obj {

using Words = std::vector<std::string_view>;

// What is wrong with a line.
struct Refused {
    std::string problem, accepted;
};

class Lines {
  public:
    explicit Lines(std::string_view text) : text_(text) {}

    // A line's words up to a comment, those of the lines that it goes on in included (they end with \). False: there are no more.
    bool next(Words& words);
    // The number of the first of them, from 1 on.
    std::size_t line() const { return line_; }

  private:
    std::string_view text_;
    std::size_t at_ = 0, line_ = 0, lines_read_ = 0;
};

// A word as messages write it.
std::string quoted(std::string_view word);

// Throw Refused for what is none; numbers that are too small for a double are 0.
double number_of(std::string_view word);
std::int64_t integer_of(std::string_view word, const char* accepted);

// The point of a line of "v". Throws Refused.
glm::dvec3 point_of(const Words& words);

// "7/2/3" as its point, texture coordinate and normal; those that aren't there are empty. Throws Refused.
std::array<std::string_view, 3> corner_parts(std::string_view word);
// From 0 on, of `count` that stand above: 1 … count or −1 … −count in the file. Throws Refused.
std::int32_t index_of(std::string_view word, std::size_t count, const char* what);

}  // namespace pelagic::obj
