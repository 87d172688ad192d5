// A Scene as text that is the same wherever and however the scene came about: what a fingerprint is made of.
#pragma once

#include <string>

#include "core/scene/scene.h"

namespace pelagic {

// Every value of the scene, one "key = value" a line, numbers in their shortest exact form, measured bins
// included. Scenes of the same text give the same frames under the same names. Left out is the range of
// frames alone: a frame is what it is whatever the range that was asked for, and a longer range must not make
// a bake do its finished frames again.
std::string canonical(const Scene& scene);

}  // namespace pelagic
