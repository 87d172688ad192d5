// A Scene as the text of a shot file.
#pragma once

#include <string>

#include "pelagic/scene.h"

namespace pelagic {

// The keys whose values differ from those of `base`, as tables of a shot file (TOML); "" if none does. Read
// as a shot file it gives the scene again where `base` is the defaults; else it is what has to change in the
// shot file of `base`. A measured spectrum is named by its file and time. What can't be written is a key that
// `base` gives and the scene doesn't: its line has to be deleted.
std::string shot_text(const Scene& scene, const Scene& base = {});

}  // namespace pelagic
