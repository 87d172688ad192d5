// What the writers of text layers share: numbers as text, indented lines, and the head of a layer.
#pragma once

#include <charconv>
#include <cstddef>
#include <glm/vec3.hpp>
#include <initializer_list>
#include <string>
#include <string_view>

namespace pelagic::usd {

// A shortest double takes at most 24 characters ("-2.2250738585072014e-308").
inline constexpr std::size_t kLongestNumber = 32;

// The fewest digits that read back as the same value.
template <class T>
std::string number(T value) {
    char text[kLongestNumber];
    const auto [end, error] = std::to_chars(text, text + sizeof text, value);
    static_cast<void>(error);  // cannot be: the buffer holds the longest
    return std::string(text, end);
}

// A real number of the stage; −0 becomes 0, which no stage needs and people stumble over. Throws
// std::invalid_argument with the name if it isn't finite.
std::string real(std::string_view name, double value);
// The same for a float attribute, with a float's digits.
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
    // An empty line between two things, none after a bracket.
    void gap() {
        if (!text_.ends_with("{\n")) line({});
    }
    // A prim without metadata of its own.
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

// Space and time of a layer: z up, metres, and the rate, without which a reference's times would be rescaled.
struct LayerHead {
    std::string_view default_prim;
    double fps;
    int first_frame;
    int last_frame;
};
// The lines between the head's brackets, the names sorted as OpenUSD does. Throws std::invalid_argument
// unless fps is above 0.
void write_head(Page& page, const LayerHead& head);
// The whole head of a layer about the mesh that has no frames of its own.
void write_timeless_head(Page& page, double fps);

}  // namespace pelagic::usd
