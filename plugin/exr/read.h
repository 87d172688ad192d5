// Pictures out of OpenEXR files, as red, green and blue.
//
// Knows the format and no physics: values are handed over as they are in the file, NaN and infinity included.
#pragma once

#include <array>
#include <filesystem>
#include <vector>

namespace pelagic::exr {

struct RgbPixels {
    int width = 0, height = 0;
    std::vector<std::array<float, 3>> pixels;  // rows from the top, x fastest
};

// The first part of a file, scan lines or tiles (of mip levels the full picture), channels R, G and B or Y
// alone (a grey picture), each half or float; other channels are not looked at.
// Throws std::runtime_error, naming the file, what is wrong and what is accepted, for a file that can't be
// opened, isn't OpenEXR or is damaged; one with deep pixels, without these channels, with channels of
// integers or of fewer samples than pixels; one whose data don't fill the picture exactly; one larger than
// 32768 pixels a side.
RgbPixels read_rgb(const std::filesystem::path& path);

}  // namespace pelagic::exr
