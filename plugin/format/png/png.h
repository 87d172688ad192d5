// PNG files in memory: 8-bit sRGB pictures for screens.
//
// Knows the format and no physics. The bytes depend on the arguments alone: no time stamp in them.
#pragma once

#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace pelagic::png {

// Rows from the top, x fastest; three sRGB bytes per pixel: R, G, B; with alpha a fourth, how much of the pixel is
// covered, by which the others are not multiplied.
struct Image {
    int width = 0, height = 0;  // 1 … 1e6 each
    std::span<const std::uint8_t> bytes;
    bool has_alpha = false;
    std::string comment{};  // ASCII, kept in the file before the pixels; empty: none
};

// The image as the bytes of a file, marked as sRGB. Throws std::invalid_argument if the size is out of range
// or doesn't match the number of bytes, and std::bad_alloc.
std::string encode(const Image& image);

// A picture that is read: rows from the top, three sRGB bytes a pixel.
struct Pixels {
    int width = 0, height = 0;
    std::vector<std::uint8_t> rgb;
};
// What is wrong with a file: the end of a sentence that begins with its name.
class ReadError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};
// Any PNG, of any program: grey, with a palette, of 1 to 16 bits, of which the upper 8 count, interlaced. Alpha is left out. Throws ReadError
// for what is none, is cut short or damaged, or has more pixels than `most`, which is known before any is unpacked; and std::bad_alloc.
Pixels decode(std::string_view bytes, std::size_t most);

// Whether the bytes are a whole file of ours: every chunk's checksum is right, the pixels can be unpacked, and nothing
// is missing or left over. Throws std::bad_alloc.
bool is_whole(std::string_view bytes);

}  // namespace pelagic::png
