// The passes of a picture: what is blurred by a shutter or a lens is a mean over moments and over places in the
// aperture. A pass has one of each for all of the picture, since the whole sea is computed for it.
//
// Were every pixel to take all passes, a picture would show so many ghosts of whatever moves or is out of focus.
// There are more passes than a pixel has samples, and each pixel takes its own: one of each stratum, by a random
// number of the pixel and the frame (a scrambled stratified sequence: Cranley and Patterson 1976, Kollig and Keller
// 2002). So the error is noise as fine as pixels. Which of its places in the pixel a sample has is its own too; the places are those of
// sharp pictures, so that what stands still and is in focus looks as there.
#pragma once

#include <cstdint>
#include <glm/common.hpp>
#include <glm/vec2.hpp>
#include <vector>

#include "core/surface/view.h"
#include "pelagic/scene.h"
#include "plugin/render/raster.h"
#include "plugin/render/render.h"

namespace pelagic {

struct PicturePass {
    double frame = 0.0;
    glm::dvec2 lens{0.0};  // in the unit disc of the aperture
    int stratum = 0, part = 0;
};

// The first is the frame's own, through the lens' middle. Others follow where a shutter is open or a lens is, and there
// is more than one sample a pixel; then the first is for what isn't blurred. Strata, as many as a pixel has samples, one
// after another with their parts.
struct PicturePasses {
    std::vector<PicturePass> all;
    int parts = 0;  // of each stratum
};
PicturePasses passes_of(const Camera& camera, int frame, const RenderOptions& options);

// What a pass sees, in a picture with that overscan [pixels of the camera's resolution].
View view_of(const Camera& camera, const PicturePass& pass, glm::ivec2 overscan_px = glm::ivec2(0));

// Where in its cell a pixel's sample lies, from the middle, in cells: −½ … ½. Of a pixel's n × n cells no two samples stand in one row
// or column, so that an edge that is nearly level, as a horizon is, takes n² steps from one pixel to the next, and not n
// (a rotated grid; Shirley 1991's n-rooks, in order). In whole 1/256, as the rasteriser has them.
inline glm::dvec2 place_in_cell(int n, glm::ivec2 cell) {
    return glm::round(256.0 * ((glm::dvec2(n - 1 - cell.y, cell.x) + 0.5) / static_cast<double>(n) - 0.5)) /
           256.0;
}

// Whether the pixel takes the pass, one of the frame's, and where in itself; samples: as many a side. Each pixel takes one
// pass of every stratum, and its places are those in samples × samples cells.
PixelPlace place_of(const PicturePass& pass, int parts, int samples, int frame, glm::ivec2 pixel);

}  // namespace pelagic
