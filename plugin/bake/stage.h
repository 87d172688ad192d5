// The stage of a bake: the root layer that people open, and the camera's layer beside it. Both are of the
// whole shot, whichever frames are baked.
#pragma once

#include "core/plan/plan.h"
#include "plugin/bake/output_part.h"

namespace pelagic {

// Hands both to the sink, the root last. The plan must have a mesh.
void write_stage(const Plan& plan, const OutputPart& mesh, const FileSink& sink);

}  // namespace pelagic
