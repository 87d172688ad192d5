// What the files of volumes and the stage both say of them.
#pragma once

#include "core/plan/plan.h"
#include "core/plan/spray.h"
#include "plugin/bake/output_part.h"
#include "plugin/format/usd/volumes.h"

namespace pelagic {

// The height above which spray's profile is this small, and the share of the sea's mean below which a column has none:
// what is left out. Each takes at most as much of the whole.
inline constexpr double kNegligibleSpray = 1e-3;
double spray_top_m(const SprayLaw& law);

// A level set's floor lies so far below the deepest trough that is to be expected.
inline constexpr double kBelow_voxels = 8.0;

FilePattern volume_pattern(const Scene& scene, VolumeKind volume);
// Without its files. The extent is by expectation, as the sea's own (core/plan/extent.h).
usd::Volume volume_prim(const Plan& plan, VolumeKind volume);

}  // namespace pelagic
