// The sky round a baked mesh, as the stage's dome shows it.
#pragma once

#include <string>
#include <string_view>

#include "core/lighting/sky.h"
#include "pelagic/scene.h"
#include "plugin/run/part.h"

namespace pelagic {

// What a sky is made of, as text, but for the bytes of its picture (sky_content()). The scene without keys.
std::string sky_text(const Scene& scene);

// The file of a sky without the sun's disc, a lat-long picture: its bytes. The scene, without keys, is what the sky was made of.
// fingerprint: in its header, where it has one.
std::string dome_file(const Scene& scene, const Sky& sky, std::string_view fingerprint = {});

// Its files where the light changes; where it stays the same there is one (usd::sky_file()).
FilePattern dome_pattern(const Shot& shot);

}  // namespace pelagic
