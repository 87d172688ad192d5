// A shot file's text with other values.
#pragma once

#include <string>
#include <string_view>

#include "pelagic/scene.h"

namespace pelagic {

// `text`, a shot file that describes `base`, with the keys written into it whose values differ in `scene`, and its edition: each where
// it stands, or else in its table. Comments and everything else stay. Text that gives its tables in another way than
// under their [headers] or inline may come out wrong: read it again, with parse_shot(). ShotError for text that is no
// TOML, and for other [[objects]].
std::string edited_shot(std::string_view text, const Scene& scene, const Scene& base);

}  // namespace pelagic
