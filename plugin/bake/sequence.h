// One sea, frame after frame, turned into the bytes of a bake's files. A frame's memory is its slot, which is used again
// for others; the sea's buffers are allocated once.
#pragma once

#include <memory>
#include <vector>

#include "plugin/bake/output_part.h"
#include "plugin/run/work.h"

namespace pelagic {

struct FrameSlot : RunSlot {
    std::vector<std::unique_ptr<OutputSlot>> outputs;  // by part
};

// In the plan's precision; its slots are FrameSlots. The plan must be one of a bake (plan_bake), and is copied. The files
// that belong to no frame are the stage, whose volumes, and whose light where it changes, are those of the frames that are named, topology, manifest; none
// without a mesh. Progress is told where a frame's foam has a long past.
// Throws BuildCancelled. What `watch` has to cancel outlives it: frames look at it too.
std::unique_ptr<Sequence> make_sequence(const Plan& plan, const BuildWatch& watch = {});

}  // namespace pelagic
