// A Scene as text that is the same wherever and however the scene came about: what a fingerprint is made of.
#pragma once

#include <string>

#include "core/scene/keys.h"
#include "pelagic/scene.h"

namespace pelagic {

// Every key that has a value and a say in one of these parts: one "key = value" a line, in the order of the
// table of keys, numbers in their shortest exact form. A measured spectrum stands with all its bins in the line of
// its file, whose path does not count. Scenes with the same text are the same as far as these parts are concerned.
std::string canonical(const Scene& scene, KeyPartSet parts);

// The same for all keys except the range of frames. No frame depends on the range, and a bake with a longer range
// must not repeat its finished frames.
std::string canonical(const Scene& scene);

}  // namespace pelagic
