// The sky round a baked mesh, as the stage's dome shows it.
#pragma once

#include <string>
#include <string_view>

#include "core/lighting/sky.h"
#include "pelagic/scene.h"
#include "plugin/run/part.h"

namespace pelagic {

// Of a sky's file. content: sky_content() of its scene, which has no keys.
std::string sky_fingerprint(const Scene& scene, const std::string& content);

// The file of a sky without the sun's disc, a lat-long picture: its bytes. The scene, without keys, is what the sky was made of.
// fingerprint: in its header.
std::string dome_file(const Scene& scene, const Sky& sky, std::string_view fingerprint);

// Its files where the light changes; where it stays the same there is one (usd::sky_file()).
FilePattern dome_pattern(const Shot& shot);

}  // namespace pelagic
