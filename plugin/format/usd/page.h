// Shared by the writers of text layers: numbers as text, indented lines, and the metadata at a layer's head.
#pragma once

#include <charconv>
#include <cstddef>
#include <glm/vec3.hpp>
#include <initializer_list>
#include <string>
#include <string_view>

namespace pelagic::usd {

// std::to_chars needs at most 24 characters for a double ("-2.2250738585072014e-308").
inline constexpr std::size_t kLongestNumber = 32;

// The fewest digits that read back as the same value.
template <class T>
std::string number(T value) {
    char text[kLongestNumber];
    const auto [end, error] = std::to_chars(text, text + sizeof text, value);
    static_cast<void>(error);  // none: the buffer holds the longest number
    return std::string(text, end);
}

// A real number of the stage. −0 is written as 0: no stage needs the sign, and it puzzles readers. Throws
// std::invalid_argument, with the name, unless the number is finite.
std::string real(std::string_view name, double value);
// The same for a float attribute: the fewest digits that read back as the same float.
std::string real32(std::string_view name, double value);
std::string color(std::string_view name, const glm::vec3& value);

// The text of a layer: lines with indentation, four spaces a level.
class Page {
  public:
    Page() { text_ = "#usda 1.0\n"; }

    void line(std::initializer_list<std::string_view> parts) {
        if (parts.size() > 0) text_.append(static_cast<std::size_t>(4 * depth_), ' ');
        for (const std::string_view part : parts) text_ += part;
        text_ += '\n';
    }
    void open(std::initializer_list<std::string_view> parts) {
        line(parts);
        ++depth_;
    }
    void close(std::string_view bracket) {
        --depth_;
        line({bracket});
    }
    // An empty line before a prim, except directly after an opening bracket.
    void gap() {
        if (!text_.ends_with("{\n")) line({});
    }
    // Opens a prim without metadata.
    void prim(std::string_view specifier, std::string_view name) {
        gap();
        line({specifier, " \"", name, "\""});
        open({"{"});
    }
    const std::string& text() const { return text_; }

  private:
    std::string text_;
    int depth_ = 0;
};

// A layer's metadata about space and time: z up, metres, the range of frames, and their rate. If a referenced
// layer had another rate, or none, USD would rescale its times.
struct LayerHead {
    std::string_view default_prim;
    double fps;
    int first_frame;
    int last_frame;
};
// The metadata without the brackets round it, sorted by name as OpenUSD sorts it. Throws
// std::invalid_argument unless fps is above 0.
void write_head(Page& page, const LayerHead& head);
// The whole head, brackets included, of a layer of the mesh that has no range of frames.
void write_timeless_head(Page& page, double fps);

}  // namespace pelagic::usd
