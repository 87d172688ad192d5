// A Scene as the text of a shot file.
#pragma once

#include <string>

#include "pelagic/scene.h"

namespace pelagic {

// The scene as a shot file (TOML), which gives it again when it is read: its edition, and the keys that differ from that edition's
// defaults. A measured spectrum is named by its file and time.
std::string shot_text(const Scene& scene);

// The keys whose values differ from those of `base`, as tables of a shot file; "" if none does: what has to change in the shot file
// of `base`. What can't be written is a key that `base` gives and the scene doesn't: its line has to be deleted.
std::string shot_text(const Scene& scene, const Scene& base);

}  // namespace pelagic
