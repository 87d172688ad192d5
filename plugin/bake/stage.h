// The stage of a bake: the root layer that people open, the layers of camera and volumes and the sky's picture beside it. They are
// of the whole shot, whichever frames are baked. Sun, sky and water are those that pictures of the shot are lit by.
#pragma once

#include <cstddef>
#include <span>
#include <utility>

#include "core/plan/plan.h"
#include "pelagic/scene.h"
#include "plugin/bake/output_part.h"

namespace pelagic {

// Finds the light that the stage will have, before anything else is done: a picture of a sky may be no such thing.
// Throws as make_sky() does. write_stage() takes it from here.
void prepare_light(const Scene& scene);

// The first and the last frame at which light has keys; the shot's first where it has none. Between them a stage has a sky for each frame.
std::pair<int, int> light_keys(const Scene& scene);

// How large the camera's layer becomes [bytes].
std::size_t camera_layer_bytes(const Scene& scene);

// Hands them to the sink, the root last; the layer of volumes names those of `volume_frames`. The plan must have a mesh. Throws as
// make_sky() does.
void write_stage(const Plan& plan, const OutputPart& mesh, std::span<const int> volume_frames,
                 const FileSink& sink);

}  // namespace pelagic
