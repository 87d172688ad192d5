// The map of the spray before a camera (core/lighting/spray.h), from what evaluate() says of the sea at places of the world.
#pragma once

#include <cstddef>

#include "core/lighting/spray.h"
#include "core/plan/spray.h"
#include "core/surface/projected_grid.h"
#include "core/surface/view.h"
#include "core/waves/frame.h"

namespace pelagic {

struct SprayMapSize {
    int columns = 2, rows = 2;
};
// In proportion to the picture's width, whatever its samples, up to where finer cells show no more. Accuracy and time: tests/bench/README.md.
SprayMapSize spray_map_size(int picture_width);

// [bytes] of the map and of what it is made from.
std::size_t spray_map_bytes(SprayMapSize size);

// What the law alone says: no map, and without light.
Spray spray_by(const SprayLaw& law);

// Without light yet. Query 0 of the frame's plan is that of pictures (picture_plan()), with Product::Displacement; the footprints
// of no texel are finer than the view's own pixels. Columns span what the view sees, or the whole circle where it sees its nadir or the zenith. Rows
// go from a part of the eye's height to where the layer is behind the horizon. Texels are means over themselves, and over
// two metres at least, where volumes have a voxel's. Ribbons are means over as much as rows are apart, and columns where those are farther apart,
// by a normal distribution round each texel: what a ray takes as linear between texels has no trace of their grid. So near the camera a
// picture's spray is smoother than a fine volume's; through a long lens it is so farther off: by a tenth of the width of a picture of 10°. Empty where the
// scene has no spray, and where no wave breaks. `drops`: the large drops near the eye are shown one by one (seen_drops.h); otherwise
// they are in it. On all threads of the calling arena; the same bits whatever their number.
template <class T>
Spray make_spray_map(const Frame<T>& frame, const View& view, const ProjectedGridOptions& options,
                     SprayMapSize size, bool drops = false);

}  // namespace pelagic
