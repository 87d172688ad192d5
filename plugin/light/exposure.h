// The exposure of a shot's pictures on a screen, metered as a camera would.
#pragma once

#include <vector>

#include "core/lighting/floor.h"
#include "core/lighting/sky.h"
#include "core/surface/view.h"
#include "pelagic/scene.h"

namespace pelagic {

// The views that are metered: the shot's camera, or where it moves up to 16 of its keys, evenly chosen. They depend on
// the shot alone, not on the frames that are asked for, so that a shot has one exposure: a camera that turns does not
// change the sea's brightness.
std::vector<View> metered_views(const Scene& scene);

// Of the scene of a frame, as make_sky(): where light has keys each frame is metered, over all those views, so that the exposure follows
// the light and neither waves nor camera.
//
// The exposure for display_colour() (core/lighting/tone.h), brighter by `stops` and camera.exposure_ev: a factor of 2 for each. > 0
// and finite. camera.ev100, or else metered: the logarithmic mean of the luminance in those views: the sky without the sun's disc,
// and through the air before it a sea that is at rest in the mean, on the earth's sphere where the shot's is, with the slopes that
// Cox and Munk 1954 saw at the shot's wind, from below where the water has a body and the eye is deep in it, over the depths of sea.depth_file; less where white foam
// would be burnt out. So nothing has to be rendered; a table of air
// for each height of the eye takes some 40 ms. `sky` is the shot's own (make_sky()), and so is `floor` (make_floor()); without it a
// shot with a map of depths reads that anew, and throws as make_floor().
float shot_exposure(const Scene& scene, const Sky& sky, double stops = 0.0, const Floor* floor = nullptr);

// Whether the shot's first metered view is in the water as shot_exposure() has it: not if it is in the waves alone, nor where nothing can be
// seen from below.
bool is_metered_in_water(const Scene& scene);

}  // namespace pelagic
