// A Scene as text that is the same wherever and however the scene came about: what a fingerprint is made of.
#pragma once

#include <string>

#include "core/scene/keys.h"
#include "core/scene/scene.h"

namespace pelagic {

// Every key that feeds one of these parts and has a value, one "key = value" a line, in the order of the
// table of keys, numbers in their shortest exact form. A measured spectrum stands with all its bins in the
// line of its file, whose path does not count. Scenes of the same text are the same sea as far as these parts
// go.
std::string canonical(const Scene& scene, FeedSet parts);

// The same of all keys but the range of frames: a frame is what it is whatever the range that was asked for,
// and a longer range must not make a bake do its finished frames again.
std::string canonical(const Scene& scene);

}  // namespace pelagic
