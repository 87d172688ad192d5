// Whether the values of a Scene make sense, each alone and together. Knows no file: who read the values from
// one adds the place (plugin/format/shot).
#pragma once

#include <vector>

#include "core/scene/problem.h"
#include "pelagic/scene.h"

namespace pelagic {

// Every problem of the scene, in the order of the shot file's tables; empty: the scene can be planned.
//
// Ranges are those of scene/limits.h: a NaN is never accepted, infinity only as a depth. Cascades must come largest first and leave
// no wavenumber out between two of them (scene/cascade_bands.h).
//
// Whitecaps that are off: the attribute "whitecaps" is then simply not written, because the attributes'
// default contains it and whoever turns the effect off wants no coverage. A *map* of them is never a default:
// asking for one while the effect is off is a contradiction, and refused.
//
// A camera on its own target looks nowhere: refused, for each key and for the straight way between two keys.
std::vector<Problem> validate(const Scene& scene);

}  // namespace pelagic
