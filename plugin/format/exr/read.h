// Reads pictures from OpenEXR files as red, green and blue.
//
// Knows the format and no physics: values are returned as they are in the file, including NaN and infinity.
#pragma once

#include <array>
#include <filesystem>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace pelagic::exr {

// A file that is no such picture. what() is the whole message, which names the file; the parts are for callers that
// add where the file was named.
class ReadError : public std::runtime_error {
  public:
    ReadError(const std::string& file, std::string problem, std::string accepted)
        : std::runtime_error("'" + file + "' " + problem + "; accepted: " + accepted),
          problem_(std::move(problem)),
          accepted_(std::move(accepted)) {}
    const std::string& problem() const { return problem_; }  // the end of a sentence: "has deep pixels"
    const std::string& accepted() const { return accepted_; }

  private:
    std::string problem_, accepted_;
};

// The first part of a file: scan lines or tiles (level 0 if there are mip levels), channels R, G and B, or Y alone
// (a grey picture), each half or float. Other channels are ignored.
//
// Throws ReadError for a file that can't be opened, isn't OpenEXR, or is cut short, as far as its tables and its
// size say; for deep pixels; for missing channels, channels of integers or with fewer samples than pixels; for data
// that don't fill the picture exactly; for more than 32768 pixels per side; and for tiles so high that a row of them
// takes gigabytes to read. Pixels aren't read for that: it takes a moment, whatever the picture's size.
class RgbFile {
  public:
    explicit RgbFile(std::filesystem::path path);

    int width() const { return width_; }
    int height() const { return height_; }
    // Rows are stored in pieces of this many, from the top: reading whole pieces decodes nothing twice.
    int rows_in_piece() const { return rows_in_piece_; }

    // Rows from the top, x fastest, three floats a pixel: as many from the first one as there is room for, a whole
    // number of them. Several threads may read, each its own rows. Throws ReadError for damaged data.
    void read(int first_row, std::span<float> rgb) const;

  private:
    std::filesystem::path path_;
    int width_ = 0, height_ = 0, rows_in_piece_ = 1;
    bool is_grey_ = false;
};

// All of such a file at once.
struct RgbPixels {
    int width = 0, height = 0;
    std::vector<std::array<float, 3>> pixels;  // rows from the top, x fastest
};
RgbPixels read_rgb(const std::filesystem::path& path);

// Whether the file is an image in scan lines, flat or deep, whose last line is there, judged as RgbFile does: false for a file that
// was cut short, is missing, or can't be read.
bool ends_whole(const std::filesystem::path& path);

}  // namespace pelagic::exr
