// OpenEXR files in memory: maps of any channels, one part, as scan lines or as tiles with the caller's own
// mip levels.
//
// Knows the format and no physics. The bytes depend on the arguments alone: no time stamp, no thread count in
// them.
//
// Orientation. Callers hand rows in the order of rising y, the way the sea is computed: the sample in column
// i and row j of n columns and m rows over a rectangle of size L × H centred on the origin lies at
//     x = −L/2 + i·L/n,    y = −H/2 + j·H/m,
// at pixel *corners*: none on the far edges, which in a periodic map are the near edges again. In the file
// the picture is seen with north on top: its bottom row is j = 0, and the encoder does the turning (OpenEXR
// counts scan lines from the top). A mip level has the same first corner and the same L and H, with fewer
// samples.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace pelagic::exr {

enum class PixelType {
    Half,  // 11 significant bits, 6.1e-5 … 65504 at full precision; for directions and fractions
    Float,
};

// One channel, read where it lies in the caller's memory: sample (column i, row j), y rising with j, is
// i · pixel_stride_bytes + j · row_stride_bytes after `data`. One component of interleaved vectors: data
// points at that component in the first vector, the pixel stride is the vector's size.
struct Channel {
    std::string name;  // "R", "xx", "coverage", …: unique in the image, 1 … 255 bytes
    const float* data = nullptr;
    std::ptrdiff_t pixel_stride_bytes = sizeof(float);
    std::ptrdiff_t row_stride_bytes = 0;  // 0: rows without a gap, width · pixel_stride_bytes
    PixelType type = PixelType::Float;
};

struct Image {
    int width = 0;   // > 0
    int height = 0;  // > 0
    std::vector<Channel> channels;
};

// All lossless. Auto is what suits a map of a sea: None; exr.cpp has the measurement.
enum class Compression { Auto, None, Rle, Zips, Zip, Piz };

// A 32-bit integer is all that the format has: longer ones (seeds) go in as text.
using AttributeValue =
    std::variant<std::string, double, float, int, std::array<float, 2>, std::array<float, 3>>;

struct Attribute {
    std::string name;  // 1 … 255 bytes, unique, and none of the format's own ("channels", "wrapmodes", …)
    AttributeValue value;
};

struct Header {
    std::vector<Attribute> attributes;  // the format keeps them sorted by name, whatever the order here
    bool periodic = false;              // wrapmodes "periodic,periodic", else "clamp,clamp"
    Compression compression = Compression::Auto;
};

// The image as the bytes of a scan-line file.
// Throws std::invalid_argument, naming what is wrong, for: no pixels, no channels, no data; a channel or
// attribute name that is empty, too long, used twice or the format's own; a sample that is NaN or infinite,
// naming channel, column and row; a sample in a Half channel that is beyond ±65504, the largest that a half
// holds (refused and not clamped: a clamped map looks whole and is wrong, and Float takes the value as it
// is).
std::string encode_scanline(const Header& header, const Image& image);

// The number of mip levels of a picture of this size, down to 1 × 1, and the size of one level, 0 being the
// picture itself: halves rounded down, at least 1 (OpenEXR's ROUND_DOWN).
int mip_level_count(int width, int height);
std::pair<int, int> mip_level_size(int width, int height, int level);

// The levels, from the full picture down to 1 × 1, as the bytes of a file of 64 × 64 tiles. All levels come
// from the caller, because filtered coverage isn't the average of coverage. Each has the size that
// mip_level_size() says and the same channels in the same order with the same types; strides may differ.
// Throws as encode_scanline(), and for a level that is missing or has another size or other channels.
std::string encode_mipmapped(const Header& header, std::span<const Image> levels);

}  // namespace pelagic::exr
