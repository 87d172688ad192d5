// A whole shot file into a Scene, key by key of core/scene/keys.h.
#pragma once

#include <toml++/toml.h>

#include "pelagic/scene.h"
#include "plugin/format/shot/reader.h"

namespace pelagic {

// Values that can't be used are told to the reader, and stay at the defaults of the file's edition. A measured spectrum, a
// cage and a sky's picture are not loaded here.
Scene read_scene(Reader& reader, const toml::table& root);

}  // namespace pelagic
