// Words that the lighting and the pictures share in Python.
#pragma once

#include <array>
#include <string>
#include <utility>

#include "core/lighting/lighting.h"

namespace pelagic::python {

// The layers of SeaRadiance by their names.
inline constexpr std::array<std::pair<const char*, glm::vec3 SeaRadiance::*>, 5> kLayers{
    {{"sun", &SeaRadiance::sun},
     {"sky", &SeaRadiance::sky},
     {"sea", &SeaRadiance::sea},
     {"foam", &SeaRadiance::foam},
     {"air", &SeaRadiance::air}}};

// pybind11::value_error for a word that is none.
SkyQuality sky_quality_of(const std::string& word);

}  // namespace pelagic::python
