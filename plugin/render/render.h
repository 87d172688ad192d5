// Pictures from the CPU: the sea of a shot through its camera, lit by core/lighting. The same picture that
// the preview draws, and the one that it is measured against.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "core/lighting/lighting.h"
#include "core/plan/plan.h"
#include "core/scene/scene.h"
#include "core/surface/view.h"

namespace pelagic {

// One frame, HDR, rows from the top, x fastest; in the sky's units. The layers add up to the picture:
// `sky` is the sky that the sea reflects and, beside the sea, the sky itself.
struct Picture {
    glm::ivec2 resolution{0};
    std::vector<SeaRadiance> layers;
    std::vector<std::uint8_t> sea;  // 1: sea, 0: sky, by pixel
};

}  // namespace pelagic
