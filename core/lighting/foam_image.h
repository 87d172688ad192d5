// An artist's pattern of foam, as foam_structure.glsl reads it: a square picture that tiles, brightest where foam is thickest.
//
// A pattern's values have the normal distribution, so that foam lies above the coverage's quantile. A picture's brightness gets
// it by rank: the share of the picture that is darker is the share of a normal distribution that is lower. Each mip level is
// the mean of four texels of the one before, ranked again and given back the variance that the mean left: so at every level, and
// at every coverage, the mean stays the coverage, whatever the picture's own distribution is.
#pragma once

#include <memory>
#include <span>
#include <vector>

namespace pelagic {

struct FoamImage {
    static constexpr int kLeastSide = 16, kMostSide = 4096;

    int side = 1;  // texels of level 0; 1: no picture
    // Rows of `side` texels, y rising: level 0, then each further level, which takes less of its rows, down to 1 × 1; and a row with the
    // variance of each level between its texels, too.
    std::vector<float> texels{0.0f, 0.0f};

    int rows() const { return 2 * side; }
};

// Throws as make_foam_image() does for such a side.
void check_foam_image_side(int side);
// Of brightnesses in rows, side × side, y rising. Throws std::invalid_argument, for a message after the file's name, if the side is no
// power of two in the range, if a brightness isn't finite, and where all are the same.
FoamImage make_foam_image(int side, std::span<const float> brightness);

}  // namespace pelagic
