// The stage of a bake: the root layer that people open, the layers of camera and volumes and the sky's picture beside it. They are
// of the whole shot, whichever frames are baked; of a very long one files that come frame by frame are named where they are. Sun, sky and water are those that pictures of the shot are lit by. The skies of a light
// that changes are their frames' (sky_part.h).
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>

#include "core/plan/plan.h"
#include "pelagic/scene.h"
#include "plugin/bake/output_part.h"

namespace pelagic {

// Makes the light that the stage will have, before the sea takes its memory and the folder is locked: a picture of a sky may be no
// such thing, and has the sun; a daylight's that the folder seems to have already isn't made. Throws as make_sky() does.
// write_stage() takes it from here.
void prepare_light(const Scene& scene, const std::filesystem::path& folder);

// How large the camera's layer becomes [bytes].
std::size_t camera_layer_bytes(const Scene& scene);

// Hands them to the sink, the root last; the layer of volumes, and a light that changes, name the files of these frames. The plan must
// have a mesh. A light that changes takes 0.1 ms a frame. Throws as make_sky() does.
void write_stage(const Plan& plan, const OutputPart& mesh, std::span<const int> frames, const FileSink& sink);

}  // namespace pelagic
