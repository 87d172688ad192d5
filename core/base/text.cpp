// What users' texts become in messages. See text.h.
#include "core/base/text.h"

#include <algorithm>

namespace pelagic {
namespace {

constexpr std::string_view kHexDigits = "0123456789abcdef";

// The bytes of the UTF-8 character at the text's beginning; 0 where there is none (Unicode 15, table 3-7).
std::size_t character_bytes(std::string_view text) {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    const unsigned char first = byte(0);
    if (first < 0x80) return 1;
    const std::size_t count = first < 0xc2 ? 0 : first < 0xe0 ? 2 : first < 0xf0 ? 3 : first < 0xf5 ? 4 : 0;
    if (count == 0 || count > text.size()) return 0;
    for (std::size_t i = 1; i < count; ++i)
        if ((byte(i) & 0xc0) != 0x80) return 0;
    const unsigned char second = byte(1);
    const bool is_overlong = (first == 0xe0 && second < 0xa0) || (first == 0xf0 && second < 0x90);
    const bool is_surrogate = first == 0xed && second > 0x9f;
    const bool is_beyond = first == 0xf4 && second > 0x8f;
    return is_overlong || is_surrogate || is_beyond ? 0 : count;
}

// The code point of a UTF-8 character of at most three bytes.
unsigned code_of(std::string_view character) {
    const auto bits = [&](std::size_t i, unsigned mask) {
        return static_cast<unsigned char>(character[i]) & mask;
    };
    if (character.size() == 1) return bits(0, 0x7f);
    if (character.size() == 2) return bits(0, 0x1f) << 6 | bits(1, 0x3f);
    return bits(0, 0x0f) << 12 | bits(1, 0x3f) << 6 | bits(2, 0x3f);
}

// Whether a terminal obeys this character instead of showing it: control characters, line separators, and characters
// that change the writing direction of the text after them.
bool is_command(unsigned code) {
    return code < 0x20 || (code >= 0x7f && code < 0xa0) || (code >= 0x2028 && code <= 0x202e) ||
           (code >= 0x2066 && code <= 0x2069);
}

void append_hex(std::string& out, unsigned code, int digits) {
    for (int shift = 4 * (digits - 1); shift >= 0; shift -= 4) out += kHexDigits[code >> shift & 15];
}

struct Escapes {
    std::string_view before_x = "\\";  // stands before the "xe9" of a byte that isn't UTF-8
    std::string_view characters = "";  // each gets a backslash
    bool commands = true;              // control characters become "\u001b"
};

std::string escaped(std::string_view text, const Escapes& escapes) {
    std::string out;
    out.reserve(text.size());
    while (!text.empty()) {
        const std::size_t bytes = character_bytes(text);
        const std::string_view character = text.substr(0, std::max<std::size_t>(bytes, 1));
        if (bytes == 0) {
            out += escapes.before_x;
            out += 'x';
            append_hex(out, static_cast<unsigned char>(text[0]), 2);
        } else if (escapes.commands && bytes < 4 && is_command(code_of(character))) {
            out += "\\u";
            append_hex(out, code_of(character), 4);
        } else {
            if (bytes == 1 && escapes.characters.find(text[0]) != std::string_view::npos) out += '\\';
            out += character;
        }
        text.remove_prefix(character.size());
    }
    return out;
}

}  // namespace

std::string quoted_text(std::string_view text) {
    return '"' + escaped(text, {.before_x = "\\\\", .characters = "\"\\"}) + '"';
}

std::string line_text(std::string_view text) {
    return escaped(text, {});
}

std::string utf8_text(std::string_view text) {
    return escaped(text, {.commands = false});
}

bool has_ending(std::string_view name, std::string_view ending) {
    return name.size() > ending.size() &&
           std::equal(ending.begin(), ending.end(), name.end() - static_cast<std::ptrdiff_t>(ending.size()),
                      [](char a, char b) { return a == (b >= 'A' && b <= 'Z' ? b - 'A' + 'a' : b); });
}

std::string_view first_character(std::string_view text) {
    return text.empty() ? text : text.substr(0, std::max<std::size_t>(character_bytes(text), 1));
}

std::string shortened(std::string_view text, std::size_t most_bytes) {
    if (text.size() <= most_bytes) return std::string(text);
    std::size_t end = most_bytes;
    const auto continues = [&] { return (static_cast<unsigned char>(text[end]) & 0xc0) == 0x80; };
    while (end > 0 && most_bytes - end < 4 && continues()) --end;
    return std::string(text.substr(0, end)) + "…";
}

}  // namespace pelagic
