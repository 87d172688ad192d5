// OpenEXR files in memory: one part with any channels, as scan lines or as tiles with mip levels that the
// caller provides.
//
// Knows the format and no physics. The bytes depend on the arguments alone: no time stamp, no thread count.
//
// Orientation. Callers pass rows in order of rising y, as the sea is computed: the sample in column i and row
// j of n columns and m rows, over a rectangle of size L × H centred on the origin, lies at
//     x = −L/2 + i·L/n,    y = −H/2 + j·H/m,
// at pixel *corners*: there are none on the far edges, which in a periodic map equal the near ones. In the
// file north is up: the bottom row is j = 0, and the encoder flips the rows (OpenEXR counts scan lines from
// the top). A mip level has the same first corner and the same L and H, with fewer samples.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace pelagic::exr {

enum class PixelType {
    Half,  // 11 significant bits, 6.1e-5 … 65504 at full precision; for directions and fractions
    Float,
};

// One channel, read in place from the caller's memory. Sample (column i, row j), y rising with j, is at
// data + i · pixel_stride_bytes + j · row_stride_bytes. For a component of interleaved vectors, `data` points
// at that component of the first vector and the pixel stride is the vector's size.
struct Channel {
    std::string name;  // "R", "sun.G", "jacobianMean", …: unique in the image, 1 … 255 bytes
    const float* data = nullptr;
    std::ptrdiff_t pixel_stride_bytes = sizeof(float);
    std::ptrdiff_t row_stride_bytes = 0;  // 0: rows without gaps, width · pixel_stride_bytes
    PixelType type = PixelType::Float;
};

struct Image {
    int width = 0;   // > 0
    int height = 0;  // > 0
    std::vector<Channel> channels;
    // Of a scan-line picture whose pixels aren't just the display window's: where the first column and the top row lie from that
    // window's upper left corner, y down, and the window's width and height; 0: the image's own.
    int x = 0, y = 0;
    std::array<int, 2> display{};
};

// All lossless. Auto is None, the best for maps of a sea; exr.cpp has the measurement.
enum class Compression { Auto, None, Rle, Zips, Zip, Piz };

// CIE x, y of a picture's primaries and of its white.
struct Chromaticities {
    std::array<float, 2> red{}, green{}, blue{}, white{};
};

// Frames per second as the ratio that is closest: 24000/1001 for 23.976.
struct FramesPerSecond {
    double value = 24.0;
};

// SMPTE's time code of a frame, counted on in whole frames, not dropping any.
struct TimeCode {
    int frame = 0;
    int fps = 24;  // 1 … 30: the format has no frames beyond 29
};

// Of row vectors, as the format has it: v M, one row after another.
using Matrix = std::array<std::array<float, 4>, 4>;

// The format has 32-bit integers only: longer ones (seeds) are written as text.
using AttributeValue = std::variant<std::string, double, float, int, std::array<float, 2>,
                                    std::array<float, 3>, Chromaticities, FramesPerSecond, TimeCode, Matrix>;

struct Attribute {
    std::string name;  // 1 … 255 bytes, unique, and not one of the format's ("channels", "wrapmodes", …)
    AttributeValue value;
};

struct Header {
    std::vector<Attribute> attributes;  // in any order: the format sorts them by name
    bool periodic = false;              // wrapmodes "periodic,periodic", otherwise "clamp,clamp"
    Compression compression = Compression::Auto;
};

// The bytes of a text attribute in a file, for callers that look for one or fill it in after the file is encoded.
std::string text_attribute_bytes(std::string_view name, std::string_view value);

// The image as the bytes of a scan-line file.
// Throws std::invalid_argument, naming the problem, for: no pixels, no channels, no data; a channel or
// attribute name that is empty, too long, used twice or the format's own; a sample that is NaN or infinite
// (with channel, column and row); a sample beyond ±65504, the largest half, in a Half channel. It isn't
// clamped, because a clamped map looks right and is wrong; Float can store the value.
std::string encode_scanline(const Header& header, const Image& image);

// Deep pixels: each has samples of its own number.
struct DeepImage {
    int width = 0, height = 0;              // > 0
    std::span<const std::uint32_t> counts;  // width × height, rows from the top, x fastest
    std::vector<Channel> channels;          // of all pixels' samples one after another; no row stride
    int x = 0, y = 0;                       // as Image's
    std::array<int, 2> display{};
};

// As the bytes of a file of deep scan lines, each compressed alone (ZIPS, whatever the header says: the format has no more).
// Throws as encode_scanline(), naming the sample's number in place of column and row.
std::string encode_deep_scanline(const Header& header, const DeepImage& image);

// The number of mip levels of a picture of this size, down to 1 × 1. Level 0 is the picture itself; each
// further level has half the size, rounded down, at least 1 (OpenEXR's ROUND_DOWN).
int mip_level_count(int width, int height);
std::pair<int, int> mip_level_size(int width, int height, int level);

// The levels, from the full picture down to 1 × 1, as the bytes of a file of 64 × 64 tiles. The caller
// provides all levels, because filtered coverage isn't the average of coverage. Each has the size that
// mip_level_size() gives, and the same channels in the same order with the same types; strides may differ.
// Throws as encode_scanline(), and for a level that is missing or has another size or other channels.
std::string encode_mipmapped(const Header& header, std::span<const Image> levels);

}  // namespace pelagic::exr
