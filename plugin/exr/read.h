// Reads pictures from OpenEXR files as red, green and blue.
//
// Knows the format and no physics: values are returned as they are in the file, including NaN and infinity.
#pragma once

#include <array>
#include <filesystem>
#include <vector>

namespace pelagic::exr {

struct RgbPixels {
    int width = 0, height = 0;
    std::vector<std::array<float, 3>> pixels;  // rows from the top, x fastest
};

// Reads the first part of a file: scan lines or tiles (level 0 if there are mip levels), channels R, G and B,
// or Y alone (a grey picture), each half or float. Other channels are ignored.
// Throws std::runtime_error, naming the file, the problem and what is accepted, for a file that can't be
// opened, isn't OpenEXR or is damaged; for deep pixels; for missing channels, channels of integers or with
// fewer samples than pixels; for data that don't fill the picture exactly; and for more than 32768 pixels per
// side.
RgbPixels read_rgb(const std::filesystem::path& path);

// Whether the file is an image in scan lines whose last one is there: false for a file that was cut short, that is
// missing, or that can't be read.
bool ends_whole(const std::filesystem::path& file);

}  // namespace pelagic::exr
